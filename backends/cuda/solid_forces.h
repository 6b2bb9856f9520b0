/* Part of executor.h: what solids change of particles' velocities by friction and adhesion, with
 * what they get of it where loads are wanted. */
#ifndef PBF_CUDA_SOLID_FORCES_H
#define PBF_CUDA_SOLID_FORCES_H

#include <type_traits>

#include "cuda/loads.h"
#include "physics/adhesion.h"
#include "physics/friction.h"

/* What each solid has of its own, for kernels: of few by value, of many on the device. */
template <bool LISTED, class Each>
using of_solids = std::conditional_t<LISTED, const Each *, Each[PBF_FEW_SOLIDS]>;

/* As pbf_friction_scales. */
template <bool LISTED>
struct friction_asked {
  pbf_load_scales loads;
  of_solids<LISTED, pbf_friction> of;
};

/* As pbf_adhesion_scales. */
template <bool LISTED>
struct adhesion_asked {
  pbf_load_scales loads;
  pbf_real pull;
  of_solids<LISTED, pbf_real> of;
};

/* Changes velocities, and moves by that. Each thread writes to its particle alone; the tally is
 * null where loads are not wanted. */
template <bool LISTED>
static __global__ void __launch_bounds__(PBF_BLOCK)
    friction_kernel(const __grid_constant__ neighborhood n,
                    const __grid_constant__ step_obstacles o, friction_asked<LISTED> scales,
                    pressure_source source, const pbf_real *activity, pbf_real inv_time_step,
                    pbf_vec *velocities, pbf_vec *push, load_tally_asked<LISTED> *tally) {
  const uint32_t i = own_index(n.particles);
  if (i >= n.particles.count) return;
  if (PBF_SLEEP && activity && pbf_is_asleep(activity[i])) return;
  point own = load(n.particles.points, i);
  load_particle p = load_particle_of(source, own, velocities[i], push[i]);
  const pbf_real mobility = n.particles.mobility ? n.particles.mobility[i] : (pbf_real)1;
  p.lambda *= mobility;
  const pbf_vec change = friction_change(
      constants_for<LISTED>(o, &n.constants), scales, o,
      solids_near<LISTED>(o, p.x, scales.loads.reach), p,
      [&] { return grid_lambda_of(source, own); },
      [&](const pbf_load_plane &plane, const load_share &share) {
        if (tally)
          add_shared_part(
              &tally->sums[plane.solid],
              load_part_beside(&scales.loads, o, p.x, plane, with_mass(share, mobility)), false);
      });
  const pbf_vec moved = pbf_add_scaled(p.x, (pbf_real)scales.loads.time_step, change);
  pbf_vec x;
  if constexpr (LISTED)
    x = resolve_collisions<LISTED_SURFACES>(o, 0, p.x, moved);
  else
    x = pbf_resolve_collisions(o, 0, p.x, moved);
  const pbf_vec v = pbf_add_scaled(p.change, 1, change);
  const pbf_vec after = pbf_velocity(inv_time_step, v, moved, x);
  for (int k = 0; k < PBF_DIM; ++k) own.c[k] = x.c[k];
  store(n.particles.points, i, own);
  velocities[i] = after;
  push[i] = pbf_add_scaled(push[i], 1, pbf_sub(after, v));
}

/* Changes velocities. The tally is null where loads are not wanted. */
template <bool LISTED>
static __global__ void __launch_bounds__(PBF_BLOCK)
    adhesion_kernel(const __grid_constant__ neighborhood n,
                    const __grid_constant__ step_obstacles o, adhesion_asked<LISTED> scales,
                    const pbf_real *missing, const pbf_real *activity, pbf_vec *velocities,
                    load_tally_asked<LISTED> *tally) {
  const uint32_t i = own_index(n.particles);
  if (i >= n.particles.count) return;
  if (PBF_SLEEP && activity && pbf_is_asleep(activity[i])) return;
  const pbf_vec x = position_of(load(n.particles.points, i));
  const pbf_vec change = adhesion_change(
      constants_for<LISTED>(o, &n.constants), scales, o,
      solids_near<LISTED>(o, x, (double)n.constants.h), x, missing[i],
      [&](const pbf_load_plane &plane, const load_share &share) {
        if (tally)
          add_shared_part(&tally->sums[plane.solid],
                          load_part_beside(&scales.loads, o, x, plane, share), false);
      });
  velocities[i] = pbf_add_scaled(velocities[i], 1, change);
}

/* What the solids of a step have: of many it lies beside the surfaces. */
template <bool LISTED, class Scales, class Each>
static inline void fill_of_solids(const solver *s, const Scales &scales,
                                  const pbf_surface *surfaces, uint64_t place,
                                  of_solids<LISTED, Each> &of) {
  if constexpr (LISTED)
    of = beside_surfaces<Each>(surfaces, place);
  else
    for (uint32_t k = 0; k < PBF_WALLS + s->collider_count; ++k) of[k] = scales.of[(int)k];
}

template <bool LISTED>
static inline friction_asked<LISTED> friction_for(const solver *s,
                                                  const pbf_friction_scales &scales,
                                                  const pbf_surface *surfaces) {
  friction_asked<LISTED> asked = {scales.loads, {}};
  fill_of_solids<LISTED, pbf_friction_scales, pbf_friction>(s, scales, surfaces,
                                                            s->many.layout.friction, asked.of);
  return asked;
}

template <bool LISTED>
static inline adhesion_asked<LISTED> adhesion_for(const solver *s,
                                                  const pbf_adhesion_scales &scales,
                                                  const pbf_surface *surfaces) {
  adhesion_asked<LISTED> asked = {scales.loads, scales.pull, {}};
  fill_of_solids<LISTED, pbf_adhesion_scales, pbf_real>(s, scales, surfaces,
                                                        s->many.layout.adhesion, asked.of);
  return asked;
}

#endif
