/* Part of solver.h: the kernels of the stages after the solve, which change velocities by sums over
 * neighbours. */
#ifndef PBF_CUDA_KERNELS_VELOCITIES_H
#define PBF_CUDA_KERNELS_VELOCITIES_H

#include "cuda/driver.h"
#include "cuda/ghosts.h"
#include "cuda/kernels_viscosity.h"
#include "cuda/solids.h"
#include "physics/passes/angular_momentum.h"
#include "physics/passes/confinement.h"
#include "physics/passes/curl.h"
#include "physics/passes/damping_compensation.h"
#include "physics/passes/shear_stress.h"
#include "physics/passes/surface_tension.h"

constexpr bool PBF_DAMPING_COMPENSATION = (PBF_BUILT & PBF_FEATURE_DAMPING_COMPENSATION) != 0;

/* As points, which are read at once: a rate fits a place. */
static __global__ void __launch_bounds__(PBF_BLOCK)
    turn_rate_kernel(neighborhood n, const pbf_curl *torques, point *rates) {
  uint32_t i = own_index(n.particles), own = min(i, n.particles.count - 1);
  const pbf_vec x = position_of(load(n.particles.points, own));
  const rotation_rate_pass pass = {&n.constants};
  const auto sums = sums_around(pass, n, i, x, {}, static_cast<const no_value *>(nullptr));
  if (i < n.particles.count) store(rates, i, point_at(pass.finish(sums, torques[i])));
}

static __global__ void __launch_bounds__(PBF_BLOCK)
    turn_kernel(neighborhood n, const point *rates, pbf_vec *velocities) {
  uint32_t i = own_index(n.particles), own = min(i, n.particles.count - 1);
  const pbf_vec x = position_of(load(n.particles.points, own));
  const rotation_pass pass = {&n.constants};
  const auto sums = sums_around(pass, n, i, x, {lanes_of(position_of(load(rates, own)))}, rates);
  if (i < n.particles.count)
    velocities[i] = pass.finish(sums, velocities[i],
                                n.particles.mobility ? n.particles.mobility[i] : (pbf_real)1);
}

template <int FEATURES>
static __global__ void __launch_bounds__(PBF_BLOCK)
    curl_kernel(neighborhood n, const pbf_vec *velocities, pbf_curl *curls, pbf_real *sizes) {
  uint32_t i = own_index(n.particles), own = min(i, n.particles.count - 1);
  const curl_pass<fixed<FEATURES>> pass = {&n.constants, {}};
  pbf_vec x = position_of(load(n.particles.points, own)), v = velocities[own];
  auto sums = sums_around(pass, n, i, x, {lanes_of(v)}, velocities);
  if (i >= n.particles.count) return;
  pbf_curl curl = pass.finish(sums);
  curls[i] = curl;
  sizes[i] = pbf_curl_size(curl);
}

template <int FEATURES>
static __global__ void __launch_bounds__(PBF_BLOCK)
    confine_kernel(neighborhood n, const pbf_curl *curls, const pbf_real *sizes,
                   pbf_vec *velocities) {
  uint32_t i = own_index(n.particles);
  const confinement_pass<fixed<FEATURES>> pass = {&n.constants, {}};
  pbf_vec x = position_of(load(n.particles.points, min(i, n.particles.count - 1)));
  auto sums = sums_around(pass, n, i, x, {}, sizes);
  if (i < n.particles.count) velocities[i] = pass.finish(sums, curls[i], velocities[i]);
}

/* What each particle lacks of neighbours. `activity` is null where nothing sleeps. */
template <surfaces_met SURFACES>
static __global__ void __launch_bounds__(PBF_BLOCK)
    missing_neighbors_kernel(const __grid_constant__ neighborhood n,
                             const __grid_constant__ step_obstacles obstacles, bool wall_density,
                             const pbf_real *activity, pbf_real *missing) {
  uint32_t i = own_index(n.particles);
  const missing_neighbors_pass pass = {&n.constants};
  const pbf_vec x = position_of(load(n.particles.points, min(i, n.particles.count - 1)));
  auto sums = sums_around(pass, n, i, x, {}, static_cast<const no_value *>(nullptr));
  if (i >= n.particles.count) return;
  const bool awake = !(PBF_SLEEP && activity && pbf_is_asleep(activity[i]));
  pbf_real lacks = awake ? pass.finish(sums, 0) : 0;
  if (wall_density && lacks > 0)
    lacks = pass.finish(
        sums,
        pbf_density_of_solids(constants_for<SURFACES == LISTED_SURFACES>(obstacles, &n.constants),
                              obstacles_near<SURFACES>(obstacles, x, (double)n.constants.h), x));
  missing[i] = lacks;
}

