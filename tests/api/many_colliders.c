/* Thousands of colliders: what is near the fluid acts as if it were alone, and what is far away not
 * at all. */
#include "load_scene.h"

#include <stdio.h>

static void want_fluid(uint32_t dimension, uint32_t precision) {
  if (!test_has_kind(dimension, precision)) test_skip("not in this build");
  if (test_is_stub()) test_skip("the stub has no fluid");
}

static int is_reference(void) { return strcmp(test_backend(), "reference") == 0; }

static void positions_of(const load_scene *s, double *x) {
  assert_ok(pbf_get_positions(s->solver, 0, s->count, s->values));
  for (uint32_t i = 0; i < s->count * s->dimension; ++i)
    x[i] = test_value(s->values, i, s->precision);
}

/* ---- A vessel of small boxes ---------------------------------------------------------------- */

/* Cells of two spacings, the vessel's inside being `wide` of them along each level axis and `high`
 * upwards, its walls `thick`. */
typedef struct vessel {
  uint32_t dimension;
  int wide, high, thick;
} vessel;

static const double cell = 0.1;

static pbf_collider box_between(uint32_t dimension, const double lower[3], const double upper[3]) {
  pbf_collider c = load_collider(PBF_COLLIDER_BOX, 0, 0, 0);
  for (uint32_t k = 0; k < dimension; ++k) {
    c.position[k] = (lower[k] + upper[k]) / 2;
    c.half_extents[k] = (upper[k] - lower[k]) / 2;
  }
  return c;
}

static uint32_t small_boxes(const vessel *v, pbf_collider *to) {
  const int depth = v->dimension == 3 ? v->wide : 0, behind = v->dimension == 3 ? v->thick : 0;
  uint32_t count = 0;
  for (int z = -behind; z < depth + behind || z == 0; ++z)
    for (int y = -v->thick; y < v->high; ++y)
      for (int x = -v->thick; x < v->wide + v->thick; ++x) {
        const int level = x >= 0 && x < v->wide && (v->dimension == 2 || (z >= 0 && z < depth));
        if (level && y >= 0) continue;
        const double lower[3] = {cell * x, cell * y, cell * z};
        const double upper[3] = {cell * (x + 1), cell * (y + 1), cell * (z + 1)};
        to[count++] = box_between(v->dimension, lower, upper);
        if (v->dimension == 2 && z > 0) fail();
      }
  return count;
}

static uint32_t large_boxes(const vessel *v, pbf_collider *to) {
  const double t = cell * v->thick, w = cell * v->wide, h = cell * v->high;
  const double parts[5][2][3] = {{{-t, -t, -t}, {w + t, 0, w + t}},
                                 {{-t, 0, -t}, {0, h, w + t}},
                                 {{w, 0, -t}, {w + t, h, w + t}},
                                 {{0, 0, -t}, {w, h, 0}},
                                 {{0, 0, w}, {w, h, w + t}}};
  const uint32_t count = v->dimension == 3 ? 5 : 3;
  for (uint32_t k = 0; k < count; ++k) to[k] = box_between(v->dimension, parts[k][0], parts[k][1]);
  return count;
}

/* How high water stands in it in the mean. */
static double level_in(const vessel *v, uint32_t precision, uint32_t layers, uint32_t steps,
                       uint32_t count, const pbf_collider *boxes) {
  const double room[3] = {0, 0, 0}, w = cell * v->wide;
  const double size[3] = {w, layers * load_spacing, w};
  pbf_params params = load_params(v->dimension, room);
  double level = 0;
  params.loads = 0;
  for (int k = 0; k < 3; ++k) {
    params.domain_min[k] = -cell * (v->thick + 3);
    params.domain_max[k] = cell * ((k == 1 ? v->high : v->wide) + v->thick + 3);
  }
  load_scene s =
      load_scene_of(v->dimension, precision, &params, size, load_everywhere, count, boxes);
  double *x = calloc((size_t)s.count * v->dimension, sizeof *x);
  assert_ok(pbf_step(s.solver, steps));
  positions_of(&s, x);
  for (uint32_t i = 0; i < s.count; ++i) {
    const double *at = x + (size_t)i * v->dimension;
    for (uint32_t k = 0; k < v->dimension; ++k)
      if (!(at[k] > 0 && at[k] < cell * (k == 1 ? v->high : v->wide)))
        fail_msg("%uD, %u boxes: particle %u is at %g along axis %u, outside of the vessel",
                 v->dimension, count, i, at[k], k);
    level += 2 * at[1] / s.count;
  }
  free(x);
  load_end(&s);
  return level;
}

