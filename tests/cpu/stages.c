/* The CPU solver against the reference in float64, each combination of stages, on a block in which
 * both find the same neighbours. */
#include "cpu_support.h"
#include "param_table.h"

enum {
  POLY6 = 1,
  SCORR = 2,
  VORTICITY = 4,
  VISCOSITY = 8,
  CHEBYSHEV = 16,
  WALLS = 32,
  COLLIDERS = 64,
  ATTRACTION = 128,
  SLEEP = 256, /* of what is slow in the shear, from the second step on */
  COMBINATIONS = 512
};

/* By an odd number, so that each bit is in every second one, with and without any others. */
static unsigned each(void) { return TEST_INSTRUMENTED ? 5 : test_is_long() ? 1 : 3; }

/* Optional parameters that the bits say, and those that compare otherwise: where a solve ends, and
 * sums that are rounded (api.tolerance, api.deep). */
static const char *const by_bits[] = {
    "attraction", "wall_density",         "scorr_k",     "vorticity",
    "viscosity",  "damping_compensation", "sleep_speed", "angular_momentum_correction"};
static const char *const elsewhere[] = {"tolerance", "pressure_grid"};

#define IS_IN(list, name) is_in(list, sizeof(list) / sizeof *(list), name)
static int is_in(const char *const *list, size_t count, const char *name) {
  for (size_t k = 0; k < count; ++k)
    if (strcmp(list[k], name) == 0) return 1;
  return 0;
}

/* All others are on in every second combination, with or without any one of the bits. */
static void set_others(pbf_params *params, unsigned bits) {
  for (int k = 0; k < TABLE_PARAMS; ++k) {
    const table_param *param = &table_params[k];
    int is_set = IS_IN(by_bits, param->name) || IS_IN(elsewhere, param->name);
    if (param->usual == 0 || is_set || params->solver < param->min_solver) continue;
    if (__builtin_parity(bits)) table_put(params, param, 0, param->usual);
  }
}

static pbf_params params_with(unsigned bits) {
  pbf_params params = cpu_block_params();
  params.kernel = bits & POLY6 ? PBF_KERNEL_POLY6_SPIKY : PBF_KERNEL_WENDLAND_C2;
  params.scorr_k = bits & SCORR ? 0.02 : 0;
  params.vorticity = bits & VORTICITY ? 0.1 : 0;
  params.viscosity = bits & VISCOSITY ? 0.1 : 0;
  params.solver = bits & CHEBYSHEV ? PBF_SOLVER_CHEBYSHEV : PBF_SOLVER_JACOBI;
  params.cohesion = bits & CHEBYSHEV && bits & SCORR ? 0 : 0.5;
  params.damping_compensation = (bits & CHEBYSHEV) && (bits & ATTRACTION) ? 0.7 : 0;
  params.angular_momentum_correction = (bits & CHEBYSHEV) && (bits & VISCOSITY) ? 0.8 : 0;
  params.wall_density = bits & WALLS ? 1 : 0;
  params.collide = bits & COLLIDERS ? PBF_COLLIDE_IN_ITERATION : 5;
  params.attraction = bits & ATTRACTION ? 2 : 0;
  params.wall_velocity[PBF_WALL_Y_MIN] = 0.1;
  params.sleep_speed = bits & SLEEP ? 0.08 : 0;
  params.sleep_time = 1e-4;
  params.loads = bits & WALLS ? 1 : 0;
  params.prestabilization = 0; /* many iterations, in which roundings grow apart */
  set_others(&params, bits);
  return params;
}

/* All four shapes touch the lowest layer, at y = 0.03, and push it by a hundredth of a spacing. */
static void set_colliders(pbf_solver *solver) {
  static const double below[4] = {0, 0.06, 0.12, 0.05};
  pbf_collider colliders[4];
  for (uint32_t shape = 0; shape < 4; ++shape) {
    pbf_collider *c = &colliders[shape];
    assert_ok(pbf_collider_init(c, sizeof *c, shape));
    c->radius = c->half_length = 0.06;
    for (int k = 0; k < 3; ++k) c->half_extents[k] = 0.05, c->position[k] = 0.2 * shape - 0.08;
    c->position[1] = 0.0302 - below[shape];
    c->velocity[0] = 0.1;
    c->angular_velocity[2] = 0.01;
  }
  colliders[PBF_COLLIDER_PLANE].position[1] = 0.0299;
  assert_ok(pbf_set_colliders(solver, 4, colliders));
}

