/* Open boundaries of given level and pressure, against volumes, weights and each other's bits. */
#include <pbf/emit.h>

#include "support.h"

#include <math.h>

static const double d = 0.05; /* the spacing */

enum { CAPACITY = 4000 };

static pbf_params params_of(double gravity) {
  pbf_params params = test_params();
  params.gravity[1] = -gravity;
  params.time_step = 1.0 / 128;
  params.domain_max[2] = 0.3;
  return params;
}

/* At the right wall of a tank 1 wide, from 0.6 on and as high as the tank. */
static pbf_reservoir reservoir_of(double depth) {
  pbf_reservoir r;
  assert_ok(pbf_reservoir_init(&r, sizeof r));
  const double position[3] = {0.8, 0.5, 0.15}, half[3] = {0.2, 0.5, 0.15};
  memcpy(r.position, position, sizeof position);
  memcpy(r.half_extents, half, sizeof half);
  r.depth = depth;
  return r;
}

/* A lattice from the origin, so many spacings along each axis. */
static pbf_solver *tank(uint32_t dimension, uint32_t precision, const pbf_params *params,
                        const uint32_t counts[3]) {
  static double raw[3 * CAPACITY];
  const pbf_desc desc = test_desc(dimension, precision, CAPACITY);
  pbf_solver *s = test_create(&desc, params);
  const uint32_t count = counts[0] * counts[1] * (dimension == 3 ? counts[2] : 1);
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t at[3] = {i % counts[0], i / counts[0] % counts[1], i / counts[0] / counts[1]};
    for (uint32_t k = 0; k < dimension; ++k)
      test_put(raw, (uint64_t)i * dimension + k, precision, d * (at[k] + 0.5));
  }
  if (count > 0) assert_ok(pbf_add_particles(s, count, raw, NULL, NULL));
  return s;
}

static pbf_reservoir got(pbf_solver *s) {
  pbf_reservoir r = {.struct_size = sizeof r};
  assert_ok(pbf_get_reservoir(s, 0, &r));
  return r;
}

static uint32_t count_of(pbf_solver *s) {
  uint32_t count;
  assert_ok(pbf_get_count(s, &count));
  return count;
}

/* ---- Volume ---------------------------------------------------------------------------------- */

/* An empty one is full after a step, of a lattice. */
static void check_filling(uint32_t dimension, uint32_t precision) {
  static double raw[3 * CAPACITY];
  const uint32_t none[3] = {0, 0, 0}, right = dimension == 3 ? 8 * 10 * 6 : 8 * 10;
  const pbf_params params = params_of(0);
  const pbf_reservoir r = reservoir_of(0.5);
  pbf_solver *s = tank(dimension, precision, &params, none);
  double nearest = INFINITY;
  assert_ok(pbf_set_reservoirs(s, 1, &r));
  assert_ok(pbf_step(s, 1));
  assert_int_equal(count_of(s), right);
  assert_true(got(s).added == right && got(s).removed == 0);
  assert_ok(pbf_get_positions(s, 0, right, raw));
  for (uint32_t i = 0; i < right; ++i)
    for (uint32_t j = 0; j < i; ++j) {
      double square = 0;
      for (uint32_t k = 0; k < dimension; ++k)
        square += pow(test_value(raw, (uint64_t)i * dimension + k, precision) -
                          test_value(raw, (uint64_t)j * dimension + k, precision),
                      2);
      nearest = fmin(nearest, sqrt(square));
    }
  if (!(nearest > 0.99 * d)) fail_msg("%.9g spacings apart", nearest / d);
  pbf_destroy(s);
}

static void an_empty_one_is_filled(void **state) {
  (void)state;
  test_for_each_kind(check_filling);
}

/* Of too many the highest go, in it alone. */
static void check_emptying(uint32_t dimension, uint32_t precision) {
  static double raw[3 * CAPACITY];
  const uint32_t counts[3] = {20, 12, 6}, wide = dimension == 3 ? 6 : 1;
  const pbf_params params = params_of(0);
  const pbf_reservoir r = reservoir_of(0.5); /* 10 layers of 8 */
  pbf_solver *s = tank(dimension, precision, &params, counts);
  assert_ok(pbf_set_reservoirs(s, 1, &r));
  assert_ok(pbf_step(s, 1));
  assert_int_equal(count_of(s), (20 * 12 - 2 * 8) * wide);
  assert_true(got(s).removed == 2 * 8 * wide && got(s).added == 0);
  assert_ok(pbf_get_positions(s, 0, count_of(s), raw));
  for (uint32_t i = 0; i < count_of(s); ++i) {
    const double x = test_value(raw, (uint64_t)i * dimension, precision);
    const double y = test_value(raw, (uint64_t)i * dimension + 1, precision);
    if (x > 0.62 && !(y < 0.52)) fail_msg("one is left at %g, %g", x, y);
  }
  pbf_destroy(s);
}