static void check_vessel(uint32_t dimension) {
  const vessel v = dimension == 3 ? (vessel){3, 11, 18, 1} : (vessel){2, 20, 30, 10};
  const uint32_t layers = 8, steps = is_reference() && dimension == 3 ? 30 : 150;
  const uint32_t precision = test_has_kind(dimension, PBF_FLOAT32) ? PBF_FLOAT32 : PBF_FLOAT64;
  want_fluid(dimension, precision);
  pbf_collider *boxes = calloc(PBF_MAX_COLLIDERS, sizeof *boxes);
  uint32_t count = small_boxes(&v, boxes);
  assert_true(count >= 1000);
  const double level = level_in(&v, precision, layers, steps, count, boxes);
  count = large_boxes(&v, boxes);
  const double right = level_in(&v, precision, layers, steps, count, boxes);
  if (!(fabs(level - right) < 0.01 * right))
    fail_msg("%uD: water stands at %g, in a vessel of large boxes at %g", dimension, level, right);
  free(boxes);
}

static void small_boxes_hold_water_in_2d(void **state) {
  (void)state;
  check_vessel(2);
}

static void small_boxes_hold_water_in_3d(void **state) {
  (void)state;
  test_skip_if_watched();
  check_vessel(3);
}

/* ---- Those that are far away ----------------------------------------------------------------- */

enum { NEAR = 10, ALL = 2000, EACH = ALL / NEAR };

/* On a GPU kernels for more than 64 are others, which round otherwise: there few are that many. */
static uint32_t few_each(void) { return strcmp(test_backend(), "cuda") == 0 ? 8 : 1; }

static const double width = 0.6;

/* Of several shapes, in and around the water; some move, some turn, some grow, some rub. */
static pbf_collider near_collider(uint32_t dimension, uint32_t i) {
  const double part = (i + 0.5) / NEAR, z = dimension == 3 ? width * (1 - part) : 0;
  pbf_collider c = load_collider(i % 3 == 0   ? PBF_COLLIDER_SPHERE
                                 : i % 3 == 1 ? PBF_COLLIDER_BOX
                                              : PBF_COLLIDER_CAPSULE,
                                 width * part, 0.05 + 0.25 * (i % 4) / 3, z);
  c.radius = 0.05;
  c.half_length = 0.04;
  for (int k = 0; k < 3; ++k) c.half_extents[k] = 0.03 + 0.01 * k;
  c.velocity[0] = i % 2 ? 0.3 : 0;
  c.velocity[1] = i % 5 == 0 ? -0.2 : 0;
  c.angular_velocity[2] = i % 3 == 1 ? 4 : 0;
  c.radius_rate = i % 4 == 3 ? 0.05 : 0;
  c.friction = i % 2 ? 0.4 : 0;
  c.no_slip = i % 3 ? 1 : 0;
  if (i % 6 == 5) c.duration = 0.1;
  return c;
}

static pbf_collider far_collider(uint32_t dimension, uint32_t i) {
  const double z = dimension == 3 ? 2 + 0.1 * (i / 15 % 15) : 0;
  pbf_collider c = load_collider(i % 2 ? PBF_COLLIDER_BOX : PBF_COLLIDER_SPHERE,
                                 2.5 + 0.1 * (i % 15), 2.5 + 0.02 * (i / 15 % 80), z);
  c.radius = 0.03;
  for (int k = 0; k < 3; ++k) c.half_extents[k] = 0.04;
  c.velocity[1] = 0.2;
  c.angular_velocity[2] = 1;
  return c;
}

/* The near ones, each the last of so many; the others are far. */
static uint32_t crowd(uint32_t dimension, uint32_t each, pbf_collider *to) {
  const uint32_t count = NEAR * each;
  for (uint32_t i = 0; i < count; ++i)
    to[i] = i % each == each - 1 ? near_collider(dimension, i / each) : far_collider(dimension, i);
  return count;
}

static pbf_params params_of_crowd(uint32_t dimension) {
  const double domain[3] = {5, 5, 5};
  pbf_params params = load_params(dimension, domain);
  params.viscosity = 0.01;
  params.wall_no_slip = 1;
  params.max_substeps =
      0; /* steps that change go by the depth, and that by the room all solids leave */
  params.damping_compensation = 1;
  return params;
}

