/* Spray, foam and bubbles: how they move, against closed forms, and what solids do to them. */
#include "diffuse_scene.h"

/* ---- Motion ---------------------------------------------------------------------------------- */

/* The parabola, and with drag what it tends to. */
static void check_spray(uint32_t dimension, uint32_t precision) {
  const double drags[] = {0, 0.0625, 3};
  const double g[3] = {0.5, -8, 0.25};
  for (int i = 0; i < 3; ++i) {
    pbf_solver *s = box_of(dimension, precision, 0, 4);
    pbf_params params = params_of(0, 4);
    memcpy(params.gravity, g, sizeof g);
    assert_ok(pbf_set_params(s, &params));
    pbf_diffuse_desc desc = desc_of_kind(s, PBF_DIFFUSE_SPRAY);
    desc.spray_drag = drags[i];
    assert_ok(pbf_set_diffuse(s, &desc));
    const double x0[3] = {1.25, 1.75, 1.125};
    add_one(s, dimension, precision, x0, throw, 100);
    assert_ok(pbf_step(s, 64));
    const one p = read_one(s);
    const double t = 64 * dt, k = drags[i], e = exp(-k * t);
    assert_int_equal(p.kind, PBF_DIFFUSE_SPRAY);
    for (uint32_t c = 0; c < dimension; ++c) {
      const double end = k > 0 ? g[c] / k : 0;
      const double v = k > 0 ? end + (throw[c] - end) * e : throw[c] + g[c] * t;
      const double x = k > 0 ? x0[c] + end * t + (throw[c] - end) * (1 - e) / k
                             : x0[c] + throw[c] * t + 0.5 * g[c] * t * t;
      assert_near(p.x[c], x, 1e-11, "a place");
      assert_near(p.v[c], v, 1e-11, "a velocity");
    }
    pbf_destroy(s);
  }
}

static void spray_flies_ballistically(void **state) {
  (void)state;
  test_for_each_kind(check_spray);
}

/* A basin in which each particle is held against gravity: fluid at rest to the last bit. */
static pbf_solver *held_basin(uint32_t dimension, uint32_t precision, double gravity) {
  static double a[3 * CAPACITY];
  pbf_solver *s = box_of(dimension, precision, gravity, 3);
  const uint32_t count =
      add_block(s, dimension, precision, (double[3]){1.5, 1.5, 1.5}, (int[3]){9, 40, 9}, NULL);
  for (uint32_t i = 0; i < count * dimension; ++i)
    test_put(a, i, precision, i % dimension == 1 ? gravity : 0);
  assert_ok(pbf_set_accelerations(s, 0, count, a));
  return s;
}

/* Rises at buoyancy g / drag in the end, by the exponential on the way. */
static void check_bubble(uint32_t dimension, uint32_t precision) {
  const double g = 8, buoyancy = 1.5, drag = 20;
  pbf_solver *s = held_basin(dimension, precision, g);
  pbf_diffuse_desc desc = desc_of_kind(s, PBF_DIFFUSE_BUBBLE);
  desc.buoyancy = buoyancy;
  desc.bubble_drag = drag;
  assert_ok(pbf_set_diffuse(s, &desc));
  const double x0[3] = {1.5, 0.75, 1.5};
  add_one(s, dimension, precision, x0, (double[3]){0, 0, 0}, 100);
  const double end = buoyancy * g / drag;
  for (int steps = 16; steps <= 128; steps += 16) {
    assert_ok(pbf_step(s, 16));
    const one p = read_one(s);
    const double t = steps * dt, e = exp(-drag * t);
    assert_int_equal(p.kind, PBF_DIFFUSE_BUBBLE);
    assert_near(p.v[1], end * (1 - e), 1e-9 + 64 * rounding_of(precision), "its speed");
    assert_near(p.x[1], x0[1] + end * (t - (1 - e) / drag), 1e-9 + 64 * rounding_of(precision),
                "its height");
    assert_near(p.x[0], 1.5, 1e-9 + 64 * rounding_of(precision), "its place");
  }
  assert_near(read_one(s).v[1], 0.6, 1e-8 + 64 * rounding_of(precision), "its speed in the end");
  pbf_destroy(s);
}

