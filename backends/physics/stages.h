/* Stage bodies: what one particle does in one stage, given its sums over neighbours. */
#ifndef PBF_PHYSICS_STAGES_H
#define PBF_PHYSICS_STAGES_H

#include "physics/collide.h"
#include "physics/constants.h"

/* Forces of one step (Algorithm 1, line 2), in the precision of the particles. */
typedef struct pbf_forces {
  pbf_real time_step;
  pbf_vec gravity;
  pbf_real attraction;
  pbf_vec attraction_center;
} pbf_forces;

static inline pbf_forces pbf_forces_of(const pbf_params *params) {
  pbf_forces f;
  f.time_step = (pbf_real)params->time_step;
  f.attraction = (pbf_real)params->attraction;
  for (int k = 0; k < PBF_DIM; ++k) {
    f.gravity.c[k] = (pbf_real)params->gravity[k];
    f.attraction_center.c[k] = (pbf_real)params->attraction_center[k];
  }
  return f;
}

/* Lines 2 and 3: the predicted position of a particle at x with velocity v. */
PBF_FN pbf_vec pbf_predict(const pbf_forces *f, pbf_vec x, pbf_vec v) {
  pbf_vec acceleration = f->gravity;
  if (f->attraction != 0)
    acceleration = pbf_add_scaled(acceleration, -f->attraction, pbf_sub(x, f->attraction_center));
  v = pbf_add_scaled(v, f->time_step, acceleration);
  return pbf_add_scaled(x, f->time_step, v);
}

/* Line 10, eqs. 1 and 11, from density = V sum W (the particle itself included), gradient = sum
 * over the others of V grad W, slope2 = sum over the others of |V grad W|². */
PBF_FN pbf_real pbf_lambda(const pbf_constants *c, pbf_real density, pbf_real slope2,
                           pbf_vec gradient) {
  pbf_real constraint = density - 1;
  pbf_real diagonal = slope2 + pbf_dot(gradient, gradient) + c->epsilon;
  if (constraint < 0) constraint *= c->tension;
  return -constraint / pbf_real_max(diagonal, c->min_diagonal);
}

/* One Chebyshev step: `lambda` is pbf_lambda's, `weight` from pbf_next_weight; *total is the lambda
 * that acts, *before the one of an iteration earlier (both 0 at the start of a step). Returns what
 * the position change of this iteration takes for lambda. */
PBF_FN pbf_real pbf_accelerate(const pbf_constants *c, pbf_real weight, pbf_real lambda,
                               pbf_real *total, pbf_real *before) {
  pbf_real now = *total;
  pbf_real next = weight * (now + c->step_size * lambda - *before) + *before;
  if (c->one_sided) next = pbf_real_min(next, 0);
  *total = next;
  *before = now;
  return (next - now) / c->omega;
}

/* Density that a plane wall lends at a distance, and its gradient, added to the sums. */
PBF_FN void pbf_add_wall(const pbf_constants *c, pbf_real distance, pbf_vec normal,
                         pbf_real *density, pbf_vec *gradient) {
  enum { LAST = PBF_WALL_NODES - 1 };
  pbf_real t = (distance + c->wall_offset) * c->inv_h * LAST;
  if (!(t < LAST)) return;
  t = pbf_real_max(t, 0);
  int k = (int)t;
  pbf_real s = t - k, s2 = s * s;
  pbf_real v0 = c->wall_value[k], v1 = c->wall_value[k + 1];
  pbf_real g0 = c->wall_slope[k], g1 = c->wall_slope[k + 1], rise = v1 - v0;
  *density += v0 + s * g0 + s2 * ((3 - 2 * s) * rise - (2 - s) * g0 - (1 - s) * g1);
  pbf_real slope = g0 + 6 * s * (1 - s) * rise - (4 * s - 3 * s2) * g0 - (2 * s - 3 * s2) * g1;
  *gradient = pbf_add_scaled(*gradient, slope * LAST * c->inv_h, normal);
}

