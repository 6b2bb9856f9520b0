#include "cpu/team.h"

#include <omp.h>

/* More threads than that gain nothing, and each costs a slot. */
enum { MOST_THREADS = 1024 };

uint32_t team_size(uint32_t wanted) {
  uint32_t threads = wanted ? wanted : (uint32_t)omp_get_max_threads();
  return threads < MOST_THREADS ? threads : MOST_THREADS;
}

void team_run(uint32_t threads, team_function function, void *context) {
#pragma omp parallel num_threads((int)threads)
  function(context, (uint32_t)omp_get_thread_num(), (uint32_t)omp_get_num_threads());
}

void team_barrier(void) {
#pragma omp barrier
}
