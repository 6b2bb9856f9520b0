/* What a particle sums over its neighbours in an iteration, and how that ends; the same wherever
 * the neighbours come from. */
#ifndef PBF_CUDA_SUMS_H
#define PBF_CUDA_SUMS_H

#include "cuda/sort.h"
#include "physics/passes/lambda.h"
#include "physics/passes/move.h"
#include "physics/passes/velocity.h"
#include "physics/scalar.h"

/* Whether the build has the accelerated solve. */
constexpr bool PBF_CHEBYSHEV = (PBF_BUILT & PBF_FEATURE_CHEBYSHEV) != 0;

/* Whether it has solves that end early. */
constexpr bool PBF_TOLERANCE = (PBF_BUILT & PBF_FEATURE_TOLERANCE) != 0;

/* Whether it has walls that mirror the fluid. */
constexpr bool PBF_MIRRORS = (PBF_BUILT & PBF_FEATURE_WALL_DENSITY) != 0;

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

/* What an iteration knows of sleepers. */
struct sleep_pass {
  const pbf_real *unrest; /* null: nothing sleeps */
  const uint32_t *all;    /* not 0: all do */
  pbf_vec *kept;          /* its first number: the lambda that the shore keeps */
  pbf_sleep sleep;
};

/* What images in the walls add to a particle's lambda_sums. */
struct image_sums {
  pbf_real density, slope2;
  pbf_vec gradient;
};

/* What only some scenes have in an iteration. A scene without any of it runs kernels built without
 * it (EXTRAS false). */
struct iteration_extras {
  step_obstacles obstacles;
  int wall_density;
  pbf_real *total; /* accelerated: lambda that has added up; else null. Particles then hold what an
                    * iteration adds, and after the last one the total */
  watch_pass watch;
  sleep_pass rest;
};
static_assert(sizeof(pbf_real) > sizeof(float) || sizeof(iteration_extras) <= 128,
              "of larger arguments the compiler holds no part in registers");

/* V W, and V grad W over x_i - x_j in units of pbf_slope_scale. */
struct pair_terms {
  pbf_real value, slope;
};

/* In units of the kernel's scales until the end. */
template <int FEATURES>
struct lambda_sums {
  pbf_real density = 0, slope2 = 0;
  pbf_vec gradient = {{0}};

  /* Returns what the pair's move needs, too. */
  __device__ __forceinline__ pair_terms add(const pbf_constants *c, pbf_vec x_ij) {
    pbf_real r2 = pbf_dot(x_ij, x_ij);
    pair_terms pair;
    pbf_pair_scaled(FEATURES, c, 1, 1, r2, &pair.value, &pair.slope);
    density += pair.value;
    slope2 += pair.slope * pair.slope * r2;
    gradient = pbf_add_scaled(gradient, pair.slope, x_ij);
    pair.value *= c->value_scale;
    return pair;
  }

  /* The particle itself is part of its density; `images` are, too, unless null. */
  template <solids_met SOLIDS>
  __device__ __forceinline__ pbf_real lambda(const pbf_constants *c, const step_obstacles &o,
                                             bool wall_density, pbf_real slack, pbf_vec x,
                                             const image_sums *images = nullptr) {
    pbf_real scale = pbf_slope_scale(FEATURES, c);
    density = density * c->value_scale + c->value_scale;
    slope2 = slope2 * scale * scale;
    for (int k = 0; k < PBF_DIM; ++k) gradient.c[k] *= scale;
    if (images) {
      density += images->density;
      slope2 += images->slope2;
      gradient = pbf_add_scaled(gradient, 1, images->gradient);
    }
    if (wall_density) add_walls<SOLIDS>(c, o, x, &density, &gradient);
    return pbf_lambda(c, slack, density, slope2, gradient);
  }
};

/* In units of pbf_slope_scale until the end. */
template <int FEATURES>
struct move_sum {
  pbf_vec sum = {{0}};

  /* `lambdas`: of both particles. */
  __device__ __forceinline__ void add(const pbf_constants *c, pbf_vec x_ij, pbf_real lambdas) {
    pair_terms pair;
    pbf_pair_scaled(FEATURES, c, c->value_scale, 1, pbf_dot(x_ij, x_ij), &pair.value, &pair.slope);
    if (FEATURES & PBF_FEATURE_SCORR) lambdas += pbf_pair_scorr(c, pair.value);
    sum = pbf_add_scaled(sum, lambdas * pair.slope, x_ij);
  }

  /* From x, and the velocity with it; `predicted` counts where there are colliders. These are
   * resolved `collisions` times: what one of them pushes another may push again. `images` push,
   * too, unless null. */
  template <solids_met SOLIDS>
  __device__ __forceinline__ pbf_vec moved(const pbf_constants *c, const step_obstacles &o,
                                           bool wall_density, int collisions,
                                           pbf_real inv_time_step, pbf_real lambda,
                                           pbf_vec predicted, pbf_vec x, pbf_vec *velocity,
                                           const pbf_vec *images = nullptr) {
    for (int k = 0; k < PBF_DIM; ++k) sum.c[k] *= pbf_slope_scale(FEATURES, c);
    if (images) sum = pbf_add_scaled(sum, 1, *images);
    if (wall_density) {
      pbf_lent lent = lent_at<SOLIDS>(c, o, x);
      sum = pbf_beside_lent(sum, lambda, &lent);
    }
    pbf_vec y = pbf_move(c, x, sum);
    *velocity = pbf_push(c, inv_time_step, *velocity, sum);
    if (SOLIDS == NO_SOLIDS) collisions = collisions > 0; /* walls push once */
    for (; collisions > 0; --collisions) {
      pbf_vec after = resolve<SOLIDS>(o, 0, predicted, y);
      *velocity = pbf_velocity(inv_time_step, *velocity, y, after);
      y = after;
    }
    return y;
  }
};

#endif
