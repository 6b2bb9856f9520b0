/* Part of kernels.cpp: passes over pairs but those of kernels_solve.h. */
#ifndef PBF_CPU_KERNELS_PAIRS_H
#define PBF_CPU_KERNELS_PAIRS_H

#include "cpu/kernels_solve.h"
#include "physics/passes/confinement.h"
#include "physics/passes/curl.h"
#include "physics/passes/surface_tension.h"
#include "physics/passes/density.h"
#include "physics/passes/overlap.h"
#include "physics/passes/pressure_fit.h"
#include "physics/passes/viscosity.h"
#include "physics/passes/viscous_stress.h"

/* ---- Velocity ------------------------------------------------------------------------------ */

static void curl(const pair_pass *p, field v, pbf_real *const curl[PBF_CURL_DIM], pbf_real *size,
                 uint32_t first, uint32_t last) {
  const pbf_constants c = *p->constants;
  const curl_pass<int> pass = {&c, hot_features(p) & PBF_FEATURE_POLY6};
  for (uint32_t g = first; g < last; ++g) {
    const auto sums = sums_of_group(pass, p, {NULL, &v}, {load_vector(v, g * WIDTH)}, g);
    const lane_sums<curl_pass<int>::sums> each(sums);
    for (int k = 0; k < PBF_CURL_DIM; ++k) lane_store(curl[k] + g * WIDTH, sums.curl[k]);
    for (uint32_t l = 0; l < WIDTH; ++l) size[g * WIDTH + l] = pbf_curl_size(pass.finish(each[l]));
  }
}

static void confine(const pair_pass *p, pbf_real *const curl[PBF_CURL_DIM], const pbf_real *size,
                    field v, uint32_t first, uint32_t last) {
  const pbf_constants c = *p->constants;
  const confinement_pass<int> pass = {&c, hot_features(p) & PBF_FEATURE_POLY6};
  for (uint32_t g = first; g < last; ++g) {
    const lane_sums<confinement_pass<int>::sums> sums(sums_of_group(pass, p, {size, NULL}, {}, g));
    for (uint32_t l = 0, i = g * WIDTH; l < lanes_in_group(&p->lists, g); ++l, ++i) {
      pbf_curl curl_i;
      for (int k = 0; k < PBF_CURL_DIM; ++k) curl_i.c[k] = curl[k][i];
      field_set(&v, i, pass.finish(sums[l], curl_i, field_at(&v, i)));
    }
  }
}

static void missing_neighbors(const pair_pass *p, const tension_pass *t, uint32_t first,
                              uint32_t last) {
  const pbf_constants c = *p->constants;
  const missing_neighbors_pass pass = {&c};
  for (uint32_t g = first; g < last; ++g) {
    const int near = p->contributing && group_near_obstacles(p, g);
    const lane_sums<missing_neighbors_pass::sums> sums(sums_of_group(pass, p, {}, {}, g));
    for (uint32_t l = 0, i = g * WIDTH; l < lanes_in_group(&p->lists, g); ++l, ++i) {
      t->missing[i] = pass.finish(sums[l], 0);
      if (near && t->missing[i] > 0) t->missing[i] = pass.finish(sums[l], t->solids(p, i));
    }
  }
}

static void surface_tension(const pair_pass *p, const tension_pass *t, uint32_t first,
                            uint32_t last) {
  const pbf_constants c = *p->constants;
  const surface_tension_pass pass = {&c};
  for (uint32_t g = first; g < last; ++g) {
    const uint32_t begin = g * WIDTH;
    const lane_sums<surface_tension_pass::sums> sums(
        sums_of_group(pass, p, {t->missing, NULL}, {lane_load(t->missing + begin)}, g));
    for (uint32_t l = 0, i = begin; l < lanes_in_group(&p->lists, g); ++l, ++i)
      field_set(&t->velocity, i, pass.finish(sums[l], field_at(&t->velocity, i)));
  }
}

/* One loop for both kernels: this one waits for memory. */
static void viscosity(const pair_pass *p, field v, field smoothed, uint32_t first, uint32_t last) {
  const pbf_constants c = *p->constants;
  const viscosity_pass<int> pass = {&c, hot_features(p) & PBF_FEATURE_POLY6};
  for (uint32_t g = first; g < last; ++g) {
    const lane_sums<viscosity_pass<int>::sums> sums(
        sums_of_group(pass, p, {NULL, &v}, {load_vector(v, g * WIDTH)}, g));
    for (uint32_t l = 0, i = g * WIDTH; l < lanes_in_group(&p->lists, g); ++l, ++i)
      field_set(&smoothed, i, pass.finish(sums[l], c.viscosity, field_at(&v, i)));
  }
}