static void the_highest_go(void **state) {
  (void)state;
  test_for_each_kind(check_emptying);
}

/* As many as there should be: nothing comes, and nothing goes, though its surface is lower at one
 * place, and higher at another one. */
static void check_counting(uint32_t dimension, uint32_t precision) {
  static double raw[3 * CAPACITY];
  const uint32_t counts[3] = {20, 10, 6};
  const pbf_params params = params_of(0);
  const pbf_reservoir r = reservoir_of(0.5);
  pbf_solver *s = tank(dimension, precision, &params, counts);
  const uint32_t lowered = 20 * 10 - 8, raised = 20 * 10 - 1;
  assert_ok(pbf_get_positions(s, 0, count_of(s), raw));
  test_put(raw, (uint64_t)lowered * dimension, precision,
           test_value(raw, (uint64_t)raised * dimension, precision));
  test_put(raw, (uint64_t)lowered * dimension + 1, precision, d * 10.5);
  assert_ok(pbf_set_positions(s, 0, count_of(s), raw));
  assert_ok(pbf_set_reservoirs(s, 1, &r));
  assert_ok(pbf_step(s, 1));
  if (got(s).added != 0 || got(s).removed != 0)
    fail_msg("%uD: %u came, %u went", dimension, (unsigned)got(s).added, (unsigned)got(s).removed);
  pbf_destroy(s);
}

static void counts_decide(void **state) {
  (void)state;
  test_for_each_kind(check_counting);
}

/* A tank next to it comes to its level from below and from above, and stays there. */
static void check_level(uint32_t dimension, uint32_t precision) {
  if (test_is_stub()) return; /* without a fluid */
  for (int from_above = 0; from_above < 2; ++from_above) {
    const uint32_t counts[3] = {20, from_above ? 12 : 8, 6};
    pbf_params params = params_of(9.81);
    params.viscosity = 0.02;
    const pbf_reservoir r = reservoir_of(0.5);
    pbf_solver *s = tank(dimension, precision, &params, counts);
    const double three[6] = {0.15, 0, 0.15, 0.4, 0, 0.15};
    double levels[2], mean = 0;
    const double two[4] = {0.15, 0, 0.4, 0};
    assert_ok(pbf_set_reservoirs(s, 1, &r));
    assert_ok(pbf_step(s, 640));
    for (int k = 0; k < 8; ++k) {
      assert_ok(pbf_step(s, 16));
      assert_ok(pbf_get_levels(s, 2, dimension == 3 ? three : two, levels));
      mean += (levels[0] + levels[1]) / 16;
    }
    if (!(fabs(mean - 0.5) < 0.5 * d))
      fail_msg("%uD, from %s: the level is %g", dimension, from_above ? "above" : "below", mean);
    pbf_destroy(s);
  }
}

static void tanks_come_to_its_level(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_level);
}

static uint32_t count_beyond(pbf_solver *s, uint32_t dimension, uint32_t precision, double x) {
  static double raw[3 * CAPACITY];
  const uint32_t count = count_of(s);
  uint32_t beyond = 0;
  assert_ok(pbf_get_positions(s, 0, count, raw));
  for (uint32_t i = 0; i < count; ++i)
    beyond += test_value(raw, (uint64_t)i * dimension, precision) > x;
  return beyond;
}

/* However fast it flows out: a drain at the other end takes all. Of a breaking dam that is
 * 8/27 sqrt(g H³) (Ritter), more than a layer of the box in each time that a particle falls by a
 * spacing. */
