/* Part of kernels.cpp: the corrections of the fluid's own motion: shear stress, damping
 * compensation and angular momentum. One loop for both kernels, for they run on request. */
#ifndef PBF_CPU_KERNELS_CORRECTIONS_H
#define PBF_CPU_KERNELS_CORRECTIONS_H

#include "cpu/kernels_pairs.h"
#include "physics/passes/angular_momentum.h"
#include "physics/passes/damping_compensation.h"
#include "physics/passes/shear_stress.h"
#include "physics/passes/torque.h"

/* The sums of a group, with those of ghosts. */
PBF_FN fabric_sums<lane> fabric_of_group(const fabric_pass<int> &pass, const pair_pass *p,
                                         uint32_t g) {
  fabric_sums<lane> with_ghosts;
  if (has_ghosts(p) && sum_with_ghosts<fabric_pass>(p, pass.features, {}, g, &with_ghosts))
    return with_ghosts;
  return sums_of_group(pass, p, {}, {}, g);
}

namespace {

/* pbf_fabric in each lane. */
struct lane_fabric {
  pbf_real density[WIDTH], moments[PBF_MOMENTS][WIDTH];
  pbf_real wall[PBF_DIM][WIDTH];
};

struct lane_deviators {
  pbf_real c[PBF_DEVIATOR_DIM][WIDTH];
};

}  // namespace

PBF_FN void store_fabric(const fabric_sums<lane> &sums, lane_fabric *f) {
  lane_store(f->density, sums.density);
  for (int k = 0; k < PBF_MOMENTS; ++k) lane_store(f->moments[k], sums.moments[k]);
  for (int k = 0; k < PBF_DIM; ++k) lane_store(f->wall[k], sums.wall.c[k]);
}

PBF_FN void set_vectors(const field *f, uint32_t i, const lane_values *a) {
  for (int k = 0; k < PBF_DIM; ++k) lane_store(f->c[k] + i, lane_load(a->c[k]));
}

PBF_FN pbf_real *part_of_deviator(const shear_pass *s, int k) {
  return k < PBF_DIM ? s->deviator.c[k % PBF_DIM] : s->rest[k - PBF_DIM];
}

/* add_walls in all lanes. */
static __attribute__((noinline)) void add_walls_to_lanes(const pair_pass *p, const lane_values *x,
                                                         lane_boundary *restrict boundary,
                                                         lane_fabric *restrict f) {
  const pbf_constants c = *p->constants;
  const pbf_domain domain = p->contributing->domain;
  memset(boundary, 0, sizeof *boundary);
  boundary_of_domain(p->constants, &p->contributing->domain, x, boundary);
  for (uint32_t l = 0; l < WIDTH; ++l) f->density[l] += boundary->density[l];
  for (int k = 0; k < PBF_DIM; ++k)
    for (uint32_t l = 0; l < WIDTH; ++l) f->wall[k][l] += boundary->gradient.c[k][l];
  for (int axis = 0; axis < PBF_DIM && !(domain.ghost_reach > 0); ++axis) {
    lane_walls walls = {{0}, {0}};
    if (!add_walls_of_axis(p->constants, &domain, axis, x, &walls)) continue;
    for (uint32_t l = 0; l < WIDTH; ++l) {
      pbf_real moments[PBF_MOMENTS];
      for (int k = 0; k < PBF_MOMENTS; ++k) moments[k] = f->moments[k][l];
      add_wall_rows(&c, walls.value[l], axis, moments);
      for (int k = 0; k < PBF_MOMENTS; ++k) f->moments[k][l] = moments[k];
    }
  }
}

static __attribute__((noinline)) void finish_deviators(const pbf_constants *constants,
                                                       const lane_fabric *f, const pbf_real *lambda,
                                                       lane_deviators *restrict d) {
  const pbf_constants c = *constants;
  const fabric_pass<fixed<0>> pass = {&c, {}};
  for (uint32_t l = 0; l < WIDTH; ++l) {
    pbf_fabric one = {f->density[l], {}, {{0}}};
    for (int k = 0; k < PBF_MOMENTS; ++k) one.moments[k] = f->moments[k][l];
    const pbf_deviator found = pass.finish(one, lambda[l]);
    for (int k = 0; k < PBF_DEVIATOR_DIM; ++k) d->c[k][l] = found.c[k];
  }
}

/* Of the particles of a group that colliders contribute to, which may lie in any way. */
static __attribute__((noinline)) void clear_deviators(const pair_pass *p, const lane_values *x,
                                                      const lane_boundary *by_walls,
                                                      lane_deviators *restrict d) {
  lane_boundary by_all;
  boundary_of_group(p->constants, p->contributing, x, NULL, &by_all);
  for (int k = 0; k < PBF_DEVIATOR_DIM; ++k)
    for (uint32_t l = 0; l < WIDTH; ++l)
      d->c[k][l] = by_all.density[l] == by_walls->density[l] ? d->c[k][l] : 0;
}

