/* Phases as they are held: they follow their particles wherever these go, change no bit where they
 * are alike, and what they can't be is refused. */
#include "phase_scene.h"

#include <pbf/emit.h>

/* ---- One step -------------------------------------------------------------------------------- */

/* Fluids mixed particle by particle, under a grid: moved as the reference moves them. */
static void check_step(uint32_t dimension, uint32_t precision) {
  const uint32_t size[3] = {8, 16, dimension == 3 ? 8 : 1};
  const double density[2] = {1, 0.5}, most = precision == PBF_FLOAT64 ? 1e-8 : 1e-4;
  pbf_params params = params_of(size, 1.2);
  if (!test_has_reference(dimension, precision)) return;
  params.prestabilization = 0;
  params.iterations = 1; /* pairs of later ones are those of the prediction on some backends */
  fluid f = fluid_of(dimension, precision, &params, size, 0.3, density, mixed);
  other_backend = "reference";
  fluid right = fluid_of(dimension, precision, &params, size, 0.3, density, mixed);
  other_backend = NULL;
  assert_ok(pbf_step(f.solver, 1));
  assert_ok(pbf_step(right.solver, 1));
  look(&f);
  look(&right);
  double off = 0;
  for (uint32_t i = 0; i < f.count * dimension; ++i)
    off = fmax(off, fabs(f.x[i] - right.x[i]) / spacing);
  destroy(&f);
  destroy(&right);
  if (!(off < most)) fail_msg("%uD, float%u: off by %g d", dimension, 8 * precision, off);
}

static void steps_are_the_references(void **state) {
  (void)state;
  test_for_each_kind(check_step);
}

/* ---- Bits ------------------------------------------------------------------------------------ */

static void *state_of(pbf_solver *solver, uint32_t count, uint32_t dimension, uint32_t precision) {
  const size_t bytes = (size_t)count * dimension * precision;
  char *values = calloc(2, bytes);
  assert_non_null(values);
  assert_ok(pbf_get_positions(solver, 0, count, values));
  assert_ok(pbf_get_velocities(solver, 0, count, values + bytes));
  return values;
}

/* `phases` 0: none; 1: alike, which the backend is not told; 2: of one mass but not one viscosity,
 * of which there is none, so that all goes by masses, each 1. */
static void *state_with(uint32_t dimension, uint32_t precision, int phases) {
  const uint32_t size[3] = {8, 12, dimension == 3 ? 6 : 1};
  const double density[2] = {1, 1};
  pbf_params params = params_of(size, 1);
  params.domain_max[0] += 0.3;
  params.shear_stress_correction = 0.5;
  params.pressure_grid = 2;
  params.damping_compensation = 0.5;
  params.loads = 1;
  fluid f = fluid_of(dimension, precision, &params, size, 0.2, density, mixed);
  if (phases == 2) {
    set_phases(f.solver, 1, 1, 0.5);
  } else if (phases == 0) {
    memset(f.phase, 0, f.count * sizeof *f.phase);
    assert_ok(pbf_set_particle_phases(f.solver, 0, f.count, f.phase));
    assert_ok(pbf_set_phases(f.solver, 0, NULL));
  }
  assert_ok(pbf_step(f.solver, 30));
  void *values = state_of(f.solver, f.count, dimension, precision);
  destroy(&f);
  return values;
}

static void check_bits(uint32_t dimension, uint32_t precision) {
  const size_t bytes = (size_t)2 * 8 * 12 * (dimension == 3 ? 6 : 1) * dimension * precision;
  void *without = state_with(dimension, precision, 0);
  for (int phases = 1; phases <= 2; ++phases) {
    if (phases == 2 && strcmp(test_backend(), "cuda") == 0) continue; /* another kernel may serve */
    void *with = state_with(dimension, precision, phases);
    if (memcmp(with, without, bytes) != 0)
      fail_msg("%uD, float%u: other bits with phases %d", dimension, 8 * precision, phases);
    free(with);
  }
  free(without);
}

static void one_fluid_keeps_its_bits(void **state) {
  (void)state;
  test_for_each_kind(check_bits);
}

/* ---- In and out ------------------------------------------------------------------------------ */

static void expect_phases(pbf_solver *solver, uint32_t count, const uint32_t *expected) {
  uint32_t phases[16], there;
  assert_ok(pbf_get_count(solver, &there));
  assert_int_equal(there, count);
  assert_ok(pbf_get_particle_phases(solver, 0, count, phases));
  for (uint32_t i = 0; i < count; ++i) assert_int_equal(phases[i], expected[i]);
}

