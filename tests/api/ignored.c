/* What a call does not look at may be anything: third numbers in 2D, sizes that a shape has not,
 * how a target would move on. It changes no bit, no hash, and no tap that is set anew. */
#include <float.h>

#include <pbf/emit.h>

#include "support.h"

static const double anything[] = {NAN, INFINITY, -1, DBL_MAX};
enum { KINDS = sizeof anything / sizeof anything[0] };

/* Of a scene in which all of them are there. */
typedef struct scene {
  pbf_collider colliders[3];
  pbf_emitter emitters[2];
  pbf_volume drains[2];
  pbf_reservoir reservoir;
} scene;

static scene scene_of(void) {
  scene s;
  for (uint32_t i = 0; i < 3; ++i) {
    pbf_collider *c = &s.colliders[i];
    assert_ok(pbf_collider_init(c, sizeof *c, PBF_COLLIDER_SPHERE + i));
    c->radius = c->half_length = c->half_extents[0] = c->half_extents[1] = 0.06;
    c->position[0] = 0.8;
    c->position[1] = 0.15 + 0.3 * i;
  }
  for (uint32_t i = 0; i < 2; ++i) {
    assert_ok(pbf_emitter_init(&s.emitters[i], sizeof *s.emitters, i));
    assert_ok(pbf_volume_init(&s.drains[i], sizeof *s.drains, i));
    s.emitters[i].position[0] = 0.3 + 0.3 * i;
    s.emitters[i].position[1] = 0.9;
    s.emitters[i].half_width = s.emitters[i].radius = 0.1;
    s.drains[i].position[0] = 0.9 * i;
    s.drains[i].half_extents[0] = s.drains[i].half_extents[1] = s.drains[i].radius = 0.05;
  }
  assert_ok(pbf_reservoir_init(&s.reservoir, sizeof s.reservoir));
  s.reservoir.position[0] = s.reservoir.position[1] = 0.2;
  s.reservoir.half_extents[0] = s.reservoir.half_extents[1] = 0.2;
  s.reservoir.depth = 0.3;
  return s;
}

/* Each number that 2D, or the shape, has no use for. */
static void spoil(scene *s, double value) {
  for (int i = 0; i < 3; ++i) {
    pbf_collider *c = &s->colliders[i];
    c->position[2] = c->velocity[2] = c->axis[2] = value;
    c->half_extents[2] = c->half_extents_rate[2] = value;
    c->angular_velocity[0] = c->angular_velocity[1] = value;
  }
  for (int i = 0; i < 2; ++i) {
    pbf_emitter *e = &s->emitters[i];
    pbf_volume *d = &s->drains[i];
    e->position[2] = e->velocity[2] = e->half_height = value;
    for (int k = 0; k < 3; ++k) e->across[k] = d->axis[k] = value;
    d->position[2] = d->half_extents[2] = d->half_length = value;
  }
  s->emitters[PBF_EMITTER_RECTANGLE].radius = value;
  s->emitters[PBF_EMITTER_DISC].half_width = value;
  s->drains[PBF_VOLUME_BOX].radius = value;
  s->drains[PBF_VOLUME_SPHERE].half_extents[0] = value;
  s->reservoir.position[2] = s->reservoir.half_extents[2] = value;
  s->reservoir.added = s->reservoir.removed = UINT64_MAX;
}

static void set(pbf_solver *solver, const scene *s) {
  assert_ok(pbf_set_emitters(solver, 2, s->emitters));
  assert_ok(pbf_set_drains(solver, 2, s->drains));
  assert_ok(pbf_set_reservoirs(solver, 1, &s->reservoir));
}

/* With a tap that is set anew while its particles leave it. */
static uint64_t hash_of(const scene *first, const scene *then) {
  pbf_desc desc = test_desc(2, PBF_FLOAT32, 400);
  const pbf_params params = test_params();
  pbf_solver *solver = test_create(&desc, &params);
  assert_ok(pbf_set_colliders(solver, 3, first->colliders));
  set(solver, first);
  assert_ok(pbf_step(solver, 7));
  set(solver, then);
  assert_ok(pbf_move_colliders(solver, 3, then->colliders, 0.1));
  assert_ok(pbf_step(solver, 7));
  const uint64_t hash = test_hash(solver);
  uint64_t size;
  void *state = test_save(solver, &size);
  assert_ok(pbf_load(solver, state, size));
  assert_int_equal(test_hash(solver), hash);
  free(state);
  pbf_destroy(solver);
  return hash;
}

static void what_2d_has_not_changes_nothing(void **state) {
  (void)state;
  const scene plain = scene_of();
  const uint64_t hash = hash_of(&plain, &plain);
  for (int i = 0; i < KINDS; ++i) {
    scene spoilt = plain;
    spoil(&spoilt, anything[i]);
    assert_int_equal(hash_of(&spoilt, &spoilt), hash);
    assert_int_equal(hash_of(&plain, &spoilt), hash);
  }
}

/* pbf_move_colliders: velocities, rates, path and duration. */
static void how_targets_move_on_is_not_looked_at(void **state) {
  (void)state;
  scene plain = scene_of();
  for (int i = 0; i < 3; ++i) plain.colliders[i].position[1] += 0.02;
  const scene before = scene_of();
  const uint64_t hash = hash_of(&before, &plain);
  for (int n = 0; n < KINDS; ++n) {
    scene moving = plain;
    for (int i = 0; i < 3; ++i) {
      pbf_collider *c = &moving.colliders[i];
      for (int k = 0; k < 3; ++k) c->velocity[k] = c->angular_velocity[k] = anything[n];
      for (int k = 0; k < 3; ++k) c->half_extents_rate[k] = anything[n];
      c->radius_rate = c->half_length_rate = c->scale_rate = c->duration = anything[n];
      c->path = UINT32_MAX;
    }
    assert_int_equal(hash_of(&before, &moving), hash);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(what_2d_has_not_changes_nothing),
      cmocka_unit_test(how_targets_move_on_is_not_looked_at),
  };
  return TEST_RUN(tests);
}
