/* A process that is forked off after CUDA has begun: the device is the parent's. */
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support.h"

enum { COUNT = 120 };

/* Which of the child's expectations has failed, 0 for none: cmocka is the parent's. */
static int child_of(pbf_solver *of_parent) {
  pbf_desc desc = test_desc(2, PBF_FLOAT32, COUNT);
  pbf_solver *solver = NULL;
  desc.strict = 1;
  if (pbf_create(&desc, NULL, &solver) != PBF_ERROR_UNAVAILABLE) return 1;
  if (!strstr(pbf_last_error(), "forked off")) return 2;
  desc.strict = 0; /* another backend serves */
  if (pbf_create(&desc, NULL, &solver) != PBF_OK) return 3;
  if (pbf_step(solver, 1) != PBF_OK) return 4;
  pbf_destroy(solver);
  if (pbf_step(of_parent, 1) != PBF_ERROR_DEVICE) return 5;
  if (!strstr(pbf_last_error(), "forked off")) return 6;
  pbf_destroy(of_parent);
  return 0;
}

static void a_child_is_told_and_its_parent_goes_on(void **state) {
  (void)state;
  pbf_desc desc = test_desc(2, PBF_FLOAT32, COUNT);
  pbf_solver *solver = test_create(&desc, NULL);
  void *positions = test_lattice(2, PBF_FLOAT32, COUNT);
  assert_ok(pbf_add_particles(solver, COUNT, positions, NULL, NULL));
  free(positions);
  assert_ok(pbf_step(solver, 3));
  const pid_t child = fork();
  assert_true(child >= 0);
  if (child == 0) _exit(child_of(solver));
  int status = 0;
  assert_int_equal(waitpid(child, &status, 0), child);
  assert_true(WIFEXITED(status));
  assert_int_equal(WEXITSTATUS(status), 0);
  assert_ok(pbf_step(solver, 3));
  pbf_destroy(solver);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_child_is_told_and_its_parent_goes_on)};
  return TEST_RUN(tests);
}
