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

static void set_deviator(const shear_pass *s, uint32_t i, pbf_deviator d) {
  for (int k = 0; k < PBF_DEVIATOR_DIM; ++k)
    (k < PBF_DIM ? s->deviator.c[k % PBF_DIM] : s->rest[k - PBF_DIM])[i] = d.c[k];
}

static void deviator(const pair_pass *p, const shear_pass *s, uint32_t first, uint32_t last) {
  const pbf_constants c = *p->constants;
  const fabric_pass<int> pass = {&c, hot_features(p) & PBF_FEATURE_POLY6};
  for (uint32_t g = first; g < last; ++g) {
    const int near = contributing_obstacles(p) && group_near_obstacles(p, g);
    const lane_sums<fabric_sums> sums(fabric_of_group(pass, p, g));
    for (uint32_t l = 0, i = g * WIDTH; l < lanes_in_group(&p->lists, g); ++l, ++i) {
      pbf_fabric one = fabric_of(sums[l]);
      const pbf_deviator none = {{0}};
      set_deviator(s, i, !near || s->add_walls(p, i, &one) ? pass.finish(one, s->lambda[i]) : none);
      field_set(&s->push, i, one.wall);
    }
  }
}

PBF_FN lane_deviator<lane> load_deviator(const shear_pass *s, uint32_t i) {
  lane_deviator<lane> d;
  for (int k = 0; k < PBF_DEVIATOR_DIM; ++k)
    d.c[k] = lane_load((k < PBF_DIM ? s->deviator.c[k % PBF_DIM] : s->rest[k - PBF_DIM]) + i);
  return d;
}

static void shear_push(const pair_pass *p, const shear_pass *s, uint32_t first, uint32_t last) {
  const pbf_constants c = *p->constants;
  const shear_push_pass<int> pass = {&c, hot_features(p) & PBF_FEATURE_POLY6};
  const lookups of = {s->rest[0], &s->deviator, s->rest[1]};
  for (uint32_t g = first; g < last; ++g) {
    const lane_deviator<lane> own = load_deviator(s, g * WIDTH);
    const lane_sums<shear_push_pass<int>::sums> sums(sums_of_group(pass, p, of, {own}, g));
    const lane_sums<lane_deviator> each(own);
    for (uint32_t l = 0, i = g * WIDTH; l < lanes_in_group(&p->lists, g); ++l, ++i)
      field_set(&s->push, i, pass.finish(sums[l], each[l], field_at(&s->push, i)));
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

static void shear_stress(const pair_pass *p, const shear_pass *s, uint32_t first, uint32_t last) {
  const pbf_constants c = *p->constants;
  const shear_stress_pass<int> pass = {&c, hot_features(p) & PBF_FEATURE_POLY6,
                                       s->mobility != NULL};
  const pbf_real *mass = s->mobility ? s->mass : s->push.c[0]; /* which are not looked at */
  const mobilities mobility(s->mobility);
  for (uint32_t g = first; g < last; ++g) {
    const lane_sums<shear_stress_pass<int>::sums> sums(
        sums_of_group(pass, p, {mass, &s->push},
                      {load_vector(s->push, g * WIDTH), lane_load(mass + g * WIDTH)}, g));
    for (uint32_t l = 0, i = g * WIDTH; l < lanes_in_group(&p->lists, g); ++l, ++i)
      field_set(&s->change, i, pass.finish(sums[l], field_at(&s->push, i), mobility[i]));
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
