/* Two numbers at once, each at an end of what is accepted of it alone, in parameters, colliders,
 * emitters, reservoirs, phases and spray: refused with a sentence that names one of them, or the
 * steps that follow end, with numbers, and what is saved then is loaded and goes on with the same
 * bits. Ends are found by trying, so that no table has to repeat what lib/ checks. */
#include <float.h>
#include <stdio.h>
#include <time.h>

#include <pbf/all.h>

#include "support.h"

enum { COUNT = 40, CAPACITY = 120, MOST_SETTINGS = 1024, MOST_VALUES = 6 };

/* All that two numbers are put into. */
typedef struct scene {
  pbf_params params;
  pbf_collider collider;
  pbf_emitter emitter;
  pbf_reservoir reservoir;
  pbf_volume drain;
  pbf_phase phases[2];
  pbf_diffuse_desc diffuse;
} scene;

typedef enum part { PARAMS, COLLIDER, EMITTER, RESERVOIR, DRAIN, PHASE, DIFFUSE } part;

typedef struct number {
  part part;
  const char *name;
  size_t offset; /* in a scene */
  int is_count;
} number;

#define IN(part, member, field) \
  { part, #field, offsetof(scene, member.field), 0 }
#define COUNT_IN(part, member, field) \
  { part, #field, offsetof(scene, member.field), 1 }

static const number numbers[] = {
#define PBF_PARAM_INTEGER(offset, name, initial, type, min, max, hint, when, feature, doc) \
  COUNT_IN(PARAMS, params, name),
#define PBF_PARAM_REAL(offset, name, initial, range, when, min_solver, low, high, usual, feature, \
                       projected, unit, doc)                                                      \
  IN(PARAMS, params, name),
#define PBF_PARAM_REALS(offset, name, count, initial, low, high, projected, unit, doc) \
  {PARAMS, #name, offsetof(scene, params.name[count / 3]), 0},
#include "physics/params.def"
    COUNT_IN(COLLIDER, collider, shape),
    COUNT_IN(COLLIDER, collider, inverted),
    COUNT_IN(COLLIDER, collider, path),
    IN(COLLIDER, collider, position[1]),
    IN(COLLIDER, collider, velocity[1]),
    IN(COLLIDER, collider, angular_velocity[2]),
    IN(COLLIDER, collider, axis[0]),
    IN(COLLIDER, collider, half_extents[0]),
    IN(COLLIDER, collider, radius),
    IN(COLLIDER, collider, half_length),
    IN(COLLIDER, collider, half_extents_rate[0]),
    IN(COLLIDER, collider, radius_rate),
    IN(COLLIDER, collider, half_length_rate),
    IN(COLLIDER, collider, duration),
    IN(COLLIDER, collider, scale),
    IN(COLLIDER, collider, scale_rate),
    IN(COLLIDER, collider, friction),
    IN(COLLIDER, collider, static_friction),
    IN(COLLIDER, collider, no_slip),
    IN(COLLIDER, collider, adhesion),
    COUNT_IN(EMITTER, emitter, shape),
    COUNT_IN(EMITTER, emitter, recycle),
    IN(EMITTER, emitter, position[1]),
    IN(EMITTER, emitter, velocity[1]),
    IN(EMITTER, emitter, across[0]),
    IN(EMITTER, emitter, half_width),
    IN(EMITTER, emitter, half_height),
    IN(EMITTER, emitter, radius),
    IN(EMITTER, emitter, rate),
    IN(EMITTER, emitter, jitter),
    IN(EMITTER, emitter, lifetime),
    IN(RESERVOIR, reservoir, position[1]),
    IN(RESERVOIR, reservoir, half_extents[0]),
    IN(RESERVOIR, reservoir, half_extents[1]),
    IN(RESERVOIR, reservoir, depth),
    IN(RESERVOIR, reservoir, pressure),
    COUNT_IN(DRAIN, drain, shape),
    IN(DRAIN, drain, position[0]),
    IN(DRAIN, drain, half_extents[0]),
    IN(DRAIN, drain, axis[0]),
    IN(DRAIN, drain, radius),
    IN(DRAIN, drain, half_length),
    IN(PHASE, phases[0], rest_density),
    IN(PHASE, phases[1], rest_density),
    IN(PHASE, phases[1], viscosity),
    COUNT_IN(DIFFUSE, diffuse, capacity),
    COUNT_IN(DIFFUSE, diffuse, interval),
    COUNT_IN(DIFFUSE, diffuse, foam_neighbors),
    COUNT_IN(DIFFUSE, diffuse, bubble_neighbors),
    IN(DIFFUSE, diffuse, trapped_air_min),
    IN(DIFFUSE, diffuse, trapped_air_max),
    IN(DIFFUSE, diffuse, wave_crest_min),
    IN(DIFFUSE, diffuse, wave_crest_max),
    IN(DIFFUSE, diffuse, energy_min),
    IN(DIFFUSE, diffuse, energy_max),
    IN(DIFFUSE, diffuse, trapped_air_rate),
    IN(DIFFUSE, diffuse, wave_crest_rate),
    IN(DIFFUSE, diffuse, lifetime_min),
    IN(DIFFUSE, diffuse, lifetime_max),
    IN(DIFFUSE, diffuse, buoyancy),
    IN(DIFFUSE, diffuse, bubble_drag),
    IN(DIFFUSE, diffuse, spray_drag),
    IN(DIFFUSE, diffuse, scatter),
};
enum { NUMBERS = sizeof numbers / sizeof numbers[0] };

typedef struct setting {
  const number *number;
  double value;
} setting;

typedef struct kind {
  uint32_t dimension, precision;
  pbf_shape *geometry;
} kind;

/* ---- A scene ----------------------------------------------------------------------------------
 */

static pbf_shape *a_wedge(uint32_t dimension) {
  static const double points[] = {-0.15, -0.1, -0.1, 0.15, -0.1, -0.1, 0, 0.15, 0, 0, -0.1, 0.15};
  static const double flat[] = {-0.15, -0.1, 0.15, -0.1, 0, 0.15};
  const pbf_hull_desc hull = {.struct_size = sizeof hull,
                              .dimension = dimension,
                              .point_count = dimension + 1,
                              .points = dimension == 3 ? points : flat,
                              .cell = 0.025};
  pbf_shape *shape = NULL;
  assert_ok(pbf_shape_from_points(&hull, &shape));
  return shape;
}

static void put(scene *s, const setting *set, const kind *k) {
  char *at = (char *)s + set->number->offset;
  if (set->number->is_count) {
    const uint32_t whole = (uint32_t)set->value;
    memcpy(at, &whole, sizeof whole);
  } else {
    memcpy(at, &set->value, sizeof set->value);
  }
  s->collider.geometry = s->collider.shape == PBF_COLLIDER_SHAPE ? k->geometry : NULL;
}

/* What `usual` adds is there where a number is of it: a step has less to do. */
static scene usual_scene(pbf_solver *solver, uint32_t shape, const kind *k) {
  scene s = {.params = test_params()};
  assert_ok(pbf_collider_init(&s.collider, sizeof s.collider, shape));
  s.collider.position[0] = s.collider.position[1] = s.collider.position[2] = 0.35;
  s.collider.radius = s.collider.half_length = 0.1;
  s.collider.scale = 1;
  for (int axis = 0; axis < 3; ++axis) s.collider.half_extents[axis] = 0.1;
  s.collider.geometry = shape == PBF_COLLIDER_SHAPE ? k->geometry : NULL;
  assert_ok(pbf_emitter_init(&s.emitter, sizeof s.emitter, PBF_EMITTER_RECTANGLE));
  s.emitter.position[0] = s.emitter.position[1] = s.emitter.position[2] = 0.7;
  s.emitter.half_width = s.emitter.half_height = s.emitter.radius = 0.1;
  assert_ok(pbf_reservoir_init(&s.reservoir, sizeof s.reservoir));
  s.reservoir.position[0] = s.reservoir.position[1] = s.reservoir.position[2] = 0.15;
  s.reservoir.half_extents[0] = s.reservoir.half_extents[1] = s.reservoir.half_extents[2] = 0.1;
  s.reservoir.depth = 0.1;
  assert_ok(pbf_volume_init(&s.drain, sizeof s.drain, PBF_VOLUME_SPHERE));
  s.drain.position[0] = s.drain.position[1] = s.drain.position[2] = 0.6;
  s.drain.half_extents[0] = s.drain.half_extents[1] = s.drain.half_extents[2] = 0.1;
  s.drain.radius = s.drain.half_length = 0.1;
  for (int i = 0; i < 2; ++i) assert_ok(pbf_phase_init(&s.phases[i], sizeof s.phases[i]));
  s.phases[1].rest_density = 0.8;
  assert_ok(pbf_diffuse_init(solver, &s.diffuse, sizeof s.diffuse));
  s.diffuse.capacity = 50;
  return s;
}

static pbf_solver *filled(const kind *k) {
  pbf_desc desc = test_desc(k->dimension, k->precision, CAPACITY);
  desc.threads = 1;
  pbf_solver *solver = test_create(&desc, NULL);
  void *x = test_lattice(k->dimension, k->precision, COUNT);
  assert_ok(pbf_add_particles(solver, COUNT, x, NULL, NULL));
  free(x);
  return solver;
}

static pbf_status set_part(pbf_solver *solver, part which, const scene *s) {
  switch (which) {
    case PARAMS:
      return pbf_set_params(solver, &s->params);
    case COLLIDER:
      return pbf_set_colliders(solver, 1, &s->collider);
    case EMITTER:
      return pbf_set_emitters(solver, 1, &s->emitter);
    case RESERVOIR:
      return pbf_set_reservoirs(solver, 1, &s->reservoir);
    case DRAIN:
      return pbf_set_drains(solver, 1, &s->drain);
    case PHASE:
      return pbf_set_phases(solver, 2, s->phases);
    case DIFFUSE:
      return pbf_set_diffuse(solver, &s->diffuse);
  }
  return PBF_OK;
}

/* ---- Ends of what is accepted of a number alone -----------------------------------------------
 */

static int accepts(pbf_solver *solver, const kind *k, const number *n, double value) {
  scene s = usual_scene(solver, PBF_COLLIDER_BOX, k);
  put(&s, &(setting){n, value}, k);
  return set_part(solver, n->part, &s) == PBF_OK;
}

/* Of sizes between one that is accepted and one that is not, the last that is, to a percent. */
static double last_accepted(pbf_solver *solver, const kind *k, const number *n, double in,
                            double out) {
  for (int i = 0; i < 24 && fabs(log(in / out)) > 0.01; ++i) {
    const double between = copysign(sqrt(fabs(in)) * sqrt(fabs(out)), in);
    if (accepts(solver, k, n, between))
      in = between;
    else
      out = between;
  }
  return in;
}

/* The largest and the smallest size of one sign. */
static int add_ends(pbf_solver *solver, const kind *k, const number *n, double sign,
                    double *values) {
  static const double sizes[] = {5e-324, 1e-300, 1e-150, 1e-75, 1e-44, 1e-38, 1e-30,
                                 1e-20,  1e-12,  1e-8,   1e-6,  1e-4,  1e-3,  0.01,
                                 0.03,   0.1,    0.3,    0.5,   1,     3,     30,
                                 1e3,    1e6,    1e12,   1e18,  3e38,  1e75,  1e150};
  enum { SIZES = sizeof sizes / sizeof sizes[0] };
  int least = SIZES, most = -1, count = 0;
  for (int i = 0; i < SIZES; ++i) {
    if (!accepts(solver, k, n, sign * sizes[i])) continue;
    if (i < least) least = i;
    most = i;
  }
  if (most < 0) return 0;
  values[count++] = most + 1 < SIZES
                        ? last_accepted(solver, k, n, sign * sizes[most], sign * sizes[most + 1])
                        : sign * sizes[most];
  values[count++] = least > 0
                        ? last_accepted(solver, k, n, sign * sizes[least], sign * sizes[least - 1])
                        : sign * sizes[least];
  return count;
}

/* Of as many iterations as may be no step would end. */
static int add_counts(pbf_solver *solver, const kind *k, const number *n, double *values) {
  static const double tried[] = {0, 1, 2, 3, 4, 7, 8, 50, 1000};
  int count = 0;
  double last = -1;
  for (size_t i = 0; i < sizeof tried / sizeof tried[0]; ++i) {
    if (!accepts(solver, k, n, tried[i])) continue;
    last = tried[i];
    if (count < 4) values[count++] = last;
  }
  if (count == 4) values[count++] = last;
  return count;
}

static uint32_t find_settings(const kind *k, setting *settings) {
  uint32_t count = 0;
  for (size_t i = 0; i < NUMBERS; ++i) {
    pbf_solver *solver = filled(k);
    double values[MOST_VALUES];
    int found = 0;
    if (numbers[i].is_count) {
      found = add_counts(solver, k, &numbers[i], values);
    } else {
      if (accepts(solver, k, &numbers[i], 0)) values[found++] = 0;
      found += add_ends(solver, k, &numbers[i], 1, values + found);
      found += add_ends(solver, k, &numbers[i], -1, values + found);
    }
    for (int j = 0; j < found; ++j) {
      assert_true(count < MOST_SETTINGS);
      settings[count++] = (setting){&numbers[i], values[j]};
    }
    pbf_destroy(solver);
  }
  return count;
}

/* ---- A pair -----------------------------------------------------------------------------------
 */

static const setting *pair[2];
static const char *where = "";

static uint32_t wrongs;

/* All of them are told of before the test fails. */
static void wrong(const char *what) {
  print_error("%s = %.17g with %s = %.17g (%s): %s: %s\n", pair[0]->number->name, pair[0]->value,
              pair[1]->number->name, pair[1]->value, where, what, pbf_last_error());
  ++wrongs;
}

/* A wall is where four numbers have it, and what has a place or as many particles as it has room
 * for is by all of its sizes. */
static void names_one(pbf_status status) {
  static const char *const labels[] = {
      [EMITTER] = "emitters[0] ", [RESERVOIR] = "reservoirs[0] ", [DIFFUSE] = ""};
  const char *said = pbf_last_error();
  if (status == PBF_ERROR_OUT_OF_MEMORY || !pbf_last_error()[0]) wrong("refused how?");
  for (int i = 0; i < 2; ++i) {
    char name[64];
    snprintf(name, sizeof name, "%.*s", (int)strcspn(pair[i]->number->name, "["),
             pair[i]->number->name);
    if (strstr(said, name)) return;
    const char *label = labels[pair[i]->number->part];
    if (label && label[0] && strstr(said, label)) return;
    if (strncmp(name, "wall_", 5) == 0 && strstr(said, "params.wall_…")) return;
  }
  wrong("neither is named");
}

static int all_finite(const double *values, size_t count) {
  for (size_t i = 0; i < count; ++i)
    if (!isfinite(values[i])) return 0;
  return 1;
}

static void particles_are_numbers(pbf_solver *solver, const kind *k) {
  double x[3 * CAPACITY], v[3 * CAPACITY];
  unsigned char densities[8 * CAPACITY];
  pbf_stats stats = {.struct_size = sizeof stats};
  uint32_t count = 0;
  assert_ok(pbf_get_count(solver, &count));
  if (count > 0) test_read(solver, k->dimension, k->precision, count, x, v);
  if (!all_finite(x, (size_t)count * k->dimension)) wrong("positions");
  if (!all_finite(v, (size_t)count * k->dimension)) wrong("velocities");
  if (pbf_get_densities(solver, 0, count, densities) != PBF_OK) wrong("densities");
  for (uint32_t i = 0; i < count; ++i)
    if (!isfinite(test_value(densities, i, k->precision))) wrong("densities");
  if (pbf_get_stats(solver, &stats) != PBF_OK) wrong("stats");
  if (!all_finite(stats.center_of_mass, 3) || !isfinite(stats.kinetic_energy) ||
      !isfinite(stats.density_error_max) || !isfinite(stats.speed_max) ||
      !isfinite(stats.density_mean) || isnan(stats.step_limit))
    wrong("stats are no numbers");
}

static void solids_are_numbers(pbf_solver *solver) {
  pbf_collider c = {.struct_size = sizeof c};
  pbf_collider_load load = {.struct_size = sizeof load};
  pbf_params params = {.struct_size = sizeof params};
  if (pbf_get_collider(solver, 0, &c) != PBF_OK) return;
  if (!all_finite(c.position, 3) || !all_finite(c.orientation, 4) || !all_finite(c.velocity, 3) ||
      !isfinite(c.radius) || !all_finite(c.half_extents, 3) || !isfinite(c.scale))
    wrong("a collider is no numbers");
  assert_ok(pbf_get_params(solver, &params));
  if (!params.loads || pbf_get_collider_loads(solver, 1, &load) != PBF_OK) return;
  if (!all_finite(load.impulse, 3) || !all_finite(load.angular_impulse, 3))
    wrong("loads are no numbers");
}

/* A solver that has loaded the state goes on as the one that has saved it. */
static void goes_on_when_loaded(pbf_solver *solver, const kind *k) {
  uint64_t size = 0, again = 0;
  pbf_solver *other = filled(k);
  if (pbf_save(solver, NULL, &size) != PBF_OK) wrong("save");
  void *state = malloc(size), *resaved = malloc(size);
  again = size;
  if (pbf_save(solver, state, &size) != PBF_OK) wrong("save");
  if (pbf_load(other, state, size) != PBF_OK) wrong("load");
  if (test_hash(solver) != test_hash(other)) wrong("hashes after a load");
  if (pbf_save(other, resaved, &again) != PBF_OK || again != size ||
      memcmp(state, resaved, size) != 0)
    wrong("what is saved again differs");
  const pbf_status a = pbf_step(solver, 2), b = pbf_step(other, 2);
  if (a != b) wrong("only one steps");
  if (test_hash(solver) != test_hash(other)) wrong("hashes of steps after a load");
  free(state), free(resaved);
  pbf_destroy(other);
}

static double seconds(void) {
  struct timespec now;
  timespec_get(&now, TIME_UTC);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* 1: both were accepted. */
static int try_pair(const kind *k, uint32_t variant) {
  static const uint32_t shapes[] = {PBF_COLLIDER_BOX, PBF_COLLIDER_SPHERE, PBF_COLLIDER_CAPSULE,
                                    PBF_COLLIDER_SHAPE, PBF_COLLIDER_PLANE};
  pbf_solver *solver = filled(k);
  scene s = usual_scene(solver, shapes[variant % 5], k);
  const int params_last = variant / 5 % 2;
  int needs[DIFFUSE + 1] = {[PARAMS] = 1, [COLLIDER] = 1};
  for (int i = 0; i < 2; ++i) {
    put(&s, pair[i], k);
    needs[pair[i]->number->part] = 1;
  }
  const double begin = seconds();
  pbf_status status = PBF_OK;
  if (variant / 10 % 2) assert_ok(pbf_step(solver, 1));
  for (int which = params_last; which <= DIFFUSE && status == PBF_OK; ++which)
    if (needs[which]) status = set_part(solver, (part)which, &s);
  if (status == PBF_OK && params_last) status = set_part(solver, PARAMS, &s);
  if (status != PBF_OK) names_one(status);
  const int accepted = status == PBF_OK;
  status = pbf_step(solver, 2);
  if (status != PBF_OK && (status != PBF_ERROR_STATE || !pbf_last_error()[0])) wrong("a step");
  particles_are_numbers(solver, k);
  solids_are_numbers(solver);
  goes_on_when_loaded(solver, k);
  particles_are_numbers(solver, k);
  if (seconds() - begin > 60) wrong("more than a minute");
  pbf_destroy(solver);
  return accepted;
}

static int all_pairs;

/* One in 631, other ones for each kind; where all is asked for, one in 11. */
static void pairs_of(uint32_t dimension, uint32_t precision) {
  static setting settings[MOST_SETTINGS];
  const kind k = {dimension, precision, a_wedge(dimension)};
  const uint32_t count = find_settings(&k, settings);
  const uint32_t every = all_pairs ? 1 : test_is_long() && !TEST_INSTRUMENTED ? 11 : 631;
  uint32_t number_of = 0, tried = 0, accepted = 0;
  static char text[32];
  snprintf(text, sizeof text, "%uD float%u", dimension, 8 * precision);
  where = text;
  for (uint32_t i = 0; i < count; ++i)
    for (uint32_t j = i + 1; j < count; ++j) {
      if (settings[i].number == settings[j].number) continue;
      if (++number_of % every != (dimension + precision) % every) continue;
      pair[0] = &settings[i], pair[1] = &settings[j];
      accepted += (uint32_t)try_pair(&k, tried);
      ++tried;
    }
  assert_true(accepted > tried / 3);
  pbf_release_shape(k.geometry);
}

static void pairs(void **state) {
  (void)state;
  if (test_is_stub() || strcmp(test_backend(), "cuda") == 0)
    test_skip("for backends on a CPU: a device would take minutes");
  wrongs = 0;
  test_for_long_kinds(pairs_of);
  assert_int_equal(wrongs, 0);
}

/* `test_api_pairs all` tries all of them, some 75,000 a kind, in a quarter of an hour. */
int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(pairs)};
  all_pairs = argc > 1 && strcmp(argv[1], "all") == 0;
  return TEST_RUN(tests);
}
