/* Stage bodies: what one particle does in one stage, given its sums over neighbours. */
#ifndef PBF_PHYSICS_STAGES_H
#define PBF_PHYSICS_STAGES_H

#include "physics/collide.h"
#include "physics/constants.h"
#include "physics/project.h"

/* Forces of one step (Algorithm 1, line 2), in the precision of the particles. */
typedef struct pbf_forces {
  pbf_real time_step, inv_time_step;
  pbf_real most_speed; /* along an axis, see pbf_most_speed_of */
  pbf_real rounding;   /* part of a last bit that predictions are off, see pbf_rounding_of */
  pbf_vec gravity;
  pbf_real attraction;
  pbf_vec attraction_center;
} pbf_forces;

/* At a constant velocity a place is rounded the same way in every step, and what is lost adds up.
 * So the ways that particles go are off by a part of a last bit before they are rounded, in each
 * step by another one: a golden part of a turn on, which spreads any run of steps as evenly as can
 * be (Kronecker's sequence), so that their mean is what was to be added. The steps' number is told
 * from the `time` at which a step begins, at a place in it that no change of the time step hits. */
static inline pbf_real pbf_rounding_of(double time, double time_step) {
  const double golden = 0.61803398874989485;
  if (!(time_step > 0)) return 0;
  double turns = golden * floor(time / time_step + (1 - golden));
  return (pbf_real)(0.9999 * (turns - floor(turns + 0.5)));
}

/* What crosses the domain in less than a step is as fast as what crosses it in one: walls stop
 * both, and squares of what is faster overflow. So may those of more than 1e15 h a time unit. */
static inline pbf_real pbf_most_speed_of(const pbf_params *params) {
  double way = 0, most = 1e15 * params->smoothing_radius;
  for (int k = 0; k < PBF_DIM; ++k) way += params->domain_max[k] - params->domain_min[k];
  way *= pbf_per_time_step(params);
  return (pbf_real)(way > 0 && way < most ? way : most);
}

static inline pbf_forces pbf_forces_of(const pbf_params *params, double time) {
  pbf_forces f;
  f.time_step = (pbf_real)params->time_step;
  f.inv_time_step = (pbf_real)pbf_per_time_step(params);
  f.most_speed = pbf_most_speed_of(params);
  f.rounding = pbf_rounding_of(time, params->time_step);
  f.attraction = (pbf_real)params->attraction;
  for (int k = 0; k < PBF_DIM; ++k) {
    f.gravity.c[k] = (pbf_real)params->gravity[k];
    f.attraction_center.c[k] = (pbf_real)params->attraction_center[k];
  }
  return f;
}

/* Line 2: the velocity that the forces leave a particle at x. */
PBF_FN pbf_vec pbf_apply_forces(const pbf_forces *f, pbf_vec x, pbf_vec v) {
  pbf_vec acceleration = f->gravity;
  if (f->attraction != 0)
    acceleration = pbf_add_scaled(acceleration, -f->attraction, pbf_sub(x, f->attraction_center));
  return pbf_add_scaled(v, f->time_step, acceleration);
}

/* Lines 2 and 3: the predicted position of a particle at x with velocity v. */
PBF_FN pbf_vec pbf_predict(const pbf_forces *f, pbf_vec x, pbf_vec v) {
  pbf_vec velocity = pbf_apply_forces(f, x, v);
  for (int k = 0; k < PBF_DIM; ++k) {
    const pbf_real sign = velocity.c[k] < 0 ? (pbf_real)-1 : (pbf_real)1;
    pbf_real way = f->time_step * (sign * velocity.c[k]);
    way += f->rounding * pbf_last_bit(x.c[k]);
    x.c[k] += sign * (way < 0 ? 0 : way);
  }
  return x;
}

/* The velocity that goes with it: obstacles may have moved what was `predicted` to `after`. What is
 * no number becomes one. */
PBF_FN pbf_vec pbf_predicted_velocity(const pbf_forces *f, pbf_vec x, pbf_vec v, pbf_vec predicted,
                                      pbf_vec after) {
  pbf_vec moved = pbf_sub(after, predicted);
  pbf_vec velocity = pbf_add_scaled(pbf_apply_forces(f, x, v), f->inv_time_step, moved);
  for (int k = 0; k < PBF_DIM; ++k)
    velocity.c[k] = pbf_real_max(-f->most_speed, pbf_real_min(velocity.c[k], f->most_speed));
  return velocity;
}