static __global__ void __launch_bounds__(PBF_BLOCK)
    surface_tension_kernel(neighborhood n, const pbf_real *missing, const pbf_real *activity,
                           pbf_vec *velocities) {
  uint32_t i = own_index(n.particles), own = min(i, n.particles.count - 1);
  const surface_tension_pass pass = {&n.constants};
  const pbf_vec x = position_of(load(n.particles.points, own));
  auto sums = sums_around(pass, n, i, x, {missing[own]}, missing);
  if (i >= n.particles.count || (PBF_SLEEP && activity && pbf_is_asleep(activity[i]))) return;
  velocities[i] = pass.finish(sums, velocities[i]);
}

/* The mean flow, from `velocities` to `flow`, as points, which are read at once. */
template <int FEATURES>
static __global__ void __launch_bounds__(PBF_BLOCK)
    flow_kernel(neighborhood n, const pbf_vec *velocities, point *flow) {
  uint32_t i = own_index(n.particles);
  pbf_vec v = smoothed_velocity<FEATURES>(n, velocities, PBF_TO_MEAN, i);
  if (i < n.particles.count) store(flow, i, point_at(v));
}

/* Lambda of the step is in the points. The torque is summed up in all scenes, and kept where
 * `torques` is not null: instances without would be as many again. */
template <int FEATURES, surfaces_met SURFACES>
static __global__ void __launch_bounds__(PBF_BLOCK)
    compensate_damping_kernel(const __grid_constant__ neighborhood n,
                              const __grid_constant__ step_obstacles obstacles, bool wall_density,
                              pbf_real inv_time_step, const point *flow, pbf_curl *torques,
                              pbf_vec *velocities) {
  uint32_t i = own_index(n.particles), own = min(i, n.particles.count - 1);
  const pbf_constants *c = &n.constants;
  const point here = load(n.particles.points, own);
  const pbf_vec x = position_of(here), mean = position_of(load(flow, own));
  const damping_compensation_pass<fixed<FEATURES | PBF_FEATURE_TORQUE>> pass = {c, {}};
  const auto sums = sums_around(pass, n, i, x, {here.lambda, lanes_of(mean)}, flow);
  if (i >= n.particles.count) return;
  if (torques)
    for (int k = 0; k < PBF_CURL_DIM; ++k) torques[i].c[k] -= sums.torque[k];
  pbf_vec change = pass.change(sums);
  if (wall_density)
    change = change_near_obstacles(constants_for<SURFACES == LISTED_SURFACES>(obstacles, c),
                                   obstacles_near<SURFACES>(obstacles, x, (double)c->h), x, mean,
                                   here.lambda, vec_of(sums.end), vec_of(sums.start));
  if (n.particles.mobility) change = pbf_scaled(change, n.particles.mobility[i]);
  velocities[i] = pass.finish(inv_time_step, velocities[i], change);
}

/* lambda D of shear_stress.h, of particles awake, and what walls push with.
 * `activity` is null where nothing sleeps, `ghosts` where there are none. */
template <int FEATURES>
static __global__ void __launch_bounds__(PBF_BLOCK)
    deviator_kernel(const __grid_constant__ neighborhood n,
                    const __grid_constant__ pbf_domain domain, bool wall_density,
                    const pbf_real *activity, const fabric_sums<pbf_real> *ghosts,
                    pbf_deviator *deviators, point *walls) {
  uint32_t i = own_index(n.particles), own = min(i, n.particles.count - 1);
  const point here = load(n.particles.points, own);
  const pbf_vec x = position_of(here);
  const fabric_pass<fixed<FEATURES>> pass = {&n.constants, {}};
  auto sums = sums_around(pass, n, i, x, {}, static_cast<const no_value *>(nullptr));
  if (i >= n.particles.count) return;
  if (PBF_GHOSTS && ghosts) add_sums(&sums, ghosts[i]);
  pbf_fabric fabric = fabric_of(sums);
  if (wall_density) add_walls(&n.constants, domain, x, &fabric);
  const bool awake = !(PBF_SLEEP && activity && pbf_is_asleep(activity[i]));
  const pbf_deviator none = {{0}};
  deviators[i] = awake ? pass.finish(fabric, here.lambda) : none;
  store(walls, i, point_at(fabric.wall));
}

