/* Angular momentum, kept.
 *
 * A step changes it by the torque of its pushes about where particles are at its start, and an
 * iteration's pushes point along pairs as these stand in it: two that push each other by p, with
 * the way x from one to the other at the start, get a torque x x p that they should not have. It is
 * summed up, half of it for either, in each iteration, and once velocities are known each particle
 * turns the pairs around it so that these have it back: at a rate that follows from their moments
 * of inertia, opposite and equal for the two of a pair, so linear momentum is kept, too. Only
 * velocities change. The pushes of walls, colliders and images are from outside, and have their
 * torque. What passes/damping_compensation.h gives back is no longer lacking. */
#ifndef PBF_PHYSICS_TURN_H
#define PBF_PHYSICS_TURN_H

#include "physics/scalar.h"

/* The rate of a particle with these moments of the pairs around it, sums of weight x_k x_m, for a
 * torque that they are to have: tensor of inertia * rate = torque. Two alone can't be turned about
 * the axis through them: a few roundings are added. */
PBF_FN_APART pbf_curl pbf_turn_rate(const pbf_real moments[PBF_MOMENTS], pbf_curl torque) {
  pbf_curl rate = {{0}};
#if PBF_DIM == 2
  pbf_real inertia = moments[0] + moments[2];
  if (inertia > 0) rate.c[0] = torque.c[0] / inertia;
#else
  pbf_real trace = moments[0] + moments[2] + moments[5];
  if (!(trace > 0)) return rate;
  const pbf_real least = (pbf_real)(sizeof(pbf_real) == sizeof(float) ? 1e-6 : 1e-13);
  pbf_real per = 1 / trace, own = 1 + least;
  pbf_real xx = own - per * moments[0], yy = own - per * moments[2], zz = own - per * moments[5];
  pbf_real xy = -per * moments[1], xz = -per * moments[3], yz = -per * moments[4];
  pbf_real ax = yy * zz - yz * yz, ay = xz * yz - xy * zz, az = xy * yz - xz * yy;
  pbf_real scale = per / (xx * ax + xy * ay + xz * az);
  pbf_real bx = torque.c[0], by = torque.c[1], bz = torque.c[2];
  rate.c[0] = scale * (ax * bx + ay * by + az * bz);
  rate.c[1] = scale * (ay * bx + (xx * zz - xz * xz) * by + (xy * xz - xx * yz) * bz);
  rate.c[2] = scale * (az * bx + (xy * xz - xx * yz) * by + (xx * yy - xy * xy) * bz);
#endif
  return rate;
}

#endif
