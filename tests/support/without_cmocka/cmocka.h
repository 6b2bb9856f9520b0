/* As much of cmocka's interface as the tests of the API use, for systems that have no cmocka: what
 * is cross-compiled is tested with it. A test that fails is left by a longjmp. */
#ifndef PBF_TESTS_WITHOUT_CMOCKA_H
#define PBF_TESTS_WITHOUT_CMOCKA_H

#include <setjmp.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef void (*CMUnitTestFunction)(void **state);
typedef int (*CMFixtureFunction)(void **state);

struct CMUnitTest {
  const char *name;
  CMUnitTestFunction test_func;
  CMFixtureFunction setup_func, teardown_func;
  void *initial_state;
};

typedef enum test_outcome { TEST_PASSED, TEST_FAILED, TEST_LEFT_OUT } test_outcome;

#ifdef __cplusplus
extern "C" {
#endif

extern jmp_buf test_end; /* of the running test, by its outcome */
__attribute__((noreturn)) void test_fail(const char *file, int line);

#define cmocka_unit_test(f) \
  { #f, f, NULL, NULL, NULL }
#define cmocka_unit_test_teardown(f, teardown) \
  { #f, f, NULL, teardown, NULL }
#define cmocka_unit_test_setup_teardown(f, setup, teardown) \
  { #f, f, setup, teardown, NULL }
#define cmocka_run_group_tests(tests, setup, teardown) \
  _cmocka_run_group_tests(#tests, tests, sizeof(tests) / sizeof(tests)[0], setup, teardown)
int _cmocka_run_group_tests(const char *name, const struct CMUnitTest *tests, size_t count,
                            CMFixtureFunction setup, CMFixtureFunction teardown);

#define print_message(...) printf(__VA_ARGS__)
#define print_error(...) fprintf(stderr, __VA_ARGS__)
#define _fail(file, line) test_fail(file, line)
#define fail() test_fail(__FILE__, __LINE__)
#define fail_msg(...) (print_error(__VA_ARGS__), print_error("\n"), fail())
#define skip() longjmp(test_end, TEST_LEFT_OUT)

#define assert_true(value) ((value) ? (void)0 : fail_msg("%s is not so", #value))
#define assert_false(value) assert_true(!(value))
#define assert_null(pointer) assert_true((pointer) == NULL)
#define assert_non_null(pointer) assert_true((pointer) != NULL)
#define assert_ptr_equal(a, b) assert_true((const void *)(a) == (const void *)(b))
#define assert_ptr_not_equal(a, b) assert_true((const void *)(a) != (const void *)(b))
#define assert_string_equal(a, b) assert_true(strcmp(a, b) == 0)
#define assert_memory_equal(a, b, size) assert_true(memcmp(a, b, size) == 0)
#define assert_memory_not_equal(a, b, size) assert_true(memcmp(a, b, size) != 0)
#define assert_int_equal(a, b) \
  test_assert_equal((uint64_t)(a), (uint64_t)(b), #a, __FILE__, __LINE__)
#define assert_int_not_equal(a, b) assert_true((uint64_t)(a) != (uint64_t)(b))
#define assert_in_range(value, least, most) \
  assert_true((uint64_t)(value) >= (uint64_t)(least) && (uint64_t)(value) <= (uint64_t)(most))

void test_assert_equal(uint64_t value, uint64_t expected, const char *what, const char *file,
                       int line);

#ifdef __cplusplus
}
#endif

#endif
