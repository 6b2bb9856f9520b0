/* Part of iteration.h: solves that end once their density error is small enough. The host does not
 * learn of it: kernels of iterations after that find nothing to do. */
#ifndef PBF_CUDA_CONVERGENCE_H
#define PBF_CUDA_CONVERGENCE_H

#include <stdint.h>

#include "physics/features.h"

/* Whether the build has them. */
constexpr bool PBF_TOLERANCE = (PBF_BUILT & PBF_FEATURE_TOLERANCE) != 0;

/* The state of a solve that ends by its density error. An iteration's
 * lambda adds the error to its own of the two sums, and its move looks at it and clears the other
 * one. */
struct convergence_state {
  unsigned long long error_units[2]; /* iterations take turns */
  uint32_t done;                     /* iterations after which the solve has ended; 0: it goes on */
};

/* What an iteration needs to watch. */
struct convergence_check {
  convergence_state *watch; /* null: not checked for convergence */
  long long limit;          /* of the sum at which the solve ends, */
  int32_t inactive;         /* and the part in it of a particle that does not solve */
  uint32_t iteration;
};

/* Whether the solve has ended before this iteration. A move that ends it says so in `done` while it
 * runs, with a number above its own iteration. */
static __device__ __forceinline__ bool is_converged(const convergence_check &w) {
  uint32_t done = *static_cast<const volatile uint32_t *>(&w.watch->done);
  return done != 0 && done <= w.iteration;
}

/* Whether the move of this iteration, which is over, has ended the solve. */
static __device__ __forceinline__ bool has_ended(const convergence_check &w) {
  return *static_cast<const volatile uint32_t *>(&w.watch->done) == w.iteration + 1;
}

/* Adds up the errors of a warp's particles, of which the first `alive` lanes have one. */
static __device__ __forceinline__ void add_error_units(const convergence_check &w, uint32_t alive,
                                                       int32_t error_units) {
  uint32_t lane = threadIdx.x % 32, mask = alive < 32 ? (1u << alive) - 1 : ~0u;
  unsigned long long sum = (unsigned long long)error_units;
  for (uint32_t step = 16; step > 0; step /= 2) {
    unsigned long long other = __shfl_down_sync(mask, sum, step);
    if (lane + step < alive) sum += other;
  }
  if (lane == 0 && sum) atomicAdd(&w.watch->error_units[w.iteration % 2], sum);
}

/* Whether the iteration of which lambda is known ends the solve; one thread of all notes it. */
static __device__ __forceinline__ bool ends(const convergence_check &w, bool last,
                                            uint32_t thread) {
  bool over = last || (long long)w.watch->error_units[w.iteration % 2] <= w.limit;
  if (thread == 0) {
    w.watch->error_units[(w.iteration + 1) % 2] = 0;
    if (over) w.watch->done = w.iteration + 1;
  }
  return over;
}

#endif
