/* What the tests of the public API share. */
#ifndef PBF_TESTS_SUPPORT_H
#define PBF_TESTS_SUPPORT_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <pbf/pbf.h>

#include "allocator.h"
#include "amount.h"
#include "ballistic.h"

enum { TEST_SKIPPED = 77 };

/* The backend under test, PBF_TEST_BACKEND; "ballistic", the stub, when unset. Loads the stub. */
const char *test_backend(void);
int test_is_stub(void);

/* Runs the group; skips it on a machine that the backend can't serve for want of a device. */
int test_run(const char *name, const struct CMUnitTest *tests, size_t count);
#define TEST_RUN(tests) test_run(#tests, tests, sizeof(tests) / sizeof(tests)[0])

/* Whether the solver's plan has a stage of that name. */
int test_has_stage(pbf_solver *solver, const char *name);

/* The switches of the stub, back at "honest". */
ballistic_control *test_stub_control(void);

/* Ends the test as skipped, and says why. */
void test_skip(const char *why);

/* For what follows a fluid for long: ends the test as skipped where a sanitizer looks at code,
 * which shorter tests run as well, unless all is asked for. */
void test_skip_if_watched(void);

/* Steps of s with each allocation failing in turn, which fail and begin again: it comes to what
 * another one comes to that is alike and has memory. */
void test_steps_without_memory(pbf_solver *s, pbf_solver *other, int steps);

/* A description for the backend under test, strict, with the counting allocator. Ends the test as
 * skipped when the backend was built without the kind. */
pbf_desc test_desc(uint32_t dimension, uint32_t precision, uint32_t capacity);

/* Default parameters, with a spacing of 0.05. */
pbf_params test_params(void);

/* Never null: fails the test. */
pbf_solver *test_create(const pbf_desc *desc, const pbf_params *params);
pbf_solver *test_solver(uint32_t dimension, uint32_t precision, uint32_t capacity);

/* Whether there is the backend `reference`, built with it. */
int test_has_reference(uint32_t dimension, uint32_t precision);

/* Whether the backend under test was built with it. */
int test_has_kind(uint32_t dimension, uint32_t precision);

/* Calls for 2D and 3D, float32 and float64, as far as the build has them. */
void test_for_each_kind(void (*function)(uint32_t dimension, uint32_t precision));

/* For what takes long and is the same physics everywhere: two kinds, one of each number and
 * dimension; one of the reference, which has what it computes in the others compared with `serial`
 * (cpu.stages), and where a sanitizer looks at code, which same_bits has in 3D. `serial` has all
 * where all is asked for; `threads` has its bits (cpu.threads). A GPU, whose kinds are compiled
 * apart, always has. */
void test_for_long_kinds(void (*function)(uint32_t dimension, uint32_t precision));

/* `count` positions on a lattice in the lower middle of the unit box, in the element type; freed by
 * the caller. */
void *test_lattice(uint32_t dimension, uint32_t precision, uint32_t count);

double test_value(const void *values, uint64_t index, uint32_t precision);
void test_put(void *values, uint64_t index, uint32_t precision, double value);

/* Positions and velocities of the first `count` rows, `dimension` numbers each. */
void test_read(pbf_solver *solver, uint32_t dimension, uint32_t precision, uint32_t count,
               double *x, double *v);

/* Adds a particle's momentum, and its angular momentum about the origin. */
void test_add_momenta(double sums[6], uint32_t dimension, double mass, const double *x,
                      const double *v);

/* A solver of that kind with `count` particles, the i-th with velocity (i+1)/8 along x. */
pbf_solver *test_filled(uint32_t dimension, uint32_t precision, uint32_t count, uint32_t capacity);

uint64_t test_hash(pbf_solver *solver);

/* The saved state, freed by the caller. */
void *test_save(pbf_solver *solver, uint64_t *size);

/* Rewrites the checksum at the end of a forged state. */
void test_seal(void *state, uint64_t size);

#define assert_ok(call) test_assert_status((call), PBF_OK, "", #call, __FILE__, __LINE__)

/* The call must fail so, with a sentence that holds `words`. */
#define assert_fails(call, status, words) \
  test_assert_status((call), (status), (words), #call, __FILE__, __LINE__)

void test_assert_status(pbf_status status, pbf_status expected, const char *words, const char *call,
                        const char *file, int line);

#endif
