/* Every function with null, dead and wrong arguments: status, sentence, nothing changed. */
#include <dlpack/dlpack.h>

#include <pbf/all.h>

#include "support.h"

/* Each call of the API that takes a solver, with arguments that would do otherwise. */
typedef pbf_status (*solver_call)(pbf_solver *solver);

static pbf_params params;
static pbf_collider collider;
static double numbers[64];
static uint32_t integers[64];
static pbf_view view = {.struct_size = sizeof view};
static pbf_stats stats = {.struct_size = sizeof stats};
static pbf_timings timings = {.struct_size = sizeof timings};
static pbf_plan plan = {.struct_size = sizeof plan};
static pbf_info info = {.struct_size = sizeof info};
static uint64_t size;

static pbf_status set_params(pbf_solver *s) { return pbf_set_params(s, &params); }
static pbf_status get_params(pbf_solver *s) { return pbf_get_params(s, &params); }
static pbf_status step(pbf_solver *s) { return pbf_step(s, 1); }
static pbf_status get_count(pbf_solver *s) { return pbf_get_count(s, integers); }
static pbf_status add(pbf_solver *s) { return pbf_add_particles(s, 1, numbers, NULL, NULL); }
static pbf_status drop(pbf_solver *s) { return pbf_remove_particles(s, 1, integers); }
static pbf_status get_x(pbf_solver *s) { return pbf_get_positions(s, 0, 1, numbers); }
static pbf_status set_x(pbf_solver *s) { return pbf_set_positions(s, 0, 1, numbers); }
static pbf_status get_v(pbf_solver *s) { return pbf_get_velocities(s, 0, 1, numbers); }
static pbf_status set_v(pbf_solver *s) { return pbf_set_velocities(s, 0, 1, numbers); }
static pbf_status set_a(pbf_solver *s) { return pbf_set_accelerations(s, 0, 1, numbers); }
static pbf_status get_ids(pbf_solver *s) { return pbf_get_ids(s, 0, 1, integers); }
static pbf_status get_rho(pbf_solver *s) { return pbf_get_densities(s, 0, 1, numbers); }
static pbf_status get_p(pbf_solver *s) { return pbf_get_pressures(s, 0, 1, numbers); }
static pbf_status set_c(pbf_solver *s) { return pbf_set_colliders(s, 1, &collider); }
static pbf_status count_c(pbf_solver *s) { return pbf_get_collider_count(s, integers); }
static pbf_status get_c(pbf_solver *s) { return pbf_get_collider(s, 0, &collider); }
static pbf_collider_load one_load;
static pbf_status get_l(pbf_solver *s) { return pbf_get_collider_loads(s, 1, &one_load); }
static pbf_status get_w(pbf_solver *s) { return pbf_get_wall_loads(s, 1, &one_load); }
static pbf_status map(pbf_solver *s) { return pbf_map(s, PBF_FIELD_POSITION, &view); }
static pbf_status unmap(pbf_solver *s) { return pbf_unmap(s, PBF_FIELD_POSITION); }
static pbf_status export(pbf_solver *s) {
  DLManagedTensor *tensor = NULL;
  return pbf_export_dlpack(s, PBF_FIELD_POSITION, &tensor);
}
static pbf_status get_stats(pbf_solver *s) { return pbf_get_stats(s, &stats); }
static pbf_status set_timing(pbf_solver *s) { return pbf_set_timing(s, 1); }
static pbf_status get_timings(pbf_solver *s) { return pbf_get_timings(s, &timings); }
static pbf_status get_plan(pbf_solver *s) { return pbf_get_plan(s, &plan); }
static pbf_status get_info(pbf_solver *s) { return pbf_get_info(s, &info); }
static pbf_status save(pbf_solver *s) { return pbf_save(s, NULL, &size); }
static pbf_status load(pbf_solver *s) { return pbf_load(s, numbers, sizeof numbers); }
static pbf_status hash(pbf_solver *s) { return pbf_hash(s, &size); }

static const solver_call calls[] = {set_params, get_params, step,        pbf_synchronize, get_count,
                                    add,        drop,       get_x,       set_x,           get_v,
                                    set_v,      get_ids,    get_rho,     get_p,           set_c,
                                    count_c,    get_c,      map,         unmap,           export,
                                    get_stats,  set_timing, get_timings, get_plan,        get_info,
                                    save,       load,       hash,        get_l,           get_w,
                                    set_a};

