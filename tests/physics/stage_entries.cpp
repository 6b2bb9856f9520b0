/* The entries of stages in a plan and in times: stages next to each other of one name share one. */
#include "support.h"

#include "common/report.h"

static void stages_of_one_name_share_an_entry(void **state) {
  (void)state;
  pbf_plan plan = {};
  pbf_timings times = {};
  pbf_plan_add_stage(&plan, PBF_STAGE_LAMBDA, 4)->launches_per_step += 4;
  pbf_plan_add_stage(&plan, PBF_STAGE_MOVE, 3)->launches_per_step += 3;
  pbf_plan_add_stage(&plan, PBF_STAGE_MOVE, 2)->launches_per_step += 4;
  pbf_plan_add_stage(&plan, PBF_STAGE_DRAG, 1);
  assert_int_equal(plan.stage_count, 3);
  assert_string_equal(plan.stages[1].name, "move");
  assert_int_equal(plan.stages[1].runs_per_step, 3);
  assert_int_equal(plan.stages[1].launches_per_step, 7);
  assert_string_equal(plan.stages[2].name, "drag");
  pbf_timings_add(&times, PBF_STAGE_MOVE, 1.5, 20);
  pbf_timings_add(&times, PBF_STAGE_MOVE, 2.5, 10);
  assert_int_equal(times.stage_count, 1);
  assert_true(times.stages[0].milliseconds == 4);
  assert_int_equal(times.stages[0].runs, 20);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(stages_of_one_name_share_an_entry)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
