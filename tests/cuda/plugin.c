/* The cuda plugin on any machine, with a device or without: it loads, exports one symbol, needs no
 * driver's library, and says why it can't serve. */
#include <dlfcn.h>
#include <stdio.h>
#include <sys/stat.h>

#include "support.h"

static pbf_backend_info cuda_info(const pbf_desc *desc) {
  uint32_t count;
  assert_ok(pbf_get_backend_count(&count));
  for (uint32_t k = 0; k < count; ++k) {
    pbf_backend_info info = {.struct_size = sizeof info};
    assert_ok(pbf_get_backend_info(desc, k, &info));
    if (strcmp(info.name, "cuda") == 0) return info;
  }
  fail_msg("the backend cuda is not among the %u found", count);
  return (pbf_backend_info){0};
}

static void loads_without_the_drivers_library(void **state) {
  (void)state;
  void *plugin = dlopen(PBF_CUDA_PLUGIN, RTLD_NOW | RTLD_LOCAL);
  assert_non_null(plugin);
  assert_non_null(dlsym(plugin, "pbf_backend_negotiate"));
  assert_null(dlsym(plugin, "pbf_cuda_probe"));
  assert_null(dlsym(plugin, "cudaMalloc"));
  dlclose(plugin);
}

static void is_under_fourteen_megabytes(void **state) {
  struct stat file;
  (void)state;
  assert_int_equal(stat(PBF_CUDA_PLUGIN, &file), 0);
  assert_in_range(file.st_size, 1, 14000000);
}

static void serves_or_says_why(void **state) {
  (void)state;
  pbf_desc desc = test_desc(3, PBF_FLOAT32, 1000);
  pbf_backend_info info = cuda_info(&desc);
  if (info.available) {
    assert_true(info.score > 0);
    assert_true(info.device_name[0] != 0);
    return;
  }
  assert_int_equal(info.score, 0);
  assert_true(strstr(info.reason, "NVIDIA driver") || strstr(info.reason, "CUDA device") ||
              strstr(info.reason, "compute capability"));
  pbf_solver *solver = NULL;
  assert_fails(pbf_create(&desc, NULL, &solver), PBF_ERROR_UNAVAILABLE, info.reason);
  assert_null(solver);
}

static void names_a_device_that_is_not_there(void **state) {
  (void)state;
  pbf_desc desc = test_desc(3, PBF_FLOAT32, 1000);
  desc.device = 1000;
  pbf_backend_info info = cuda_info(&desc);
  assert_int_equal(info.available, 0);
  assert_true(info.reason[0] != 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(loads_without_the_drivers_library),
      cmocka_unit_test(is_under_fourteen_megabytes),
      cmocka_unit_test(serves_or_says_why),
      cmocka_unit_test(names_a_device_that_is_not_there),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
