/* The log, and exceptions that its function throws. */
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
#if PBF_HAS_EXCEPTIONS
    cmocka_unit_test_teardown(log_exceptions_stay_out_of_the_library, nothing_live),
    cmocka_unit_test_teardown(log_exceptions_of_batches_do, nothing_live),
    cmocka_unit_test_teardown(values_throw, nothing_live),
#endif
  };
  return cmocka_run_group_tests_name("logs", tests, nullptr, nullptr);
}