static void bubbles_rise_to_their_speed(void **state) {
  (void)state;
  test_for_each_kind(check_bubble);
}

/* A bubble without drag has the acceleration of buoyancy alone. */
static void check_free_bubble(uint32_t dimension, uint32_t precision) {
  pbf_solver *s = held_basin(dimension, precision, 1);
  pbf_diffuse_desc desc = desc_of_kind(s, PBF_DIFFUSE_BUBBLE);
  desc.buoyancy = 2;
  desc.bubble_drag = 0;
  assert_ok(pbf_set_diffuse(s, &desc));
  add_one(s, dimension, precision, (double[3]){1.5, 0.75, 1.5}, (double[3]){0, 0, 0}, 100);
  assert_ok(pbf_step(s, 32));
  const one p = read_one(s);
  assert_near(p.v[1], 2 * 32 * dt, 1e-12, "its speed");
  assert_near(p.x[1], 0.75 + pow(32 * dt, 2), 1e-12, "its height");
  pbf_destroy(s);
}

static void bubbles_without_drag_fall_upwards(void **state) {
  (void)state;
  test_for_each_kind(check_free_bubble);
}

/* On fluid that goes all alike it goes as the fluid does, on fluid at rest it stays. */
static void check_foam(uint32_t dimension, uint32_t precision) {
  for (int moving = 0; moving < 2; ++moving) {
    pbf_solver *s = box_of(dimension, precision, 0, 4);
    add_block(s, dimension, precision, (double[3]){2, 2, 2}, (int[3]){9, 9, 9},
              moving ? shifting : still);
    const pbf_diffuse_desc desc = desc_of_kind(s, PBF_DIFFUSE_FOAM);
    assert_ok(pbf_set_diffuse(s, &desc));
    const double x0[3] = {2.03, 2 + 4.4 * d, 1.98};
    add_one(s, dimension, precision, x0, throw, 100);
    assert_ok(pbf_step(s, 40));
    const one p = read_one(s);
    assert_int_equal(p.kind, PBF_DIFFUSE_FOAM);
    for (uint32_t k = 0; k < dimension; ++k) {
      const double v = moving ? shifting(x0, (int)k) : 0;
      assert_near(p.x[k], test_value(&(float){(float)x0[k]}, 0, PBF_FLOAT32) + v * 40 * dt, 2e-5,
                  "a place");
      assert_near(p.v[k], v, 2e-5, "a velocity");
    }
    pbf_destroy(s);
  }
}

static void foam_goes_with_the_fluid(void **state) {
  (void)state;
  test_for_each_kind(check_foam);
}

static const double omega = 2.5;
static double turning(const double x[3], int component) {
  return component == 0 ? -omega * (x[1] - 2) : component == 1 ? omega * (x[0] - 2) : 0;
}

/* A block that is turned about (2, 2), and goes round. */
static void set_turned(pbf_solver *s, uint32_t dimension, uint32_t precision, uint32_t count,
                       const double *x0, double angle) {
  static double x[3 * CAPACITY], v[3 * CAPACITY];
  for (uint32_t i = 0; i < count; ++i) {
    const double *from = &x0[i * dimension], a = from[0] - 2, b = from[1] - 2;
    double at[3] = {2 + cos(angle) * a - sin(angle) * b, 2 + sin(angle) * a + cos(angle) * b, 2};
    if (dimension == 3) at[2] = from[2];
    for (uint32_t k = 0; k < dimension; ++k) {
      test_put(x, (uint64_t)i * dimension + k, precision, at[k]);
      test_put(v, (uint64_t)i * dimension + k, precision, turning(at, (int)k));
    }
  }
  assert_ok(pbf_set_positions(s, 0, count, x));
  assert_ok(pbf_set_velocities(s, 0, count, v));
}

/* Fluid that is set to turn before each step, and goes straight in it: its velocity is then A x,
 * and foam is carried by I + dt A + dt² A² / 2, be it outside of all particles or between them. */
