/* How many threads are worth having for so many particles. */
#ifndef PBF_CPU_TEAM_WORTH_H
#define PBF_CPU_TEAM_WORTH_H

#include <math.h>
#include <stdint.h>

/* What a step costs with so many threads, in particles that one thread does alone: a team's loops
 * cost as much as a few hundred beside their work, as measured with 1 to 16 threads. */
static inline double team_cost(double particles, uint32_t threads) {
  return threads > 1 ? particles / threads + 150 + 12 * (double)threads : particles;
}

/* The number, up to `most`, with which a step costs least. */
static inline uint32_t team_worth(double particles, uint32_t max_threads) {
  const double cheapest = sqrt(particles / 12);
  uint32_t threads = cheapest < max_threads ? (uint32_t)cheapest : max_threads;
  if (threads < max_threads && team_cost(particles, threads + 1) < team_cost(particles, threads))
    ++threads;
  return team_cost(particles, threads) < particles ? threads : 1;
}

#endif