static void null_and_dead_handles(void **state) {
  (void)state;
  params = test_params();
  assert_ok(pbf_collider_init(&collider, sizeof collider, PBF_COLLIDER_BOX));
  pbf_solver *dead = test_solver(3, PBF_FLOAT32, 10);
  pbf_destroy(dead);
  uint64_t garbage[64] = {0};
  for (size_t i = 0; i < sizeof calls / sizeof calls[0]; ++i) {
    assert_fails(calls[i](NULL), PBF_ERROR_INVALID_ARGUMENT, "solver is null");
    assert_fails(calls[i](dead), PBF_ERROR_INVALID_ARGUMENT, "pbf_destroy has taken back");
    assert_fails(calls[i]((pbf_solver *)garbage), PBF_ERROR_INVALID_ARGUMENT, "pbf_create");
  }
  pbf_destroy(NULL);
  pbf_destroy(dead);
  pbf_destroy((pbf_solver *)garbage);
}

static void null_arguments(void **state) {
  (void)state;
  pbf_solver *s = test_filled(3, PBF_FLOAT32, 4, 10);
  pbf_desc desc = test_desc(3, PBF_FLOAT32, 10);
  pbf_status bad = PBF_ERROR_INVALID_ARGUMENT;
  uint64_t before = test_hash(s);
  assert_fails(pbf_desc_init(NULL, sizeof desc), bad, "null");
  assert_fails(pbf_params_init(NULL, sizeof params), bad, "null");
  assert_fails(pbf_collider_init(NULL, sizeof collider, 0), bad, "null");
  assert_fails(pbf_create(NULL, NULL, &s), bad, "desc is null");
  assert_fails(pbf_create(&desc, NULL, NULL), bad, "solver is null");
  assert_fails(pbf_set_params(s, NULL), bad, "params is null");
  assert_fails(pbf_get_params(s, NULL), bad, "params is null");
  assert_fails(pbf_get_count(s, NULL), bad, "count is null");
  assert_fails(pbf_add_particles(s, 1, NULL, NULL, NULL), bad, "positions is null");
  assert_fails(pbf_remove_particles(s, 1, NULL), bad, "ids is null");
  assert_fails(pbf_get_positions(s, 0, 1, NULL), bad, "positions is null");
  assert_fails(pbf_set_positions(s, 0, 1, NULL), bad, "positions is null");
  assert_fails(pbf_get_velocities(s, 0, 1, NULL), bad, "velocities is null");
  assert_fails(pbf_set_velocities(s, 0, 1, NULL), bad, "velocities is null");
  assert_fails(pbf_get_ids(s, 0, 1, NULL), bad, "ids is null");
  assert_fails(pbf_get_densities(s, 0, 1, NULL), bad, "densities is null");
  assert_fails(pbf_set_colliders(s, 1, NULL), bad, "colliders is null");
  assert_fails(pbf_get_collider_count(s, NULL), bad, "count is null");
  assert_fails(pbf_get_collider(s, 0, NULL), bad, "collider is null");
  assert_fails(pbf_map(s, PBF_FIELD_ID, NULL), bad, "view is null");
  assert_fails(pbf_export_dlpack(s, PBF_FIELD_ID, NULL), bad, "tensor is null");
  assert_fails(pbf_get_stats(s, NULL), bad, "stats is null");
  assert_fails(pbf_get_timings(s, NULL), bad, "timings is null");
  assert_fails(pbf_get_plan(s, NULL), bad, "plan is null");
  assert_fails(pbf_get_info(s, NULL), bad, "info is null");
  assert_fails(pbf_save(s, NULL, NULL), bad, "size is null");
  assert_fails(pbf_load(s, NULL, 100), bad, "buffer is null");
  assert_fails(pbf_hash(s, NULL), bad, "hash is null");
  assert_fails(pbf_get_backend_count(NULL), bad, "count is null");
  assert_fails(pbf_get_backend_info(NULL, 0, NULL), bad, "info is null");
  assert_fails(pbf_load_backend(NULL), bad, "path is null");
  assert_int_equal(test_hash(s), before);
  pbf_destroy(s);
}

/* By the names that the headers give them, which are not always those of their types. */
static void named(pbf_status status, const char *argument) {
  const size_t length = strlen(argument);
  assert_int_equal(status, PBF_ERROR_INVALID_ARGUMENT);
  if (strncmp(pbf_last_error(), argument, length) != 0 ||
      strncmp(pbf_last_error() + length, " is null", 8) != 0)
    fail_msg("\"%s\" does not begin with %s is null", pbf_last_error(), argument);
}

