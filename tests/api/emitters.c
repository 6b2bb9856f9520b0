/* What comes and goes in steps, against what it must be by time and volume alone. */
#include <pbf/diffuse.h>

#include "emitter_scene.h"

static double particle_volume(uint32_t dimension) { return dimension == 3 ? d * d * d : d * d; }

static pbf_volume drain_of(double lower, double upper) {
  pbf_volume v;
  assert_ok(pbf_volume_init(&v, sizeof v, PBF_VOLUME_BOX));
  v.position[0] = v.position[2] = 0.5;
  v.position[1] = 0.5 * (lower + upper);
  v.half_extents[1] = 0.5 * (upper - lower);
  return v;
}

static pbf_in_out in_out_of(pbf_solver *s) {
  pbf_in_out in_out = {.struct_size = sizeof in_out};
  assert_ok(pbf_get_in_out(s, &in_out));
  return in_out;
}

/* ---- How much -------------------------------------------------------------------------------- */

/* 10,000 steps of a rate that no step divides; a drain keeps few of the particles. */
static void check_rate(uint32_t dimension, uint32_t precision) {
  pbf_solver *s = tank(dimension, precision, 0);
  pbf_emitter e = emitter_of(PBF_EMITTER_DISC);
  const pbf_volume drain = drain_of(0, 1.4);
  e.rate = (dimension == 3 ? 0.0371 : 0.271) / 3;
  e.jitter = 0.2;
  assert_ok(pbf_set_emitters(s, 1, &e));
  assert_ok(pbf_set_drains(s, 1, &drain));
  for (int part = 1; part <= 4; ++part) {
    assert_ok(pbf_step(s, 2500));
    const pbf_in_out in_out = in_out_of(s);
    const double right = e.rate * part * 2500 / 128 / particle_volume(dimension);
    if (!(fabs((double)in_out.emitted - right) <= 1))
      fail_msg("%g have come, not %.9g", (double)in_out.emitted, right);
    assert_true(in_out.refused == 0 && in_out.emitters == 1 && in_out.drains == 1);
    assert_int_equal(in_out.emitted - in_out.drained, count_of(s));
  }
  pbf_destroy(s);
}

static void the_rate_is_exact(void **state) {
  (void)state;
  test_for_long_kinds(check_rate);
}

/* Of a stream: nothing nearer than the lattice has it, and as much as its section carries. */
static void check_stream(pbf_solver *s, uint32_t dimension, uint32_t precision, const char *what) {
  static double raw[3 * CAPACITY];
  const uint32_t count = count_of(s);
  double nearest = INFINITY;
  assert_ok(pbf_get_positions(s, 0, count, raw));
  for (uint32_t i = 0; i < count; ++i)
    for (uint32_t j = 0; j < i; ++j) {
      double square = 0;
      for (uint32_t k = 0; k < dimension; ++k)
        square += pow(test_value(raw, (uint64_t)i * dimension + k, precision) -
                          test_value(raw, (uint64_t)j * dimension + k, precision),
                      2);
      nearest = fmin(nearest, sqrt(square));
    }
  if (!(nearest > 0.97 * d)) fail_msg("%s: %.9g spacings apart", what, nearest / d);
}

static void check_lattice(uint32_t dimension, uint32_t precision) {
  const double ways[2][3] = {{0, -1, 0}, {0.6, -1.1, dimension == 3 ? 0.4 : 0}};
  for (uint32_t shape = PBF_EMITTER_RECTANGLE; shape <= PBF_EMITTER_DISC; ++shape) {
    for (int way = 0; way < 2; ++way) {
      pbf_solver *s = tank(dimension, precision, 0);
      pbf_emitter e = emitter_of(shape);
      memcpy(e.velocity, ways[way], sizeof e.velocity);
      assert_ok(pbf_set_emitters(s, 1, &e));
      assert_ok(pbf_step(s, 40));
      check_stream(s, dimension, precision, way ? "aslant" : "downwards");
      pbf_destroy(s);
    }
  }
}

static void streams_are_lattices(void **state) {
  (void)state;
  test_for_each_kind(check_lattice);
}

/* Until it is h away a particle stays in its column, whatever pulls it: gravity by the one step
 * since it was last set there. */