/* Line 10, eqs. 1 and 11, from density = V sum W (the particle itself included), gradient = sum
 * over the others of V grad W, slope2 = sum over the others of |V grad W|². In a crowd the
 * eigenvalues of the iteration grow with the density, and a step that is to stay inside them has to
 * shrink with it. The error itself is not bounded: a crowd that pushes less the denser it is draws
 * in what is around it. `slack` is 0 or pbf_slack's. */
PBF_FN pbf_real pbf_lambda(const pbf_constants *c, pbf_real slack, pbf_real density,
                           pbf_real slope2, pbf_vec gradient) {
  pbf_real constraint = density - c->target - slack;
  pbf_real diagonal = slope2 + pbf_dot(gradient, gradient) + c->epsilon;
  if (constraint < 0) constraint *= c->tension;
  if (constraint > 0 && constraint < c->rounding) constraint = 0;
  diagonal = pbf_real_max(diagonal, c->min_diagonal);
  if ((PBF_BUILT & PBF_FEATURE_CHEBYSHEV) && c->accelerated) diagonal *= pbf_real_max(density, 1);
  return -constraint / diagonal;
}

/* What a step leaves of the density error at its start. */
PBF_FN pbf_real pbf_slack(const pbf_constants *c, pbf_real density) {
  pbf_real error = pbf_real_max(density - c->target, 0);
  return pbf_real_max(c->slack * error, c->most_slack * error - c->most_undone);
}

/* A particle's part of the density error that ends a solve, in units of 2^-24: the sum of integers
 * is the same in any order. Above 64, and what is no number, it counts as 64, and as nothing. */
PBF_FN int32_t pbf_excess(const pbf_constants *c, pbf_real slack, pbf_real density) {
  const pbf_real most = 64, unit = (pbf_real)(1 << 24);
  return (int32_t)(pbf_real_min(pbf_real_max(density - c->target - slack, 0), most) * unit);
}

/* The part of a particle that does not solve, and so has no say in when the others have done. */
static inline int32_t pbf_idle_excess(const pbf_params *params) {
  return (int32_t)(fmin(params->tolerance, 64) * (1 << 24));
}

/* What the sum over all particles may be when the solve ends. */
static inline int64_t pbf_excess_limit(const pbf_params *params, uint32_t count) {
  return (int64_t)fmin(params->tolerance * count * (1 << 24), 0x1p62);
}

/* One Chebyshev step: `lambda` is pbf_lambda's; *total is the lambda that has added up, *change
 * what the iteration adds to it and moves particles by (both 0 at the start of a step).
 *
 * Where fluid is pressed hard, the large forces of a particle's neighbours cancel, and what is left
 * when one is out of place grows like stiffness * |lambda|. So no iteration adds more than a few
 * parts of 1 / stiffness, at places where neighbours have moved by as much: momentum is kept to
 * rounding however hard. Nothing pulls, lambda > 0, but as pbf_set_pull says. */
PBF_FN void pbf_accelerate(const pbf_constants *c, pbf_real density, pbf_real lambda,
                           pbf_real *total, pbf_real *change) {
  const pbf_real crowd = (pbf_real)1.5;
  pbf_real most = c->most_change / pbf_real_max(density / crowd, 1);
  pbf_real add = (c->weight - 1) * *change + c->weight * c->step_size * lambda;
  add = pbf_real_max(pbf_real_min(add, most), -most);
  pbf_real next = *total + add;
  next = pbf_real_min(next, density > c->least_pulled ? c->most_pull : 0);
  *change = next - *total;
  *total = next;
}

enum { PBF_WALL_LAST = PBF_WALL_NODES - 1 };

/* Where a distance from a plane wall is among the nodes that say what the wall lends: from
 * PBF_WALL_LAST on it lends nothing. */
PBF_FN pbf_real pbf_wall_place(const pbf_constants *c, pbf_real distance) {
  return (distance + c->wall_offset) * c->inv_h * PBF_WALL_LAST;
}

/* From the slope of what a wall lends to what it pushes with, at a place among the nodes. */
PBF_FN pbf_real pbf_wall_push(const pbf_constants *c, pbf_real place) {
  pbf_real beyond = pbf_real_min(pbf_real_max(place - c->wall_first, 0), c->wall_layer);
  return c->wall_push + c->wall_push_rise * beyond;
}

/* Density that the wall lends at the part s of the way between two nodes with these values and
 * slopes, and its derivative over this way. */
