/* A tank with an emitter in it. */
#ifndef PBF_TESTS_EMITTER_SCENE_H
#define PBF_TESTS_EMITTER_SCENE_H

#include <pbf/emit.h>

#include "support.h"

static const double d = 0.05; /* the spacing */

enum { CAPACITY = 4000 };

/* A box of 1, 2 high, without gravity unless it is given. */
static inline pbf_solver *tank(uint32_t dimension, uint32_t precision, double gravity) {
  const pbf_desc desc = test_desc(dimension, precision, CAPACITY);
  pbf_params params = test_params();
  params.gravity[1] = -gravity;
  params.domain_max[1] = 2;
  params.time_step = 1.0 / 128;
  return test_create(&desc, &params);
}

static inline pbf_emitter emitter_of(uint32_t shape) {
  pbf_emitter e;
  assert_ok(pbf_emitter_init(&e, sizeof e, shape));
  e.position[0] = e.position[2] = 0.5;
  e.position[1] = 1.5;
  e.half_width = 0.1;
  e.half_height = 0.125;
  e.radius = 0.15;
  return e;
}

static inline uint32_t count_of(pbf_solver *s) {
  uint32_t count;
  assert_ok(pbf_get_count(s, &count));
  return count;
}

#endif