/* Eight particles of the phases 0, 1, 0, 1, … */
static pbf_solver *eight(uint32_t dimension, uint32_t precision) {
  const uint32_t phases[8] = {0, 1, 0, 1, 0, 1, 0, 1};
  pbf_solver *solver = test_filled(dimension, precision, 8, 16);
  set_phases(solver, 1, 0.1, 1);
  assert_ok(pbf_set_particle_phases(solver, 0, 8, phases));
  expect_phases(solver, 8, phases);
  return solver;
}

/* Phases stay with particles that others are removed between, new ones are of phase 0, and a state
 * that is saved goes on with the same bits. */
static void check_rows(uint32_t dimension, uint32_t precision) {
  pbf_solver *solver = eight(dimension, precision), *other;
  const uint32_t removed[3] = {0, 3, 6}, left[5] = {1, 0, 0, 1, 1}, more[6] = {1, 0, 0, 1, 1, 0};
  const uint32_t one = 1;
  uint64_t size;
  assert_ok(pbf_step(solver, 3));
  assert_ok(pbf_remove_particles(solver, 3, removed));
  expect_phases(solver, 5, left);
  void *place = test_lattice(dimension, precision, 1);
  assert_ok(pbf_add_particles(solver, 1, place, NULL, NULL));
  free(place);
  expect_phases(solver, 6, more);
  assert_ok(pbf_set_particle_phases(solver, 5, 1, &one));
  void *saved = test_save(solver, &size);
  other = test_filled(dimension, precision, 2, 16);
  assert_ok(pbf_load(other, saved, size));
  assert_true(test_hash(other) == test_hash(solver));
  uint32_t count;
  assert_ok(pbf_get_phase_count(other, &count));
  assert_int_equal(count, 2);
  assert_ok(pbf_step(solver, 20));
  assert_ok(pbf_step(other, 20));
  assert_true(test_hash(other) == test_hash(solver));
  assert_ok(pbf_set_particle_phases(other, 0, 1, (const uint32_t[]){0}));
  assert_false(test_hash(other) == test_hash(solver));
  free(saved);
  pbf_destroy(other);
  pbf_destroy(solver);
}

/* Where they press on each other, the backend's are the same as those of a state that is loaded. */
static void check_pressed(uint32_t dimension, uint32_t precision) {
  const uint32_t size[3] = {6, 6, dimension == 3 ? 6 : 1};
  const double density[2] = {1, 0.1};
  const pbf_params params = params_of(size, 1);
  fluid f = fluid_of(dimension, precision, &params, size, 0.2, density, mixed);
  uint32_t removed[216], count = 0;
  uint64_t bytes;
  for (uint32_t id = 0; id < f.count; id += 3) removed[count++] = id;
  assert_ok(pbf_step(f.solver, 2));
  assert_ok(pbf_remove_particles(f.solver, count, removed));
  void *saved = test_save(f.solver, &bytes);
  const pbf_desc desc = test_desc(dimension, precision, f.count);
  pbf_solver *other = test_create(&desc, &params);
  assert_ok(pbf_load(other, saved, bytes));
  assert_ok(pbf_step(f.solver, 20));
  assert_ok(pbf_step(other, 20));
  assert_true(test_hash(other) == test_hash(f.solver));
  free(saved);
  pbf_destroy(other);
  destroy(&f);
}

static void phases_follow_their_particles(void **state) {
  (void)state;
  test_for_each_kind(check_rows);
  test_for_each_kind(check_pressed);
}

