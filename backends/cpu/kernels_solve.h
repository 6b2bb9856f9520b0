/* The density constraint's passes over pairs, lambda and move: a particle in each lane, its
 * neighbours one after another. */
#ifndef PBF_CPU_KERNELS_SOLVE_H
#define PBF_CPU_KERNELS_SOLVE_H

#include "cpu/driver.h"
#include "cpu/driver_ghosts.h"
#include "cpu/boundary.h"
#include "physics/passes/lambda.h"
#include "physics/passes/mobility.h"
#include "physics/passes/move.h"
#include "physics/passes/overlap.h"
#include "physics/passes/smooth_pressure.h"

/* What the loops are built for; a build that is without a feature has no loop for it. */
PBF_FN int hot_features(const pair_pass *p) { return p->features & PBF_BUILT; }

PBF_FN const pbf_obstacles *contributing_obstacles(const pair_pass *p) {
  return PBF_BUILT & PBF_FEATURE_WALL_DENSITY ? p->contributing : NULL;
}

PBF_FN uint32_t lanes_in_group(const lists *n, uint32_t g) {
  return n->count - g * WIDTH < WIDTH ? n->count - g * WIDTH : (uint32_t)WIDTH;
}

/* Of one group, in the last iteration. */
static __attribute__((noinline)) void smooth_group(const pair_pass *p, pbf_real *lambda,
                                                   pbf_real *added, uint32_t g) {
  for (uint32_t l = 0, i = g * WIDTH; l < lanes_in_group(&p->lists, g); ++l, ++i)
    pbf_smooth_pressure(p->constants, p->last_pressure[p->order[i]], &lambda[i], &added[i]);
}

PBF_FN bool smooths(const pair_pass *p) {
  return (PBF_BUILT & PBF_FEATURE_CHEBYSHEV) && p->last_pressure;
}

/* Whether some of a group have an overlap: few do, and not for long. */
PBF_FN bool any_overlap(const pbf_real *overlap, uint32_t g) {
  return lane_any_below(ops<lane>::set(0), lane_load(overlap + g * WIDTH));
}

/* What is allowed for of a group's overlap from its next iteration on. What is below 0 stays. */
PBF_FN void bound_overlap(const pair_pass *p, const lane *density, uint32_t g) {
  if (!p->overlap || !any_overlap(p->overlap, g)) return;
  alignas(64) pbf_real densities[WIDTH];
  lane_store(densities, *density);
  pbf_real *overlap = p->overlap + g * WIDTH;
  for (uint32_t l = 0; l < lanes_in_group(&p->lists, g); ++l)
    overlap[l] = pbf_overlap_of_error(overlap[l], densities[l] - p->constants->target);
}

/* Lambda of one group from its sums. */
template <class Pass>
PBF_FN void lambda_group(const Pass &pass, const lane *density,
                         const lane_sums<Pass::template sums> &sums,
                         const pbf_real *residual_density, pbf_real *lambda, pbf_real *added) {
  const pbf_constants *c = pass.c;
  alignas(64) pbf_real densities[WIDTH], lambdas[WIDTH];
  lane_store(densities, *density);
  for (uint32_t l = 0; l < WIDTH; ++l)
    lambdas[l] = pass.finish(sums[l], residual_density ? residual_density[l] : 0);
  if ((PBF_BUILT & PBF_FEATURE_CHEBYSHEV) && c->accelerated)
    for (uint32_t l = 0; l < WIDTH; ++l)
      pbf_accelerate(c, densities[l], lambdas[l], &lambda[l], &added[l]);
  else
    lane_store(lambda, lane_load(lambdas));
}

