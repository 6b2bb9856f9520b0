/* The threads of a solver: what the `serial` and the `openmp` plugin do not share. Everything that
 * computes is the same object code in both; it cuts its work by thread number, and no result
 * depends on where the cuts are. */
#ifndef PBF_CPU_TEAM_H
#define PBF_CPU_TEAM_H

#include <stdint.h>

typedef struct team team;

/* One thread's place in a running team. */
typedef struct member {
  team *team;
  uint32_t thread, threads;
  uint32_t barriers; /* that this thread has passed */
} member;

typedef void (*team_function)(void *context, member *me);

/* Threads that a solver gets when its description asks for `wanted` (0: all there are). */
uint32_t team_size(uint32_t wanted);

/* Calls `function` in up to `threads` threads at once, thread 0 being the caller's. */
void team_run(uint32_t threads, team_function function, void *context);

/* Within `function`: no thread goes on before all have come here. */
void team_barrier(member *me);

#endif