static pbf_solver *run(const char *backend, const cpu_block *block, uint32_t precision,
                       unsigned bits) {
  pbf_params params = params_with(bits);
  pbf_desc desc = cpu_desc(backend, block->dimension, precision, block->count, 2);
  pbf_solver *solver = test_create(&desc, &params);
  if (bits & COLLIDERS) set_colliders(solver);
  /* The last ones come, with walls, among others that a step has moved: an overlap. */
  const uint32_t late = bits & WALLS ? 8 : 0, early = block->count - late;
  cpu_add(solver, precision, block->dimension, early, block->x, block->v);
  assert_ok(pbf_step(solver, 1));
  if (late) {
    const uint64_t at = (uint64_t)early * block->dimension;
    cpu_add(solver, precision, block->dimension, late, block->x + at, block->v + at);
  }
  assert_ok(pbf_step(solver, 2));
  return solver;
}

/* The stages of the table, and which of them some combination has run. */
static const char *const stages[] = {
#define PBF_STAGE(ID, name, feature, times, launches) name,
#include "physics/stages.def"
};
enum { STAGES = sizeof stages / sizeof *stages };
static int has_run[STAGES];

static void note_stages(pbf_solver *solver) {
  pbf_plan plan = {.struct_size = sizeof plan};
  assert_ok(pbf_get_plan(solver, &plan));
  for (uint32_t k = 0; k < plan.stage_count; ++k)
    for (int stage = 0; stage < STAGES; ++stage)
      has_run[stage] |= strcmp(stages[stage], plan.stages[k].name) == 0;
}

static double worst_x, worst_v, worst_rho;
static unsigned combinations, combinations_asleep; /* all; those with particles asleep */

/* Confinement divides by the size of a gradient, however small: rounding shows more there. */
static double max_velocity(unsigned bits, double most) {
  return (bits & VORTICITY ? 50 : 2) * most / 2e-4;
}

static uint32_t asleep_in(pbf_solver *solver) {
  pbf_stats stats = {.struct_size = sizeof stats};
  assert_ok(pbf_get_stats(solver, &stats));
  return stats.asleep;
}

static void compare(const cpu_block *block, uint32_t precision, unsigned bits, double most) {
  pbf_solver *expected = run("reference", block, PBF_FLOAT64, bits);
  pbf_solver *found = run("serial", block, precision, bits);
  double x = cpu_difference(expected, found, PBF_FIELD_POSITION);
  double v = cpu_difference(expected, found, PBF_FIELD_VELOCITY);
  double rho = cpu_difference(expected, found, PBF_FIELD_DENSITY);
  if (!(x < most && v < max_velocity(bits, most) && rho < 200 * most))
    print_error("%ud, f%u, stages %u: x %g, v %g, density %g\n", block->dimension, 8 * precision,
                bits, x, v, rho);
  assert_true(x < most);
  assert_true(v < max_velocity(bits, most));
  assert_true(rho < 200 * most);
  assert_int_equal(asleep_in(expected), asleep_in(found));
  ++combinations;
  combinations_asleep += asleep_in(found) > 0;
  note_stages(found);
  assert_true(asleep_in(found) < block->count);
  worst_x = fmax(worst_x, x);
  worst_v = fmax(worst_v, v);
  worst_rho = fmax(worst_rho, rho);
  pbf_destroy(expected);
  pbf_destroy(found);
}

static void compare_all(uint32_t precision, double most, unsigned below, unsigned step) {
  worst_x = worst_v = worst_rho = 0;
  for (uint32_t dimension = 2; dimension <= 3; ++dimension) {
    if (!test_has_kind(dimension, precision) || !test_has_kind(dimension, PBF_FLOAT64)) continue;
    cpu_block block = cpu_make_block(dimension);
    for (unsigned bits = 0; bits < below; bits += step) compare(&block, precision, bits, most);
    cpu_free_block(&block);
  }
  print_message("float%u: x %g, v %g, density %g\n", 8 * precision, worst_x, worst_v, worst_rho);
}

/* A particle that touches a collider's surface has a normal that rounding turns: hence not 1e-15.
 */
static void stages_in_float64(void **state) {
  (void)state;
  compare_all(PBF_FLOAT64, 1e-14, COMBINATIONS, each());
  assert_true(combinations_asleep > combinations / 4);
}

/* But for those of parameters that compare elsewhere. */
static void every_stage_has_run(void **state) {
  (void)state;
  for (int stage = 0; stage < STAGES; ++stage)
    if (!has_run[stage] && strcmp(stages[stage], "pressure grid") != 0)
      fail_msg("no combination runs the stage \"%s\"", stages[stage]);
}

/* Without sleep: rounding decides whether a particle is slow enough. */
static void stages_in_float32(void **state) {
  (void)state;
  compare_all(PBF_FLOAT32, 2e-6, SLEEP, TEST_INSTRUMENTED ? 25 : 5);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(stages_in_float64),
      cmocka_unit_test(stages_in_float32),
      cmocka_unit_test(every_stage_has_run),
  };
  return TEST_RUN(tests);
}