static void crowding(const pair_pass *p, pbf_real *left_out, uint32_t first, uint32_t last) {
  const pbf_constants c = *p->constants;
  const crowding_pass pass = {&c};
  for (uint32_t g = first; g < last; ++g) {
    const lane_sums<crowding_pass::sums> sums(sums_of_group(pass, p, {}, {}, g));
    for (uint32_t l = 0, i = g * WIDTH; l < lanes_in_group(&p->lists, g); ++l, ++i)
      left_out[i] = pass.finish(sums[l]);
  }
}

static __attribute__((noinline)) int add_no_slip_at(const pair_pass *p, const viscous_pass *s,
                                                    uint32_t i, pbf_vec v,
                                                    pbf_viscous_system *system) {
  const pbf_vec x = field_at(&p->x, i);
  return add_no_slip(p->constants, pbf_obstacles_near(*s->obstacles, x, p->constants->h),
                     *s->no_slip, s->weights.first != 0, x, v, system,
                     s->phase ? p->constants->phases.viscosity[s->phase[i]] : 1);
}

/* Whether some of a group may stick to solids; of colliders nothing is known. */
static __attribute__((noinline)) int group_may_stick(const pair_pass *p, const viscous_pass *s,
                                                     uint32_t g) {
  if (!s->obstacles || pbf_surface_count(*s->obstacles)) return s->obstacles != NULL;
  const lane_values xs = values_of(load_vector(p->x, g * WIDTH));
  _Alignas(64) pbf_real distances[WIDTH];
  return domain_distances(s->obstacles, &xs, distances) < p->constants->h;
}

static void viscous_stress(const pair_pass *p, const viscous_pass *s, uint32_t first,
                           uint32_t last) {
  const pbf_constants c = *p->constants;
  const viscous_stress_pass pass = {&c};
  const bool begins = s->weights.first != 0;
  const field of = begins ? s->v : s->change;
  for (uint32_t g = first; g < last; ++g) {
    const lane_sums<viscous_stress_pass::sums> sums(
        sums_of_group(pass, p, {s->crowding, &of},
                      {lane_load(s->crowding + g * WIDTH), load_vector(of, g * WIDTH)}, g));
    const int may_stick = group_may_stick(p, s, g);
    for (uint32_t l = 0, i = g * WIDTH; l < lanes_in_group(&p->lists, g); ++l, ++i) {
      const pbf_vec none = {{0}}, change = begins ? none : field_at(&s->change, i);
      pbf_viscous_system system =
          pass.system(sums[l], begins ? none : pbf_sub(field_at(&s->force, i), change),
                      s->phase ? pbf_viscous_scale(&c.phases, s->phase[i]) : 1);
      const int with_solids = may_stick && add_no_slip_at(p, s, i, field_at(&of, i), &system);
      if (begins) field_set(&s->force, i, system.residual);
      if (begins) field_set(&s->change, i, none);
      const pbf_vec before = begins ? none : field_at(&s->next, i);
      field_set(&s->next, i, pass.finish(system, with_solids, s->weights, change, before));
    }
  }
}

/* ---- Sleep --------------------------------------------------------------------------------- */

/* The windows of a block in which a particle can be awakened, a bit each. */
PBF_FN uint32_t windows_with_sleepers(const block *b, const uint8_t *has_sleepers) {
  uint32_t windows = 0;
  for (uint32_t part = 0; part < PARTS; ++part) {
    uint32_t first = b->first[part], last = first + SLOTS - 2;
    windows |=
        (uint32_t)(has_sleepers[first / ACTIVITY_CHUNK] | has_sleepers[last / ACTIVITY_CHUNK])
        << part;
  }
  return windows;
}

/* The neighbours of particle i, whose list begins at `list`, in these windows of a block are
 * awakened. */
static void wake_around(const pair_pass *p, uint32_t *awakened, uint32_t i, const block *b,
                        const uint8_t *list, uint32_t windows) {
  const pbf_vec x = field_at(&p->x, i);
  for (uint32_t round = 0; round < b->rounds; ++round) {
    uint32_t slot = list[round * WIDTH], part = slot / SLOTS;
    if (slot % SLOTS == 0 || !(windows >> part & 1)) continue;
    uint32_t j = b->first[part] + slot % SLOTS - 1;
    pbf_vec x_ij = pbf_add_scaled(pbf_sub(x, field_at(&p->x, j)), 1, p->images[b->image]);
    /* Others may say the same at the same time. */
    if (pbf_dot(x_ij, x_ij) < p->constants->h2)
      __atomic_store_n(&awakened[j], AWAKENED, __ATOMIC_RELAXED);
  }
}