static void check_turning_foam(uint32_t dimension, uint32_t precision) {
  static double x0[3 * CAPACITY], v0[3 * CAPACITY];
  pbf_solver *s = box_of(dimension, precision, 0, 4);
  const uint32_t count =
      add_block(s, dimension, precision, (double[3]){2, 2, 2}, (int[3]){13, 13, 7}, turning);
  const pbf_diffuse_desc desc = desc_of_kind(s, PBF_DIFFUSE_FOAM);
  assert_ok(pbf_set_diffuse(s, &desc));
  const double from[2] = {4 * d, -6.4 * d};
  double a[2] = {from[0], from[1]};
  add_one(s, dimension, precision, (double[3]){2 + from[0], 2 + from[1], 2}, throw, 100);
  test_read(s, dimension, precision, count, x0, v0);
  const double scale = omega / (1 + omega * omega * dt * dt);
  for (int step = 0; step < 48; ++step) {
    set_turned(s, dimension, precision, count, x0, omega * step * dt);
    assert_ok(pbf_step(s, 1));
    const double u[2] = {scale * (omega * dt * a[0] - a[1]), scale * (a[0] + omega * dt * a[1])};
    const double w[2] = {scale * (omega * dt * u[0] - u[1]), scale * (u[0] + omega * dt * u[1])};
    for (int k = 0; k < 2; ++k) a[k] += dt * u[k] + 0.5 * dt * dt * w[k];
  }
  const one p = read_one(s);
  for (int k = 0; k < 2; ++k) assert_near(p.x[k], 2 + a[k], 3e-5, "a place");
  /* The angle by which it has gone round: what turns it turns as the fluid. */
  const double turned = atan2(p.x[1] - 2, p.x[0] - 2) - atan2(from[1], from[0]);
  assert_near(turned, omega * 48 * dt, 2e-3, "its angle");
  pbf_destroy(s);
}

static void foam_turns_with_the_fluid(void **state) {
  (void)state;
  test_for_each_kind(check_turning_foam);
}

/* By how many particles are within h: one alone, a lattice's corner, its inside. */
static void check_kinds(uint32_t dimension, uint32_t precision) {
  pbf_solver *s = box_of(dimension, precision, 0, 4);
  add_block(s, dimension, precision, (double[3]){2, 2, 2}, (int[3]){9, 9, 9}, NULL);
  pbf_diffuse_desc desc = desc_of(s);
  assert_int_equal(desc.foam_neighbors, dimension == 3 ? 7 : 3);
  assert_int_equal(desc.bubble_neighbors, dimension == 3 ? 21 : 8);
  desc.trapped_air_rate = desc.wave_crest_rate = desc.buoyancy = 0;
  assert_ok(pbf_set_diffuse(s, &desc));
  one all[3];
  const double places[3][3] = {{2, 2, 2}, {2.01, 2 + 4.1 * d, 2.01}, {2, 2 + 5.8 * d, 2}};
  for (int i = 0; i < 3; ++i)
    add_one(s, dimension, precision, places[i], (double[3]){0, 0, 0}, 100);
  assert_ok(pbf_step(s, 1));
  assert_int_equal(read_all(s, all, 3), 3);
  assert_int_equal(all[0].kind, PBF_DIFFUSE_BUBBLE);
  assert_int_equal(all[1].kind, PBF_DIFFUSE_FOAM);
  assert_int_equal(all[2].kind, PBF_DIFFUSE_SPRAY);
  const pbf_diffuse_info info = info_of(s);
  assert_true(info.bubbles == 1 && info.foam == 1 && info.spray == 1 && info.count == 3);
  pbf_destroy(s);
}

static void kinds_go_by_neighbours(void **state) {
  (void)state;
  test_for_each_kind(check_kinds);
}

/* ---- Solids ---------------------------------------------------------------------------------- */

static pbf_collider collider_of(uint32_t shape, int inverted) {
  pbf_collider c;
  assert_ok(pbf_collider_init(&c, sizeof c, shape));
  for (int k = 0; k < 3; ++k) c.position[k] = 2;
  c.inverted = (uint32_t)inverted;
  c.radius = 0.5;
  c.half_length = 0.25;
  c.axis[0] = 0, c.axis[1] = 1, c.axis[2] = 0;
  c.half_extents[0] = 0.5, c.half_extents[1] = 0.25, c.half_extents[2] = 0.5;
  return c;
}