static void check_flow(uint32_t dimension, uint32_t precision) {
  if (test_is_stub()) return; /* without a fluid */
  const uint32_t counts[3] = {20, 10, 6};
  const double full = 8 * 10 * (dimension == 3 ? 6.0 : 1.0);
  const pbf_params params = params_of(9.81);
  const pbf_reservoir r = reservoir_of(0.5);
  pbf_solver *s = tank(dimension, precision, &params, counts);
  pbf_volume drain;
  double mean = 0;
  assert_ok(pbf_volume_init(&drain, sizeof drain, PBF_VOLUME_BOX));
  for (uint32_t k = 0; k < 3; ++k) drain.half_extents[k] = k == 0 ? 0.1 : 2;
  assert_ok(pbf_set_drains(s, 1, &drain));
  assert_ok(pbf_set_reservoirs(s, 1, &r));
  assert_ok(pbf_step(s, 128));
  for (uint32_t k = 0; k < 8; ++k) {
    assert_ok(pbf_step(s, 16));
    mean += count_beyond(s, dimension, precision, 0.6) / 8.0;
  }
  if (!(mean > 0.95 * full && mean < 1.05 * full))
    fail_msg("%uD: %g particles are in it, of %g", dimension, mean, full);
  pbf_destroy(s);
}

static void it_gives_what_flows_out(void **state) {
  (void)state;
  test_for_long_kinds(check_flow);
}

/* ---- Pressure -------------------------------------------------------------------------------- */

/* Fluid without weight on a floor, in a reservoir that is all of its tank: the floor carries the
 * pressure, and no wall across it anything like that in sum. Turned upside down, the ceiling. */
static void check_pressure(uint32_t dimension, uint32_t precision) {
  if (test_is_stub()) return;
  for (int turned = 0; turned < 2; ++turned) {
    const uint32_t none[3] = {0, 0, 0};
    const double pressure = 2;
    pbf_params params = params_of(0);
    pbf_collider_load loads[6] = {{.struct_size = sizeof loads[0]}};
    pbf_reservoir r = reservoir_of(0.4);
    params.loads = 1;
    params.viscosity = 0.02;
    params.domain_min[0] = 0.6;
    r.pressure = pressure;
    if (turned) memcpy(r.orientation, (double[]){0, 0, 1, 0}, sizeof r.orientation);
    pbf_solver *s = tank(dimension, precision, &params, none);
    assert_ok(pbf_set_reservoirs(s, 1, &r));
    assert_ok(pbf_step(s, 256));
    for (int k = 0; k < 6; ++k) loads[k].struct_size = sizeof loads[k];
    assert_ok(pbf_get_wall_loads(s, 2 * dimension, loads));
    assert_ok(pbf_step(s, 256));
    assert_ok(pbf_get_wall_loads(s, 2 * dimension, loads));
    const pbf_collider_load *pressed = &loads[turned ? PBF_WALL_Y_MAX : PBF_WALL_Y_MIN];
    const double area = dimension == 3 ? 0.4 * 0.3 : 0.4;
    const double force = pressed->impulse_sum[1] / pressed->time_sum * (turned ? 1 : -1);
    if (!(fabs(force / (pressure * area) - 1) < 0.02))
      fail_msg("%uD, turned %d: the wall carries %g of the pressure", dimension, turned,
               force / (pressure * area));
    pbf_destroy(s);
  }
}

static void its_pressure_is_on_the_wall(void **state) {
  (void)state;
  test_for_long_kinds(check_pressure);
}

/* ---- Bits ------------------------------------------------------------------------------------ */

static pbf_solver *busy(uint32_t dimension, uint32_t precision) {
  const uint32_t counts[3] = {20, 6, 6};
  const pbf_params params = params_of(9.81);
  pbf_solver *s = tank(dimension, precision, &params, counts);
  pbf_reservoir two[2] = {reservoir_of(0.4), reservoir_of(0.2)};
  two[1].position[0] = 0.2;
  two[1].pressure = 0.5;
  assert_ok(pbf_set_reservoirs(s, 2, two));
  return s;
}

static void check_divided(uint32_t dimension, uint32_t precision) {
  pbf_solver *once = busy(dimension, precision), *parts = busy(dimension, precision);
  pbf_solver *loaded = test_solver(dimension, precision, CAPACITY);
  uint64_t size;
  assert_ok(pbf_step(once, 100));
  for (uint32_t done = 0; done < 60; ++done) assert_ok(pbf_step(parts, 1));
  void *saved = test_save(parts, &size);
  assert_ok(pbf_load(loaded, saved, size));
  assert_true(test_hash(loaded) == test_hash(parts));
  assert_true(got(loaded).added == got(parts).added);
  assert_ok(pbf_step(parts, 40));
  assert_ok(pbf_step(loaded, 40));
  assert_true(got(once).added > 0);
  assert_true(test_hash(once) == test_hash(parts));
  assert_true(test_hash(once) == test_hash(loaded));
  free(saved);
  pbf_destroy(once);
  pbf_destroy(parts);
  pbf_destroy(loaded);
}

