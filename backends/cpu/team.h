/* The threads of a solver: what the `serial`, `threads` and `openmp` plugins do not share.
 * Everything that computes is the same object code for all (core.h): loops over tasks of the work.
 * Results depend neither on how many tasks there are, nor on which thread did which. */
#ifndef PBF_CPU_TEAM_H
#define PBF_CPU_TEAM_H

#include <stdint.h>

#include <pbf/pbf.h>

#include "common/system.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct team team;

/* In a loop that waits for another thread: `looks` counts its turns from 1. After many of
 * them the core is offered to others. */
static inline void wait_a_little(unsigned *looks) {
  enum { LOOKS_BEFORE_YIELD = 2000 };
  if (++*looks >= LOOKS_BEFORE_YIELD) {
    pbf_yield();
    return;
  }
#if defined(__x86_64__)
  __builtin_ia32_pause();
#endif
}

typedef struct team_api team_api;

/* One thread's place in a running team. */
typedef struct team_thread {
  const team_api *api;
  struct team *team;
  uint32_t thread, threads;
  uint32_t loops; /* that this thread has come to */
  uint64_t tasks; /* in these loops */
  uint64_t done;  /* of them, by this thread */
  double waited;  /* seconds, in loops that took long to end */
} team_thread;

typedef void (*team_function)(void *context, team_thread *self);
typedef void (*task_function)(void *context, uint32_t task);
typedef void (*completion_function)(void *context);

/* Most tasks of a loop: a power of two less 1. */
enum { TEAM_MAX_TASKS = 0xffff };

/* Of the memory in which a team meets. */
enum { TEAM_ALIGNMENT = 64 };

/* A caller's task system; without one `enqueue` is null. */
typedef struct team_tasks {
  pbf_enqueue_task_fn enqueue;
  pbf_finish_task_fn finish;
  void *user;
} team_tasks;

/* What a plugin gives to the solver. */
struct team_api {
  /* 1: runs may have other numbers of threads than those before at no cost. */
  int resizes;

  /* 1: the team starts threads whether there is a task system or not. */
  int ignores_tasks;

  /* Steps times particles that a team runs at once; how many threads it has may change in between.
   */
  uint64_t run_length;

  /* Threads that a solver gets when its description asks for `wanted` (0: all there are). */
  uint32_t (*size)(uint32_t wanted);

  /* Of these, those that a run in the calling thread has now: fewer in a process that can't start
   * so many, and one in the child of a fork. */
  uint32_t (*threads)(uint32_t threads);

  /* Bytes of the memory, aligned to TEAM_ALIGNMENT, in which such a team meets. */
  uint64_t (*bytes)(uint32_t threads);

  /* The life of a solver: a team runs only between these two. */
  void (*begin)(void);
  void (*end)(void);

  /* Calls `function` in up to `threads` threads at once, thread 0 being the caller's. */
  void (*run)(const team_tasks *tasks, team *all, uint32_t threads, team_function function,
              void *context);

  void (*parallel_for)(team_thread *self, uint32_t tasks, task_function task,
                       completion_function last, void *context);
};

/* A plugin has one of them: the source that defines it is what it is linked with. */
extern const team_api cpu_team;

/* A loop that the whole team shares. Within `function` every thread calls this for the same loops
 * in the same order; `task` is then called once for each task, in whatever thread is free, and
 * when all are done `last`, unless null, once in one of them. Returns when all this has been done.
 *
 * No thread waits for one that has nothing in hand: a thread may come to a loop when the others
 * are long past it. So what other threads write may be read in `task` and `last` alone; between
 * loops a thread knows only what it works out for itself. `context` is the calling thread's own. */
static inline void parallel_for(team_thread *self, uint32_t tasks, task_function task,
                                completion_function last, void *context) {
  self->api->parallel_for(self, tasks, task, last, context);
}

#ifdef __cplusplus
}
#endif

#endif
