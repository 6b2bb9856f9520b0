/* C++ exceptions that leave a call from within the caller's functions: they pass through C as far
 * as it has unwind tables, and leave a solver that can be destroyed. Of the backend
 * PBF_TEST_BACKEND. */
#include <csetjmp>
#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>

extern "C" {
#include <cmocka.h>
}

#include <pbf/pbf.h>

#if defined(_WIN32)
#include <malloc.h>
static void *aligned_memory(size_t alignment, size_t size) {
  return _aligned_malloc(size, alignment);
}
static void free_aligned(void *memory) { _aligned_free(memory); }
#else
static void *aligned_memory(size_t alignment, size_t size) {
  return std::aligned_alloc(alignment, size);
}
static void free_aligned(void *memory) { std::free(memory); }
#endif

static long live;
static int until_throw; /* calls of the allocator; 0: never */

static void *allocate_or_throw(void *, uint64_t size, uint64_t alignment) {
  if (until_throw && --until_throw == 0) throw std::runtime_error("the allocator throws");
  ++live;
  return aligned_memory(alignment, (size + alignment - 1) / alignment * alignment);
}

static void release(void *, void *memory, uint64_t, uint64_t) {
  --live;
  free_aligned(memory);
}

static void throw_message(void *, int32_t, const char *message) {
  throw std::runtime_error(message);
}

static pbf_solver *make(const char *backend, uint32_t strict) {
  const pbf_allocator allocator = {sizeof allocator, 0, nullptr, allocate_or_throw, release};
  pbf_desc desc;
  pbf_solver *solver = nullptr;
  assert_int_equal(pbf_desc_init(&desc, sizeof desc), PBF_OK);
  desc.backend = backend;
  desc.strict = strict;
  desc.capacity = 100;
  desc.threads = 2;
  desc.allocator = &allocator;
  desc.log = throw_message;
  try {
    assert_int_equal(pbf_create(&desc, nullptr, &solver), PBF_OK);
    assert_int_equal(strict, 1);
  } catch (const std::runtime_error &) {
    assert_int_equal(strict, 0);
  }
  return solver;
}

static void add(pbf_solver *solver) {
  const float x[6] = {.5f, .5f, .5f, .6f, .5f, .5f};
  assert_int_equal(pbf_add_particles(solver, 2, x, nullptr, nullptr), PBF_OK);
  assert_int_equal(pbf_step(solver, 1), PBF_OK);
}

static void assert_destroyable(pbf_solver *solver) {
  assert_int_equal(pbf_step(solver, 1), PBF_ERROR_STATE);
  pbf_destroy(solver);
  assert_int_equal(live, 0);
}

static void allocators_throw(void **) {
  for (int nth = 1; nth <= 2; ++nth) {
    pbf_solver *solver = make(std::getenv("PBF_TEST_BACKEND"), 1);
    const uint32_t id = 0;
    add(solver);
    until_throw = nth;
    try {
      pbf_remove_particles(solver, 1, &id);
      fail_msg("nothing was thrown");
    } catch (const std::runtime_error &) {
    }
    assert_destroyable(solver);
  }
}

static void logs_throw(void **) {
  pbf_solver *solver = make(std::getenv("PBF_TEST_BACKEND"), 1);
  pbf_params params;
  add(solver);
  assert_int_equal(pbf_params_init(&params, sizeof params), PBF_OK);
  params.time_step = 1;
  assert_int_equal(pbf_set_params(solver, &params), PBF_OK);
  try {
    pbf_step(solver, 1);
    fail_msg("nothing was thrown");
  } catch (const std::runtime_error &) {
  }
  assert_destroyable(solver);
}

int main() {
  const CMUnitTest exceptions[] = {
      cmocka_unit_test(allocators_throw),
      cmocka_unit_test(logs_throw),
  };
  return cmocka_run_group_tests(exceptions, nullptr, nullptr);
}