/* The density error of a group's particles. */
static __attribute__((noinline)) int64_t error_units_of(const pair_pass *p, const lane *density,
                                                        uint32_t g) {
  _Alignas(64) pbf_real densities[WIDTH];
  int64_t sum = 0;
  lane_store(densities, *density);
  for (uint32_t l = 0; l < lanes_in_group(&p->lists, g); ++l)
    if (!p->activity || !pbf_is_inactive(p->activity[g * WIDTH + l]))
      sum += pbf_error_units(
          p->constants, p->residual_density ? p->residual_density[g * WIDTH + l] : 0, densities[l]);
  return sum;
}

PBF_FN int64_t *asked_excess(const pair_pass *p) {
  return PBF_BUILT & PBF_FEATURE_TOLERANCE ? p->error_units : NULL;
}

static __attribute__((noinline)) int group_near_obstacles(const pair_pass *p, uint32_t g) {
  return near_obstacles(p->constants, p->contributing, load_vector(p->x, g * WIDTH));
}

PBF_FN lane_boundary group_boundary(const pair_pass *p, uint32_t g, const lanes_asked *asked) {
  const lane_values xs = values_of(load_vector(p->x, g * WIDTH));
  lane_boundary boundary;
  boundary_of_group(p->constants, p->contributing, &xs, asked, &boundary);
  return boundary;
}

/* Which of a group's particles may be near colliders; null: all. */
static __attribute__((noinline)) const lanes_asked *ask_lanes(const pair_pass *p, uint32_t g,
                                                              lanes_asked *asked) {
  const clear_ways *clear = &p->clear;
  if (!clear->of) return NULL;
  const lane_values xs = values_of(load_vector(p->x, g * WIDTH));
  const lane_values from = values_of(load_vector(clear->predicted, g * WIDTH));
  pbf_real *ways = clear->of + g * WIDTH, without[WIDTH];
  if (clear->first) find_clear(p->constants, p->contributing, &xs, ways);
  for (uint32_t l = 0; l < WIDTH; ++l)
    without[l] = ways[l] < clear_reach(p->constants) ? 0 : clear_way(p->constants);
  *asked = lanes_beyond(without, &from, &xs);
  return asked;
}

/* What surfaces contribute to a group's densities; adds to their gradients, and leaves it for move.
 */
static __attribute__((noinline)) lane add_boundary(const pair_pass *p, uint32_t g,
                                                   lane_values *gradients) {
  lanes_asked asked;
  const lane_boundary boundary = group_boundary(p, g, ask_lanes(p, g, &asked));
  lane_store(p->boundary.rest + g * WIDTH, lane_load(boundary.rest));
  for (int k = 0; k < PBF_DIM; ++k) {
    lane_store(p->boundary.gradient.c[k] + g * WIDTH, lane_load(boundary.gradient.c[k]));
    for (uint32_t l = 0; l < WIDTH; ++l) gradients->c[k][l] += boundary.gradient.c[k][l];
  }
  return lane_load(boundary.density);
}

PBF_FN void add_boundary_to(const pair_pass *p, uint32_t g, lambda_sums<lane> *sums) {
  if (!contributing_obstacles(p) || !group_near_obstacles(p, g)) return;
  lane_values gradients;
  for (int k = 0; k < PBF_DIM; ++k) lane_store(gradients.c[k], sums->gradient.c[k]);
  const lane boundary = add_boundary(p, g, &gradients);
  sums->density = sums->density + boundary;
  for (int k = 0; k < PBF_DIM; ++k) sums->gradient.c[k] = lane_load(gradients.c[k]);
}