/* What an emitter emits is of its phase, and weighs as much as that. */
static void check_emitter(uint32_t dimension, uint32_t precision) {
  const uint32_t size[3] = {12, 4, dimension == 3 ? 12 : 1};
  const double density[2] = {1, 0.1};
  pbf_emitter emitter;
  pbf_collider_load walls[6];
  pbf_params params = params_of(size, 1);
  params.loads = 1;
  const pbf_desc desc = test_desc(dimension, precision, 2000);
  pbf_solver *solver = test_create(&desc, &params);
  set_phases(solver, density[0], density[1], 1);
  assert_ok(pbf_emitter_init(&emitter, sizeof emitter, PBF_EMITTER_RECTANGLE));
  emitter.position[0] = 0.3;
  emitter.position[1] = 0.8;
  emitter.position[2] = dimension == 3 ? 0.3 : 0;
  emitter.half_width = emitter.half_height = 2 * spacing;
  emitter.phase = 1;
  assert_ok(pbf_set_emitters(solver, 1, &emitter));
  assert_ok(pbf_step(solver, 60));
  emitter.rate = 1e-9;
  assert_ok(pbf_set_emitters(solver, 1, &emitter));
  assert_ok(pbf_step(solver, 240));
  uint32_t count, phases[2000];
  assert_ok(pbf_get_count(solver, &count));
  assert_true(count > 20 && count < 2000);
  assert_ok(pbf_get_particle_phases(solver, 0, count, phases));
  for (uint32_t i = 0; i < count; ++i) assert_int_equal(phases[i], 1);
  for (int k = 0; k < 6; ++k) walls[k].struct_size = sizeof walls[k];
  assert_ok(pbf_get_wall_loads(solver, 2 * dimension, walls));
  assert_ok(pbf_step(solver, 120));
  assert_ok(pbf_get_wall_loads(solver, 2 * dimension, walls));
  const double weight = count * density[1] * pow(spacing, dimension) * gravity;
  const double carried = -walls[PBF_WALL_Y_MIN].impulse_sum[1] / walls[PBF_WALL_Y_MIN].time_sum;
  if (!(fabs(carried / weight - 1) < 0.01))
    fail_msg("%uD, float%u: the floor carries %g of what has been emitted", dimension,
             8 * precision, carried / weight);
  pbf_destroy(solver);
}

static void emitters_have_phases(void **state) {
  (void)state;
  test_for_each_kind(check_emitter);
}

/* ---- Refusals -------------------------------------------------------------------------------- */

static void refuse_phase(pbf_solver *solver, double density, double viscosity, pbf_status status,
                         const char *words) {
  pbf_phase phases[2];
  for (int k = 0; k < 2; ++k) assert_ok(pbf_phase_init(&phases[k], sizeof phases[k]));
  phases[1].rest_density = density;
  phases[1].viscosity = viscosity;
  assert_fails(pbf_set_phases(solver, 2, phases), status, words);
}

static void refuse_param(pbf_solver *solver, size_t offset, double value, const char *words) {
  pbf_params params = {.struct_size = sizeof params};
  assert_ok(pbf_get_params(solver, &params));
  memcpy((char *)&params + offset, &value, sizeof value);
  assert_fails(pbf_set_params(solver, &params), PBF_ERROR_UNSUPPORTED, words);
}