PBF_FN pbf_real pbf_wall_between(pbf_real s, pbf_real v0, pbf_real v1, pbf_real g0, pbf_real g1,
                                 pbf_real *slope) {
  pbf_real s2 = s * s, rise = v1 - v0;
  *slope = g0 + 6 * s * (1 - s) * rise - (4 * s - 3 * s2) * g0 - (2 * s - 3 * s2) * g1;
  return v0 + s * g0 + s2 * ((3 - 2 * s) * rise - (2 - s) * g0 - (1 - s) * g1);
}

PBF_FN_APART pbf_real pbf_wall(const pbf_constants *c, pbf_real distance, pbf_real *slope) {
  pbf_real t = pbf_wall_place(c, distance);
  *slope = 0;
  if (!(t < PBF_WALL_LAST)) return 0;
  t = pbf_real_max(t, 0);
  int k = (int)t;
  pbf_real value = pbf_wall_between(t - k, c->wall_value[k], c->wall_value[k + 1], c->wall_slope[k],
                                    c->wall_slope[k + 1], slope);
  *slope *= pbf_wall_push(c, t);
  return value;
}

/* The part of what an obstacle lends that it shares with others: all of it up to twice what it
 * lends the first layer of a fluid at rest, then ever less; *rate is the derivative. The rest it
 * lends for itself: deep inside two walls nothing of their slopes may be lost, else their common
 * edge pushes back less than the fluid presses, and holds for good whom an impact has thrown there.
 */
PBF_FN pbf_real pbf_wall_share(const pbf_constants *c, pbf_real value, pbf_real *rate) {
  pbf_real beyond = pbf_real_min(pbf_real_max(value * c->wall_inv_rest - 2, 0), 2);
  *rate = 1 - beyond / 2;
  return pbf_real_min(value, 2 * c->wall_rest) + c->wall_rest * beyond * (1 - beyond / 4);
}

/* Joins the share of one more obstacle, `value` with the gradient `slope` * `normal`, to what
 * others lend. Half-spaces overlap, where walls meet at right angles: what is free of both is about
 * the product of what is free of each, exactly so for a kernel that is a product over the axes. */
PBF_FN pbf_real pbf_join_slope(pbf_real value, pbf_real slope, pbf_real lent, pbf_real gradient) {
  return gradient * (1 - value) + (1 - lent) * slope;
}

PBF_FN pbf_real pbf_join_value(pbf_real value, pbf_real lent) { return lent + (1 - lent) * value; }

/* What obstacles lend: as far as they share it, and each for itself; and of what they share what
 * they would lend at most to a fluid at rest. */
typedef struct pbf_lent {
  pbf_real shared, own, resting;
  pbf_vec shared_gradient, own_gradient;
} pbf_lent;

PBF_FN void pbf_join_wall(const pbf_constants *c, pbf_real value, pbf_real slope, pbf_vec normal,
                          pbf_lent *lent) {
  pbf_real rate, share = pbf_wall_share(c, value, &rate);
  for (int k = 0; k < PBF_DIM; ++k)
    lent->shared_gradient.c[k] =
        pbf_join_slope(share, rate * slope * normal.c[k], lent->shared, lent->shared_gradient.c[k]);
  lent->shared = pbf_join_value(share, lent->shared);
  lent->resting = pbf_join_value(pbf_real_min(share, c->wall_rest), lent->resting);
  lent->own_gradient = pbf_add_scaled(lent->own_gradient, (1 - rate) * slope, normal);
  lent->own += value - share;
}

/* How much the half-space of one more obstacle and what others lend overlap, from 1 where they face
 * the same way, as a floor and a plane laid on it do, by 0 at right angles, to -1 where they face
 * each other. `gradient` is of what the others lend: where they cancel out, no way. */
PBF_FN pbf_real pbf_facing(pbf_vec gradient, pbf_real slope, pbf_vec normal) {
  pbf_real steep2 = pbf_real_max(pbf_dot(gradient, gradient), slope * slope / 16);
  return steep2 > 0 ? -pbf_dot(gradient, normal) / pbf_real_sqrt(steep2) : 0;
}

/* How much of what two lend overlaps, where they face the same way so much and each other so. */
PBF_FN pbf_real pbf_overlap(pbf_real a, pbf_real b, pbf_real same, pbf_real product) {
  return product * a * b + same * pbf_real_min(a, b);
}

/* Joins the share of a collider's plane: like pbf_join_wall at right angles, the larger of both
 * where they face the same way, and their sum where they face each other. */
