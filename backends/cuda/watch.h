/* Solves that end once their density error is small enough. The host does not learn of it: kernels
 * of iterations after that find nothing to do. */
#ifndef PBF_CUDA_WATCH_H
#define PBF_CUDA_WATCH_H

#include <stdint.h>

#include "physics/features.h"

/* Whether the build has them. */
constexpr bool PBF_TOLERANCE = (PBF_BUILT & PBF_FEATURE_TOLERANCE) != 0;

/* How a watched solve stands: one whose density error ends it. An iteration's lambda adds the error
 * to its own of the two sums, and its move looks at it and clears the other one. */
struct solve_watch {
  unsigned long long excess[2]; /* iterations take turns */
  uint32_t done;                /* iterations after which the solve has ended; 0: it goes on */
};

/* What an iteration needs to watch. */
struct watch_pass {
  solve_watch *watch; /* null: not watched */
  long long limit;    /* of the sum at which the solve ends, */
  int32_t idle;       /* and the part in it of a particle that does not solve */
  uint32_t iteration;
};

/* Whether the solve has ended before this iteration. A move that ends it says so in `done` while it
 * runs, with a number above its own iteration. */
static __device__ __forceinline__ bool is_over(const watch_pass &w) {
  uint32_t done = *static_cast<const volatile uint32_t *>(&w.watch->done);
  return done != 0 && done <= w.iteration;
}

/* Adds up the errors of a warp's particles, of which the first `alive` lanes have one. */
static __device__ __forceinline__ void add_excess(const watch_pass &w, uint32_t alive,
                                                  int32_t excess) {
  uint32_t lane = threadIdx.x % 32, mask = alive < 32 ? (1u << alive) - 1 : ~0u;
  unsigned long long sum = (unsigned long long)excess;
  for (uint32_t step = 16; step > 0; step /= 2) {
    unsigned long long other = __shfl_down_sync(mask, sum, step);
    if (lane + step < alive) sum += other;
  }
  if (lane == 0 && sum) atomicAdd(&w.watch->excess[w.iteration % 2], sum);
}

/* Whether the iteration whose lambda is known ends the solve; one thread of all notes it. */
static __device__ __forceinline__ bool ends(const watch_pass &w, bool last, uint32_t thread) {
  bool over = last || (long long)w.watch->excess[w.iteration % 2] <= w.limit;
  if (thread == 0) {
    w.watch->excess[(w.iteration + 1) % 2] = 0;
    if (over) w.watch->done = w.iteration + 1;
  }
  return over;
}

#endif
