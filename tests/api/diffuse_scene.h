/* Scenes with spray, foam and bubbles, and what is read of them. */
#ifndef PBF_TESTS_DIFFUSE_SCENE_H
#define PBF_TESTS_DIFFUSE_SCENE_H

#include <pbf/diffuse.h>
#include <pbf/query.h>

#include <float.h>
#include <stdio.h>

#include "support.h"

static const double d = 0.05; /* the spacing */
static const double dt = 1.0 / 128;

enum { CAPACITY = 4000, MANY = 100000 };

/* ---- Scenes ---------------------------------------------------------------------------------- */

static inline pbf_params params_of(double gravity, double upper) {
  pbf_params params = test_params();
  for (int k = 0; k < 3; ++k) {
    params.gravity[k] = 0;
    params.domain_min[k] = 0;
    params.domain_max[k] = upper;
  }
  params.gravity[1] = -gravity;
  params.time_step = dt;
  params.vorticity = params.viscosity = 0;
  return params;
}

static inline pbf_solver *box_of(uint32_t dimension, uint32_t precision, double gravity,
                                 double upper) {
  const pbf_desc desc = test_desc(dimension, precision, CAPACITY);
  const pbf_params params = params_of(gravity, upper);
  return test_create(&desc, &params);
}

typedef double (*field)(const double x[3], int component);

/* A lattice around a place, so many particles wide, with a velocity field. Returns how many. */
static inline uint32_t add_block(pbf_solver *s, uint32_t dimension, uint32_t precision,
                                 const double middle[3], const int wide[3], field velocity) {
  static double x[3 * CAPACITY], v[3 * CAPACITY];
  uint32_t count = 0;
  for (int i = 0; i < wide[0]; ++i)
    for (int j = 0; j < wide[1]; ++j)
      for (int k = 0; k < (dimension == 3 ? wide[2] : 1); ++k, ++count) {
        const int at[3] = {i, j, k};
        double place[3];
        for (int c = 0; c < 3; ++c) place[c] = middle[c] + (at[c] - 0.5 * (wide[c] - 1)) * d;
        for (uint32_t c = 0; c < dimension; ++c) {
          test_put(x, (uint64_t)count * dimension + c, precision, place[c]);
          test_put(v, (uint64_t)count * dimension + c, precision,
                   velocity ? velocity(place, (int)c) : 0);
        }
      }
  assert_ok(pbf_add_particles(s, count, x, v, NULL));
  return count;
}

static inline pbf_diffuse_desc desc_of(pbf_solver *s) {
  pbf_diffuse_desc desc;
  assert_ok(pbf_diffuse_init(s, &desc, sizeof desc));
  desc.capacity = 20000;
  return desc;
}

/* All of one kind, and none made. */
static inline pbf_diffuse_desc desc_of_kind(pbf_solver *s, uint32_t kind) {
  pbf_diffuse_desc desc = desc_of(s);
  desc.trapped_air_rate = desc.wave_crest_rate = 0;
  desc.foam_neighbors = kind == PBF_DIFFUSE_SPRAY ? MANY : 0;
  desc.bubble_neighbors = kind == PBF_DIFFUSE_BUBBLE ? 0 : MANY;
  return desc;
}

static inline void add_one(pbf_solver *s, uint32_t dimension, uint32_t precision, const double x[3],
                           const double v[3], double life) {
  double raw[7];
  double velocity[3], lives[1];
  for (uint32_t k = 0; k < dimension; ++k) {
    test_put(raw, k, precision, x[k]);
    test_put(velocity, k, precision, v[k]);
  }
  test_put(lives, 0, precision, life);
  assert_ok(pbf_add_diffuse(s, 1, raw, velocity, lives));
}

static inline pbf_diffuse_info info_of(pbf_solver *s) {
  pbf_diffuse_info info = {.struct_size = sizeof info};
  assert_ok(pbf_get_diffuse_info(s, &info));
  return info;
}

/* As float64 with three numbers, whatever the solver has. */
typedef struct one {
  double x[3], v[3], age, life;
  uint32_t kind, reserved;
  uint64_t id;
} one;

static inline uint32_t read_all(pbf_solver *s, one *to, uint32_t room) {
  const uint32_t count = info_of(s).count;
  assert_true(count <= room);
  memset(to, 0, room * sizeof *to);
  const pbf_diffuse_read read = {.struct_size = sizeof read,
                                 .count = count,
                                 .element_type = PBF_TYPE_FLOAT64,
                                 .components = 3,
                                 .stride = sizeof *to,
                                 .positions = to->x,
                                 .velocities = to->v,
                                 .ages = &to->age,
                                 .lives = &to->life,
                                 .kinds = &to->kind,
                                 .ids = &to->id};
  assert_ok(pbf_read_diffuse(s, &read));
  return count;
}

static inline one read_one(pbf_solver *s) {
  one only;
  assert_int_equal(read_all(s, &only, 1), 1);
  return only;
}

static inline void assert_near(double found, double right, double most, const char *what) {
  if (!(fabs(found - right) <= most))
    fail_msg("%s is %.12g, not %.12g: off by %.3g", what, found, right, found - right);
}

static inline double rounding_of(uint32_t precision) {
  return precision == PBF_FLOAT32 ? FLT_EPSILON : DBL_EPSILON;
}

/* Where one begins, and with which velocity. */
static const double start[3] = {1.3, 1.7, 1.1}, throw[3] = {0.5, 2.5, -0.25};

/* Velocity fields. */
static inline double still(const double x[3], int component) { return 0 * x[component]; }
static inline double shifting(const double x[3], int component) {
  return 0 * x[component] + (component == 0 ? 1.25 : component == 1 ? -0.5 : 0.25);
}

#endif
