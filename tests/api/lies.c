/* A backend that fails or breaks its word: the host keeps its own, whatever the call. */
#include <dlpack/dlpack.h>

#include "support.h"

static void creation(void **state) {
  (void)state;
  static const struct {
    ballistic_lie lie;
    const char *words;
  } lies[] = {{BALLISTIC_NO_SOLVER, "it gave no solver"},
              {BALLISTIC_NO_TABLE, "it gave no table"},
              {BALLISTIC_BAD_TABLE, "no function 'read'"}};
  for (int i = 0; i < 3; ++i) {
    pbf_desc desc = test_desc(3, PBF_FLOAT32, 8);
    pbf_solver *solver = NULL;
    test_stub_control()->lie = lies[i].lie;
    assert_fails(pbf_create(&desc, NULL, &solver), PBF_ERROR_PLUGIN, lies[i].words);
    assert_null(solver);
    assert_int_equal(test_count.live_blocks, 0);
  }
}

static uint64_t steps_of(pbf_solver *s) {
  pbf_info info = {.struct_size = sizeof info};
  assert_ok(pbf_get_info(s, &info));
  return info.step;
}

static void steps(void **state) {
  (void)state;
  ballistic_control *control = test_stub_control();
  pbf_solver *s = test_filled(3, PBF_FLOAT32, 3, 8);
  control->lie = BALLISTIC_TOO_MANY_STEPS;
  assert_fails(pbf_step(s, 4), PBF_ERROR_PLUGIN, "has done 5 of 4 steps");
  assert_int_equal(steps_of(s), 4);
  control->lie = BALLISTIC_TOO_FEW_STEPS;
  assert_fails(pbf_step(s, 4), PBF_ERROR_PLUGIN, "has done 3 of 4 steps");
  assert_int_equal(steps_of(s), 7);
  test_stub_control();
  pbf_destroy(s);
}

/* The steps before the one that failed stand, and the state is that of the last good one. */
static void a_step_that_fails(void **state) {
  (void)state;
  ballistic_control *control = test_stub_control();
  pbf_solver *s = test_filled(3, PBF_FLOAT32, 3, 8), *twin = test_filled(3, PBF_FLOAT32, 3, 8);
  control->calls_until_failure = 3;
  control->failure_status = PBF_ERROR_DEVICE;
  assert_fails(pbf_step(s, 10), PBF_ERROR_DEVICE, "the test ordered this failure");
  assert_int_equal(steps_of(s), 2);
  pbf_info info = {.struct_size = sizeof info};
  assert_ok(pbf_get_info(s, &info));
  assert_true(info.time == 2 * test_params().time_step);
  assert_ok(pbf_step(twin, 2));
  assert_int_equal(test_hash(s), test_hash(twin));
  pbf_destroy(s);
  pbf_destroy(twin);
}

static void views(void **state) {
  (void)state;
  static const struct {
    ballistic_lie lie;
    const char *words;
  } lies[] = {
      {BALLISTIC_VIEW_COUNT, "'count'"},        {BALLISTIC_VIEW_FIELD, "'field'"},
      {BALLISTIC_VIEW_TYPE, "'element_type'"},  {BALLISTIC_VIEW_COMPONENTS, "'components'"},
      {BALLISTIC_VIEW_DEVICE, "'device_type'"}, {BALLISTIC_VIEW_NO_DATA, "'data'"},
      {BALLISTIC_VIEW_NO_IDS, "'ids'"},
  };
  ballistic_control *control = test_stub_control();
  pbf_solver *s = test_filled(3, PBF_FLOAT32, 3, 8);
  pbf_view view = {.struct_size = sizeof view};
  DLManagedTensor *tensor = NULL;
  for (size_t i = 0; i < sizeof lies / sizeof lies[0]; ++i) {
    control->lie = lies[i].lie;
    assert_fails(pbf_map(s, PBF_FIELD_POSITION, &view), PBF_ERROR_PLUGIN, lies[i].words);
    assert_fails(pbf_export_dlpack(s, PBF_FIELD_POSITION, &tensor), PBF_ERROR_PLUGIN,
                 lies[i].words);
  }
  control->lie = BALLISTIC_VIEW_ODD_STRIDE;
  assert_fails(pbf_export_dlpack(s, PBF_FIELD_POSITION, &tensor), PBF_ERROR_UNSUPPORTED, "strides");
  control->lie = BALLISTIC_HONEST;
  assert_ok(pbf_step(s, 1)); /* no view has stayed mapped */
  pbf_destroy(s);
}

static void reports(void **state) {
  (void)state;
  ballistic_control *control = test_stub_control();
  pbf_solver *s = test_filled(3, PBF_FLOAT32, 3, 8);
  pbf_stats stats = {.struct_size = sizeof stats};
  pbf_plan plan = {.struct_size = sizeof plan};
  pbf_info info = {.struct_size = sizeof info};
  control->lie = BALLISTIC_STATS_COUNT;
  assert_fails(pbf_get_stats(s, &stats), PBF_ERROR_PLUGIN, "4 particles out of 3");
  assert_int_equal(stats.count, 0);
  control->lie = BALLISTIC_STAGE_COUNT;
  assert_fails(pbf_get_plan(s, &plan), PBF_ERROR_PLUGIN, "25 stages");
  control->lie = BALLISTIC_ARRAY_COUNT;
  assert_fails(pbf_get_plan(s, &plan), PBF_ERROR_PLUGIN, "41 arrays");
  control->lie = BALLISTIC_ENDLESS_TEXT;
  assert_ok(pbf_get_plan(s, &plan));
  assert_int_equal(strlen(plan.variant), sizeof plan.variant - 1);
  assert_ok(pbf_get_info(s, &info));
  assert_int_equal(strlen(info.device_name), sizeof info.device_name - 1);
  test_stub_control();
  pbf_destroy(s);
}

