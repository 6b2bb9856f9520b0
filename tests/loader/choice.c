/* "auto", names, strict, fallback. The folder holds stubs under all the known names, so that the
 * real backends stay out of it. */
#include <stdio.h>

#include "child.h"

static char folder[64];

static int set_up(void **state) {
  (void)state;
  make_folder(folder, sizeof folder);
  put_file(folder, "pbf_backend_reference.so", "stub_reference.so"); /* score 99 */
  put_file(folder, "pbf_backend_serial.so", "stub_serial.so");       /* 5 */
  put_file(folder, "pbf_backend_threads.so", "stub_threads.so");     /* 8 */
  put_file(folder, "pbf_backend_openmp.so", "stub_openmp.so");       /* 9 */
  put_file(folder, "pbf_backend_cuda.so", "stub_cuda.so");           /* 0 */
  return setenv("PBF_BACKEND_PATH", folder, 1);
}

static int tear_down(void **state) {
  (void)state;
  drop_folder(folder);
  return 0;
}

static char logged[512];
static int32_t logged_level;

static void take_log(void *user, int32_t level, const char *message) {
  (void)user;
  logged_level = level;
  snprintf(logged, sizeof logged, "%s", message);
}

static pbf_status create(const char *backend, uint32_t strict, pbf_info *info) {
  pbf_desc desc;
  pbf_solver *solver = NULL;
  check_ok(pbf_desc_init(&desc, sizeof desc));
  desc.capacity = 10;
  desc.backend = backend;
  desc.strict = strict;
  desc.log = take_log;
  *info = (pbf_info){.struct_size = sizeof *info};
  logged[0] = 0;
  pbf_status status = pbf_create(&desc, NULL, &solver);
  if (status == PBF_OK) check_ok(pbf_get_info(solver, info));
  pbf_destroy(solver);
  return status;
}

static void choose(void) {
  pbf_info info;
  char path[128];
  check_ok(create("auto", 0, &info));
  check(strcmp(info.backend, "openmp") == 0);
  check(!info.fell_back && !info.fallback_reason[0] && !logged[0]);
  snprintf(path, sizeof path, "%s/pbf_backend_openmp.so", folder);
  check(strcmp(info.path, path) == 0);
  check_ok(create(NULL, 1, &info));
  check(strcmp(info.backend, "openmp") == 0);
  check_ok(create("serial", 1, &info));
  check(strcmp(info.backend, "serial") == 0 && !info.fell_back);
  check_ok(create("reference", 0, &info));
  check(strcmp(info.backend, "reference") == 0 && !info.fell_back);
}

static void scores_decide(void **state) {
  (void)state;
  in_child(choose);
}

static void fall_back(void) {
  pbf_info info;
  check_fails(create("cuda", 1, &info), PBF_ERROR_UNAVAILABLE,
              "cuda: the stub's probe always fails");
  check_ok(create("cuda", 0, &info));
  check(strcmp(info.backend, "openmp") == 0 && info.fell_back == 1);
  check(strstr(info.fallback_reason, "the stub's probe always fails"));
  check(logged_level == PBF_LOG_WARNING && strstr(logged, "the stub's probe always fails"));
  check_fails(
      create("metal", 0, &info), PBF_ERROR_NOT_FOUND,
      "desc.backend is \"metal\"; known are: auto; reference; serial; threads; openmp; cuda");
  check_fails(create("Serial", 1, &info), PBF_ERROR_NOT_FOUND, "\"Serial\"");
}

static void fallback_is_seen(void **state) {
  (void)state;
  in_child(fall_back);
}

/* Judged best, yet unable to create: the next one serves, and the reason is kept. */
static void fail_to_create(void) {
  pbf_info info;
  check_ok(pbf_load_backend(PBF_STUB_DIR "/broken19.so"));
  check_ok(create("auto", 0, &info));
  check(strcmp(info.backend, "openmp") == 0 && !info.fell_back);
  check(strstr(info.fallback_reason, "broken19"));
  check_ok(create("broken19", 0, &info));
  check(strcmp(info.backend, "openmp") == 0 && info.fell_back == 1);
  check(strstr(info.fallback_reason, "failed in create with PBF_ERROR_DEVICE"));
  check_fails(create("broken19", 1, &info), PBF_ERROR_DEVICE, "failed in create");
}

static void creation_fails(void **state) {
  (void)state;
  in_child(fail_to_create);
}

/* `reference` is taken when, and only when, nothing else will do; equal scores go to the first. */
static void take_what_is_left(void) {
  char path[128];
  pbf_info info;
  snprintf(path, sizeof path, "%s/pbf_backend_serial.so", folder);
  remove(path);
  put_file(folder, "pbf_backend_serial.so", "broken6.so");
  put_file(folder, "pbf_backend_threads.so", "broken6.so");
  put_file(folder, "pbf_backend_openmp.so", "broken6.so");
  check_ok(pbf_load_backend(PBF_STUB_DIR "/broken16.so"));  /* score 1, and creates nothing */
  check_ok(pbf_load_backend(PBF_STUB_DIR "/ballistic.so")); /* score 1 */
  check_ok(create("ballistic", 1, &info));
  check_ok(create("broken16", 0, &info));
}

static void ties_and_leftovers(void **state) {
  (void)state;
  in_child(take_what_is_left);
}

int main(void) {
  const struct CMUnitTest choice[] = {
      cmocka_unit_test(scores_decide),
      cmocka_unit_test(fallback_is_seen),
      cmocka_unit_test(creation_fails),
      cmocka_unit_test(ties_and_leftovers),
  };
  return cmocka_run_group_tests(choice, set_up, tear_down);
}
