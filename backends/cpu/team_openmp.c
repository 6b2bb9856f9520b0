/* Threads by OpenMP, with a barrier of their own: a step has some fifteen barriers, and OpenMP's
 * costs as much as a stage of a small scene, and far more where a thread has to wait for a core. */
#include <omp.h>
#include <sched.h>
#include <stdatomic.h>

#include "cpu/team.h"

/* More threads than that gain nothing. */
enum { MOST_THREADS = 256 };

/* How often a waiting thread looks before it offers its core to others. */
enum { PATIENCE = 2000 };

typedef struct line {
  _Alignas(64) atomic_uint barriers;
} line;

/* Each thread counts the barriers that it has reached on a cache line of its own; the first one
 * sees that all are there, and lets them go. */
struct team {
  line go;
  line reached[MOST_THREADS];
};

uint32_t team_size(uint32_t wanted) {
  uint32_t threads = wanted ? wanted : (uint32_t)omp_get_max_threads();
  return threads < MOST_THREADS ? threads : MOST_THREADS;
}

void team_run(uint32_t threads, team_function function, void *context) {
  team all;
  atomic_init(&all.go.barriers, 0);
  for (uint32_t t = 0; t < threads; ++t) atomic_init(&all.reached[t].barriers, 0);
#pragma omp parallel num_threads((int)threads)
  {
    member me = {.team = &all,
                 .thread = (uint32_t)omp_get_thread_num(),
                 .threads = (uint32_t)omp_get_num_threads()};
    function(context, &me);
  }
}

static void wait_for(atomic_uint *barriers, uint32_t number) {
  for (int looks = 0; atomic_load_explicit(barriers, memory_order_acquire) != number; ++looks) {
    if (looks >= PATIENCE) {
      sched_yield();
      continue;
    }
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
  }
}

void team_barrier(member *me) {
  team *all = me->team;
  uint32_t number = ++me->barriers;
  if (me->threads == 1) return;
  if (me->thread == 0) {
    for (uint32_t t = 1; t < me->threads; ++t) wait_for(&all->reached[t].barriers, number);
    atomic_store_explicit(&all->go.barriers, number, memory_order_release);
  } else {
    atomic_store_explicit(&all->reached[me->thread].barriers, number, memory_order_release);
    wait_for(&all->go.barriers, number);
  }
}
