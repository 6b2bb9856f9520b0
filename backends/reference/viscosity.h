/* Part of step.h: viscosity, before the solve, or XSPH after it. */
#ifndef PBF_REFERENCE_VISCOSITY_H
#define PBF_REFERENCE_VISCOSITY_H

#include "physics/passes/viscous_stress.h"
#include "reference/driver.h"
#include "reference/loads.h"
#include "reference/sleep.h"

static inline void apply_xsph(solver *s) {
  for (uint32_t i = 0; i < s->count; ++i)
    s->change[i] = asleep(s, i) ? s->v[i] : smoothed_velocity(s, s->constants.viscosity, i);
  memcpy(s->v, s->change, s->count * sizeof *s->v);
}

/* Sums over the pairs that are near each other at the prediction, as lists have them, of a pass
 * that looks at them where they came from. */
template <class Pass>
static inline typename Pass::template sums<pbf_real> sums_before(
    const solver *s, const Pass &pass, const lookups &of,
    const typename Pass::template own<pbf_real> &own, uint32_t i) {
  auto sums = pass.template begin<pbf_real>();
  neighbor n = neighbors_of(&s->grid, i);
  while (next_neighbor(&s->grid, s->moved, s->constants.h2, &n)) {
    neighbor before = n;
    before.x_ij = pbf_sub(s->x[i], s->x[n.j]);
    if (s->grid.periods.any) before.x_ij = pbf_add_scaled(before.x_ij, 1, n.image);
    before.r2 = pbf_dot(before.x_ij, before.x_ij);
    pass.pair(&sums, own, looked_up(before, of));
  }
  return sums;
}

/* Before the solve what it adds is not there yet: what crowding leaves out is. */
static inline void find_crowding(solver *s) {
  const crowding_pass pass = {&s->constants};
  for (uint32_t i = 0; i < s->count; ++i) {
    s->added[i] = asleep(s, i) ? 0 : pass.finish(sums_before(s, pass, {}, {}, i));
    if (s->phase) s->added[i] = pbf_left_out(&s->constants.phases, s->phase[i], s->added[i]);
  }
}

/* Stage k, from the state at the step's start, the velocities of the prediction and, of the last
 * stages, s->change: in s->predicted, which is not asked for until it is made anew, are the changes
 * after stage k - 2, and then those after k. */
static inline void apply_viscous_stress(solver *s, const pbf_obstacles *o, uint32_t k) {
  const viscous_stress_pass pass = {&s->constants};
  const pbf_viscosity_weights weights = pbf_viscosity_weights_of(&s->constants, k);
  const pbf_no_slip no_slip = pbf_no_slip_of(&s->params, s->table.list);
  const pbf_vec *of = weights.first ? s->v : s->change;
  for (uint32_t i = 0; i < s->count; ++i) {
    const pbf_vec none = {{0}}, change = weights.first ? none : s->change[i];
    const pbf_vec before = weights.first ? none : s->predicted[i];
    s->predicted[i] = none;
    if (asleep(s, i)) continue;
    const auto sums = sums_before(s, pass, {s->added, of}, {s->added[i], lanes_of(of[i])}, i);
    pbf_viscous_system system =
        pass.system(sums, weights.first ? none : pbf_sub(s->viscous_force[i], change),
                    s->phase ? pbf_viscous_scale(&s->constants.phases, s->phase[i]) : 1);
    const int with_solids =
        s->schedule.no_slip &&
        add_no_slip(&s->constants, *o, no_slip, weights.first != 0, s->x[i], of[i], &system,
                    s->phase ? s->constants.phases.viscosity[s->phase[i]] : 1);
    if (weights.first) s->viscous_force[i] = system.residual;
    s->predicted[i] = pass.finish(system, with_solids, weights, change, before);
  }
  for (uint32_t i = 0; i < s->count; ++i) {
    const pbf_vec next = s->predicted[i];
    s->predicted[i] = weights.first ? (pbf_vec){{0}} : s->change[i];
    s->change[i] = next;
  }
}

static inline void apply_viscosity(solver *s, const pbf_obstacles *o, uint32_t k) {
  if (s->schedule.accelerated)
    apply_viscous_stress(s, o, k);
  else
    apply_xsph(s);
}

#endif
