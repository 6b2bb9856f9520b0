#include <cmocka.h>

jmp_buf test_end;

void test_fail(const char *file, int line) {
  fprintf(stderr, "%s:%d: failed\n", file, line);
  longjmp(test_end, TEST_FAILED);
}

void test_assert_equal(uint64_t value, uint64_t expected, const char *what, const char *file,
                       int line) {
  if (value == expected) return;
  fprintf(stderr, "%s is %lld, not %lld\n", what, (long long)value, (long long)expected);
  test_fail(file, line);
}

static test_outcome run(const struct CMUnitTest *test) {
  void *state = test->initial_state;
  const test_outcome outcome = (test_outcome)setjmp(test_end);
  if (outcome == TEST_PASSED) test->test_func(&state);
  return outcome;
}

int _cmocka_run_group_tests(const char *name, const struct CMUnitTest *tests, size_t count,
                            CMFixtureFunction setup, CMFixtureFunction teardown) {
  static const char *const words[] = {"passed", "FAILED", "skipped"};
  int failed = 0;
  (void)setup, (void)teardown; /* of groups, of which none has one */
  for (size_t k = 0; k < count; ++k) {
    void *state = tests[k].initial_state;
    if (tests[k].setup_func) tests[k].setup_func(&state);
    const test_outcome outcome = run(&tests[k]);
    if (tests[k].teardown_func) tests[k].teardown_func(&state);
    printf("%s: %s.%s\n", words[outcome], name, tests[k].name);
    failed += outcome == TEST_FAILED;
  }
  fflush(stdout);
  return failed;
}