static void steps_may_be_divided(void **state) {
  (void)state;
  test_for_each_kind(check_divided);
}

/* A step that there is no memory for begins again where it was. */
static void failures(void **state) {
  (void)state;
  if (!test_has_kind(3, PBF_FLOAT32)) return;
  pbf_solver *s = busy(3, PBF_FLOAT32), *other = busy(3, PBF_FLOAT32);
  test_steps_without_memory(s, other, 20);
  pbf_destroy(s);
  pbf_destroy(other);
}

/* Where the solver is full nothing comes, and no step fails. */
static void a_full_solver(void **state) {
  (void)state;
  if (!test_has_kind(2, PBF_FLOAT32)) return;
  const pbf_desc desc = test_desc(2, PBF_FLOAT32, 80);
  const pbf_params params = params_of(9.81);
  pbf_solver *s = test_create(&desc, &params);
  const pbf_reservoir r = reservoir_of(0.5);
  assert_ok(pbf_set_reservoirs(s, 1, &r));
  assert_ok(pbf_step(s, 60)); /* what flows out of it is not made up for */
  assert_int_equal(count_of(s), 80);
  assert_true(got(s).added == 80);
  pbf_destroy(s);
}

/* ---- Refusals -------------------------------------------------------------------------------- */

static void refusals(void **state) {
  (void)state;
  if (!test_has_kind(3, PBF_FLOAT32)) return;
  const pbf_status bad = PBF_ERROR_INVALID_ARGUMENT;
  const uint32_t none[3] = {0, 0, 0};
  const pbf_params params = params_of(9.81);
  pbf_solver *s = tank(3, PBF_FLOAT32, &params, none);
  const pbf_reservoir good = reservoir_of(0.5);
  pbf_reservoir r = good, two[2] = {good, good};
  uint32_t count;
  assert_ok(pbf_set_reservoirs(s, 1, &good));
  const uint64_t before = test_hash(s);
  assert_fails(pbf_reservoir_init(NULL, sizeof r), bad, "null");
  assert_fails(pbf_set_reservoirs(s, 65, &r), bad, "count is 65");
  assert_fails(pbf_set_reservoirs(s, 1, NULL), bad, "reservoirs is null");
  two[1].struct_size += 8;
  assert_fails(pbf_set_reservoirs(s, 2, two), PBF_ERROR_STRUCT_SIZE, "reservoirs[1].struct_size");
  two[1] = good;
  two[1].depth = 0;
  assert_fails(pbf_set_reservoirs(s, 2, two), bad, "reservoirs[1].depth");
  r.depth = 1.5;
  assert_fails(pbf_set_reservoirs(s, 1, &r), bad, "it must be at most the height of its box, 1");
  r = good;
  r.pressure = -1;
  assert_fails(pbf_set_reservoirs(s, 1, &r), bad, "reservoirs[0].pressure is -1");
  r = good;
  r.half_extents[2] = 0;
  assert_fails(pbf_set_reservoirs(s, 1, &r), bad, "reservoirs[0].half_extents");
  r = good;
  r.orientation[3] = 2;
  assert_fails(pbf_set_reservoirs(s, 1, &r), bad, "reservoirs[0].orientation");
  r = good;
  r.position[0] = 0.9;
  assert_fails(pbf_set_reservoirs(s, 1, &r), bad, "reaches to 1.1 along axis 0");
  r = good;
  r.phase = 1;
  assert_fails(pbf_set_reservoirs(s, 1, &r), bad, "reservoirs[0].phase is 1");
  assert_fails(pbf_get_reservoir(s, 1, &r), PBF_ERROR_NOT_FOUND, "the solver has 1 reservoirs");
  assert_fails(pbf_get_reservoir_count(s, NULL), bad, "count is null");
  assert_ok(pbf_get_reservoir_count(s, &count));
  assert_true(count == 1 && test_hash(s) == before);
  pbf_destroy(s);
  const pbf_desc small = test_desc(3, PBF_FLOAT32, 100);
  s = test_create(&small, &params);
  assert_fails(pbf_set_reservoirs(s, 1, &good), PBF_ERROR_CAPACITY,
               "reservoirs[0] holds 480 particles; desc.capacity is 100");
  pbf_destroy(s);
  assert_int_equal(test_count.live_blocks, 0);
}