static void check_guided(uint32_t dimension, uint32_t precision) {
  static double raw[3 * CAPACITY];
  const double g = 20, dt = 1.0 / 128, h = 2 * d;
  pbf_solver *s = tank(dimension, precision, g);
  pbf_emitter e = emitter_of(PBF_EMITTER_DISC);
  uint32_t near = 0;
  e.position[0] = 0.1;
  memcpy(e.velocity, (double[]){1, 0, 0}, sizeof e.velocity);
  e.radius = 0.01; /* one column */
  assert_ok(pbf_set_emitters(s, 1, &e));
  assert_ok(pbf_step(s, 40));
  assert_ok(pbf_get_positions(s, 0, count_of(s), raw));
  for (uint32_t i = 0; i < count_of(s); ++i) {
    const double x = test_value(raw, (uint64_t)i * dimension, precision) - 0.1;
    const double y = test_value(raw, (uint64_t)i * dimension + 1, precision) - 1.5;
    near += x < h;
    if (x < h && !(fabs(y) < 1.5 * g * dt * dt)) fail_msg("%.9g below at %.9g", -y, x);
    if (x > 2 * h && !(y < -4 * g * dt * dt)) fail_msg("%.9g below at %.9g", -y, x);
  }
  assert_true(near >= 2);
  pbf_destroy(s);
}

static void openings_guide(void **state) {
  (void)state;
  test_for_each_kind(check_guided);
}

/* At most as much as columns carry: 0 is that, and more is refused. Rectangles: 4 x 5 columns. */
static void check_most(uint32_t dimension, uint32_t precision) {
  pbf_solver *s = tank(dimension, precision, 0);
  pbf_emitter e = emitter_of(PBF_EMITTER_RECTANGLE);
  const uint32_t columns = dimension == 3 ? 20 : 4;
  assert_ok(pbf_set_emitters(s, 1, &e));
  assert_ok(pbf_step(s, 64)); /* half a time unit: 10 spacings */
  assert_in_range(in_out_of(s).emitted, 10 * columns - 1, 10 * columns);
  e.rate = columns * particle_volume(dimension) / d;
  assert_ok(pbf_set_emitters(s, 1, &e));
  e.rate *= 1.01;
  assert_fails(pbf_set_emitters(s, 1, &e), PBF_ERROR_INVALID_ARGUMENT, "columns carry at most");
  assert_ok(pbf_get_emitter(s, 0, &e));
  assert_true(e.rate < 1.001 * columns * particle_volume(dimension) / d);
  pbf_destroy(s);
}

static void columns_carry_so_much(void **state) {
  (void)state;
  test_for_each_kind(check_most);
}

/* A closed tank: volume over area. */
static void check_filling(uint32_t dimension, uint32_t precision) {
  if (test_is_stub()) return; /* without a fluid */
  pbf_solver *s = tank(dimension, precision, 9.81);
  pbf_params params = {.struct_size = sizeof params};
  pbf_emitter e = emitter_of(PBF_EMITTER_DISC);
  double x[9], levels[3], mean = 0;
  assert_ok(pbf_get_params(s, &params));
  params.domain_max[0] = params.domain_max[2] = 0.6;
  params.viscosity = 0.01;
  assert_ok(pbf_set_params(s, &params));
  e.position[0] = e.position[2] = 0.3;
  e.position[1] = 0.8;
  e.radius = 0.1;
  e.rate = dimension == 3 ? 0.02 : 0.1;
  assert_ok(pbf_set_emitters(s, 1, &e));
  assert_ok(pbf_step(s, 640)); /* 5 */
  assert_ok(pbf_set_emitters(s, 0, NULL));
  assert_ok(pbf_step(s, 256));
  for (uint32_t i = 0; i < 3 * dimension; ++i) x[i] = 0.2 + 0.1 * (i / dimension);
  assert_ok(pbf_get_levels(s, 3, x, levels));
  for (int i = 0; i < 3; ++i) mean += levels[i] / 3;
  const double right = (dimension == 3 ? 0.02 * 5 / 0.6 : 0.1 * 5) / 0.6;
  if (!(fabs(mean - right) < 0.5 * d)) fail_msg("the level is %.9g, not %.9g", mean, right);
  pbf_destroy(s);
}

static void a_closed_tank_fills(void **state) {
  (void)state;
  test_for_long_kinds(check_filling);
}

/* A channel: an inlet along the floor, a weir at the far end, over which what is above the level
 * drains away. The level stays. */
