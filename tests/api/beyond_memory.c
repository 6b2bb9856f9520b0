/* A solver that wants more memory than the machine has is refused before any of it is written to:
 * Linux would give it, and end the process then. */
#include <sys/sysinfo.h>

#include "support.h"

static uint64_t asked, room; /* room 0: whatever is asked for */
static int was_asked_for_more;

/* Of the library, too. What is more than there is, which a solver would be given, it gets not here:
 * so the machine comes to no harm where the library does not look. */
__attribute__((visibility("default"))) void *aligned_alloc(size_t alignment, size_t size) {
  void *memory = NULL;
  if (room && (asked += size) > room) {
    was_asked_for_more = 1;
    return NULL;
  }
  return posix_memalign(&memory, alignment, size) == 0 ? memory : NULL;
}

static uint64_t whole_memory(void) {
  struct sysinfo info;
  assert_int_equal(sysinfo(&info), 0);
  return ((uint64_t)info.totalram + info.totalswap) * info.mem_unit;
}

static void a_solver_larger_than_memory(void **state) {
  (void)state;
  const uint64_t all_arrays = UINT64_C(100) * PBF_MAX_CAPACITY;
  pbf_desc desc;
  pbf_solver *solver = NULL;
  if (whole_memory() > all_arrays) test_skip("this machine has memory for the largest solver");
  assert_ok(pbf_desc_init(&desc, sizeof desc));
  desc.backend = "serial";
  desc.strict = 1;
  desc.capacity = PBF_MAX_CAPACITY;
  asked = 0;
  room = whole_memory();
  was_asked_for_more = 0;
  const pbf_status status = pbf_create(&desc, NULL, &solver);
  room = 0;
  assert_int_equal(status, PBF_ERROR_OUT_OF_MEMORY);
  assert_non_null(strstr(pbf_last_error(), "no memory for the arrays of 1073741823 particles"));
  assert_null(solver);
  assert_false(was_asked_for_more);
}

/* It is looked at anew for memory that was given back. */
static void smaller_ones_go_on(void **state) {
  (void)state;
  for (int k = 0; k < 3000; ++k) {
    pbf_desc desc = test_desc(3, PBF_FLOAT32, 1 << 16);
    pbf_solver *solver = NULL;
    desc.allocator = NULL;
    assert_ok(pbf_create(&desc, NULL, &solver));
    pbf_destroy(solver);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_solver_larger_than_memory),
      cmocka_unit_test(smaller_ones_go_on),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