static void null_arguments_have_their_names(void **state) {
  (void)state;
  pbf_solver *s = test_filled(2, PBF_FLOAT32, 4, 10);
  const pbf_desc desc = test_desc(2, PBF_FLOAT32, 10);
  pbf_shape *shape = NULL;
  pbf_shape_info about = {.struct_size = sizeof about};
  pbf_collider ball;
  pbf_batch *batch = NULL;
  assert_ok(pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SPHERE));
  named(pbf_set_colliders(s, 1, NULL), "colliders");
  assert_ok(pbf_set_colliders(s, 1, &ball));
  named(pbf_move_colliders(s, 1, NULL, 1), "targets");
  named(pbf_get_drain(s, 0, NULL), "drain");
  named(pbf_get_diffuse_info(s, NULL), "info");
  named(pbf_get_backend_info(NULL, 0, NULL), "info");
  named(pbf_shape_from_grid(NULL, &shape), "grid");
  named(pbf_shape_from_mesh(NULL, &shape), "mesh");
  named(pbf_shape_from_heights(NULL, &shape), "heights");
  named(pbf_shape_from_points(NULL, &shape), "hull");
  named(pbf_get_shape_info(NULL, &about), "shape");
  named(pbf_get_shape_info(NULL, NULL), "info");
  named(pbf_hold_shape(NULL), "shape");
  assert_ok(pbf_batch_create(&desc, NULL, 1, &batch));
  named(pbf_batch_get_info(batch, NULL), "info");
  pbf_batch_destroy(batch);
  pbf_destroy(s);
}

static void rows_out_of_range(void **state) {
  (void)state;
  pbf_solver *s = test_filled(2, PBF_FLOAT64, 4, 10);
  pbf_status bad = PBF_ERROR_INVALID_ARGUMENT;
  assert_fails(pbf_get_positions(s, 0, 5, numbers), bad, "first is 0 and count 5");
  assert_fails(pbf_get_velocities(s, 4, 1, numbers), bad, "holds 4");
  assert_fails(pbf_get_densities(s, UINT32_MAX, 2, numbers), bad, "first is 4294967295");
  assert_fails(pbf_set_positions(s, 1, UINT32_MAX, numbers), bad, "count 4294967295");
  assert_fails(pbf_get_ids(s, 5, 0, integers), bad, "first is 5");
  assert_ok(pbf_get_positions(s, 4, 0, NULL));
  assert_fails(pbf_get_positions(s, 0, 1, (char *)numbers + 1), bad,
               "aligned to"); /* 8, or on 32-bit x86 4 */
  assert_fails(pbf_get_collider(s, 0, &collider), PBF_ERROR_NOT_FOUND, "has 0 colliders");
  assert_fails(pbf_set_timing(s, 2), bad, "enabled is 2");
  assert_fails(pbf_set_timing(s, 1), PBF_ERROR_UNSUPPORTED, "ballistic");
  assert_fails(pbf_get_timings(s, &timings), PBF_ERROR_UNSUPPORTED, "ballistic");
  pbf_destroy(s);
}

static void statuses_have_names(void **state) {
  (void)state;
  assert_string_equal(pbf_status_string(PBF_OK), "PBF_OK");
  assert_string_equal(pbf_status_string(PBF_ERROR_INVALID_ARGUMENT), "PBF_ERROR_INVALID_ARGUMENT");
  assert_string_equal(pbf_status_string(PBF_ERROR_CAPACITY), "PBF_ERROR_CAPACITY");
  assert_string_equal(pbf_status_string(PBF_ERROR_BUSY), "PBF_ERROR_BUSY");
  assert_string_equal(pbf_status_string(PBF_ERROR_DATA), "PBF_ERROR_DATA");
  assert_string_equal(pbf_status_string(PBF_ERROR_CANCELLED), "PBF_ERROR_CANCELLED");
  assert_string_equal(pbf_status_string(-14), "unknown pbf_status");
  assert_string_equal(pbf_status_string(1), "unknown pbf_status");
  assert_string_equal(pbf_status_string(INT32_MIN), "unknown pbf_status");
  assert_int_equal(pbf_version(),
                   PBF_VERSION_MAJOR * 1000000 + PBF_VERSION_MINOR * 1000 + PBF_VERSION_PATCH);
}

/* A call that succeeds leaves the sentence of the last failure alone. */
static void the_sentence_stays(void **state) {
  (void)state;
  pbf_solver *s = test_solver(3, PBF_FLOAT32, 10);
  uint32_t count;
  assert_fails(pbf_get_count(s, NULL), PBF_ERROR_INVALID_ARGUMENT, "count is null");
  assert_ok(pbf_get_count(s, &count));
  assert_ok(pbf_step(s, 1));
  assert_ok(pbf_get_backend_count(&count));
  assert_string_equal(pbf_last_error(), "count is null");
  pbf_destroy(s);
}

int main(void) {
  const struct CMUnitTest contract[] = {
      cmocka_unit_test(null_and_dead_handles),
      cmocka_unit_test(null_arguments),
      cmocka_unit_test(null_arguments_have_their_names),
      cmocka_unit_test(rows_out_of_range),
      cmocka_unit_test(statuses_have_names),
      cmocka_unit_test(the_sentence_stays),
  };
  return TEST_RUN(contract);
}