template <class Features>
PBF_FN void lambda_groups(Features features, const pair_pass *p, pbf_real *lambda, pbf_real *added,
                          uint32_t first, uint32_t last) {
  typedef lambda_pass<Features, SCALED_SUMS> pass_type;
  const pbf_constants c = *p->constants;
  const pass_type pass = {&c, features};
  for (uint32_t g = first; g < last; ++g) {
    lambda_sums<lane> sums, with_ghosts;
    if (has_ghosts(p) && sum_with_ghosts<lambda_pass>(p, features, {}, g, &with_ghosts))
      sums = with_ghosts;
    else
      sums = sums_of_group(pass, p, {}, {}, g);
    add_boundary_to(p, g, &sums);
    if (asked_excess(p)) *p->error_units += error_units_of(p, &sums.density, g);
    lambda_group(pass, &sums.density, lane_sums<pass_type::template sums>(sums),
                 p->residual_density ? p->residual_density + g * WIDTH : NULL, lambda + g * WIDTH,
                 added + g * WIDTH);
    bound_overlap(p, &sums.density, g);
    if (smooths(p)) smooth_group(p, lambda, added, g);
  }
}

/* Of a group from its sums where phases differ: what particles are moved by is found and bounded.
 * Loops of one thing each, from constants that nothing else can change: the compiler makes vectors
 * of these alone. */
static __attribute__((noinline)) void mobile_lambda_group(int features, const pair_pass *p,
                                                          const mobile_lambda_sums<lane> &sums,
                                                          pbf_real *lambda, pbf_real *added,
                                                          uint32_t g) {
  const pbf_constants c = *p->constants;
  const lane_sums<lambda_sums> each(sums.lambda);
  alignas(64) pbf_real densities[WIDTH], found[WIDTH], mobility[WIDTH];
  alignas(64) pbf_real slope2[WIDTH], mobile[WIDTH];
  lane_store(densities, sums.lambda.density);
  lane_store(slope2, sums.slope2);
  lane_store(mobile, sums.mobile);
  for (uint32_t l = 0; l < WIDTH; ++l) mobility[l] = 1; /* lanes without a particle */
  memcpy(mobility, p->mobility + g * WIDTH, lanes_in_group(&p->lists, g) * sizeof *mobility);
  const pbf_real *residual_density = p->residual_density ? p->residual_density + g * WIDTH : NULL;
  const lambda_pass<int, SCALED_SUMS> of_lambda = {&c, features};
  const mobility_pass<int> of_mobility = {&c, features};
  for (uint32_t l = 0; l < WIDTH; ++l)
    found[l] = of_lambda.finish(each[l], residual_density ? residual_density[l] : 0);
  for (uint32_t l = 0; l < WIDTH; ++l)
    mobility[l] = of_mobility.finish({0, slope2[l], mobile[l]}, mobility[l]);
  if ((PBF_BUILT & PBF_FEATURE_CHEBYSHEV) && c.accelerated)
    for (uint32_t l = 0; l < WIDTH; ++l)
      pbf_accelerate_for(&c, mobility[l], densities[l], found[l], &lambda[l], &added[l]);
  else
    for (uint32_t l = 0; l < WIDTH; ++l) lambda[l] = pbf_lambda_for(mobility[l], found[l]);
}

/* Loops for both kernels. */
static __attribute__((noinline)) void lambda_of_phases(const pair_pass *p, pbf_real *lambda,
                                                       pbf_real *added, uint32_t first,
                                                       uint32_t last) {
  const pbf_constants c = *p->constants;
  const mobile_lambda_pass<int, SCALED_SUMS> pass = {&c, hot_features(p) & PBF_FEATURE_POLY6};
  const lookups of = {p->mobility, NULL};
  for (uint32_t g = first; g < last; ++g) {
    mobile_lambda_sums<lane> sums;
    lane_ghost_walls m;
    if (has_ghosts(p) && find_ghost_walls(p, g, &m))
      sums = sums_with_ghosts(pass, p, of, g, m);
    else
      sums = sums_of_group(pass, p, of, {lane_load(p->mobility + g * WIDTH)}, g);
    add_boundary_to(p, g, &sums.lambda);
    if (asked_excess(p)) *p->error_units += error_units_of(p, &sums.lambda.density, g);
    mobile_lambda_group(pass.features, p, sums, lambda + g * WIDTH, added + g * WIDTH, g);
    bound_overlap(p, &sums.lambda.density, g);
    if (smooths(p)) smooth_group(p, lambda, added, g);
  }
}