/* The same for all walls of the domain and all colliders, each by its nearest plane. */
PBF_FN void pbf_add_walls(const pbf_constants *c, const pbf_walls *walls, int count,
                          const pbf_solid *solids, pbf_vec x, pbf_real *density,
                          pbf_vec *gradient) {
  for (int side = 0; side < 2 * PBF_DIM; ++side) {
    int k = side / 2;
    pbf_vec normal = {{0}};
    normal.c[k] = side % 2 ? (pbf_real)-1 : (pbf_real)1;
    pbf_real distance = side % 2 ? walls->upper.c[k] - x.c[k] : x.c[k] - walls->lower.c[k];
    pbf_add_wall(c, distance, normal, density, gradient);
  }
  for (int k = 0; k < count; ++k) {
    pbf_vec normal;
    pbf_real distance = pbf_solid_distance(&solids[k], x, &normal);
    pbf_add_wall(c, distance, normal, density, gradient);
  }
}

/* Factor on V grad W in the position change (line 13, eqs. 12 and 14) is
 * lambda_i + lambda_j + s_ij; `sum` is the sum of these products over the others. */
PBF_FN pbf_vec pbf_move(const pbf_constants *c, pbf_vec predicted, pbf_vec sum) {
  return pbf_add_scaled(predicted, c->omega, sum);
}

/* Line 21: the velocity that explains the step. */
PBF_FN pbf_vec pbf_velocity(pbf_real inv_time_step, pbf_vec before, pbf_vec after) {
  pbf_vec v = pbf_sub(after, before);
  for (int k = 0; k < PBF_DIM; ++k) v.c[k] *= inv_time_step;
  return v;
}

/* One pair's part of the curl of the velocity (eq. 15): (v_j - v_i) x V grad_j W, with
 * V grad_j W = -slope (x_i - x_j). */
PBF_FN void pbf_add_curl(pbf_curl *curl, pbf_real slope, pbf_vec x_ij, pbf_vec v_ji) {
#if PBF_DIM == 3
  curl->c[0] -= slope * (v_ji.c[1] * x_ij.c[2] - v_ji.c[2] * x_ij.c[1]);
  curl->c[1] -= slope * (v_ji.c[2] * x_ij.c[0] - v_ji.c[0] * x_ij.c[2]);
  curl->c[2] -= slope * (v_ji.c[0] * x_ij.c[1] - v_ji.c[1] * x_ij.c[0]);
#else
  curl->c[0] -= slope * (v_ji.c[0] * x_ij.c[1] - v_ji.c[1] * x_ij.c[0]);
#endif
}

PBF_FN pbf_real pbf_curl_size(pbf_curl curl) {
  pbf_real sum = 0;
  for (int k = 0; k < PBF_CURL_DIM; ++k) sum += curl.c[k] * curl.c[k];
  return pbf_real_sqrt(sum);
}

/* Vorticity confinement (eq. 16), velocity change: dt e (N x curl), N = eta/|eta|, where eta is
 * the gradient of |curl|, sum over the others of V |curl|_j grad_i W. */
PBF_FN pbf_vec pbf_confine(pbf_real dt_strength, pbf_vec eta, pbf_curl curl) {
  pbf_real size = pbf_real_sqrt(pbf_dot(eta, eta));
  pbf_real s = size > 0 ? dt_strength / size : 0;
  pbf_vec dv;
#if PBF_DIM == 3
  dv.c[0] = s * (eta.c[1] * curl.c[2] - eta.c[2] * curl.c[1]);
  dv.c[1] = s * (eta.c[2] * curl.c[0] - eta.c[0] * curl.c[2]);
  dv.c[2] = s * (eta.c[0] * curl.c[1] - eta.c[1] * curl.c[0]);
#else
  dv.c[0] = s * eta.c[1] * curl.c[0];
  dv.c[1] = -s * eta.c[0] * curl.c[0];
#endif
  return dv;
}

#endif