static void wake_neighbors(const pair_pass *p, const pbf_real *is_source,
                           const uint8_t *has_sleepers, uint32_t *awakened, uint32_t first,
                           uint32_t last) {
  uint8_t space[MAX_ROUNDS * WIDTH];
  for (uint32_t g = first; g < last; ++g)
    for (block_cursor w = group_blocks(&p->lists, g); w.left;) {
      const block *b = current_block(&w);
      uint32_t windows = windows_with_sleepers(b, has_sleepers);
      if (!windows) {
        skip_block(&w);
        continue;
      }
      const uint8_t *list = next_list(&w, space);
      for (uint32_t l = 0; l < lanes_in_group(&p->lists, g); ++l)
        if (is_source[g * WIDTH + l] > 0)
          wake_around(p, awakened, g * WIDTH + l, b, list + l, windows);
    }
}

/* ---- On request, or seldom
 * ---------------------------------------------------------------------------- */

/* Where walls have ghosts all groups sum up alike: which of a particle's neighbours in the order
 * have ghosts must not show in how its own sum is rounded. */
static lane density_by_walls(const pair_pass *p, int features, uint32_t g) {
  const pbf_constants c = *p->constants;
  lambda_sums<lane> sums;
  if (!sum_with_ghosts<lambda_pass>(p, features, {}, g, &sums))
    sums = sums_of_group<FOR_SIZE>(lambda_pass<int, SCALED_SUMS>{&c, features}, p, {}, {}, g);
  return sums.density;
}

/* How many neighbours each particle of a group has. */
static u32_lanes count_neighbors(const pair_pass *p, uint32_t g) {
  uint8_t space[MAX_ROUNDS * WIDTH];
  u32_lanes count = u32_set(0);
  for (block_cursor w = group_blocks(&p->lists, g); w.left;) {
    const uint32_t rounds = current_block(&w)->rounds;
    const uint8_t *list = next_list(&w, space), *end = list + rounds * WIDTH;
    for (; list < end; list += WIDTH)
      count = count + (u32_set(1) & ~u32_below(u32_of_bytes(list), 1));
  }
  return count;
}

static void density(const pair_pass *p, pbf_real *densities, uint32_t *neighbors, uint32_t first,
                    uint32_t last) {
  const pbf_constants c = *p->constants;
  const density_pass<int> pass = {&c, hot_features(p) & PBF_FEATURE_POLY6};
  for (uint32_t g = first; g < last; ++g) {
    lane_store(densities + g * WIDTH, has_ghosts(p) ? density_by_walls(p, pass.features, g)
                                                    : sums_of_group(pass, p, {}, {}, g).density);
    if (neighbors) u32_store(neighbors + g * WIDTH, count_neighbors(p, g));
    if (contributing_obstacles(p) && group_near_obstacles(p, g)) {
      const lane_boundary boundary = group_boundary(p, g, NULL);
      for (uint32_t l = 0; l < WIDTH; ++l) densities[g * WIDTH + l] += boundary.density[l];
    }
  }
}

static void placed_density(const pair_pass *p, const pbf_real *numbers, pbf_real *placed,
                           pbf_real *stream, uint32_t first, uint32_t last) {
  const placed_density_pass<int> pass = {p->constants, hot_features(p) & PBF_FEATURE_POLY6};
  for (uint32_t g = first; g < last; ++g) {
    const auto sums = sums_of_group<FOR_SIZE>(pass, p, {numbers, NULL}, {}, g);
    lane_store(placed + g * WIDTH, sums.density);
    lane_store(stream + g * WIDTH, sums.stream);
  }
}

/* What lies in the windows beside neighbours counts as well. */
static int any_number_around(const pair_pass *p, const pbf_real *numbers, uint32_t g) {
  const lane zero = ops<lane>::set(0);
  for (block_cursor w = group_blocks(&p->lists, g); w.left; skip_block(&w)) {
    const block *b = current_block(&w);
    for (uint32_t part = 0; part < b->parts; ++part)
      for (uint32_t slot = 0; slot < SLOTS; slot += WIDTH) {
        const lane number = lane_load(numbers + b->first[part] + slot);
        if (lane_any_below(zero, ops<lane>::max(number, zero - number))) return 1;
      }
  }
  return 0;
}

static void fit(const pair_pass *p, const pbf_real *numbers, pbf_real *fitted, uint32_t first,
                uint32_t last) {
  const pbf_constants c = *p->constants;
  const pressure_fit_pass pass = {&c};
  for (uint32_t g = first; g < last; ++g) {
    const pbf_real *own = numbers + g * WIDTH;
    pbf_real *lines = fitted + g * WIDTH;
    const auto sums = sums_of_group<FOR_SIZE>(pass, p, {numbers, NULL}, {}, g);
    lane_store(lines, pass.line(sums, lane_load(own)));
    for (uint32_t l = 0; l < WIDTH; ++l) lines[l] = pass.finish(lines[l], own[l]);
  }
}

#endif