/* … and none beside colliders. */
template <surfaces_met SURFACES>
static __global__ void __launch_bounds__(PBF_BLOCK)
    leave_colliders_kernel(const __grid_constant__ neighborhood n,
                           const __grid_constant__ step_obstacles obstacles,
                           pbf_deviator *deviators) {
  const uint32_t i = own_index(n.particles);
  if (i >= n.particles.count) return;
  const pbf_vec x = position_of(load(n.particles.points, i));
  const pbf_constants *c = constants_for<SURFACES == LISTED_SURFACES>(obstacles, &n.constants);
  const pbf_deviator none = {{0}};
  if (colliders_contribute(c, obstacles_near<SURFACES>(obstacles, x, (double)c->h), x))
    deviators[i] = none;
}

/* From what walls push with to the pushes. */
template <int FEATURES>
static __global__ void __launch_bounds__(PBF_BLOCK)
    shear_push_kernel(neighborhood n, const pbf_deviator *deviators, point *pushes) {
  uint32_t i = own_index(n.particles), own = min(i, n.particles.count - 1);
  const pbf_vec x = position_of(load(n.particles.points, own));
  const auto d = lanes_of(deviators[own]);
  const shear_push_pass<fixed<FEATURES>> pass = {&n.constants, {}};
  const auto sums = sums_around(pass, n, i, x, {d}, deviators);
  if (i >= n.particles.count) return;
  point push = point_at(pass.finish(sums, d, position_of(load(pushes, i))));
  if (n.particles.mobility) {
    push = point_at(pbf_scaled(position_of(push), n.particles.mobility[i]));
    push.lambda = 1 / n.particles.mobility[i];
  }
  store(pushes, i, push);
}

/* Where phases differ pushes are over masses, which lie beside them. */
template <int FEATURES>
static __global__ void __launch_bounds__(PBF_BLOCK)
    shear_stress_kernel(neighborhood n, const point *pushes, pbf_vec *changes) {
  uint32_t i = own_index(n.particles), own = min(i, n.particles.count - 1);
  const pbf_vec x = position_of(load(n.particles.points, own));
  const point push = load(pushes, own);
  const pbf_real *mobility = n.particles.mobility;
  const shear_stress_pass<fixed<FEATURES>> pass = {&n.constants, {}, mobility != nullptr};
  const auto sums = sums_around(pass, n, i, x, {lanes_of(position_of(push)), push.lambda},
                                reinterpret_cast<const point_with_number *>(pushes));
  if (i < n.particles.count)
    changes[i] = pass.finish(sums, position_of(push), mobility ? mobility[i] : (pbf_real)1);
}

/* What velocities change by moves particles at once. Where there are colliders, collide_kernel
 * comes next, and reads where particles have come from in `from`; elsewhere it is null, and what
 * walls then do is added to `push`, unless that is null. */
static __global__ void __launch_bounds__(PBF_BLOCK)
    way_kernel(sorted_particles p, const pbf_real *activity,
               const __grid_constant__ pbf_domain domain, pbf_real time_step,
               pbf_real inv_time_step, const pbf_vec *changes, pbf_vec *velocities, pbf_vec *push,
               point *from) {
  const uint32_t i = own_index(p);
  if (i >= p.count || (PBF_SLEEP && activity && pbf_is_asleep(activity[i]))) return;
  point here = load(p.points, i);
  if (from) store(from, i, here);
  const pbf_vec to = pbf_add_scaled(position_of(here), time_step, changes[i]);
  const pbf_vec x = from ? to : pbf_keep_in_domain(&domain, to);
  const pbf_vec v = pbf_add_scaled(velocities[i], 1, changes[i]);
  const pbf_vec pushed = pbf_velocity(inv_time_step, v, to, x);
  velocities[i] = pushed;
  if (PBF_BUILT & PBF_FEATURE_LOADS && push)
    push[i] = pbf_add_scaled(push[i], 1, pbf_sub(pushed, v));
  point after = point_at(x);
  after.lambda = here.lambda;
  store(p.points, i, after);
}

#endif
