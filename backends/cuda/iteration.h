/* What the kernels of an iteration are told, and how a particle's sums over its neighbours end; the
 * same wherever the neighbours come from. */
#ifndef PBF_CUDA_ITERATION_H
#define PBF_CUDA_ITERATION_H

#include "cuda/driver.h"
#include "cuda/sort.h"
#include "cuda/convergence.h"
#include "physics/passes/lambda.h"
#include "physics/passes/move.h"
#include "physics/passes/smooth_pressure.h"
#include "physics/passes/velocity.h"

/* Whether the build has the accelerated solve. */
constexpr bool PBF_CHEBYSHEV = (PBF_BUILT & PBF_FEATURE_CHEBYSHEV) != 0;

/* Whether it has walls with ghosts. */
constexpr bool PBF_GHOSTS = (PBF_BUILT & PBF_FEATURE_WALL_DENSITY) != 0;

/* The place of an iteration among those of the step. */
struct iteration_place {
  bool first, second, last;
};

/* What an iteration knows of sleepers. */
struct sleep_pass {
  const pbf_real *activity; /* null: nothing sleeps */
  const uint32_t *all;      /* not 0: all do */
  pbf_vec *kept;            /* its first number: the lambda that the sleeping boundary keeps */
  pbf_sleep sleep;
};

/* What only some scenes have in an iteration. A scene without any of it runs kernels built without
 * it (EXTRAS false). */
struct iteration_extras {
  step_obstacles obstacles;
  int wall_density;
  pbf_real *total; /* accelerated: lambda that has added up; else null. Particles then hold what an
                    * iteration adds, and after the last one the total */
  convergence_check watch;
  sleep_pass rest;
};
static_assert(sizeof(pbf_real) > sizeof(float) || sizeof(iteration_extras) <= 128,
              "of larger arguments the compiler holds no part in registers");

/* What walls and colliders contribute to particles where there are colliders: a kernel of its own
 * finds it before lambda (solids.h), so that the loops over pairs keep their registers. */
struct boundary_sums {
  pbf_real *densities; /* null: lambda and move look at the walls themselves */
  point *gradients;    /* with the part of a fluid at rest in place of lambda; nothing where the
                        * density is 0 */
};

static __device__ __forceinline__ void add_boundary_of(const boundary_sums &found, uint32_t i,
                                                       lambda_sums<pbf_real> *sums) {
  const pbf_real density = found.densities[i];
  if (density == 0) return;
  sums->density += density;
  sums->gradient.add_scaled(1, lanes_of(position_of(load(found.gradients, i))));
}

static __device__ __forceinline__ void correct_by_boundary_of(const boundary_sums &found,
                                                              uint32_t i, pbf_real lambda,
                                                              move_sums<pbf_real> *sums) {
  if (found.densities[i] == 0) return;
  const point kept = load(found.gradients, i);
  sums->change = lanes_of(
      pbf_boundary_correction(vec_of(sums->change), lambda, kept.lambda, position_of(kept)));
}

/* Lambda of a particle at x, with what obstacles contribute. */
template <surfaces_met SURFACES, class Pass>
static __device__ __forceinline__ pbf_real finish_lambda(const Pass &pass, const step_obstacles &o,
                                                         bool wall_density,
                                                         pbf_real residual_density, pbf_vec x,
                                                         lambda_sums<pbf_real> *sums) {
  if (wall_density) {
    pbf_vec gradient = vec_of(sums->gradient);
    add_boundary<SURFACES>(pass.c, o, x, &sums->density, &gradient);
    sums->gradient = lanes_of(gradient);
  }
  return pass.finish(*sums, residual_density);
}

/* How an iteration's move ends, wherever its sums come from. */
struct move_finish {
  bool wall_density;
  int collisions; /* what a collider pushes another may push again */
  pbf_real inv_time_step;
  const pbf_real *mobility = nullptr; /* of the particle; null: phases do not differ */
};

/* Where a move takes a particle from x, and its velocity with it; `predicted` counts where there
 * are colliders. */
template <surfaces_met SURFACES, class Pass>
static __device__ __forceinline__ pbf_vec finish_move(const Pass &pass, const step_obstacles &o,
                                                      const move_finish &end, pbf_real lambda,
                                                      bool overlaps, const uint32_t &id,
                                                      pbf_vec predicted, pbf_vec x,
                                                      move_sums<pbf_real> sums, pbf_vec *velocity) {
  if (end.wall_density) {
    pbf_boundary boundary = boundary_at<SURFACES>(pass.c, o, x);
    sums.change = lanes_of(pbf_boundary_correction(vec_of(sums.change), lambda, &boundary));
  }
  if (end.mobility) sums.change.scale(*end.mobility);
  lane_vector<pbf_real> y = lanes_of(x), v = lanes_of(*velocity);
  pass.finish(sums, end.inv_time_step, &y, &v);
  x = pbf_break_symmetry(pass.c, lambda, overlaps, vec_of(sums.change), id, vec_of(y));
  *velocity = vec_of(v);
  int collisions = end.collisions;
  if (SURFACES == NO_SURFACES) collisions = collisions > 0; /* walls push once */
  for (; collisions > 0; --collisions) {
    pbf_vec after = resolve_collisions<SURFACES>(o, 0, predicted, x);
    *velocity = pbf_velocity(end.inv_time_step, *velocity, x, after);
    x = after;
  }
  return x;
}

#endif
