/* Points, colliders and surfaces for tests of what solids do. */
#ifndef PBF_TESTS_PHYSICS_SOLIDS_H
#define PBF_TESTS_PHYSICS_SOLIDS_H

#include "support.h"

static inline pbf_vec point(double x, double y, double z) {
  double full[3] = {x, y, z};
  pbf_vec p;
  for (int k = 0; k < PBF_DIM; ++k) p.c[k] = full[k];
  return p;
}

static inline void assert_at(pbf_vec p, double x, double y, double z) {
  double full[3] = {x, y, z};
  for (int k = 0; k < PBF_DIM; ++k) assert_near(p.c[k], full[k], 1e-12);
}

static inline pbf_collider collider(uint32_t shape) {
  pbf_collider c;
  memset(&c, 0, sizeof c);
  c.struct_size = sizeof c;
  c.shape = shape;
  c.orientation[3] = 1;
  c.axis[1] = 1;
  c.half_extents[0] = 1;
  c.half_extents[1] = 2;
  c.half_extents[2] = 3;
  c.radius = 0.5;
  c.half_length = 1;
  return c;
}

/* A surface that pushes out at once. */
static inline pbf_surface surface_at(const pbf_collider *c, double elapsed, double time_step) {
  pbf_surface s = pbf_surface_at(c, elapsed, time_step);
  s.prediction_push = s.iteration_push = INFINITY;
  return s;
}

static inline pbf_domain wide_domain(void) {
  pbf_domain domain = {.lower = point(-1000, -1000, -1000), .upper = point(1000, 1000, 1000)};
  return domain;
}
#endif