static void deviator(const pair_pass *p, const shear_pass *s, uint32_t first, uint32_t last) {
  const pbf_constants c = *p->constants;
  const fabric_pass<int> pass = {&c, hot_features(p) & PBF_FEATURE_POLY6};
  for (uint32_t g = first; g < last; ++g) {
    const uint32_t i = g * WIDTH;
    const int near = contributing_obstacles(p) && group_near_obstacles(p, g);
    alignas(64) lane_fabric fabric;
    alignas(64) lane_deviators d;
    const lane_values x = values_of(load_vector(p->x, i));
    lane_boundary by_walls;
    store_fabric(fabric_of_group(pass, p, g), &fabric);
    if (near) add_walls_to_lanes(p, &x, &by_walls, &fabric);
    finish_deviators(p->constants, &fabric, s->lambda + i, &d);
    if (near && pbf_surface_count(*p->contributing)) clear_deviators(p, &x, &by_walls, &d);
    for (int k = 0; k < PBF_DEVIATOR_DIM; ++k)
      lane_store(part_of_deviator(s, k) + i, lane_load(d.c[k]));
    for (int k = 0; k < PBF_DIM; ++k) lane_store(s->push.c[k] + i, lane_load(fabric.wall[k]));
  }
}

PBF_FN lane_deviator<lane> load_deviator(const shear_pass *s, uint32_t i) {
  lane_deviator<lane> d;
  for (int k = 0; k < PBF_DEVIATOR_DIM; ++k) d.c[k] = lane_load(part_of_deviator(s, k) + i);
  return d;
}

static __attribute__((noinline)) void finish_pushes(const pbf_constants *constants,
                                                    const lane_deviators *own,
                                                    const lane_values *wall,
                                                    lane_values *restrict push) {
  const shear_push_pass<fixed<0>> pass = {constants, {}};
  for (uint32_t l = 0; l < WIDTH; ++l) {
    lane_deviator<pbf_real> d;
    shear_push_pass<fixed<0>>::sums<pbf_real> sums;
    pbf_vec by_wall;
    for (int k = 0; k < PBF_DEVIATOR_DIM; ++k) d.c[k] = own->c[k][l];
    for (int k = 0; k < PBF_DIM; ++k) sums.push.c[k] = push->c[k][l];
    for (int k = 0; k < PBF_DIM; ++k) by_wall.c[k] = wall->c[k][l];
    const pbf_vec whole = pass.finish(sums, d, by_wall);
    for (int k = 0; k < PBF_DIM; ++k) push->c[k][l] = whole.c[k];
  }
}

static void shear_push(const pair_pass *p, const shear_pass *s, uint32_t first, uint32_t last) {
  const pbf_constants c = *p->constants;
  const shear_push_pass<int> pass = {&c, hot_features(p) & PBF_FEATURE_POLY6};
  const lookups of = {s->rest[0], &s->deviator, s->rest[1]};
  for (uint32_t g = first; g < last; ++g) {
    const lane_deviator<lane> own = load_deviator(s, g * WIDTH);
    alignas(64) lane_deviators each;
    lane_values push = values_of(sums_of_group(pass, p, of, {own}, g).push);
    const lane_values wall = values_of(load_vector(s->push, g * WIDTH));
    for (int k = 0; k < PBF_DEVIATOR_DIM; ++k) lane_store(each.c[k], own.c[k]);
    finish_pushes(p->constants, &each, &wall, &push);
    set_vectors(&s->push, g * WIDTH, &push);
  }
}

namespace {

/* Of each particle, or 1 for all. */
struct mobilities {
  pbf_real one;
  const pbf_real *of;
  uint32_t stride;
  PBF_IN explicit mobilities(const pbf_real *all)
      : one(1), of(all ? all : &one), stride(all != NULL) {}
  mobilities(const mobilities &) = delete;
  PBF_IN pbf_real operator[](uint32_t i) const { return of[i * stride]; }
};

}  // namespace

/* From pushes. */
static __attribute__((noinline)) void finish_changes(const pbf_constants *constants,
                                                     const pbf_real *mobility,
                                                     const lane_values *exchanged,
                                                     lane_values *restrict change) {
  const pbf_constants c = *constants;
  const shear_stress_pass<fixed<0>> pass = {&c, {}, false};
  for (uint32_t l = 0; l < WIDTH; ++l) {
    shear_stress_pass<fixed<0>>::sums<pbf_real> sums;
    pbf_vec push;
    for (int k = 0; k < PBF_DIM; ++k) sums.exchanged.c[k] = exchanged->c[k][l];
    for (int k = 0; k < PBF_DIM; ++k) push.c[k] = change->c[k][l];
    push = pass.finish(sums, push, mobility ? mobility[l] : 1);
    for (int k = 0; k < PBF_DIM; ++k) change->c[k][l] = push.c[k];
  }
}