static void check_channel(uint32_t dimension, uint32_t precision) {
  if (test_is_stub()) return;
  const pbf_desc desc = test_desc(dimension, precision, CAPACITY);
  pbf_params params = test_params();
  params.domain_max[0] = 2;
  params.domain_max[1] = 1;
  params.domain_max[2] = 0.2;
  pbf_solver *s = test_create(&desc, &params);
  pbf_emitter inlet = emitter_of(PBF_EMITTER_RECTANGLE);
  pbf_volume weir = drain_of(0.5 - 0.5 * d, 1);
  const double position[3] = {0.025, 0.15, 0.1}, velocity[3] = {0.5, 0, 0};
  memcpy(inlet.position, position, sizeof position);
  memcpy(inlet.velocity, velocity, sizeof velocity);
  memcpy(inlet.across, (double[]){0, 1, 0}, sizeof inlet.across);
  inlet.half_width = inlet.half_height = 0.1;
  weir.position[0] = 1.9;
  weir.half_extents[0] = 0.1;
  double raw[3 * CAPACITY];
  uint32_t count = 0;
  for (uint32_t i = 0; i < 40 * 10 * (dimension == 3 ? 4u : 1u); ++i, ++count) {
    const uint32_t at[3] = {i % 40, i / 40 % 10, i / 400};
    for (uint32_t k = 0; k < dimension; ++k)
      test_put(raw, (uint64_t)i * dimension + k, precision, d * (at[k] + 0.5));
  }
  assert_ok(pbf_add_particles(s, count, raw, NULL, NULL));
  assert_ok(pbf_set_emitters(s, 1, &inlet));
  assert_ok(pbf_set_drains(s, 1, &weir));
  double x[9], levels[3], mean = 0;
  for (uint32_t i = 0; i < 3 * dimension; ++i)
    x[i] = i % dimension == 0 ? 0.5 + 0.4 * (i / dimension) : 0.1;
  assert_ok(pbf_step(s, 600));
  for (int sample = 0; sample < 10; ++sample) {
    assert_ok(pbf_step(s, 60));
    assert_ok(pbf_get_levels(s, 3, x, levels));
    for (int i = 0; i < 3; ++i) mean += levels[i] / 30;
  }
  const pbf_in_out in_out = in_out_of(s);
  print_message("level %.4g, %u particles, %g in, %g out\n", mean, count_of(s),
                (double)in_out.emitted, (double)in_out.drained);
  assert_true(fabs(mean - 0.5) < d && in_out.drained > 0.8 * in_out.emitted);
  pbf_destroy(s);
}

static void a_channel_keeps_its_level(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_channel);
}

/* ---- Bits ------------------------------------------------------------------------------------ */

