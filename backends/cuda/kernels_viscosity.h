/* The kernels of viscosity: XSPH, and the viscous stress before the solve. */
#ifndef PBF_CUDA_KERNELS_VISCOSITY_H
#define PBF_CUDA_KERNELS_VISCOSITY_H

#include <type_traits>

#include "cuda/driver.h"
#include "cuda/solids.h"
#include "physics/passes/viscosity.h"
#include "physics/passes/viscous_stress.h"

/* v_i and what eq. 17 adds to it. All threads of a warp call it. */
template <int FEATURES>
static __device__ __forceinline__ pbf_vec smoothed_velocity(const neighborhood &n,
                                                            const pbf_vec *velocities,
                                                            pbf_real viscosity, uint32_t i) {
  uint32_t own = min(i, n.particles.count - 1);
  const viscosity_pass<fixed<FEATURES>> pass = {&n.constants, {}};
  pbf_vec x = position_of(load(n.particles.points, own)), v = velocities[own];
  return pass.finish(sums_around(pass, n, i, x, {lanes_of(v)}, velocities), viscosity, v);
}

/* From `velocities` to `smoothed`. */
template <int FEATURES>
static __global__ void __launch_bounds__(PBF_BLOCK)
    viscosity_kernel(neighborhood n, const pbf_vec *velocities, pbf_vec *smoothed) {
  uint32_t i = own_index(n.particles);
  pbf_vec v = smoothed_velocity<FEATURES>(n, velocities, n.constants.viscosity, i);
  if (i < n.particles.count) smoothed[i] = v;
}

/* Where particles have come from, at which viscosity looks at them, with what crowding leaves out
 * of it. */
static __global__ void __launch_bounds__(PBF_BLOCK)
    crowding_kernel(neighborhood n, pbf_real time_step, const pbf_real *activity, point *starts) {
  uint32_t i = own_index(n.particles), own = min(i, n.particles.count - 1);
  const crowding_pass pass = {&n.constants};
  const pbf_vec *velocities = n.particles.velocities;
  const at_start places = {time_step};
  const pbf_vec x = places.place(load(n.particles.points, own), velocities[own]);
  const auto sums = sums_around(pass, n, i, x, {}, velocities, places);
  if (i >= n.particles.count) return;
  point start = point_at(x);
  start.lambda = PBF_SLEEP && activity && pbf_is_asleep(activity[i]) ? 0 : pass.finish(sums);
  if (n.particles.phase)
    start.lambda = pbf_left_out(&n.constants.phases, n.particles.phase[i], start.lambda);
  store(starts, i, start);
}

/* What a stage of viscosity works on. */
struct viscous_stage {
  pbf_viscosity_weights weights;
  const pbf_real *activity;  /* null where nothing sleeps */
  const pbf_vec *velocities; /* of the prediction, … */
  pbf_vec *force;            /* … and what acts on them, which the first stage finds */
  pbf_vec *changes;          /* after the last stage, … */
  pbf_vec *next;             /* … after the one before it, and then after this one */
};

/* As pbf_no_slip, for kernels. */
struct few_no_slip {
  pbf_real walls, inv_time_step, of[PBF_FEW_COLLIDERS];
};

/* The same where colliders are listed: on the device. */
struct many_no_slip {
  pbf_real walls, inv_time_step;
  const pbf_real *of;
};

template <bool LISTED>
using no_slip_asked = std::conditional_t<LISTED, many_no_slip, few_no_slip>;

/* n's points are the starts. What fluid that sticks to solids needs is in instances of its own, as
 * is what few scenes have, ALL. */
template <bool NO_SLIP, surfaces_met SURFACES, bool ALL>
static __global__ void __launch_bounds__(PBF_BLOCK)
    viscous_stress_kernel(const __grid_constant__ neighborhood n, const point *predicted,
                          viscous_stage s, const __grid_constant__ step_obstacles obstacles,
                          no_slip_asked<SURFACES == LISTED_SURFACES> no_slip) {
  uint32_t i = own_index(n.particles), own = min(i, n.particles.count - 1);
  const viscous_stress_pass pass = {&n.constants};
  const bool begins = s.weights.first != 0;
  const pbf_vec *of = begins ? s.velocities : s.changes;
  const point here = load(n.particles.points, own);
  const pbf_vec x = position_of(here), v = of[own], none = {{0}};
  const auto sums = sums_around(pass, n, i, x, {here.lambda, lanes_of(v)}, of,
                                at_moved_points<ALL>{{}, predicted});
  if (i >= n.particles.count) return;
  const pbf_vec change = begins ? none : v, before = begins ? none : s.next[i];
  const pbf_phase_constants *phases = &n.constants.phases;
  const uint8_t *phase = ALL ? n.particles.phase : nullptr;
  pbf_viscous_system system =
      pass.system(sums, begins ? none : pbf_sub(s.force[i], change),
                  phase ? pbf_viscous_scale(phases, phase[i]) : (pbf_real)1);
  int with_solids = 0;
  if (NO_SLIP)
    with_solids =
        add_no_slip(constants_for<SURFACES == LISTED_SURFACES>(obstacles, &n.constants),
                    obstacles_near<SURFACES>(obstacles, x, (double)n.constants.h), no_slip, begins,
                    x, v, &system, phase ? phases->viscosity[phase[i]] : (pbf_real)1);
  if (begins) {
    s.force[i] = system.residual;
    s.changes[i] = none;
  }
  const bool asleep = PBF_SLEEP && s.activity && pbf_is_asleep(s.activity[i]);
  s.next[i] = asleep ? none : pass.finish(system, with_solids, s.weights, change, before);
}

#endif
