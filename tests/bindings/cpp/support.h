/* What the tests of pbf.hpp share. They are built with exceptions and without, and run on the
 * backend PBF_TEST_BACKEND. */
#ifndef PBF_TESTS_BINDINGS_CPP_SUPPORT_H
#define PBF_TESTS_BINDINGS_CPP_SUPPORT_H

#include <array>
#include <atomic>
#include <cmath>
#include <csetjmp>
#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <type_traits>

extern "C" {
#include <cmocka.h>
}

#include <pbf/pbf.hpp>

/* malloc, counted; of a batch by several threads at once. */
class counted final : public pbf::allocator {
 public:
  std::atomic<long> live{0};
  long until_none = -1; /* allocations until there is no memory; -1: never */
  void *allocate(std::uint64_t size, std::uint64_t alignment) noexcept override {
    if (until_none == 0) return nullptr;
    if (until_none > 0) --until_none;
    ++live;
    return std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
  }
  void release(void *memory, std::uint64_t, std::uint64_t) noexcept override {
    --live;
    std::free(memory);
  }
};
inline counted memory;

inline pbf::desc test_desc() {
  pbf::desc desc;
  desc.backend = std::getenv("PBF_TEST_BACKEND");
  desc.strict = 1;
  desc.capacity = 100;
  desc.threads = 2;
  desc.memory = &memory;
  return desc;
}

template <class T>
T given(pbf::result<T> result) {
  if (!result) fail_msg("%s", result.message());
  return std::move(*result);
}

inline void done(const pbf::result<void> &result) {
  if (!result) fail_msg("%s", result.message());
}

inline void assert_refused(const pbf::detail::outcome &result, pbf_status status,
                           const char *words) {
  assert_false(result.ok());
  assert_int_equal(result.status(), status);
  if (!std::strstr(result.message(), words))
    fail_msg("\"%s\" lacks \"%s\"", result.message(), words);
}

/* Two particles. */
inline pbf::solver filled() {
  auto fluid = given(pbf::solver::create(test_desc()));
  const std::vector<float> x = {.5f, .5f, .5f, .6f, .5f, .5f};
  assert_int_equal(given(fluid.add_particles(x)), 0);
  return fluid;
}

/* After a test: all memory has been given back. */
inline int nothing_live(void **) {
  assert_int_equal(memory.live, 0);
  return 0;
}

inline void assert_near(double got, double wanted, double bound) {
  if (!(std::abs(got - wanted) <= bound)) fail_msg("%.9g is not %.9g", got, wanted);
}

constexpr double d = 0.05; /* the spacing by default */

/* 10 by 10 by 10 particles, at rest, in a corner of the tank. */
inline pbf::solver block() {
  pbf::desc desc = test_desc();
  desc.capacity = 1000;
  auto fluid = given(pbf::solver::create(desc));
  std::vector<float> x;
  for (int i = 0; i < 1000; ++i)
    for (const int n : {i % 10, i / 10 % 10, i / 100})
      x.push_back(static_cast<float>((n + .5) * d));
  given(fluid.add_particles(x));
  return fluid;
}

/* The groups of tests, a file each, give how many of theirs failed. */
int values();
int motion();
int shapes();
int queries();
int emission();
int phases();
int batches();
int diffuse();
int lifetimes();
int logs();

#endif