static void lambda(const pair_pass *p, pbf_real *lambda, pbf_real *added, uint32_t first,
                   uint32_t last) {
  if (p->mobility)
    lambda_of_phases(p, lambda, added, first, last);
  else if (hot_features(p) & PBF_FEATURE_POLY6)
    lambda_groups(fixed<PBF_FEATURE_POLY6>{}, p, lambda, added, first, last);
  else
    lambda_groups(fixed<0>{}, p, lambda, added, first, last);
}

/* The walls' part of the change, by what lambda has left of it. */
PBF_FN void correct_change(const pair_pass *p, const pbf_real *lambda, uint32_t g,
                           lane_values *sums) {
  for (uint32_t l = 0, i = g * WIDTH; l < WIDTH; ++l, ++i) {
    pbf_vec sum = pbf_boundary_correction(lane_value(sums, l), lambda[i], p->boundary.rest[i],
                                          field_at(&p->boundary.gradient, i));
    set_lane(sums, l, sum);
  }
}

/* Those that may meet colliders on their ways: a fourth of the way that is clear, as the domain
 * pushes a particle by no more than twice what it is out of it. */
static __attribute__((noinline)) lanes_asked lanes_under_way(const pair_pass *p,
                                                             const pbf_domain *domain,
                                                             const lane_values *from,
                                                             const lane_values *x, uint32_t first) {
  pbf_real ways[WIDTH];
  lanes_asked asked;
  memset(&asked, 1, sizeof asked); /* where nothing is known */
  if (!p->clear.of) return asked;
  for (uint32_t l = 0; l < WIDTH; ++l) ways[l] = p->clear.of[first + l] / 4;
  asked = lanes_beyond(ways, from, x);
  for (uint32_t l = 0; l < WIDTH; ++l) {
    asked.is[l] |= !(pbf_domain_distance(domain, lane_value(x, l)) > -ways[l]);
    asked.any |= asked.is[l];
  }
  return asked;
}

/* Those that meet no collider, and stay where the domain keeps them, are not asked. */
PBF_FN void leave_clear_ways(const pbf_obstacles *o, const lane_values *from,
                             const lane_values *kept, uint32_t lanes, lanes_asked *asked) {
  asked->any = 0;
  for (uint32_t l = 0; l < WIDTH && l < lanes; ++l) {
    if (asked->is[l]) asked->is[l] = !is_clear_way(o, lane_value(from, l), lane_value(kept, l));
    asked->any |= asked->is[l];
  }
}

/* Bounds of those that are asked, on their ways. */
static __attribute__((noinline)) group_bounds bounds_of_asked(const lanes_asked *asked,
                                                              const lane_values *from,
                                                              const lane_values *x,
                                                              uint32_t lanes) {
  lane_values starts = *from, ends = *x;
  uint32_t some = 0;
  while (some + 1 < lanes && !asked->is[some]) ++some;
  for (uint32_t l = 0; l < WIDTH; ++l) {
    if (l < lanes && asked->is[l]) continue;
    for (int k = 0; k < PBF_DIM; ++k) {
      starts.c[k][l] = from->c[k][some];
      ends.c[k][l] = x->c[k][some];
    }
  }
  return bounds_of_group(&starts, &ends);
}

static __attribute__((noinline)) void resolve_group(const pair_pass *p,
                                                    const pbf_obstacles *obstacles,
                                                    const lane_values *from, lane_values *x,
                                                    uint32_t first, uint32_t lanes) {
  lanes_asked asked = lanes_under_way(p, &obstacles->domain, from, x, first);
  const lane_values ends = *x;
  clamp_group(obstacles, x);
  if (!BUILT_FOR_SIZE && asked.any && p->clear.of)
    leave_clear_ways(obstacles, from, x, lanes, &asked);
  if (!asked.any) return;
  const group_bounds these = bounds_of_asked(&asked, from, &ends, lanes);
  resolve_ways(obstacles, &these, 0, [&](auto resolve) {
    for (uint32_t l = 0; l < lanes; ++l)
      if (asked.is[l]) set_lane(x, l, resolve(lane_value(from, l), lane_value(&ends, l)));
  });
}