/* Saved states with other words where reservoirs are. */
static void forged(void **state) {
  (void)state;
  if (!test_has_kind(3, PBF_FLOAT32)) return;
  pbf_solver *s = busy(3, PBF_FLOAT32);
  uint64_t size;
  assert_ok(pbf_step(s, 10));
  const uint64_t before = test_hash(s);
  unsigned char *saved = test_save(s, &size);
  uint32_t refused = 0;
  for (uint64_t at = size - 400; at + 8 < size; at += 4) {
    uint32_t word, wild = 0xfffffff1u;
    memcpy(&word, saved + at, sizeof word);
    memcpy(saved + at, &wild, sizeof wild);
    test_seal(saved, size);
    const pbf_status status = pbf_load(s, saved, size);
    refused += status == PBF_ERROR_DATA || status == PBF_ERROR_INVALID_ARGUMENT;
    memcpy(saved + at, &word, sizeof word);
    test_seal(saved, size);
    assert_ok(pbf_load(s, saved, size));
  }
  assert_true(refused > 10 && test_hash(s) == before);
  free(saved);
  pbf_destroy(s);
}

/* With a spacing of a billionth it would hold more particles than there are numbers. */
/* A state may hold a box that reaches far beyond the domain, which may have become smaller since.
 */
static void a_box_far_below_the_domain(void **state) {
  (void)state;
  const double far[] = {1e6, 1e12, 1e18, 1e150};
  const uint32_t counts[3] = {6, 3, 6};
  const pbf_params params = test_params();
  for (size_t i = 0; i < sizeof far / sizeof far[0]; ++i) {
    pbf_solver *s = tank(2, PBF_FLOAT32, &params, counts);
    pbf_reservoir r = reservoir_of(0.3);
    r.half_extents[1] = 0.4375; /* which stands once in a state */
    r.position[1] = 0.5;
    assert_ok(pbf_set_reservoirs(s, 1, &r));
    uint64_t size, at = 0;
    unsigned char *saved = test_save(s, &size);
    while (memcmp(saved + at, &r.half_extents[1], sizeof(double)) != 0)
      assert_true(++at + 8 < size);
    memcpy(saved + at, &far[i], sizeof far[i]);
    test_seal(saved, size);
    assert_ok(pbf_load(s, saved, size));
    assert_ok(pbf_step(s, 2)); /* and ends */
    uint32_t count;
    assert_ok(pbf_get_count(s, &count));
    assert_int_equal(count, 18); /* the level is below the domain */
    free(saved);
    pbf_destroy(s);
  }
}

static void a_spacing_far_smaller_since(void **state) {
  (void)state;
  const uint32_t none[3] = {0, 0, 0};
  pbf_params params = params_of(9.81);
  pbf_solver *s = tank(2, PBF_FLOAT64, &params, none);
  const pbf_reservoir r = reservoir_of(0.5);
  assert_ok(pbf_set_reservoirs(s, 1, &r));
  params.spacing = 1e-9;
  params.smoothing_radius = 2e-9;
  assert_ok(pbf_set_params(s, &params));
  assert_ok(pbf_step(s, 2));
  assert_int_equal(count_of(s), 0);
  assert_fails(pbf_set_reservoirs(s, 1, &r), PBF_ERROR_CAPACITY, "reservoirs[0] holds");
  const pbf_reservoir film = reservoir_of(1e-10);
  assert_fails(pbf_set_reservoirs(s, 1, &film), PBF_ERROR_CAPACITY, "reservoirs[0]");
  pbf_destroy(s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(an_empty_one_is_filled),
      cmocka_unit_test(the_highest_go),
      cmocka_unit_test(counts_decide),
      cmocka_unit_test(tanks_come_to_its_level),
      cmocka_unit_test(it_gives_what_flows_out),
      cmocka_unit_test(its_pressure_is_on_the_wall),
      cmocka_unit_test(steps_may_be_divided),
      cmocka_unit_test(failures),
      cmocka_unit_test(a_full_solver),
      cmocka_unit_test(refusals),
      cmocka_unit_test(a_box_far_below_the_domain),
      cmocka_unit_test(a_spacing_far_smaller_since),
      cmocka_unit_test(forged),
  };
  return TEST_RUN(tests);
}