static void a_failure_without_a_reason(void **state) {
  (void)state;
  ballistic_control *control = test_stub_control();
  pbf_solver *s = test_filled(3, PBF_FLOAT32, 3, 8);
  static const struct {
    int32_t status, expected;
    const char *words;
  } cases[] = {
      {PBF_ERROR_DEVICE, PBF_ERROR_DEVICE, "failed in step with PBF_ERROR_DEVICE and gave no"},
      {77, PBF_ERROR_PLUGIN, "the unknown status 77 from step"},
      {-1000, PBF_ERROR_PLUGIN, "the unknown status -1000"},
  };
  for (int i = 0; i < 6; ++i) {
    control->calls_until_failure = 1;
    control->failure_status = cases[i % 3].status;
    control->failure_is_silent = 1 + i / 3;
    assert_fails(pbf_step(s, 1), cases[i % 3].expected, cases[i % 3].words);
  }
  pbf_destroy(s);
}

static pbf_solver *solver_to_load_into(void) {
  pbf_solver *s = test_filled(3, PBF_FLOAT32, 7, 8);
  assert_ok(pbf_remove_particles(s, 1, (const uint32_t[]){3}));
  return s;
}

/* A state with another gravity, a collider and other particles. */
static void *state_to_load(uint64_t *size) {
  pbf_solver *s = test_filled(3, PBF_FLOAT32, 5, 8);
  pbf_collider ball;
  pbf_params params = test_params();
  params.gravity[0] = 3;
  assert_ok(pbf_set_params(s, &params));
  assert_ok(pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SPHERE));
  assert_ok(pbf_set_colliders(s, 1, &ball));
  assert_ok(pbf_remove_particles(s, 1, (const uint32_t[]){0}));
  void *saved = test_save(s, size);
  pbf_destroy(s);
  return saved;
}

/* Each call of a load that can fail does: the solver is then as it was, and goes on as it would
 * have. */
static void a_load_that_fails_half_way(void **state) {
  (void)state;
  ballistic_control *control = test_stub_control();
  uint64_t size;
  void *saved = state_to_load(&size);
  pbf_status status = PBF_ERROR_DEVICE;
  int failures = -1;
  for (int32_t n = 1; status != PBF_OK; ++n, ++failures) {
    pbf_solver *s = solver_to_load_into(), *twin = solver_to_load_into();
    control->calls_until_failure = n;
    control->failure_status = PBF_ERROR_DEVICE;
    status = pbf_load(s, saved, size);
    control->calls_until_failure = 0;
    if (status != PBF_OK) {
      uint32_t colliders = 9;
      assert_fails(status, PBF_ERROR_DEVICE, "the test ordered this failure");
      assert_ok(pbf_get_collider_count(s, &colliders));
      assert_int_equal(colliders, 0);
      assert_int_equal(test_hash(s), test_hash(twin));
      assert_ok(pbf_step(s, 1));
      assert_ok(pbf_step(twin, 1));
      assert_int_equal(test_hash(s), test_hash(twin));
    }
    pbf_destroy(s);
    pbf_destroy(twin);
  }
  assert_int_equal(failures, 7); /* two reads, parameters, colliders, remove all, add, the time */
  free(saved);
  assert_int_equal(test_count.live_blocks, 0);
}

/* Adding and removing: the host's ids and the backend's rows stay in step. */
static void changes_that_fail(void **state) {
  (void)state;
  ballistic_control *control = test_stub_control();
  pbf_solver *s = test_filled(3, PBF_FLOAT32, 5, 8);
  float x[3] = {0.5f, 0.5f, 0.5f};
  uint64_t before = test_hash(s);
  for (int i = 0; i < 5; ++i) {
    pbf_params params = test_params();
    control->calls_until_failure = 1;
    control->failure_status = PBF_ERROR_DEVICE;
    pbf_status status = PBF_OK;
    if (i == 0) status = pbf_add_particles(s, 1, x, NULL, NULL);
    if (i == 1) status = pbf_remove_particles(s, 1, (const uint32_t[]){2});
    if (i == 2) status = pbf_set_positions(s, 0, 1, x);
    if (i == 3) status = pbf_set_colliders(s, 0, NULL);
    if (i == 4) status = pbf_set_params(s, &params);
    assert_fails(status, PBF_ERROR_DEVICE, "ordered");
    assert_int_equal(test_hash(s), before);
  }
  pbf_destroy(s);
}

int main(void) {
  const struct CMUnitTest lies[] = {
      cmocka_unit_test(creation),
      cmocka_unit_test(steps),
      cmocka_unit_test(a_step_that_fails),
      cmocka_unit_test(views),
      cmocka_unit_test(reports),
      cmocka_unit_test(a_failure_without_a_reason),
      cmocka_unit_test(a_load_that_fails_half_way),
      cmocka_unit_test(changes_that_fail),
  };
  return TEST_RUN(lies);
}