/* Some of them jump into the water, others go on to where they are to be. */
static void jump_and_go(pbf_solver *solver, uint32_t count, pbf_collider *colliders) {
  const uint32_t each = count / NEAR;
  for (uint32_t i = 0; i < count; ++i) {
    colliders[i].struct_size = sizeof colliders[i];
    assert_ok(pbf_get_collider(solver, i, &colliders[i]));
  }
  for (uint32_t i = each - 1; i < count; i += 3 * each) colliders[i].position[0] += 0.15;
  assert_ok(pbf_set_colliders(solver, count, colliders));
  assert_ok(pbf_step(solver, 3));
  for (uint32_t i = 0; i < count; ++i) {
    assert_ok(pbf_get_collider(solver, i, &colliders[i]));
    colliders[i].position[1] += 0.05;
  }
  assert_ok(pbf_move_colliders(solver, count, colliders, 0.1));
}

typedef struct outcome {
  uint32_t count;
  double *x;
  pbf_collider_load loads[NEAR];
} outcome;

static outcome outcome_of(uint32_t dimension, uint32_t precision, uint32_t each) {
  const pbf_params params = params_of_crowd(dimension);
  const double size[3] = {width, 0.3, width};
  const int long_enough = is_reference() && dimension == 3 ? 4 : 12;
  pbf_collider *colliders = calloc(ALL, sizeof *colliders);
  pbf_collider_load *loads = calloc(ALL, sizeof *loads);
  outcome o;
  const uint32_t count = crowd(dimension, each, colliders);
  load_scene s =
      load_scene_of(dimension, precision, &params, size, load_everywhere, count, colliders);
  assert_ok(pbf_step(s.solver, (uint32_t)long_enough));
  jump_and_go(s.solver, count, colliders);
  assert_ok(pbf_step(s.solver, (uint32_t)long_enough));
  load_colliders(&s, count, loads);
  for (uint32_t i = 0; i < NEAR; ++i) o.loads[i] = loads[(i + 1) * (count / NEAR) - 1];
  for (uint32_t i = 0; i < count; ++i)
    if (i % each != each - 1) assert_true(loads[i].contacts == 0);
  o.count = s.count * dimension;
  o.x = calloc(o.count, sizeof *o.x);
  positions_of(&s, o.x);
  load_end(&s);
  free(colliders);
  free(loads);
  return o;
}

static void check_alone(uint32_t dimension, uint32_t precision) {
  want_fluid(dimension, precision);
  outcome alone = outcome_of(dimension, precision, few_each());
  outcome among = outcome_of(dimension, precision, EACH);
  assert_int_equal(alone.count, among.count);
  for (uint32_t i = 0; i < alone.count; ++i)
    if (alone.x[i] != among.x[i])
      fail_msg("%uD: number %u is %.17g, without the others %.17g", dimension, i, among.x[i],
               alone.x[i]);
  uint32_t contacts = 0;
  for (int i = 0; i < NEAR; ++i) {
    assert_memory_equal(&alone.loads[i], &among.loads[i], sizeof alone.loads[i]);
    contacts += alone.loads[i].contacts;
  }
  assert_true(contacts > 20);
  free(alone.x);
  free(among.x);
}

static void the_far_ones_change_no_bit(void **state) {
  (void)state;
  test_for_long_kinds(check_alone);
}

/* ---- A heap that falls through water --------------------------------------------------------- */

enum { BALLS = 500 };

/* Row upon row of balls, some spacings from each other, over the water. */
static void heap(uint32_t dimension, pbf_collider *balls) {
  const uint32_t along = dimension == 3 ? 5 : 4;
  for (uint32_t i = 0; i < BALLS; ++i) {
    const uint32_t x = i % along, z = dimension == 3 ? i / along % along : 0;
    const uint32_t row = dimension == 3 ? i / along / along : i / along;
    balls[i] = load_collider(PBF_COLLIDER_SPHERE, 0.1 + 0.2 * x + 0.05 * (row % 2), 0.5 + 0.2 * row,
                             dimension == 3 ? 0.1 + 0.2 * z + 0.05 * (row / 2 % 2) : 0);
    balls[i].radius = 0.03 + 0.01 * (i % 4);
    balls[i].velocity[1] = -1.5;
    balls[i].angular_velocity[2] = i % 3;
  }
}

static void momentum_of(load_scene *s, double momentum[3]) { load_momentum(s, momentum); }

/* What the fluid loses in a step beside gravity is what solids get, in units of what gravity gives.
 */
