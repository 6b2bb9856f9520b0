/* What a particle sums over its neighbours in an iteration, and how that ends; the same wherever
 * the neighbours come from. */
#ifndef PBF_CUDA_SUMS_H
#define PBF_CUDA_SUMS_H

#include "cuda/sort.h"
#include "physics/scalar.h"

/* Whether the build has the accelerated solve. */
constexpr bool PBF_CHEBYSHEV = (PBF_BUILT & PBF_FEATURE_CHEBYSHEV) != 0;

/* What only some scenes have in an iteration. A scene without any of it runs kernels built without
 * it (EXTRAS false). */
struct iteration_extras {
  step_obstacles obstacles;
  int wall_density;
  pbf_real *before;      /* accelerated: lambda an iteration earlier; else null */
  const pbf_real *slack; /* in very short steps; else null */
};

static __device__ __forceinline__ void add_walls(const pbf_constants *c, const step_obstacles &o,
                                                 pbf_vec x, pbf_real *density, pbf_vec *gradient) {
  pbf_add_walls(c, &o.walls, o.count, o.solids, x, density, gradient);
}

template <int FEATURES>
struct lambda_sums {
  pbf_real density = 0, slope2 = 0;
  pbf_vec gradient = {{0}};

  __device__ __forceinline__ void add(const pbf_constants *c, pbf_vec x_ij) {
    pbf_real r2 = pbf_dot(x_ij, x_ij), value, slope;
    pbf_pair_kernel(FEATURES, c, r2, &value, &slope);
    density += value;
    slope2 += slope * slope * r2;
    gradient = pbf_add_scaled(gradient, slope, x_ij);
  }

  /* The particle itself is part of its density. */
  __device__ __forceinline__ pbf_real lambda(const pbf_constants *c, const step_obstacles &o,
                                             bool wall_density, pbf_real slack, pbf_vec x) {
    density += c->value_scale;
    if (wall_density) add_walls(c, o, x, &density, &gradient);
    return pbf_lambda(c, slack, density, slope2, gradient);
  }
};

template <int FEATURES>
struct move_sum {
  pbf_vec sum = {{0}};

  /* `lambdas`: of both particles. */
  __device__ __forceinline__ void add(const pbf_constants *c, pbf_vec x_ij, pbf_real lambdas) {
    pbf_real value, slope;
    pbf_pair_kernel(FEATURES, c, pbf_dot(x_ij, x_ij), &value, &slope);
    if (FEATURES & PBF_FEATURE_SCORR) lambdas += pbf_pair_scorr(c, value);
    sum = pbf_add_scaled(sum, lambdas * slope, x_ij);
  }

  /* From x; `predicted` counts where lambda adds up, `accelerated`, and where there are colliders.
   */
  template <bool COLLIDERS>
  __device__ __forceinline__ pbf_vec moved(const pbf_constants *c, const step_obstacles &o,
                                           bool wall_density, bool accelerated, bool collide,
                                           pbf_real lambda, pbf_vec predicted, pbf_vec x) {
    if (wall_density) {
      pbf_real density = 0;
      pbf_vec from_walls = {{0}};
      add_walls(c, o, x, &density, &from_walls);
      sum = pbf_add_scaled(sum, lambda, from_walls);
    }
    pbf_vec y = PBF_CHEBYSHEV && accelerated ? pbf_relax(c, predicted, x, lambda, sum)
                                             : pbf_move(c, x, sum);
    return collide ? resolve<COLLIDERS>(o, 0, predicted, y) : y;
  }
};

#endif