PBF_FN void pbf_join_plane(const pbf_constants *c, pbf_real value, pbf_real slope, pbf_vec normal,
                           pbf_lent *lent) {
  pbf_real rate, share = pbf_wall_share(c, value, &rate);
  pbf_real facing = pbf_facing(lent->shared_gradient, slope, normal);
  pbf_real same = pbf_real_max(facing, 0), product = 1 - pbf_real_max(facing, -facing);
  pbf_real keep = 1 - product * share - (lent->shared < share ? same : 0);
  pbf_real add = 1 - product * lent->shared - (lent->shared < share ? 0 : same);
  pbf_real resting = pbf_real_min(share, c->wall_rest);
  for (int k = 0; k < PBF_DIM; ++k)
    lent->shared_gradient.c[k] =
        keep * lent->shared_gradient.c[k] + add * rate * slope * normal.c[k];
  lent->shared += share - pbf_overlap(lent->shared, share, same, product);
  lent->resting += resting - pbf_overlap(lent->resting, resting, same, product);
  lent->own_gradient = pbf_add_scaled(lent->own_gradient, (1 - rate) * slope, normal);
  lent->own += value - share;
}

/* The inside of a box lends by all of its faces, as the domain does, everything else by its nearest
 * plane. */
PBF_FN int pbf_lending_planes(const pbf_solid *s) {
  return s->shape == PBF_COLLIDER_BOX && s->sign < 0 ? 2 * PBF_DIM : 1;
}

PBF_FN pbf_real pbf_plane_distance(const pbf_solid *s, int plane, int planes, pbf_vec x,
                                   pbf_vec *normal) {
  if (planes == 1) return pbf_solid_distance(s, x, normal);
  int row = plane / 2;
  pbf_real sign = plane % 2 ? (pbf_real)-1 : (pbf_real)1;
  for (int k = 0; k < PBF_DIM; ++k) normal->c[k] = sign * s->frame[row].c[k];
  return s->half_extents.c[row] + pbf_dot(pbf_sub(x, s->center), *normal);
}

/* Walls that mirror the fluid lend nothing beside. */
PBF_FN pbf_lent pbf_lent_by_walls(const pbf_constants *c, const pbf_walls *walls, pbf_vec x) {
  pbf_lent lent = {0, 0, 0, {{0}}, {{0}}};
  if ((PBF_BUILT & PBF_FEATURE_WALL_DENSITY) && walls->reach > 0) return lent;
  for (int k = 0; k < PBF_DIM; ++k) {
    pbf_vec axis = {{0}};
    axis.c[k] = 1;
    pbf_real rise, fall, value = pbf_wall(c, x.c[k] - walls->lower.c[k], &rise);
    value += pbf_wall(c, walls->upper.c[k] - x.c[k], &fall);
    pbf_join_wall(c, value, rise - fall, axis, &lent);
  }
  return lent;
}

/* From where on obstacles lend nothing. */
PBF_FN pbf_real pbf_lending_reach(const pbf_constants *c) { return c->h - c->wall_offset; }

PBF_FN void pbf_join_solid(const pbf_constants *c, const pbf_solid *s, pbf_vec x, pbf_lent *lent) {
  if (pbf_solid_beyond(s, x, pbf_lending_reach(c))) return;
  int planes = pbf_lending_planes(s);
  for (int plane = 0; plane < planes; ++plane) {
    pbf_vec normal;
    pbf_real slope, distance = pbf_plane_distance(s, plane, planes, x, &normal);
    pbf_real value = pbf_wall(c, distance, &slope);
    pbf_join_plane(c, value, slope, normal, lent);
  }
}

PBF_FN void pbf_add_lent(const pbf_lent *lent, pbf_real *density, pbf_vec *gradient) {
  *density += lent->shared + lent->own;
  *gradient = pbf_add_scaled(*gradient, 1, lent->shared_gradient);
  *gradient = pbf_add_scaled(*gradient, 1, lent->own_gradient);
}

/* What all walls of the domain and all colliders lend. */
PBF_FN pbf_lent pbf_lent_at(const pbf_constants *c, const pbf_walls *walls, int count,
                            const pbf_solid *solids, pbf_vec x) {
  pbf_lent lent = pbf_lent_by_walls(c, walls, x);
  for (int k = 0; k < count; ++k) pbf_join_solid(c, &solids[k], x, &lent);
  return lent;
}

PBF_FN void pbf_add_walls(const pbf_constants *c, const pbf_walls *walls, int count,
                          const pbf_solid *solids, pbf_vec x, pbf_real *density,
                          pbf_vec *gradient) {
  pbf_lent lent = pbf_lent_at(c, walls, count, solids, x);
  pbf_add_lent(&lent, density, gradient);
}

