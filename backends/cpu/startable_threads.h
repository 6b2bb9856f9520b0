/* How many threads a process can still start. */
#ifndef PBF_CPU_THREAD_ROOM_H
#define PBF_CPU_THREAD_ROOM_H

#include <stddef.h>
#include <stdint.h>

/* 0 … wanted, that many at once, with such stacks (0: the system's default): they have been
 * started, and have ended. Limits of users, control groups and of memory count alike. Others may
 * take them at any time. */
uint32_t startable_threads(uint32_t wanted, size_t stack_bytes);

/* The calling thread's number, and whether a thread of this process has that number: always, where
 * the system can't tell. */
long thread_number(void);
int thread_is_there(long number);

/* Waits until none has it; 0: one still has, after so many seconds. */
int thread_has_ended(long number, double seconds);

#endif
