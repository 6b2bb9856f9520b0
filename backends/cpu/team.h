/* The threads of a solver: what the `serial` and the `openmp` plugin do not share. Everything that
 * computes is the same object code in both; it cuts its work by thread number, and no result
 * depends on where the cuts are. */
#ifndef PBF_CPU_TEAM_H
#define PBF_CPU_TEAM_H

#include <stdint.h>

typedef void (*team_function)(void *context, uint32_t thread, uint32_t threads);

/* Threads that a solver gets when its description asks for `wanted` (0: all there are). */
uint32_t team_size(uint32_t wanted);

/* Calls `function` in up to `threads` threads at once, thread 0 being the caller's. */
void team_run(uint32_t threads, team_function function, void *context);

/* Within `function`: no thread goes on before all have come here. */
void team_barrier(void);

#endif