static void check_momentum(load_scene *s, const double before[3], pbf_collider_load *loads) {
  const double dt = s->params.time_step, weight = s->count * s->mass * load_gravity * dt;
  pbf_collider_load walls[6];
  double after[3];
  momentum_of(s, after);
  load_walls(s, walls);
  load_colliders(s, BALLS, loads);
  for (uint32_t k = 0; k < s->dimension; ++k) {
    double sum = 0, size = weight;
    for (uint32_t i = 0; i < 2 * s->dimension; ++i) sum += walls[i].impulse[k];
    for (uint32_t i = 0; i < BALLS; ++i) sum += loads[i].impulse[k];
    for (uint32_t i = 0; i < BALLS; ++i) size += fabs(loads[i].impulse[k]);
    const double lost = before[k] - after[k] - (k == 1 ? weight : 0);
    const double part = s->precision == PBF_FLOAT64 ? 1e-6 : 1e-4;
    if (!(fabs(sum - lost) <= part * size))
      fail_msg("%uD: solids get %.9g along axis %u, and the fluid loses %.9g", s->dimension, sum, k,
               lost);
  }
}

static void check_outside(const load_scene *s, const pbf_collider *balls, const double *x,
                          uint32_t step) {
  const double skin = 1e-3 * s->params.smoothing_radius;
  for (uint32_t i = 0; i < s->count; ++i) {
    const double *at = x + (size_t)i * s->dimension;
    for (uint32_t k = 0; k < s->dimension; ++k)
      if (!(at[k] >= 0 && at[k] <= s->params.domain_max[k]))
        fail_msg("%uD, step %u: particle %u is at %g along axis %u", s->dimension, step, i, at[k],
                 k);
    for (uint32_t b = 0; b < BALLS; ++b) {
      double r2 = 0;
      for (uint32_t k = 0; k < s->dimension; ++k)
        r2 += (at[k] - balls[b].position[k]) * (at[k] - balls[b].position[k]);
      if (!(sqrt(r2) > balls[b].radius - skin))
        fail_msg("%uD, step %u: particle %u is %g deep in ball %u", s->dimension, step, i,
                 balls[b].radius - sqrt(r2), b);
    }
  }
}

static void check_heap(uint32_t dimension, uint32_t precision) {
  want_fluid(dimension, precision);
  const double domain[3] = {1.05, 30, 1.05}, size[3] = {1, 0.4, 1};
  pbf_params params = load_params(dimension, domain);
  params.gravity[1] = -load_gravity;
  pbf_collider *balls = calloc(BALLS, sizeof *balls);
  pbf_collider_load *loads = calloc(BALLS, sizeof *loads);
  heap(dimension, balls);
  load_scene s = load_scene_of(dimension, precision, &params, size, load_everywhere, BALLS, balls);
  double *x = calloc((size_t)s.count * dimension, sizeof *x);
  const uint32_t rounds = is_reference() && dimension == 3 ? 3 : 8;
  uint32_t contacts = 0;
  for (uint32_t round = 1; round <= rounds; ++round) {
    double before[3];
    assert_ok(pbf_step(s.solver, 9));
    momentum_of(&s, before);
    assert_ok(pbf_step(s.solver, 1));
    check_momentum(&s, before, loads);
    for (uint32_t b = 0; b < BALLS; ++b) {
      balls[b].struct_size = sizeof balls[b];
      assert_ok(pbf_get_collider(s.solver, b, &balls[b]));
      contacts += loads[b].contacts;
    }
    positions_of(&s, x);
    check_outside(&s, balls, x, 10 * round);
  }
  assert_true(contacts > 50);
  free(x);
  free(balls);
  free(loads);
  load_end(&s);
}

static void a_heap_falls_through_water(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_heap);
}

/* ---- Sleep, saved states, limits ------------------------------------------------------------- */

enum { STONES = 150, BESIDE = 100, ALOOF = 120 };

static load_scene pond(uint32_t dimension, uint32_t precision, pbf_collider *stones) {
  const double domain[3] = {4, 4, 4}, size[3] = {0.5, 0.2, 0.5};
  pbf_params params = load_params(dimension, domain);
  params.domain_max[0] = 0.5;
  params.domain_max[2] = 0.5;
  params.loads = 0;
  params.sleep_speed = 0.3;
  params.sleep_time = 0.05;
  for (uint32_t i = 0; i < STONES; ++i) {
    stones[i] = load_collider(PBF_COLLIDER_SPHERE, 0.25, 1 + 0.01 * i, 0.25);
    stones[i].radius = 0.02;
  }
  stones[BESIDE].position[1] = 0.3;
  return load_scene_of(dimension, precision, &params, size, load_everywhere, STONES, stones);
}

static uint32_t asleep(const load_scene *s) {
  pbf_stats stats = {.struct_size = sizeof stats};
  assert_ok(pbf_get_stats(s->solver, &stats));
  return stats.asleep;
}

static void move_one(const load_scene *s, uint32_t which, double by, pbf_collider *stones) {
  stones[which].position[1] += by;
  assert_ok(pbf_move_colliders(s->solver, STONES, stones, 2 * s->params.time_step));
  assert_ok(pbf_step(s->solver, 1));
}

