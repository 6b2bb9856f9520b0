/* Part of kernels_solve.h. What walls and colliders do to particles in an iteration, where there
 * are colliders: few particles are near them, and the loops over pairs are short of registers. So
 * one kernel runs before lambda, which takes what it finds, as does the move, and one after the
 * move.
 */
#ifndef PBF_CUDA_SOLIDS_H
#define PBF_CUDA_SOLIDS_H

#include "cuda/iteration.h"

/* Few threads meet a solid: these are not to take the registers of all. Nor are arguments copied to
 * the stack of all, for the sake of functions that take pointers to them. */
enum { BLOCKS_WITH_SOLIDS = sizeof(pbf_real) == sizeof(float) ? 4 : 2 };

/* Whether a particle takes no part in the iteration. */
static __device__ __forceinline__ bool is_idle(const iteration_extras &extras, uint32_t i) {
  if (PBF_TOLERANCE && extras.watch.watch && is_converged(extras.watch)) return true;
  const pbf_real *activity = extras.rest.activity;
  return PBF_SLEEP && activity && (*extras.rest.all || pbf_is_inactive(activity[i]));
}

/* What walls and colliders contribute. Not read is what it leaves as it is: gradients where the
 * density is 0, and all of idle particles. */
template <surfaces_met SURFACES>
static __global__ void __launch_bounds__(PBF_BLOCK, BLOCKS_WITH_SOLIDS)
    boundary_kernel(const __grid_constant__ neighborhood n,
                    const __grid_constant__ iteration_extras extras, boundary_sums found) {
  const uint32_t i = own_index(n.particles);
  if (i >= n.particles.count || is_idle(extras, i)) return;
  const pbf_vec x = position_of(load(n.particles.points, i));
  const pbf_boundary boundary = boundary_at<SURFACES>(&n.constants, extras.obstacles, x);
  pbf_real density = 0;
  pbf_vec gradient = {{0}};
  pbf_add_boundary(&boundary, &density, &gradient);
  found.densities[i] = density;
  if (density == 0) return;
  point kept = point_at(gradient);
  kept.lambda = boundary.rest;
  store(found.gradients, i, kept);
}

/* How often solids push in this iteration: what a collider pushes another may push again. */
struct pushes_by_solids {
  iteration_place place;
  int in_iteration, in_last;
};

/* What a move has moved a particle by is told by its velocities, those of the prediction first. */
static __device__ __forceinline__ pbf_vec predicted_place(const neighborhood &n, uint32_t i,
                                                          const iteration_place &place,
                                                          pbf_real inv_time_step, pbf_vec x,
                                                          pbf_vec v) {
  if (place.first || !(inv_time_step > 0)) return position_of(load(n.particles.points, i));
  return pbf_add_scaled(x, -1 / inv_time_step, pbf_sub(v, n.particles.velocities[i]));
}

/* Takes particles that something has moved from n.particles.points to `moved` out of solids. What
 * these do to velocities is added to `push`, unless that is null. */
template <surfaces_met SURFACES>
static __global__ void __launch_bounds__(PBF_BLOCK, BLOCKS_WITH_SOLIDS)
    collide_kernel(const __grid_constant__ neighborhood n, point *moved,
                   const __grid_constant__ iteration_extras extras, pushes_by_solids pushes,
                   pbf_real inv_time_step, pbf_vec *velocities, pbf_vec *push) {
  const uint32_t i = own_index(n.particles);
  if (i >= n.particles.count || is_idle(extras, i)) return;
  const iteration_place &place = pushes.place;
  const bool last = place.last || (PBF_TOLERANCE && extras.watch.watch && has_ended(extras.watch));
  const pbf_real *activity = PBF_SLEEP ? extras.rest.activity : nullptr;
  if (activity && pbf_is_asleep(activity[i])) return;
  int collisions = pushes.in_iteration + (last && pushes.in_last);
  if (!collisions) return;
  point to = load(moved, i);
  const pbf_vec before = position_of(to);
  const pbf_vec velocity = velocities[i];
  pbf_vec x = before, v = velocity;
  const bool just_woke = activity && last && pbf_just_woke(&extras.rest.sleep, activity[i]);
  const pbf_vec predicted = predicted_place(n, i, place, just_woke ? 0 : inv_time_step, before, v);
  for (; collisions > 0; --collisions) {
    const pbf_vec after = resolve_collisions<SURFACES>(extras.obstacles, 0, predicted, x);
    v = pbf_velocity(inv_time_step, v, x, after);
    x = after;
  }
  bool pushed = false;
  for (int k = 0; k < PBF_DIM; ++k) pushed |= x.c[k] != before.c[k];
  if (!pushed) return;
  for (int k = 0; k < PBF_DIM; ++k) to.c[k] = x.c[k];
  store(moved, i, to);
  if (!just_woke) velocities[i] = v;
  if (PBF_BUILT & PBF_FEATURE_LOADS && push)
    push[i] = pbf_add_scaled(push[i], 1, pbf_sub(v, velocity));
}

#endif
