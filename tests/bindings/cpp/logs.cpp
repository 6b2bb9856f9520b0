/* The log, and exceptions that its function throws. */
#include <atomic>
#include <mutex>
#include <optional>
#include <thread>

#include "support.h"

static std::string logged;

/* The log is told of its time step. */
static pbf::solver falling_too_fast(const pbf::desc &desc) {
  pbf::params params;
  params.time_step = 0.5;
  auto fluid = given(pbf::solver::create(desc, params));
  given(fluid.add_particles(std::vector<float>{.5f, .5f, .5f}));
  return fluid;
}

static void logs_are_heard(void **) {
  logged.clear();
  pbf::desc desc = test_desc();
  desc.log_to = [count = 0](int, const char *sentence) mutable {
    logged = std::to_string(++count) + sentence;
  };
  auto fluid = falling_too_fast(desc);
  done(fluid.step());
  assert_non_null(std::strstr(logged.c_str(), "time_step"));
  assert_int_equal(logged[0], '1');
  assert_false(fluid.take_log_exception() != nullptr);
}

static std::atomic<int> gone, told;

/* What a log has for its own. */
struct held {
  ~held() { ++gone; }
};

static std::optional<pbf::solver> slot;
static std::mutex slots_lock;

static pbf::solver destroyed_by_its_log() {
  pbf::params params;
  params.time_step = .5; /* for this and the attraction steps are too long */
  params.attraction = 20;
  pbf::desc desc = test_desc();
  desc.memory = nullptr; /* what is counted belongs to the thread of the test */
  desc.log_to = [own = std::make_shared<held>()](int, const char *) {
    const std::lock_guard<std::mutex> hold(slots_lock);
    slot.reset();
    told += gone == 0 && own ? 1 : 100;
  };
  return given(pbf::solver::create(desc, params));
}

static void a_log_of_begun_steps_destroys(void **) {
  gone = told = 0;
  {
    const std::lock_guard<std::mutex> hold(slots_lock);
    slot.emplace(destroyed_by_its_log());
    given(slot->add_particles(std::vector<float>(3, .5f)));
    done(slot->begin_step(UINT32_MAX));
  }
  while (gone == 0) std::this_thread::yield();
  assert_int_equal(told, 1);
}

#if PBF_HAS_EXCEPTIONS
static void log_exceptions_stay_out_of_the_library(void **) {
  pbf::desc desc = test_desc();
  desc.log_to = [](int, const char *sentence) { throw std::string(sentence); };
  auto fluid = falling_too_fast(desc);
  done(fluid.begin_step());
  done(fluid.end_step());
  const std::exception_ptr thrown = fluid.take_log_exception();
  assert_true(thrown != nullptr);
  try {
    std::rethrow_exception(thrown);
  } catch (const std::string &sentence) {
    assert_non_null(std::strstr(sentence.c_str(), "time_step"));
  }
  assert_false(fluid.take_log_exception() != nullptr);
  done(fluid.step()); /* the solver goes on, as one does not that an exception has left */
}

static void log_exceptions_of_batches_do(void **) {
  pbf::params params;
  params.time_step = .5; /* which the log is told of */
  pbf::desc desc = test_desc();
  desc.log_to = [](int, const char *sentence) { throw std::string(sentence); };
  auto batch = given(pbf::batch::create(desc, params, 2));
  const std::array<std::uint32_t, 2> counts = {1, 1};
  done(batch.add_particles(counts, std::vector<float>(6, .5f)));
  done(batch.step());
  assert_true(batch.take_log_exception() != nullptr);
  assert_false(given(batch.world(0)).take_log_exception() != nullptr);
}

static void values_throw(void **) {
  auto fluid = pbf::solver::create(test_desc()).value();
  fluid.step().value();
  try {
    given(fluid.get_params());
    pbf::params params;
    params.smoothing_radius = -2;
    fluid.set_params(params).value();
    fail_msg("nothing was thrown");
  } catch (const pbf::exception &thrown) {
    assert_int_equal(thrown.status(), PBF_ERROR_INVALID_ARGUMENT);
    assert_non_null(std::strstr(thrown.what(), "smoothing_radius"));
  }
}
#endif

int logs() {
  const CMUnitTest tests[] = {
    cmocka_unit_test_teardown(logs_are_heard, nothing_live),
    cmocka_unit_test(a_log_of_begun_steps_destroys),
#if PBF_HAS_EXCEPTIONS
    cmocka_unit_test_teardown(log_exceptions_stay_out_of_the_library, nothing_live),
    cmocka_unit_test_teardown(log_exceptions_of_batches_do, nothing_live),
    cmocka_unit_test_teardown(values_throw, nothing_live),
#endif
  };
  return cmocka_run_group_tests_name("logs", tests, nullptr, nullptr);
}
