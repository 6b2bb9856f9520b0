/* Objects that are moved, or outlive each other, and memory that is short. */
#include "support.h"

static void moved_from_is_refused(void **) {
  auto fluid = filled();
  pbf::solver taken = std::move(fluid);
  assert_refused(fluid.step(), PBF_ERROR_INVALID_ARGUMENT, "solver");  // NOLINT
  assert_refused(fluid.add_particles(std::vector<float>(3)), PBF_ERROR_INVALID_ARGUMENT, "solver");
  assert_refused(fluid.reader().cancel(), PBF_ERROR_INVALID_ARGUMENT, "solver");
  assert_false(fluid.take_log_exception() != nullptr);
  done(taken.step());
  fluid = std::move(taken);
  done(fluid.step());
}

template <class T>
static void move_to(T &to, T &from) {
  to = std::move(from);
}

/* As algorithms may that exchange the elements of a container. */
static void what_is_moved_to_itself_stays(void **) {
  auto fluid = filled();
  move_to(fluid, fluid);
  done(fluid.set_snapshots(2));
  done(fluid.step());
  auto snapshot = given(fluid.acquire_snapshot());
  move_to(snapshot, snapshot);
  assert_int_equal(snapshot.size(), 2);
  auto view = given(fluid.map(PBF_FIELD_POSITION));
  move_to(view, view);
  assert_refused(fluid.step(), PBF_ERROR_STATE, "map");
  assert_int_equal(view.size(), 2);
  const auto other = std::move(view);
  assert_int_equal(view.size(), 0);  // NOLINT
  assert_true(view.raw().data == nullptr && view.ids().empty());
  assert_int_equal(other.size(), 2);
}

static void views_block_steps_and_outlive_solvers(void **) {
  std::vector<pbf::view> kept;
  {
    auto fluid = filled();
    {
      auto view = given(fluid.map(PBF_FIELD_POSITION));
      assert_int_equal(view.size(), 2);
      assert_refused(fluid.step(), PBF_ERROR_STATE, "map");
    }
    done(fluid.step(0));
    kept.push_back(given(fluid.map(PBF_FIELD_POSITION)));
  }
  if (kept[0].on_host()) {
    const bool first = kept[0].ids()[0] == 0;
    assert_true(kept[0].at<float>(first ? 0 : 1, 0) == .5f);
    assert_true(kept[0].at<float>(first ? 1 : 0, 0) == .6f);
  }
  assert_true(memory.live > 0);
  kept.clear();
}

static void snapshots_outlive_solvers(void **) {
  std::vector<pbf::snapshot> kept;
  {
    auto fluid = filled();
    done(fluid.set_snapshots(2));
    kept.push_back(given(fluid.acquire_snapshot()));
  }
  assert_int_equal(kept[0].size(), 2);
  assert_int_equal(kept[0].positions<float>().size(), 6);
  assert_true(kept[0].positions<float>()[3] == .6f);
  assert_true(kept[0].positions<double>().empty());
}

static void readers_outlive_solvers(void **) {
  std::vector<pbf::reader> kept;
  pbf_solver *handle = nullptr;
  {
    auto fluid = filled();
    handle = fluid.handle();
    kept.push_back(fluid.reader());
    done(fluid.begin_step(1000000000));
    assert_refused(fluid.count(), PBF_ERROR_BUSY, "");
  } /* cancelled and waited for, though the reader still has the solver */
  std::uint32_t count = 0;
  assert_int_equal(pbf_get_count(handle, &count), PBF_OK);
  done(kept[0].cancel());
  assert_refused(kept[0].acquire_snapshot(), PBF_ERROR_STATE, "snapshot");
}

static void memory_that_is_short_is_an_error(void **) {
  for (long n = 0; n < 4; ++n) {
    memory.until_none = n;
    assert_refused(pbf::solver::create(test_desc()), PBF_ERROR_OUT_OF_MEMORY, "");
    memory.until_none = -1;
    assert_int_equal(memory.live, 0);
  }
}

int lifetimes() {
  const CMUnitTest tests[] = {
      cmocka_unit_test_teardown(moved_from_is_refused, nothing_live),
      cmocka_unit_test_teardown(what_is_moved_to_itself_stays, nothing_live),
      cmocka_unit_test_teardown(views_block_steps_and_outlive_solvers, nothing_live),
      cmocka_unit_test_teardown(snapshots_outlive_solvers, nothing_live),
      cmocka_unit_test_teardown(readers_outlive_solvers, nothing_live),
      cmocka_unit_test_teardown(memory_that_is_short_is_an_error, nothing_live),
  };
  return cmocka_run_group_tests_name("lifetimes", tests, nullptr, nullptr);
}
