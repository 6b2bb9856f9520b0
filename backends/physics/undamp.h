/* The damping of a flow by long steps, undone.
 *
 * A step pushes pairs along their direction at its end, x*, which is implicit Euler: that calms the
 * motion of single particles, without which a few iterations of a constraint would be noise, but
 * takes from the fluid's own motion, too. A fluid that turns at the rate w loses w² dt of its
 * angular momentum in a time unit. Along their direction at the step's start, as SHAKE has it
 * (Ryckaert, Ciccotti and Berendsen 1977), pushes would keep both. So once a step is solved,
 * velocities, not places, get the difference that the start would have made, but with the way from
 * there as the mean flow around the two has it, and not they themselves: each is left out of its
 * own mean, or narrow kernels, of which most is its own, would give its noise back, and impacts
 * would gain energy. Pair by pair the difference is opposite and equal, so momentum is kept. Where
 * the flow moves two by more than a tenth of h to each other in a step, ever less of it is undone:
 * nothing resolves such a flow. */
#ifndef PBF_PHYSICS_UNDAMP_H
#define PBF_PHYSICS_UNDAMP_H

#include "physics/boundary.h"
#include "physics/scalar.h"

/* What obstacles lend: the domain's walls, which don't turn, at x, and colliders at `at`, as they
 * stood `before` the step or after it. */
PBF_FN_APART pbf_lent pbf_lent_from(const pbf_constants *c, const pbf_walls *walls, int count,
                                    const pbf_solid *solids, pbf_vec x, pbf_vec at, int before) {
  pbf_lent lent = pbf_lent_by_walls(c, walls, x);
  for (int k = 0; k < count; ++k) {
    const pbf_solid solid = before ? pbf_solid_before(&solids[k]) : solids[k];
    pbf_join_solid(c, &solid, at, &lent);
  }
  return lent;
}

PBF_FN pbf_vec pbf_lent_gradient(const pbf_lent *lent) {
  return pbf_add_scaled(lent->shared_gradient, 1, lent->own_gradient);
}

/* `to` with the length of `from`; `from` where it is a thousand times as long: `to` is at the end
 * of a wall's reach, where rounding makes its direction and division overflows. */
PBF_FN pbf_vec pbf_turned(pbf_vec from, pbf_vec to) {
  const pbf_vec none = {{0}};
  pbf_real from2 = pbf_dot(from, from), to2 = pbf_dot(to, to);
  if (!(to2 > (pbf_real)1e-6 * from2)) return from;
  return pbf_add_scaled(none, pbf_real_sqrt(from2 / to2), to);
}

/* The change of the push of a particle at x that has `lambda`, from its sums over pairs at the
 * step's end and at its start, between obstacles that lend density: what these push
 * with is turned as it was where the mean flow and the colliders had the two at the start. Out of
 * their reach at the end nothing is. */
PBF_FN pbf_vec pbf_undamped(const pbf_constants *c, const pbf_walls *walls, int count,
                            const pbf_solid *solids, pbf_vec x, pbf_vec mean, pbf_real lambda,
                            pbf_vec end, pbf_vec start) {
  pbf_vec pushes[2] = {end, start}, at = x, gradient = {{0}};
  pbf_lent lent = {0, 0, 0, {{0}}, {{0}}};
  for (int before = 0; before < 2; ++before) {
    if (!before || count > 0) {
      lent = pbf_lent_from(c, walls, count, solids, x, at, before);
      if (!before && !(lent.resting > 0)) return pbf_sub(start, end);
      pbf_vec now = pbf_lent_gradient(&lent);
      gradient = before ? pbf_turned(gradient, now) : now;
    }
    pushes[before] = pbf_beside_walls(pushes[before], lambda, lent.resting, gradient);
    at = pbf_add_scaled(x, -c->flow_time, mean);
  }
  return pbf_sub(pushes[1], pushes[0]);
}

#endif
