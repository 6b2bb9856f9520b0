/* Scenes in which the fluid's load on solids is known. */
#ifndef PBF_TESTS_LOAD_SCENE_H
#define PBF_TESTS_LOAD_SCENE_H

#include "support.h"

#include <pbf/shapes.h>

#include <math.h>

static const double load_spacing = 0.05, load_gravity = 9.81;

typedef struct load_scene {
  uint32_t dimension, precision, count;
  pbf_params params;
  pbf_solver *solver;
  double mass; /* of a particle, over rest density */
  char *values;
} load_scene;

/* Whether a particle may begin there. */
typedef int (*load_filter)(const double x[3]);

static inline int load_everywhere(const double x[3]) {
  (void)x;
  return 1;
}

/* The next place of a lattice in the box from 0 to `size`; 0 behind the last one. */
static inline int load_next_place(const double size[3], uint32_t dimension, uint32_t *at,
                                  double x[3]) {
  uint32_t left = (*at)++;
  for (uint32_t k = 0; k < 3; ++k) {
    const uint32_t n = k < dimension ? (uint32_t)lround(size[k] / load_spacing) : 1;
    x[k] = k < dimension ? load_spacing * (left % n + 0.5) : 0;
    left /= n;
  }
  return left == 0;
}

static inline uint32_t load_count(const double size[3], uint32_t dimension, load_filter there) {
  uint32_t count = 0, at = 0;
  for (double x[3]; load_next_place(size, dimension, &at, x);) count += there(x) != 0;
  return count;
}

static inline pbf_params load_params(uint32_t dimension, const double domain[3]) {
  pbf_params params = test_params();
  (void)dimension;
  params.spacing = load_spacing;
  params.smoothing_radius = 2 * load_spacing;
  params.pressure_grid = 0;
  params.shear_stress_correction = 0;
  params.loads = 1;
  for (int k = 0; k < 3; ++k) params.domain_max[k] = domain[k];
  return params;
}

/* Water at rest from 0 to `size`, wherever `there` is. */
static inline load_scene load_scene_of(uint32_t dimension, uint32_t precision,
                                       const pbf_params *params, const double size[3],
                                       load_filter there, uint32_t colliders,
                                       const pbf_collider *list) {
  load_scene s = {dimension, precision, load_count(size, dimension, there), *params, NULL, 0, NULL};
  pbf_desc desc = test_desc(dimension, precision, s.count ? s.count : 1);
  uint32_t at = 0, i = 0;
  s.mass = pow(load_spacing, dimension);
  s.solver = test_create(&desc, params);
  s.values = calloc((size_t)s.count * dimension + 1, precision);
  for (double x[3]; load_next_place(size, dimension, &at, x);)
    if (there(x)) {
      for (uint32_t k = 0; k < dimension; ++k)
        test_put(s.values, (uint64_t)i * dimension + k, precision, x[k]);
      ++i;
    }
  assert_ok(pbf_set_colliders(s.solver, colliders, list));
  if (s.count) assert_ok(pbf_add_particles(s.solver, s.count, s.values, NULL, NULL));
  return s;
}

static inline void load_end(load_scene *s) {
  pbf_destroy(s->solver);
  free(s->values);
}

static inline void load_momentum(load_scene *s, double momentum[3]) {
  assert_ok(pbf_get_velocities(s->solver, 0, s->count, s->values));
  for (uint32_t k = 0; k < 3; ++k) momentum[k] = 0;
  for (uint32_t i = 0; i < s->count; ++i)
    for (uint32_t k = 0; k < s->dimension; ++k)
      momentum[k] += s->mass * test_value(s->values, (uint64_t)i * s->dimension + k, s->precision);
}

static inline void load_walls(load_scene *s, pbf_collider_load loads[6]) {
  for (int k = 0; k < 6; ++k) loads[k].struct_size = sizeof loads[k];
  assert_ok(pbf_get_wall_loads(s->solver, 2 * s->dimension, loads));
}

static inline void load_colliders(load_scene *s, uint32_t count, pbf_collider_load *loads) {
  for (uint32_t k = 0; k < count; ++k) loads[k].struct_size = sizeof loads[k];
  assert_ok(pbf_get_collider_loads(s->solver, count, loads));
}

static inline pbf_collider load_collider(uint32_t shape, double x, double y, double z) {
  pbf_collider c;
  assert_ok(pbf_collider_init(&c, sizeof c, shape));
  c.position[0] = x;
  c.position[1] = y;
  c.position[2] = z;
  return c;
}

/* Makes a box the hull of its corners; the geometry is the caller's to release. */
static inline void load_make_hull(uint32_t dimension, double cell, pbf_collider *box) {
  double corners[8 * 3];
  const uint32_t count = dimension == 3 ? 8 : 4;
  for (uint32_t i = 0; i < count; ++i)
    for (uint32_t k = 0; k < dimension; ++k)
      corners[i * dimension + k] = i >> k & 1 ? box->half_extents[k] : -box->half_extents[k];
  const pbf_hull_desc hull = {.struct_size = sizeof hull,
                              .dimension = dimension,
                              .point_count = count,
                              .points = corners,
                              .cell = cell};
  assert_ok(pbf_shape_from_points(&hull, &box->geometry));
  box->shape = PBF_COLLIDER_SHAPE;
}

/* The mean force and torque since they were last asked for. */
static inline double load_force(const pbf_collider_load *load, int k) {
  return load->impulse_sum[k] / load->time_sum;
}

static inline double load_torque(const pbf_collider_load *load, int k) {
  return load->angular_impulse_sum[k] / load->time_sum;
}

static inline void load_expect(const char *what, double is, double right, double part) {
  if (!(fabs(is - right) <= part * fabs(right)))
    fail_msg("%s is %.9g, it must be %.9g to %g", what, is, right, part);
}

#endif