/* And nothing changes. */
static void refusals(void **state) {
  pbf_solver *solver = eight(3, PBF_FLOAT32);
  const uint32_t two = 2;
  const uint64_t before = test_hash(solver);
  pbf_phase phase, many[9];
  (void)state;
  assert_fails(pbf_phase_init(NULL, sizeof phase), PBF_ERROR_INVALID_ARGUMENT, "phase is null");
  assert_fails(pbf_phase_init(&phase, 3), PBF_ERROR_STRUCT_SIZE, "pbf_phase");
  for (int k = 0; k < 9; ++k) assert_ok(pbf_phase_init(&many[k], sizeof many[k]));
  assert_fails(pbf_set_phases(solver, 9, many), PBF_ERROR_INVALID_ARGUMENT, "at most 8");
  assert_fails(pbf_set_phases(solver, 2, NULL), PBF_ERROR_INVALID_ARGUMENT, "phases is null");
  assert_fails(pbf_set_phases(solver, 1, many), PBF_ERROR_INVALID_ARGUMENT, "id 1 is of phase 1");
  assert_fails(pbf_set_phases(solver, 0, NULL), PBF_ERROR_INVALID_ARGUMENT, "of phase 1");
  many[1].struct_size = 40;
  assert_fails(pbf_set_phases(solver, 2, many), PBF_ERROR_STRUCT_SIZE, "that of phases[0]");
  refuse_phase(solver, 0, 1, PBF_ERROR_INVALID_ARGUMENT, "phases[1].rest_density");
  refuse_phase(solver, NAN, 1, PBF_ERROR_INVALID_ARGUMENT, "phases[1].rest_density");
  refuse_phase(solver, 1001, 1, PBF_ERROR_INVALID_ARGUMENT, "0.001 … 1000");
  refuse_phase(solver, 1, 1.5, PBF_ERROR_INVALID_ARGUMENT, "phases[1].viscosity");
  many[0].rest_density = 0.5;
  many[1].struct_size = sizeof many[1];
  many[1].rest_density = 600;
  assert_fails(pbf_set_phases(solver, 2, many), PBF_ERROR_INVALID_ARGUMENT, "1000 times as heavy");
  assert_fails(pbf_set_particle_phases(solver, 0, 1, &two), PBF_ERROR_INVALID_ARGUMENT,
               "below the number of phases, 2");
  assert_fails(pbf_set_particle_phases(solver, 8, 1, &two), PBF_ERROR_INVALID_ARGUMENT, "first is");
  assert_fails(pbf_set_particle_phases(solver, 0, 1, NULL), PBF_ERROR_INVALID_ARGUMENT, "phases");
  phase.struct_size = sizeof phase;
  assert_fails(pbf_get_phase(solver, 2, &phase), PBF_ERROR_NOT_FOUND, "2 phases");
  assert_ok(pbf_get_phase(solver, 1, &phase));
  assert_true(phase.rest_density == 0.1);
  refuse_param(solver, offsetof(pbf_params, pressure_grid), 2,
               "pressure_grid is 2 and a phase has");
  refuse_param(solver, offsetof(pbf_params, surface_tension), 1e-4, "and phases differ");
  pbf_emitter emitter;
  assert_ok(pbf_emitter_init(&emitter, sizeof emitter, PBF_EMITTER_DISC));
  for (int k = 0; k < 3; ++k) emitter.position[k] = 0.5;
  emitter.radius = 0.1;
  emitter.phase = 2;
  assert_fails(pbf_set_emitters(solver, 1, &emitter), PBF_ERROR_INVALID_ARGUMENT,
               "emitters[0].phase is 2");
  assert_true(test_hash(solver) == before);
  pbf_destroy(solver);
}

/* Each byte of a saved state's phases, changed: what is not refused is another sound state. */
static void forged(void **state) {
  pbf_solver *solver = eight(3, PBF_FLOAT32);
  const uint64_t before = test_hash(solver);
  uint64_t size;
  unsigned char *saved = test_save(solver, &size);
  uint32_t refused = 0;
  (void)state;
  for (uint64_t at = size - 80; at < size - 8; ++at) {
    for (int bit = 0; bit < 8; bit += 7) {
      saved[at] ^= (unsigned char)(1 << bit);
      test_seal(saved, size);
      pbf_solver *other = test_filled(3, PBF_FLOAT32, 3, 16);
      if (pbf_load(other, saved, size) == PBF_OK)
        assert_ok(pbf_step(other, 1));
      else
        ++refused;
      pbf_destroy(other);
      saved[at] ^= (unsigned char)(1 << bit);
    }
  }
  assert_true(refused > 20 && test_hash(solver) == before);
  free(saved);
  pbf_destroy(solver);
}

/* The stub knows no masses: phases that are alike need none, others it refuses. */
static void backends_without(void **state) {
  pbf_solver *solver = test_filled(2, PBF_FLOAT32, 4, 8);
  pbf_phase phases[2];
  const uint32_t numbers[4] = {1, 0, 1, 0};
  (void)state;
  for (int k = 0; k < 2; ++k) assert_ok(pbf_phase_init(&phases[k], sizeof phases[k]));
  assert_ok(pbf_set_phases(solver, 2, phases));
  assert_ok(pbf_set_particle_phases(solver, 0, 4, numbers));
  expect_phases(solver, 4, numbers);
  phases[0].rest_density = 2;
  assert_fails(pbf_set_phases(solver, 2, phases), PBF_ERROR_UNSUPPORTED,
               "has no phases that differ");
  expect_phases(solver, 4, numbers);
  pbf_destroy(solver);
}

int main(void) {
  const struct CMUnitTest of_stub[] = {cmocka_unit_test(backends_without)};
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(steps_are_the_references),
      cmocka_unit_test(one_fluid_keeps_its_bits),
      cmocka_unit_test(phases_follow_their_particles),
      cmocka_unit_test(emitters_have_phases),
      cmocka_unit_test(refusals),
      cmocka_unit_test(forged),
  };
  return test_is_stub() ? TEST_RUN(of_stub) : TEST_RUN(tests);
}