static void check_sleep(uint32_t dimension, uint32_t precision) {
  want_fluid(dimension, precision);
  pbf_collider stones[STONES];
  load_scene s = pond(dimension, precision, stones);
  for (int k = 0; k < 60 && asleep(&s) < s.count; ++k) assert_ok(pbf_step(s.solver, 10));
  assert_int_equal(asleep(&s), s.count);
  move_one(&s, ALOOF, 0.01, stones);
  assert_int_equal(asleep(&s), s.count);
  move_one(&s, BESIDE, -0.08, stones);
  assert_true(asleep(&s) < s.count);
  load_end(&s);
}

static void what_moves_near_wakes(void **state) {
  (void)state;
  test_for_long_kinds(check_sleep);
}

/* What has been set into the water counts as placed there, whichever number it has, also after the
 * state has been saved between. */
static void check_saved(uint32_t dimension, uint32_t precision) {
  want_fluid(dimension, precision);
  pbf_collider stones[STONES];
  uint64_t size;
  load_scene s = pond(dimension, precision, stones), t = pond(dimension, precision, stones);
  assert_ok(pbf_step(s.solver, 10));
  stones[BESIDE].position[1] = 0.12;
  stones[ALOOF].position[1] = 0.06;
  assert_ok(pbf_set_colliders(s.solver, STONES, stones));
  void *saved = test_save(s.solver, &size);
  assert_ok(pbf_load(t.solver, saved, size));
  uint64_t again_size;
  void *again = test_save(t.solver, &again_size);
  assert_true(again_size == size && memcmp(saved, again, size) == 0);
  assert_ok(pbf_step(s.solver, 10));
  assert_ok(pbf_step(t.solver, 10));
  assert_true(test_hash(s.solver) == test_hash(t.solver));
  free(saved);
  free(again);
  load_end(&s);
  load_end(&t);
}

static void a_saved_state_has_all_of_them(void **state) {
  (void)state;
  test_for_long_kinds(check_saved);
}

static void so_many_and_no_more(void **state) {
  (void)state;
  const uint32_t precision = test_has_kind(3, PBF_FLOAT32) ? PBF_FLOAT32 : PBF_FLOAT64;
  want_fluid(3, precision);
  pbf_collider *c = calloc(PBF_MAX_COLLIDERS + 1, sizeof *c);
  pbf_solver *s = test_filled(3, precision, 30, 30);
  for (uint32_t i = 0; i <= PBF_MAX_COLLIDERS; ++i) {
    c[i] = load_collider(PBF_COLLIDER_BOX, 0.01 * (i % 100), 0.02 * (i / 100), 0.5);
    for (int k = 0; k < 3; ++k) c[i].half_extents[k] = 1e-3;
  }
  c[PBF_MAX_COLLIDERS - 1].velocity[0] = 7;
  assert_fails(pbf_set_colliders(s, PBF_MAX_COLLIDERS + 1, c), PBF_ERROR_INVALID_ARGUMENT,
               "count is 4097; it must be at most 4096");
  assert_ok(pbf_set_colliders(s, PBF_MAX_COLLIDERS, c));
  assert_ok(pbf_step(s, 2));
  uint32_t count = 0;
  double limit = 0;
  pbf_collider last = {.struct_size = sizeof last};
  assert_ok(pbf_get_collider_count(s, &count));
  assert_int_equal(count, PBF_MAX_COLLIDERS);
  assert_ok(pbf_get_collider(s, PBF_MAX_COLLIDERS - 1, &last));
  assert_true(fabs(last.position[0] - c[PBF_MAX_COLLIDERS - 1].position[0] - 14.0 / 120) < 1e-9);
  assert_ok(pbf_get_step_limit(s, &limit));
  assert_true(fabs(limit - 0.05 / 7) < 1e-9);
  assert_ok(pbf_set_colliders(s, 3, c));
  assert_ok(pbf_step(s, 1));
  assert_ok(pbf_set_colliders(s, 0, NULL));
  assert_ok(pbf_step(s, 1));
  pbf_destroy(s);
  free(c);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(small_boxes_hold_water_in_2d),
      cmocka_unit_test(small_boxes_hold_water_in_3d),
      cmocka_unit_test(the_far_ones_change_no_bit),
      cmocka_unit_test(a_heap_falls_through_water),
      cmocka_unit_test(what_moves_near_wakes),
      cmocka_unit_test(a_saved_state_has_all_of_them),
      cmocka_unit_test(so_many_and_no_more),
  };
  return TEST_RUN(tests);
}