/* From `from` out to `to`, without the velocity (1, 1, 0) that leads in. */
typedef struct push {
  uint32_t shape;
  int inverted;
  double from[2], to[2], v[2];
} push;

static void check_pushes(uint32_t dimension, uint32_t precision) {
  static const push pushes[] = {
      {PBF_COLLIDER_SPHERE, 0, {-0.25, 0}, {-0.5, 0}, {0, 1}},
      {PBF_COLLIDER_SPHERE, 0, {0, -0.375}, {0, -0.5}, {1, 0}},
      {PBF_COLLIDER_SPHERE, 0, {0, 0.375}, {0, 0.5}, {1, 1}},
      {PBF_COLLIDER_SPHERE, 0, {0, 0.625}, {0, 0.625}, {1, 1}},
      {PBF_COLLIDER_SPHERE, 1, {0, 0.75}, {0, 0.5}, {1, 0}},
      {PBF_COLLIDER_BOX, 0, {0.25, -0.1875}, {0.25, -0.25}, {1, 0}},
      {PBF_COLLIDER_BOX, 0, {-0.4375, 0.125}, {-0.5, 0.125}, {0, 1}},
      {PBF_COLLIDER_BOX, 1, {0.75, 0.125}, {0.5, 0.125}, {0, 1}},
      {PBF_COLLIDER_CAPSULE, 0, {-0.25, 0.125}, {-0.5, 0.125}, {0, 1}},
      {PBF_COLLIDER_CAPSULE, 0, {0, -0.5}, {0, -0.75}, {1, 0}},
      {PBF_COLLIDER_PLANE, 0, {0.25, -0.5}, {0.25, 0}, {1, 1}},
      {PBF_COLLIDER_PLANE, 1, {0.25, 0.5}, {0.25, 0}, {1, 0}},
  };
  for (size_t i = 0; i < sizeof pushes / sizeof pushes[0]; ++i) {
    pbf_solver *s = box_of(dimension, precision, 0, 4);
    const pbf_diffuse_desc desc = desc_of_kind(s, PBF_DIFFUSE_SPRAY);
    const pbf_collider c = collider_of(pushes[i].shape, pushes[i].inverted);
    assert_ok(pbf_set_colliders(s, 1, &c));
    assert_ok(pbf_set_diffuse(s, &desc));
    const double v[3] = {1, 1, 0};
    double x[3] = {2, 2, 2};
    for (int k = 0; k < 2; ++k) x[k] += pushes[i].from[k] - dt * v[k];
    add_one(s, dimension, precision, x, v, 100);
    assert_ok(pbf_step(s, 1));
    const one p = read_one(s);
    for (int k = 0; k < 2; ++k) {
      if (!(fabs(p.x[k] - 2 - pushes[i].to[k]) < 1e-6)) fail_msg("%zu: at %.9g", i, p.x[k] - 2);
      if (!(fabs(p.v[k] - pushes[i].v[k]) < 1e-6)) fail_msg("%zu: goes by %.9g", i, p.v[k]);
    }
    pbf_destroy(s);
  }
}

static void colliders_push_them_out(void **state) {
  (void)state;
  test_for_long_kinds(check_pushes);
}

/* What moves takes along what is before it, as a wall does; a turned box is out by its own frame.
 */
static void check_moving(uint32_t dimension, uint32_t precision) {
  pbf_solver *s = box_of(dimension, precision, 0, 4);
  const pbf_diffuse_desc desc = desc_of_kind(s, PBF_DIFFUSE_SPRAY);
  pbf_collider c[2] = {collider_of(PBF_COLLIDER_BOX, 0), collider_of(PBF_COLLIDER_BOX, 0)};
  one all[3];
  c[0].velocity[0] = 2;
  c[1].position[1] = 3;
  c[1].orientation[2] = c[1].orientation[3] = sqrt(0.5); /* a quarter turn: 0.25 wide now */
  pbf_params params = params_of(0, 4);
  params.wall_velocity[PBF_WALL_X_MIN] = 1;
  assert_ok(pbf_set_params(s, &params));
  assert_ok(pbf_set_colliders(s, 2, c));
  assert_ok(pbf_set_diffuse(s, &desc));
  add_one(s, dimension, precision, (double[3]){2.5, 2, 2}, (double[3]){0, 0.5, 0}, 100);
  add_one(s, dimension, precision, (double[3]){0.0, 2, 2}, (double[3]){-3, 0.5, 0}, 100);
  add_one(s, dimension, precision, (double[3]){2.125, 3.0, 2}, (double[3]){0, 0, 0}, 100);
  assert_ok(pbf_step(s, 32));
  assert_int_equal(read_all(s, all, 3), 3);
  assert_near(all[0].x[0], 2.5 + 2 * 32 * dt, 1e-9, "the place before the box");
  assert_near(all[0].v[0], 2, 1e-9, "its velocity");
  assert_near(all[0].v[1], 0.5, 1e-9, "its velocity along");
  assert_near(all[1].x[0], 32 * dt, 1e-9, "the place at the wall");
  assert_near(all[1].v[0], 1, 1e-9, "its velocity there");
  assert_near(all[2].x[0], 2.25, 1e-9, "the place beside the turned box");
  pbf_destroy(s);
}