static void shear_stress(const pair_pass *p, const shear_pass *s, uint32_t first, uint32_t last) {
  const pbf_constants c = *p->constants;
  const shear_stress_pass<int> pass = {&c, hot_features(p) & PBF_FEATURE_POLY6,
                                       s->mobility != NULL};
  const pbf_real *mass = s->mobility ? s->mass : s->push.c[0]; /* which are not looked at */
  for (uint32_t g = first; g < last; ++g) {
    const uint32_t i = g * WIDTH;
    const lane_vector<lane> own = load_vector(s->push, i);
    const lane_values exchanged = values_of(
        sums_of_group(pass, p, {mass, &s->push}, {own, lane_load(mass + i)}, g).exchanged);
    lane_values change = values_of(own);
    finish_changes(p->constants, s->mobility ? s->mobility + i : NULL, &exchanged, &change);
    set_vectors(&s->change, i, &change);
  }
}

static void torque(const pair_pass *p, const momentum_pass *t, uint32_t first, uint32_t last) {
  const pbf_constants c = *p->constants;
  const int features = hot_features(p) & (PBF_FEATURE_POLY6 | PBF_FEATURE_SCORR);
  const torque_pass<int> pass = {&c, features};
  for (uint32_t g = first; g < last; ++g) {
    const uint32_t i = g * WIDTH;
    torque_pass<int>::sums<lane> sums;
    for (int k = 0; k < PBF_CURL_DIM; ++k) sums.torque[k] = lane_load(t->torque.c[k] + i);
    add_neighbors(pass, p, {t->lambda, &t->start},
                  {lane_load(t->lambda + i), load_vector(t->start, i)}, g, &sums);
    for (int k = 0; k < PBF_CURL_DIM; ++k) lane_store(t->torque.c[k] + i, sums.torque[k]);
  }
}

static void compensate_damping(const pair_pass *p, const damping_pass *u, uint32_t first,
                               uint32_t last) {
  typedef damping_compensation_pass<int> pass_type;
  const pbf_constants c = *p->constants;
  const int features = (hot_features(p) & PBF_FEATURE_POLY6) | (u->torque ? PBF_FEATURE_TORQUE : 0);
  const pass_type pass = {&c, features};
  const lookups of = {u->lambda, &u->flow};
  for (uint32_t g = first; g < last; ++g) {
    const int near = contributing_obstacles(p) && group_near_obstacles(p, g);
    const auto sums = sums_of_group(
        pass, p, of, {lane_load(u->lambda + g * WIDTH), load_vector(u->flow, g * WIDTH)}, g);
    for (int k = 0; k < PBF_CURL_DIM && u->torque; ++k) {
      pbf_real *torque = u->torque->c[k] + g * WIDTH;
      lane_store(torque, lane_load(torque) - sums.torque[k]);
    }
    const lane_sums<pass_type::sums> each(sums);
    for (uint32_t l = 0, i = g * WIDTH; l < lanes_in_group(&p->lists, g); ++l, ++i) {
      const auto one = each[l];
      pbf_vec change =
          near ? u->between(p, u, i, vec_of(one.end), vec_of(one.start)) : pass.change(one);
      if (u->mobility) change = pbf_scaled(change, u->mobility[i]);
      field_set(&u->velocity, i, pass.finish(u->inv_time_step, field_at(&u->velocity, i), change));
    }
  }
}

static void angular_rate(const pair_pass *p, const momentum_pass *t, uint32_t first,
                         uint32_t last) {
  const pbf_constants c = *p->constants;
  const rotation_rate_pass pass = {&c};
  for (uint32_t g = first; g < last; ++g) {
    const lane_sums<rotation_rate_pass::sums> sums(sums_of_group(pass, p, {}, {}, g));
    for (uint32_t l = 0, i = g * WIDTH; l < lanes_in_group(&p->lists, g); ++l, ++i) {
      pbf_curl torque;
      for (int k = 0; k < PBF_CURL_DIM; ++k) torque.c[k] = t->torque.c[k][i];
      field_set(&t->rate, i, pass.finish(sums[l], torque));
    }
  }
}

static void turn(const pair_pass *p, const momentum_pass *t, uint32_t first, uint32_t last) {
  const pbf_constants c = *p->constants;
  const rotation_pass pass = {&c};
  const mobilities mobility(t->mobility);
  for (uint32_t g = first; g < last; ++g) {
    const lane_sums<rotation_pass::sums> sums(
        sums_of_group(pass, p, {NULL, &t->rate}, {load_vector(t->rate, g * WIDTH)}, g));
    for (uint32_t l = 0, i = g * WIDTH; l < lanes_in_group(&p->lists, g); ++l, ++i)
      field_set(&t->velocity, i, pass.finish(sums[l], field_at(&t->velocity, i), mobility[i]));
  }
}

#endif