/* Of a group's velocities, by what walls and colliders made of its moves. */
PBF_FN void store_velocities(const move_pass *m, const lane_vector<lane> &pushed,
                             const lane_values *moved, const lane_values *after, uint32_t first,
                             uint32_t lanes) {
  const lane inv_time_step = ops<lane>::set(m->inv_time_step);
  for (int k = 0; k < PBF_DIM; ++k) {
    const lane v = ops<lane>::multiply_add(
        inv_time_step, lane_load(after->c[k]) - lane_load(moved->c[k]), pushed.c[k]);
    if (lanes == WIDTH) {
      lane_store(m->velocity.c[k] + first, v);
    } else {
      alignas(64) pbf_real values[WIDTH];
      lane_store(values, v);
      memcpy(m->velocity.c[k] + first, values, lanes * sizeof(pbf_real));
    }
  }
}

/* The sums of a group over pairs alone. */
template <class Pass>
static __attribute__((noinline)) move_sums<lane> sums_of_pairs(const Pass &pass, const pair_pass *p,
                                                               const lookups *of, uint32_t g) {
  return sums_of_group(pass, p, *of, {lane_load(of->number + g * WIDTH)}, g);
}

/* What solids do to a group's velocities, which were v, and without them would have got `pairs`. */
static __attribute__((noinline)) void note_push(const pbf_constants *c, const move_pass *m,
                                                const lane_values *v, const lane_values *pairs,
                                                uint32_t first) {
  const lane push = ops<lane>::set(m->inv_time_step * c->omega);
  for (int k = 0; k < PBF_DIM; ++k) {
    const lane without = ops<lane>::multiply_add(push, lane_load(pairs->c[k]), lane_load(v->c[k]));
    pbf_real *noted = m->push->c[k] + first;
    lane_store(noted, lane_load(noted) + (lane_load(m->velocity.c[k] + first) - without));
  }
}

/* Whether symmetry may hold particles of a group: pressed, and not moved along an axis. */
PBF_FN int any_may_be_held(lane lambda, const lane_vector<lane> &change) {
  const lane tiny =
      ops<lane>::set(sizeof(pbf_real) == sizeof(float) ? (pbf_real)1e-37 : (pbf_real)1e-300);
  lane negative_min = -ops<lane>::max(change.c[0], -change.c[0]); /* of the axes' sizes */
  for (int k = 1; k < PBF_DIM; ++k)
    negative_min = ops<lane>::max(negative_min, -ops<lane>::max(change.c[k], -change.c[k]));
  return lane_any_below(ops<lane>::max(lambda, -negative_min - tiny), ops<lane>::set(0));
}

static __attribute__((noinline)) void break_symmetry(const pbf_constants *c, const move_pass *m,
                                                     uint32_t first, uint32_t lanes,
                                                     const lane_values *change, lane_values *x) {
  for (uint32_t l = 0, i = first; l < lanes; ++l, ++i) {
    const bool overlaps = m->overlap && m->overlap[i] > 0;
    set_lane(x, l,
             pbf_break_symmetry(c, m->lambda[i], overlaps, lane_value(change, l), m->ids[i],
                                lane_value(x, l)));
  }
}

