/* Devices that a build of given architectures serves, by CMake's and CUDA's manuals: machine code
 * runs on devices of its major version from its minor one on, PTX on all later ones. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

extern "C" {
#include <cmocka.h>
}

#include "cuda/architectures.h"

static void machine_code_serves_its_generation(void **) {
  assert_false(pbf_cuda_has_code("80-real", 75));
  assert_true(pbf_cuda_has_code("80-real", 80));
  assert_true(pbf_cuda_has_code("80-real", 86));
  assert_false(pbf_cuda_has_code("86-real", 80));
  assert_false(pbf_cuda_has_code("80-real", 90));
  assert_true(pbf_cuda_has_code("100-real", 103));
  assert_false(pbf_cuda_has_code("100-real", 120));
}

static void code_for_drivers_serves_all_later_ones(void **) {
  assert_true(pbf_cuda_has_code("75-virtual", 75));
  assert_true(pbf_cuda_has_code("75-virtual", 120));
  assert_false(pbf_cuda_has_code("75-virtual", 70));
  assert_true(pbf_cuda_has_code("75", 90));
}

static void code_for_one_device_serves_that_one(void **) {
  assert_true(pbf_cuda_has_code("90a-real", 90));
  assert_true(pbf_cuda_has_code("90a", 90));
  assert_false(pbf_cuda_has_code("90a", 100));
  assert_false(pbf_cuda_has_code("90a-virtual", 100));
}

static void any_of_a_list_does(void **) {
  assert_true(pbf_cuda_has_code("80-real,90", 86));
  assert_true(pbf_cuda_has_code("80-real,90", 120));
  assert_false(pbf_cuda_has_code("80-real,90", 75));
  assert_true(pbf_cuda_has_code("70-real,90-real", 75));
  assert_false(pbf_cuda_has_code("70-real,90-real", 80));
  assert_true(pbf_cuda_has_code("70-real,80-real,", 80));
  assert_false(pbf_cuda_has_code("", 90));
}

static void what_a_compiler_makes_of_a_name_is_not_known(void **) {
  assert_true(pbf_cuda_has_code("all-major", 75));
  assert_true(pbf_cuda_has_code("native", 50));
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(machine_code_serves_its_generation),
      cmocka_unit_test(code_for_drivers_serves_all_later_ones),
      cmocka_unit_test(code_for_one_device_serves_that_one),
      cmocka_unit_test(any_of_a_list_does),
      cmocka_unit_test(what_a_compiler_makes_of_a_name_is_not_known),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