/* The part of a kernel's slope along a wall that lies beyond it is to the whole as the densities
 * are (by parts). Fluid mirrored in the wall would lend that, too; without it a pressure that grows
 * with the depth carries less of the fluid next to walls than of the rest, by a quarter at three
 * spacings, and it sinks, for good. So what its neighbours do along a wall is done more often, but
 * not for closer particles than in a fluid at rest: thin sheets would gain energy. With less than
 * PBF_BESIDE of it the fluid next to walls sinks, with all of it it rises. */
#define PBF_BESIDE 0.75

/* A sum of moves with the walls' part, where these lend something with a gradient, which is
 * `resting` for a fluid at rest. A corner of three walls comes to 0.75 at h = 5 spacings; colliders
 * that face each other in a slot may add up to more than there is. */
PBF_FN pbf_vec pbf_beside_walls(pbf_vec sum, pbf_real lambda, pbf_real resting, pbf_vec gradient) {
  pbf_real walls = pbf_real_min(resting, (pbf_real)0.75);
  pbf_real more = (pbf_real)PBF_BESIDE * walls / (1 - walls);
  pbf_real steep2 = pbf_dot(gradient, gradient);
  pbf_real across = pbf_dot(sum, gradient) / (steep2 > 0 ? steep2 : 1);
  pbf_vec along = pbf_add_scaled(sum, -across, gradient);
  return pbf_add_scaled(pbf_add_scaled(sum, more, along), lambda, gradient);
}

PBF_FN pbf_vec pbf_beside_lent(pbf_vec sum, pbf_real lambda, const pbf_lent *lent) {
  pbf_real density = 0;
  pbf_vec gradient = {{0}};
  pbf_add_lent(lent, &density, &gradient);
  return pbf_beside_walls(sum, lambda, lent->resting, gradient);
}

/* Factor on V grad W in the position change (line 13, eqs. 12 and 14) is
 * lambda_i + lambda_j + s_ij; `sum` is the sum of these products over the others. Where lambda adds
 * up it is the iteration's change of it that counts. */
PBF_FN pbf_vec pbf_move(const pbf_constants *c, pbf_vec x, pbf_vec sum) {
  return pbf_add_scaled(x, c->omega, sum);
}

/* Line 21, a move at a time: the velocity that explains it. Dividing x* - x by the time step would
 * round away what a particle does not move in a step, and turn what positions round into speed. */
PBF_FN pbf_vec pbf_push(const pbf_constants *c, pbf_real inv_time_step, pbf_vec velocity,
                        pbf_vec sum) {
  return pbf_add_scaled(velocity, inv_time_step * c->omega, sum);
}

/* The same for what walls and colliders do to a place. */
PBF_FN pbf_vec pbf_velocity(pbf_real inv_time_step, pbf_vec velocity, pbf_vec before,
                            pbf_vec after) {
  return pbf_add_scaled(velocity, inv_time_step, pbf_sub(after, before));
}

/* Pressure over rest density of a step, from the lambda that has added up. A step moves a pair by
 * V (lambda_i + lambda_j) grad W: forces, once divided by dt², of which a plane through the rest
 * lattice transmits -pbf_derived.pressure * lambda / dt² an area (the virial; for a wide kernel the
 * factor is 1). `scale` is that factor over dt², or 0 with no step to speak of. */
PBF_FN pbf_real pbf_pressure(pbf_real scale, pbf_real total) {
  return scale > 0 ? 0 - scale * total : 0;
}

PBF_FN pbf_real pbf_curl_size(pbf_curl curl) {
  pbf_real sum = 0;
  for (int k = 0; k < PBF_CURL_DIM; ++k) sum += curl.c[k] * curl.c[k];
  return pbf_real_sqrt(sum);
}

/* A viscosity that leads to the mean velocity of the others. */
#define PBF_TO_MEAN ((pbf_real)1e30)

/* XSPH (eq. 17): v, and of `sum`, that of V W (v_j - v) over the others, as much as `viscosity`
 * says, but no more than leads to their mean: with `weight`, the sum of V W, which is below 1 but
 * in crowds. So no velocity ends beyond all of those around it, however viscous and dense. */
PBF_FN pbf_vec pbf_smooth(pbf_real viscosity, pbf_vec v, pbf_vec sum, pbf_real weight) {
  const pbf_real tiny = (pbf_real)1e-20;
  return pbf_add_scaled(v, pbf_real_min(viscosity, 1 / pbf_real_max(weight, tiny)), sum);
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