static pbf_solver *busy(uint32_t dimension, uint32_t precision) {
  pbf_solver *s = tank(dimension, precision, 9.81);
  pbf_emitter two[2] = {emitter_of(PBF_EMITTER_RECTANGLE), emitter_of(PBF_EMITTER_DISC)};
  const pbf_volume drain = drain_of(-0.1, 0.2);
  two[0].position[0] = 0.3;
  two[1].position[0] = 0.7;
  two[1].jitter = 0.3;
  two[1].seed = 7;
  two[0].lifetime = 0.2;
  two[1].rate = dimension == 3 ? 0.01 : 0.1;
  assert_ok(pbf_set_emitters(s, 2, two));
  assert_ok(pbf_set_drains(s, 1, &drain));
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
  assert_ok(pbf_begin_step(parts, 40));
  assert_ok(pbf_end_step(parts));
  assert_ok(pbf_step(loaded, 40));
  assert_true(in_out_of(once).expired > 0 && in_out_of(once).drained > 0);
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

/* Without any, a state and its hash are what they were. */
/* A jet at 60 degrees, in steps of 0.05 that the library divides, which has spray: room for that
 * follows what comes in each part. */
typedef struct jet {
  pbf_solver *solver;
  uint32_t dimension, precision, count;
  void *x, *v;
} jet;

static const double jet_speed = 4.75, jet_time = 0.6, jet_along[2] = {0.5, 0.8660254037844386};

static jet jet_of(uint32_t dimension, uint32_t precision, double gravity) {
  const pbf_desc desc = test_desc(dimension, precision, CAPACITY);
  jet j = {.dimension = dimension, .precision = precision};
  pbf_params params = test_params();
  for (int k = 0; k < 3; ++k) params.domain_min[k] = -4, params.domain_max[k] = 4;
  params.gravity[1] = -gravity;
  params.time_step = 0.05;
  params.max_substeps = 10;
  j.solver = test_create(&desc, &params);
  pbf_emitter e = emitter_of(PBF_EMITTER_DISC);
  for (int k = 0; k < 3; ++k) e.position[k] = 0;
  for (int k = 0; k < 2; ++k) e.velocity[k] = jet_speed * jet_along[k];
  assert_ok(pbf_set_emitters(j.solver, 1, &e));
  pbf_diffuse_desc spray;
  assert_ok(pbf_diffuse_init(j.solver, &spray, sizeof spray));
  assert_ok(pbf_set_diffuse(j.solver, &spray));
  assert_ok(pbf_step(j.solver, (uint32_t)lround(jet_time / params.time_step)));
  j.count = count_of(j.solver);
  j.x = calloc((size_t)j.count * dimension, precision);
  j.v = calloc((size_t)j.count * dimension, precision);
  assert_ok(pbf_get_positions(j.solver, 0, j.count, j.x));
  assert_ok(pbf_get_velocities(j.solver, 0, j.count, j.v));
  return j;
}

static void jet_end(jet *j) {
  pbf_destroy(j->solver);
  free(j->x);
  free(j->v);
}

static double jet_number(const jet *j, const void *array, uint64_t i, uint32_t k) {
  return test_value(array, i * j->dimension + k, j->precision);
}

/* As much comes as in whole steps, the first of it is where it must be by then, and behind that is
 * the same in each spacing. */
static void check_divided_stream(uint32_t dimension, uint32_t precision) {
  jet j = jet_of(dimension, precision, 0);
  const double columns = dimension == 3 ? 32 : 6, way = jet_speed * jet_time;
  enum { ROWS = 50 };
  double farthest = 0;
  uint32_t rows[ROWS] = {0};
  for (uint64_t i = 0; i < j.count; ++i) {
    double along = 0;
    for (uint32_t k = 0; k < 2; ++k) along += jet_along[k] * jet_number(&j, j.x, i, k);
    farthest = fmax(farthest, along);
    if (along > 0 && along < ROWS * d) ++rows[(int)(along / d)];
  }
  for (int row = 1; row < ROWS; ++row) assert_true(fabs(rows[row] / columns - 1) <= 0.5);
  assert_true(fabs(j.count - columns * way / d) <= 1);
  assert_true(fabs(farthest - way) < d);
  jet_end(&j);
}

/* What is within h of its opening is led, and so its height there is given to it; from then on
 * energy is kept. */
static void check_divided_jet(uint32_t dimension, uint32_t precision) {
  const double g = 9.81, led = test_params().smoothing_radius * jet_along[1];
  jet j = jet_of(dimension, precision, g);
  double energy = 0;
  for (uint64_t i = 0; i < j.count; ++i) {
    energy += g * jet_number(&j, j.x, i, 1) / j.count;
    for (uint32_t k = 0; k < dimension; ++k)
      energy += 0.5 * pow(jet_number(&j, j.v, i, k), 2) / j.count;
  }
  const double right = 0.5 * jet_speed * jet_speed + g * led;
  if (!(fabs(energy / right - 1) < 0.03))
    fail_msg("a particle of the jet has the energy %g, it must be %g", energy, right);
  jet_end(&j);
}

static void check_divided_jets(uint32_t dimension, uint32_t precision) {
  check_divided_stream(dimension, precision);
  check_divided_jet(dimension, precision);
}

static void jets_keep_their_energy_in_divided_steps(void **state) {
  (void)state;
  test_for_long_kinds(check_divided_jets);
}

static void unused(void **state) {
  (void)state;
  pbf_solver *s = test_filled(3, PBF_FLOAT32, 50, 100);
  uint64_t size, after;
  const uint64_t before = test_hash(s);
  void *saved = test_save(s, &size);
  assert_ok(pbf_set_emitters(s, 0, NULL));
  assert_ok(pbf_set_drains(s, 0, NULL));
  void *again = test_save(s, &after);
  assert_true(test_hash(s) == before && size == after && memcmp(saved, again, size) == 0);
  free(saved);
  free(again);
  pbf_destroy(s);
}

/* A step that there is no memory for begins again where it was. */
static void failures(void **state) {
  (void)state;
  pbf_solver *s = busy(3, PBF_FLOAT32), *other = busy(3, PBF_FLOAT32);
  test_steps_without_memory(s, other, 40);
  pbf_destroy(s);
  pbf_destroy(other);
}

/* ---- Lifetimes and capacity ------------------------------------------------------------------ */

/* Those of the last 0.25, which are 32 steps. */
static void check_lives(uint32_t dimension, uint32_t precision, double a_step) {
  pbf_solver *s = tank(dimension, precision, 0);
  pbf_emitter e = emitter_of(PBF_EMITTER_RECTANGLE);
  e.lifetime = 0.25;
  e.velocity[1] = -5;
  e.rate = a_step * 128 * particle_volume(dimension);
  assert_ok(pbf_set_emitters(s, 1, &e));
  assert_ok(pbf_step(s, 100));
  assert_int_equal(in_out_of(s).emitted, floor(a_step * 100));
  assert_int_equal(in_out_of(s).expired, floor(a_step * 68));
  assert_int_equal(count_of(s), floor(a_step * 100) - floor(a_step * 68));
  assert_ok(pbf_set_emitters(s, 0, NULL)); /* those that there are live on to their end */
  assert_ok(pbf_step(s, 33));
  assert_int_equal(count_of(s), 0);
  pbf_destroy(s);
}

static void check_lifetime(uint32_t dimension, uint32_t precision) {
  check_lives(dimension, precision, 0.375); /* in some steps none comes, */
  check_lives(dimension, precision, 2.375); /* in all of these two or three */
}

static void lifetimes(void **state) {
  (void)state;
  test_for_each_kind(check_lifetime);
}

/* Where the solver is full the oldest go, or nothing more comes. */
static void check_full(uint32_t dimension, uint32_t precision) {
  pbf_solver *s = tank(dimension, precision, 0);
  pbf_emitter e = emitter_of(PBF_EMITTER_RECTANGLE);
  pbf_desc desc = test_desc(dimension, precision, 30);
  pbf_params params = {.struct_size = sizeof params};
  uint32_t ids[30];
  assert_ok(pbf_get_params(s, &params));
  pbf_destroy(s);
  s = test_create(&desc, &params);
  e.rate = 0.25 * 128 * particle_volume(dimension);
  assert_ok(pbf_set_emitters(s, 1, &e));
  assert_ok(pbf_step(s, 140)); /* 35 */
  assert_true(in_out_of(s).emitted == 30 && in_out_of(s).refused == 5);
  e.recycle = 1;
  assert_ok(pbf_set_emitters(s, 1, &e));
  assert_ok(pbf_step(s, 40)); /* 10 more */
  assert_true(in_out_of(s).emitted == 40 && in_out_of(s).recycled == 10);
  assert_int_equal(count_of(s), 30);
  assert_ok(pbf_get_ids(s, 0, 30, ids));
  for (uint32_t row = 0; row < 30; ++row) assert_int_equal(ids[row], row + 10);
  pbf_destroy(s);
}

static void a_full_solver(void **state) {
  (void)state;
  test_for_each_kind(check_full);
}

/* ---- Refusals -------------------------------------------------------------------------------- */

static const pbf_status bad = PBF_ERROR_INVALID_ARGUMENT;

static void refusals(void **state) {
  (void)state;
  pbf_solver *s = tank(3, PBF_FLOAT32, 9.81);
  const pbf_emitter good = emitter_of(PBF_EMITTER_RECTANGLE);
  pbf_emitter e = good, two[2] = {good, good};
  pbf_volume drain = drain_of(0, 1);
  assert_ok(pbf_set_emitters(s, 1, &good));
  const uint64_t before = test_hash(s);
  assert_fails(pbf_emitter_init(&e, sizeof e, 2), bad, "shape is 2");
  assert_fails(pbf_emitter_init(NULL, sizeof e, 0), bad, "null");
  assert_fails(pbf_set_emitters(s, 65, &e), bad, "count is 65");
  assert_fails(pbf_set_emitters(s, 1, NULL), bad, "emitters is null");
  two[1].struct_size += 8;
  assert_fails(pbf_set_emitters(s, 2, two), PBF_ERROR_STRUCT_SIZE, "emitters[1].struct_size");
  e.velocity[1] = 0;
  assert_fails(pbf_set_emitters(s, 1, &e), bad, "emitters[0].velocity has the size 0");
  e = good;
  e.rate = -1;
  assert_fails(pbf_set_emitters(s, 1, &e), bad, "rate");
  e.rate = NAN;
  assert_fails(pbf_set_emitters(s, 1, &e), bad, "rate is NaN");
  e = good;
  e.half_height = 0;
  assert_fails(pbf_set_emitters(s, 1, &e), bad, "half_height");
  e = good;
  e.jitter = 1.5;
  assert_fails(pbf_set_emitters(s, 1, &e), bad, "jitter");
  e = good;
  e.position[0] = 0.95;
  assert_fails(pbf_set_emitters(s, 1, &e), bad, "it must be inside the domain");
  e.half_width = 1e30;
  assert_fails(pbf_set_emitters(s, 1, &e), PBF_ERROR_CAPACITY, "so large");
  e = good;
  e.velocity[1] = -1e5;
  assert_fails(pbf_set_emitters(s, 1, &e), PBF_ERROR_CAPACITY, "particles in each step");
  drain.radius = NAN;
  drain.shape = PBF_VOLUME_SPHERE;
  assert_fails(pbf_set_drains(s, 1, &drain), bad, "drains[0].radius is NaN");
  assert_fails(pbf_set_drains(s, 65, &drain), bad, "count is 65");
  assert_fails(pbf_get_emitter(s, 1, &e), PBF_ERROR_NOT_FOUND, "the solver has 1 emitters");
  assert_fails(pbf_get_drain(s, 0, &drain), PBF_ERROR_NOT_FOUND, "the solver has 0 drains");
  assert_fails(pbf_get_in_out(s, NULL), bad, "in_out is null");
  assert_true(test_hash(s) == before);
  pbf_destroy(s);
  assert_int_equal(test_count.live_blocks, 0);
}

/* Saved states with other words where emitters are. */
/* A step has gone through more of them than there are then. */
static void fewer_of_them_are_saved(void **state) {
  pbf_solver *s = tank(2, PBF_FLOAT64, 0);
  pbf_emitter both[2] = {emitter_of(PBF_EMITTER_RECTANGLE), emitter_of(PBF_EMITTER_RECTANGLE)};
  const pbf_volume drain = drain_of(0, 0.2);
  (void)state;
  both[1].position[1] = 0.5;
  assert_ok(pbf_set_emitters(s, 2, both));
  for (uint32_t left = 3; left-- > 0;) { /* at last nothing but the counts of what was */
    unsigned char saved[100000];
    uint64_t size = sizeof saved, before = 0, after = 0;
    assert_ok(pbf_step(s, 2));
    assert_ok(pbf_set_emitters(s, left > 0 ? left - 1 : 0, both));
    assert_ok(pbf_set_drains(s, left > 0, &drain));
    assert_ok(pbf_hash(s, &before));
    assert_ok(pbf_save(s, saved, &size));
    assert_ok(pbf_load(s, saved, size));
    assert_ok(pbf_hash(s, &after));
    assert_int_equal(after, before);
  }
  pbf_destroy(s);
}

static void forged(void **state) {
  (void)state;
  pbf_solver *s = busy(3, PBF_FLOAT32);
  uint64_t size;
  assert_ok(pbf_step(s, 30));
  const uint64_t before = test_hash(s);
  unsigned char *saved = test_save(s, &size);
  uint32_t refused = 0;
  for (uint64_t at = size - 700; at + 8 < size; at += 4) {
    uint32_t word, wild = 0xfffffff1u;
    memcpy(&word, saved + at, sizeof word);
    memcpy(saved + at, &wild, sizeof wild);
    test_seal(saved, size);
    const pbf_status status = pbf_load(s, saved, size);
    refused += status == PBF_ERROR_DATA;
    if (status != PBF_OK) assert_int_equal(status, PBF_ERROR_DATA);
    memcpy(saved + at, &word, sizeof word);
    test_seal(saved, size);
    assert_ok(pbf_load(s, saved, size));
  }
  assert_true(refused > 20 && test_hash(s) == before);
  free(saved);
  pbf_destroy(s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_rate_is_exact),
      cmocka_unit_test(streams_are_lattices),
      cmocka_unit_test(openings_guide),
      cmocka_unit_test(columns_carry_so_much),
      cmocka_unit_test(a_closed_tank_fills),
      cmocka_unit_test(a_channel_keeps_its_level),
      cmocka_unit_test(steps_may_be_divided),
      cmocka_unit_test(jets_keep_their_energy_in_divided_steps),
      cmocka_unit_test(unused),
      cmocka_unit_test(failures),
      cmocka_unit_test(lifetimes),
      cmocka_unit_test(a_full_solver),
      cmocka_unit_test(refusals),
      cmocka_unit_test(fewer_of_them_are_saved),
      cmocka_unit_test(forged),
  };
  return TEST_RUN(tests);
}
