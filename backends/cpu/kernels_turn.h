/* The corrections of the fluid's own motion: damping compensation and angular momentum. One loop
 * for both kernels, for they run on request. */
#ifndef PBF_CPU_KERNELS_TURN_H
#define PBF_CPU_KERNELS_TURN_H

#include "cpu/kernels_pairs.h"
#include "physics/passes/damping_compensation.h"
#include "physics/passes/torque.h"
#include "physics/turn.h"

static void torque(const pair_pass *p, const turn_pass *t, uint32_t first, uint32_t last) {
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

static void undamp(const pair_pass *p, const undamp_pass *u, uint32_t first, uint32_t last) {
  typedef damping_compensation_pass<int> pass_type;
  const pbf_constants c = *p->constants;
  const int features = (hot_features(p) & PBF_FEATURE_POLY6) | (u->torque ? PBF_FEATURE_TORQUE : 0);
  const pass_type pass = {&c, features};
  const lookups of = {u->lambda, &u->flow};
  for (uint32_t g = first; g < last; ++g) {
    const int near = lending_walls(p) && group_near_obstacles(p, g);
    const auto sums = sums_of_group(
        pass, p, of, {lane_load(u->lambda + g * WIDTH), load_vector(u->flow, g * WIDTH)}, g);
    for (int k = 0; k < PBF_CURL_DIM && u->torque; ++k) {
      pbf_real *torque = u->torque->c[k] + g * WIDTH;
      lane_store(torque, lane_load(torque) - sums.torque[k]);
    }
    const lane_sums<pass_type::sums> each(sums);
    for (uint32_t l = 0, i = g * WIDTH; l < lanes_in_group(&p->lists, g); ++l, ++i) {
      const auto one = each[l];
      const pbf_vec change =
          near ? u->between(p, u, i, vec_of(one.end), vec_of(one.start)) : pass.change(one);
      field_set(&u->velocity, i, pass.finish(u->inv_time_step, field_at(&u->velocity, i), change));
    }
  }
}

static void turn_rate(const pair_pass *p, const turn_pass *t, uint32_t first, uint32_t last) {
  const pbf_constants c = *p->constants;
  uint8_t space[MOST_ROUNDS * WIDTH];
  for (uint32_t g = first; g < last; ++g) {
    const lane_vec x = lane_vec_load(&p->x, g * WIDTH);
    _Alignas(64) pbf_real moments[PBF_MOMENTS][WIDTH];
    lane sums[PBF_MOMENTS];
    memset(sums, 0, sizeof sums);
    for (walk w = walk_group(&p->lists, g); w.left;) {
      const block *b = walk_block(&w);
      const neighbor_table around = neighbors_in(b, p, NULL);
      const uint8_t *list = walk_on(&w, space), *end = list + b->rounds * WIDTH;
      for (; list < end; list += WIDTH) {
        const pair_lanes pair = pairs_listed(b, list, &x, &around);
        lanes_add_moments(&c, sums, pair.x_ij.c, pair.r2);
      }
    }
    for (int k = 0; k < PBF_MOMENTS; ++k) lane_store(moments[k], sums[k]);
    for (uint32_t l = 0, i = g * WIDTH; l < lanes_in_group(&p->lists, g); ++l, ++i) {
      pbf_real of[PBF_MOMENTS];
      pbf_curl lacks, rate;
      for (int k = 0; k < PBF_MOMENTS; ++k) of[k] = moments[k][l];
      for (int k = 0; k < PBF_CURL_DIM; ++k) lacks.c[k] = c.torque_part * t->torque.c[k][i];
      rate = pbf_turn_rate(of, lacks);
      for (int k = 0; k < PBF_DIM; ++k) t->rate.c[k][i] = k < PBF_CURL_DIM ? rate.c[k] : 0;
    }
  }
}

static void turn(const pair_pass *p, const turn_pass *t, uint32_t first, uint32_t last) {
  const pbf_constants c = *p->constants;
  uint8_t space[MOST_ROUNDS * WIDTH];
  for (uint32_t g = first; g < last; ++g) {
    const lane_vec x = lane_vec_load(&p->x, g * WIDTH), rate = lane_vec_load(&t->rate, g * WIDTH);
    lane_vec sum = lane_vec_zero();
    for (walk w = walk_group(&p->lists, g); w.left;) {
      const block *b = walk_block(&w);
      const neighbor_table around = neighbors_in(b, p, NULL);
      const vector_table rates = vectors_in(b, p, &t->rate, NULL);
      const uint8_t *list = walk_on(&w, space), *end = list + b->rounds * WIDTH;
      for (; list < end; list += WIDTH) {
        const pair_lanes pair = pairs_listed(b, list, &x, &around);
        lane_vec both = vectors_at(&rates, pair.j, 0).v;
        for (int k = 0; k < PBF_DIM; ++k) both.c[k] = both.c[k] + rate.c[k];
        lanes_add_turn(&c, sum.c, both.c, pair.x_ij.c, pair.r2);
      }
    }
    const lane_values sums = lane_vec_values(&sum);
    for (uint32_t l = 0, i = g * WIDTH; l < lanes_in_group(&p->lists, g); ++l, ++i)
      field_set(&t->velocity, i,
                pbf_add_scaled(field_at(&t->velocity, i), 1, lane_value(&sums, l)));
  }
}

#endif
