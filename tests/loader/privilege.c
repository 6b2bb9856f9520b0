/* Whose environment may be trusted. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "os_privilege.h"

static void identities(void **state) {
  (void)state;
  static const struct {
    pbf_identity identity;
    int elevated;
  } cases[] = {
      {{0, 1000, 1000, 1000, 1000}, 0}, {{0, 0, 0, 0, 0}, 0},
      {{1, 1000, 1000, 1000, 1000}, 1}, /* file capabilities, or a security module's word */
      {{0, 1000, 0, 1000, 1000}, 1},    /* setuid */
      {{0, 1000, 1000, 1000, 5}, 1},    /* setgid */
      {{0, 0, 1000, 0, 0}, 1},          /* root that has put its rights down for now */
  };
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i)
    assert_int_equal(pbf_is_elevated(&cases[i].identity), cases[i].elevated);
}

static void this_process(void **state) {
  (void)state;
  pbf_identity identity = pbf_identity_of_process();
  assert_int_equal(pbf_is_elevated(&identity), 0);
}

int main(void) {
  const struct CMUnitTest privilege[] = {
      cmocka_unit_test(identities),
      cmocka_unit_test(this_process),
  };
  return cmocka_run_group_tests(privilege, NULL, NULL);
}