template <class Pass>
PBF_FN void move_groups(const Pass &pass, const pair_pass *p, const move_pass *m, uint32_t first,
                        uint32_t last) {
  const lookups of = {m->lambda, NULL};
  for (uint32_t g = first; g < last; ++g) {
    lane_vector<lane> x = load_vector(p->x, g * WIDTH), v = load_vector(m->velocity, g * WIDTH);
    move_sums<lane> sums, with_ghosts;
    const bool meets_ghosts =
        has_ghosts(p) && sum_with_ghosts<move_pass_of>(p, pass.features, of, g, &with_ghosts);
    if (meets_ghosts)
      sums = with_ghosts;
    else
      sums = sums_of_group(pass, p, of, {lane_load(m->lambda + g * WIDTH)}, g);
    lane_values pairs, v_before;
    const bool notes = (PBF_BUILT & PBF_FEATURE_LOADS) && m->push;
    bool by_solids = meets_ghosts; /* has been changed */
    if (notes) {
      pairs = values_of(meets_ghosts ? sums_of_pairs(pass, p, &of, g).change : sums.change);
      v_before = values_of(v);
    }
    if (contributing_obstacles(p) && group_near_obstacles(p, g)) {
      lane_values change;
      for (int k = 0; k < PBF_DIM; ++k) lane_store(change.c[k], sums.change.c[k]);
      correct_change(p, m->lambda, g, &change);
      for (int k = 0; k < PBF_DIM; ++k) sums.change.c[k] = lane_load(change.c[k]);
      by_solids = notes && (by_solids || memcmp(&pairs, &change, sizeof pairs) != 0);
    }
    if (m->mobility) {
      const lane mobility = lane_load(m->mobility + g * WIDTH);
      sums.change.scale(mobility);
      for (int k = 0; k < PBF_DIM && notes; ++k)
        lane_store(pairs.c[k], lane_load(pairs.c[k]) * mobility);
    }
    pass.finish(sums, m->inv_time_step, &x, &v);
    lane_values moved = values_of(x);
    uint32_t lanes = lanes_in_group(&p->lists, g);
    if ((m->overlap && any_overlap(m->overlap, g)) ||
        any_may_be_held(lane_load(m->lambda + g * WIDTH), sums.change)) {
      const lane_values change = values_of(sums.change);
      break_symmetry(pass.c, m, g * WIDTH, lanes, &change, &moved);
    }
    lane_values after = moved;
    if (m->collide && pbf_surface_count(*m->obstacles)) {
      const lane_values starts = values_of(load_vector(m->predicted, g * WIDTH));
      resolve_group(p, m->obstacles, &starts, &after, g * WIDTH, lanes);
    } else if (m->collide) {
      clamp_group(m->obstacles, &after);
    }
    store_velocities(m, v, &moved, &after, g * WIDTH, lanes);
    if (notes && (by_solids || memcmp(&moved, &after, sizeof moved) != 0))
      note_push(pass.c, m, &v_before, &pairs, g * WIDTH);
    store_lanes(&m->to, g * WIDTH, lanes, &after);
  }
}

template <class Features>
PBF_FN void move_with(Features features, const pair_pass *p, const move_pass *m, uint32_t first,
                      uint32_t last) {
  const pbf_constants c = *p->constants;
  move_groups(move_pass_of<Features, SCALED_SUMS>{&c, features}, p, m, first, last);
}

static void move(const pair_pass *p, const move_pass *m, uint32_t first, uint32_t last) {
  enum { BOTH = PBF_FEATURE_POLY6 | PBF_FEATURE_SCORR };
  if (BUILT_FOR_SIZE)
    move_with(hot_features(p) & BOTH, p, m, first, last);
  else if ((hot_features(p) & BOTH) == BOTH)
    move_with(fixed<BOTH>{}, p, m, first, last);
  else if (hot_features(p) & PBF_FEATURE_POLY6)
    move_with(fixed<PBF_FEATURE_POLY6>{}, p, m, first, last);
  else if (hot_features(p) & PBF_FEATURE_SCORR)
    move_with(fixed<PBF_FEATURE_SCORR>{}, p, m, first, last);
  else
    move_with(fixed<0>{}, p, m, first, last);
}

#endif
