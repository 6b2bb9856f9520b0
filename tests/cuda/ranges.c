/* Ranges for profilers: one for a call of steps, and in it one for each run of a stage; none where
 * no profiler has asked. */
#include <dlfcn.h>

#include "profiler.h"
#include "support.h"

static const profile *profile_of_this_process(void) {
  void *library = dlopen(PBF_TEST_PROFILER, RTLD_NOW);
  if (!library) fail_msg("%s", dlerror());
  void *symbol = dlsym(library, "profile_seen");
  profile_seen_fn function;
  assert_non_null(symbol);
  memcpy(&function, &symbol, sizeof function);
  return function();
}

static uint64_t ranges_of(const profile *seen, const char *name) {
  for (uint32_t k = 0; k < seen->names; ++k)
    if (strcmp(seen->name[k], name) == 0) return seen->count[k];
  return 0;
}

static void ranges_are_those_of_the_stages(void **state) {
  (void)state;
  pbf_timings timings = {.struct_size = sizeof timings};
  const profile *seen = profile_of_this_process();
  const int asked = getenv("NVTX_INJECTION64_PATH") != NULL;
  pbf_desc desc = test_desc(3, PBF_FLOAT32, 1000);
  pbf_params params = test_params();
  params.viscosity = 0.001; /* so that each stage is launched by itself */
  pbf_solver *s = test_create(&desc, &params);
  void *positions = test_lattice(3, PBF_FLOAT32, 1000);
  assert_ok(pbf_add_particles(s, 1000, positions, NULL, NULL));
  free(positions);
  assert_ok(pbf_set_timing(s, 1));
  assert_ok(pbf_step(s, 2));
  assert_ok(pbf_step(s, 3));
  assert_ok(pbf_get_timings(s, &timings));
  assert_true(timings.stage_count > 2);
  if (asked) assert_int_equal(ranges_of(seen, "pbf_step"), 2);
  for (uint32_t k = 0; asked && k < timings.stage_count; ++k)
    if (ranges_of(seen, timings.stages[k].name) != timings.stages[k].runs)
      fail_msg("%s ran %llu times, and has %llu ranges", timings.stages[k].name,
               (unsigned long long)timings.stages[k].runs,
               (unsigned long long)ranges_of(seen, timings.stages[k].name));
  assert_int_equal(seen->depth, 0);
  assert_int_equal(seen->deepest, asked ? 2 : 0);
  pbf_destroy(s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(ranges_are_those_of_the_stages),
  };
  return TEST_RUN(tests);
}