static void what_moves_takes_them_along(void **state) {
  (void)state;
  test_for_each_kind(check_moving);
}

/* Through one face and in at the other; fluid beyond a face is near. */
static void check_periodic(uint32_t dimension, uint32_t precision) {
  const pbf_desc desc_here = test_desc(dimension, precision, CAPACITY);
  pbf_params params = params_of(0, 2);
  params.periodic = PBF_PERIODIC_X;
  pbf_solver *s = test_create(&desc_here, &params);
  add_block(s, dimension, precision, (double[3]){0.5 * d, 1, 1}, (int[3]){1, 5, 5}, NULL);
  add_block(s, dimension, precision, (double[3]){2 - 0.5 * d, 1, 1}, (int[3]){1, 5, 5}, NULL);
  pbf_diffuse_desc desc = desc_of(s);
  desc.trapped_air_rate = desc.wave_crest_rate = desc.buoyancy = 0;
  desc.foam_neighbors = 1;
  desc.bubble_neighbors = dimension == 3 ? 12 : 4; /* one side alone has fewer */
  assert_ok(pbf_set_diffuse(s, &desc));
  one all[2];
  add_one(s, dimension, precision, (double[3]){1.75, 0.5, 1}, (double[3]){2, 0, 0}, 100);
  add_one(s, dimension, precision, (double[3]){0, 1, 1}, (double[3]){0, 0, 0}, 100);
  assert_ok(pbf_step(s, 32));
  assert_int_equal(read_all(s, all, 2), 2);
  assert_near(all[0].x[0], 0.25, 1e-9, "its place");
  assert_int_equal(all[1].kind, PBF_DIFFUSE_BUBBLE);
  pbf_destroy(s);
}

static void periodic_axes_lead_to_the_other_side(void **state) {
  (void)state;
  test_for_each_kind(check_periodic);
}

/* Nor looks at memory that there is not, which a sanitizer would tell. */
static void no_fluid_makes_none(void **state) {
  (void)state;
  pbf_solver *s = box_of(2, PBF_FLOAT64, 10, 1);
  pbf_diffuse_desc desc;
  pbf_diffuse_info info = {.struct_size = sizeof info};
  assert_ok(pbf_diffuse_init(s, &desc, sizeof desc));
  assert_true(desc.wave_crest_rate > 0);
  assert_ok(pbf_set_diffuse(s, &desc));
  assert_ok(pbf_step(s, 2));
  assert_ok(pbf_get_diffuse_info(s, &info));
  assert_true(info.generated == 0 && info.time == 2 * dt);
  pbf_destroy(s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(spray_flies_ballistically),
      cmocka_unit_test(bubbles_rise_to_their_speed),
      cmocka_unit_test(bubbles_without_drag_fall_upwards),
      cmocka_unit_test(foam_goes_with_the_fluid),
      cmocka_unit_test(foam_turns_with_the_fluid),
      cmocka_unit_test(kinds_go_by_neighbours),
      cmocka_unit_test(colliders_push_them_out),
      cmocka_unit_test(what_moves_takes_them_along),
      cmocka_unit_test(periodic_axes_lead_to_the_other_side),
      cmocka_unit_test(no_fluid_makes_none),
  };
  return TEST_RUN(tests);
}
