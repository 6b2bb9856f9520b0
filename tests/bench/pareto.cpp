/* pareto: fronts and what lies between their points, sweep files, the plan made of them, results
 * that are read back. */
#include <cmath>
#include <cstdio>
#include <cstring>
#include <set>

#include "bench_test.h"
#include "core/error.h"
#include "pareto/analysis.h"
#include "pareto/judge.h"
#include "report/chart.h"

namespace {

using namespace bench;

// In double precision, which cmocka's own comparison is not.
void near(double value, double expected, double tolerance) {
  if (!(std::fabs(value - expected) <= tolerance)) {
    print_error("%.17g is not %.17g\n", value, expected);
  }
  assert_true(std::fabs(value - expected) <= tolerance);
}

// ---- Fronts ----

void a_front_has_what_nothing_beats(void **) {
  const std::vector<Sample> front = front_of({{4, 0.01, 0},
                                              {1, 0.2, 1},
                                              {2, 0.3, 2},
                                              {2, 0.1, 3},
                                              {3, 0.1, 4},
                                              {8, 0.01, 5},
                                              {1, 0.5, 6}});
  assert_int_equal(front.size(), 3);
  const size_t expected[] = {1, 3, 0};
  for (size_t i = 0; i < 3; ++i) assert_int_equal(front[i].point, expected[i]);
  assert_true(front_of({}).empty());
}

// Along error = 1/time², which is straight on logarithmic axes.
const std::vector<Sample> parabola = {{1, 1, 0}, {10, 1e-2, 1}, {100, 1e-4, 2}};

void between_points_the_front_is_straight(void **) {
  near(*error_at_time(parabola, 2), 0.25, 1e-12);
  near(*error_at_time(parabola, 50), 1.0 / 2500, 1e-12);
  near(*error_at_time(parabola, 1000), 1e-4, 1e-15);
  assert_false(error_at_time(parabola, 0.5).has_value());
  near(time_at_error(parabola, 0.25)->time, 2, 1e-12);
  near(time_at_error(parabola, 1e-2)->time, 10, 1e-12);
  assert_false(time_at_error(parabola, 0.25)->at_most);
  assert_false(time_at_error(parabola, 1e-5).has_value());
  const auto easy = time_at_error(parabola, 2);
  assert_true(easy->at_most);
  near(easy->time, 1, 0);
}

// No straight line leads to an error of 0 on a logarithmic axis.
void an_error_of_0_is_reached_at_its_point(void **) {
  const std::vector<Sample> front = front_of({{1, 0.1, 0}, {10, 0, 1}});
  near(*error_at_time(front, 5), 0.1, 0);
  near(time_at_error(front, 1e-3)->time, 10, 0);
}

void advantages_compare_where_both_have_something(void **) {
  const std::vector<Sample> fast = {{0.1, 1, 0}, {1, 1e-2, 1}, {10, 1e-4, 2}};  // a tenth the time
  const auto equal = at_equal_time(parabola, fast);
  near(equal->median, 100, 1e-9);
  near(equal->most, 100, 1e-9);
  near(equal->least, 1, 1e-9);  // both end at 1e-4
  near(equal->from, 1, 0);
  near(at_equal_error(parabola, 100, fast, 1e-3)->ratio, 10, 1e-9);
  assert_false(at_equal_time(parabola, {}).has_value());
  assert_false(at_equal_time({{5, 1, 0}}, {}).has_value());
}

void ratios_say_when_they_are_bounds(void **) {
  using Bound = TimeRatio::Bound;
  const std::vector<Sample> poor = {{1, 0.5, 0}, {20, 0.1, 1}}, good = {{1, 0.3, 0}, {2, 1e-3, 1}};
  const auto never = at_equal_error(poor, 30, good, 1e-3);
  near(never->ratio, 15, 1e-12);
  assert_int_equal(never->bound, Bound::at_least);
  const auto at_once = at_equal_error(poor, 30, good, 0.4);
  assert_int_equal(at_once->bound, Bound::at_least);
  assert_int_equal(at_equal_error(good, 2, poor, 0.4)->bound, Bound::at_most);
  assert_int_equal(at_equal_error(poor, 30, {{1, 0.4, 0}, {2, 0.05, 1}}, 0.1)->bound, Bound::exact);
  assert_false(at_equal_error(good, 2, poor, 1e-3).has_value());
  assert_false(at_equal_error(good, 2, poor, 0.9).has_value());
}

// ---- Sweep files ----

std::string sweep_text(const std::string &families, const std::string &baseline = "a") {
  return R"({"version": 1, "description": "d", "baseline": ")" + baseline +
         R"(", "subject": "b", "errors": [{"figure": "E1.x@mean", "title": "t", "explains": "e"},
            {"figure": "E9.rms@last", "title": "t", "explains": "e", "scenes": ["still-tank"]}],
            "families": [)" +
         families + "]}";
}

const char *const two =
    R"({"name": "a", "title": "A", "set": {"solver": "jacobi", "wall_density": 0},
        "vary": [{"iterations": [1, 2, 4], "divide_time_step": [1, 2]}, {"cfm": [0.5]}]},
       {"name": "b", "title": "B"})";

Sweep sweep_of(const std::string &text, const char *scene = "dam-break-2d") {
  return read_sweep(Document("s.json", text), scene);
}

void a_sweep_takes_every_combination(void **) {
  const Sweep sweep = sweep_of(sweep_text(two));
  assert_int_equal(sweep.candidates.size(), 3 * 2 + 1 + 1);
  assert_int_equal(sweep.baseline, 0);
  assert_int_equal(sweep.subject, 1);
  assert_int_equal(sweep.candidates[0].choices.size(), 4);
  assert_int_equal(sweep.candidates[6].choices.size(), 3);
  assert_int_equal(sweep.candidates[7].choices.size(), 0);
}

void errors_are_for_the_scenes_they_name(void **) {
  assert_int_equal(sweep_of(sweep_text(two)).errors.size(), 1);
  assert_int_equal(sweep_of(sweep_text(two), "still-tank").errors.size(), 2);
}

void the_built_in_sweeps_are_whole(void **) {
  for (const char *scene : {"still-tank", "dam-break-3d"}) {
    assert_true(default_sweep(scene).candidates.size() > 50);
    assert_int_equal(quick_sweep(scene).baseline, 0);
  }
  const Sweep sweep = default_sweep("dam-break-3d");
  assert_string_equal(sweep.families[sweep.baseline].name.c_str(), "plain");
}

std::string refusal(const std::string &text) {
  try {
    sweep_of(text);
    return "";
  } catch (const Error &error) {
    assert_int_equal(error.code, exit_usage);
    return error.what();
  }
}

void wrong_sweeps_are_refused_with_the_place(void **) {
  const auto families = [](const std::string &a) {
    return sweep_text("{\"name\": \"a\", \"title\": \"A\", " + a +
                      "}, {\"name\": \"b\", \"title\": \"B\"}");
  };
  const std::string wrong[][2] = {
      {"{", "s.json:1:2: this is not JSON"},
      {"{}", "is missing"},
      {sweep_text(two, "nonesuch"), "/baseline: there is no family \"nonesuch\""},
      {sweep_text(R"({"name": "a", "title": "A"}, {"name": "a", "title": "B"})"), "stands twice"},
      {sweep_text(R"({"name": "a", "title": "A"})"), "at least 2 families"},
      {families(R"("sett": {})"), "did you mean set"},
      {families(R"("set": {"iterationz": 3})"), "did you mean iterations?"},
      {families(R"("set": {"time_step": 0.1})"), "divide_time_step"},
      {families(R"("set": {"gravity": [0, -1]})"), "one for the whole sweep"},
      {families(R"("set": {"divide_time_step": 0})"), "wanted: an integer, 1 … 1000"},
      {families(R"("set": {"smoothing_radius": 0.1})"), "support takes h as a multiple"},
      {families(R"("set": {"support": 1})"), "wanted: a number above 1, up to 8"},
      {families(R"("set": {"precision": "f16"})"), "wanted: \"f32\" or \"f64\""},
      {families(R"("vary": [{"iterations": []}])"), "wanted: a list of values"},
      {families(R"("vary": [{"iterations": 3}])"), "wanted: a list of values"},
      {families(R"("set": {"cfm": 1}, "vary": [{"cfm": [1, 2]}])"), "whole family already"},
  };
  for (const auto &[text, words] : wrong) expect_contains(refusal(text), words);
  expect_contains(refusal(families(R"("set": {"iterationz": 3})")), "s.json:3:");
}

// ---- The plan ----

PlanOptions plan_options(const char *scene = "dam-break-2d") {
  PlanOptions options;
  options.scene.name = scene;
  options.scene.particles = 200;
  options.scene.steps = 20;
  options.frames = 5;
  return options;
}

void finer_time_steps_keep_the_simulated_time(void **) {
  const Plan plan = make_plan(sweep_of(sweep_text(two)), plan_options());
  for (const Point &point : plan.points) {
    near(simulated_time(point), 20 * plan.scene.params.time_step, 1e-12);
    near(point.every * point.scene.params.time_step, 4 * plan.scene.params.time_step, 1e-12);
  }
  assert_int_equal(plan.points[1].divide * plan.points[1].scene.params.iterations, 2);
}

void support_keeps_the_spacing(void **) {
  const Plan plan =
      make_plan(sweep_of(sweep_text(R"({"name": "a", "title": "A", "vary": [{"support": [2, 3]}]},
                             {"name": "b", "title": "B"})")),
                plan_options());
  const pbf_params &narrow = plan.points[0].scene.params, &wide = plan.points[1].scene.params;
  near(narrow.spacing, wide.spacing, 0);
  near(narrow.smoothing_radius, 2 * narrow.spacing, 1e-12);
  near(wide.smoothing_radius, 3 * narrow.spacing, 1e-12);
  assert_string_equal(plan.points[1].label.c_str(), "h = 3 d");
  assert_true(plan.points[1].work > 2 * plan.points[0].work);
}

// Matter begins half a spacing behind the bound where walls lend no density, else at the bound.
void walls_stand_at_one_place(void **) {
  const Plan plan = make_plan(sweep_of(sweep_text(two)), plan_options());
  const pbf_params &bare = plan.points[0].scene.params, &lent = plan.points.back().scene.params;
  near(bare.wall_density, 0, 0);
  assert_true(lent.wall_density > 0);
  for (unsigned axis = 0; axis < 2; ++axis) {
    const double half = lent.spacing / 2;
    near(bare.domain_min[axis] - half, lent.domain_min[axis], 1e-12);
    near(bare.domain_max[axis] + half, lent.domain_max[axis], 1e-12);
  }
}

void keys_change_with_whatever_changes_an_outcome(void **) {
  const Sweep sweep = sweep_of(sweep_text(two));
  const Plan plan = make_plan(sweep, plan_options());
  std::set<std::string> keys;
  for (const Point &point : plan.points) keys.insert(point.key);
  assert_int_equal(keys.size(), plan.points.size());
  assert_string_equal(make_plan(sweep, plan_options()).points[0].key.c_str(),
                      plan.points[0].key.c_str());
  std::vector<PlanOptions> others(6, plan_options());
  others[0].scene.steps = 40;
  others[1].scene.particles = 300;
  others[2].judge = "another";
  others[3].frames = 2;
  others[5].cpu_time = true;
  others[4].scene.settings = {"gravity.1=-3"};
  for (const PlanOptions &other : others) keys.insert(make_plan(sweep, other).points[0].key);
  assert_int_equal(keys.size(), plan.points.size() + others.size());
}

void a_value_that_no_scene_takes_is_refused_with_the_sweeps_line(void **) {
  const std::string text = sweep_text(
      "{\"name\": \"a\", \"title\": \"A\", \"set\": {\"iterations\": 0}},\n"
      "{\"name\": \"b\", \"title\": \"B\"}");
  try {
    make_plan(sweep_of(text), plan_options());
    fail();
  } catch (const Error &error) {
    assert_int_equal(error.code, exit_usage);
    expect_contains(error.what(), "s.json:3:");
    expect_contains(error.what(), "wanted: an integer, at least 1");
  }
}

// ---- Reports of the checker, and results ----

void means_leave_the_start_out(void **) {
  const auto report = nlohmann::json::parse(R"({"errors": {
      "E1": {"figures": {}, "frames": [{"x": 9}, {"x": 0.1}, {"x": -0.3}, {"x": 0.2}]},
      "E6": {"figures": {"highest_gain": -0.5}, "frames": []},
      "E7": {"reason": "no gravity"}}})");
  Outcome outcome;
  read_report(report,
              {{"E1.x@mean", "", ""},
               {"E1.x@largest", "", ""},
               {"E1.x@last", "", ""},
               {"E1.y@mean", "", ""},
               {"E6.highest_gain", "", ""},
               {"E7.max@last", "", ""}},
              outcome);
  near(outcome.errors.at("E1.x@mean"), 0.2, 1e-12);
  near(outcome.errors.at("E1.x@largest"), 0.3, 0);
  near(outcome.errors.at("E1.x@last"), 0.2, 0);
  near(outcome.start.at("E1.x@last"), 9, 0);
  near(outcome.errors.at("E6.highest_gain"), 0, 0);
  assert_int_equal(outcome.errors.size(), 4);
  assert_string_equal(outcome.reasons.at("E7.max@last").c_str(), "no gravity");
  assert_int_equal(outcome.reasons.count("E1.y@mean"), 1);
}

Study study_of(const std::string &text) {
  Study study;
  study.sweep = sweep_of(text);
  study.plan = make_plan(study.sweep, plan_options());
  return study;
}

void results_are_read_back(void **) {
  const std::string path = PBF_TEST_WORK "/results.json";
  Study written = study_of(sweep_text(two));
  written.plan.points[0].outcome = {
      {{"E1.x@mean", 0.125}}, {{"E1.x@mean", 1e-7}}, {}, "abc", {0.5, 0.75, 0.25}, "", "c0ffee"};
  written.plan.points[2].outcome.reason = "given up";
  write_results(written, path);
  Study read = study_of(sweep_text(two));
  assert_int_equal(resume(path, read), 0);
  const Outcome &outcome = read.plan.points[0].outcome;
  near(outcome.errors.at("E1.x@mean"), 0.125, 0);
  near(outcome.start.at("E1.x@mean"), 1e-7, 0);
  assert_int_equal(outcome.seconds.size(), 3);
  assert_string_equal(outcome.state.c_str(), "abc");
  near(median_cost(read.plan.points[0]) * simulated_time(read.plan.points[0]), 0.5, 1e-12);
  assert_false(read.plan.points[1].outcome.judged());
  assert_string_equal(read.plan.points[2].outcome.reason.c_str(), "given up");
  read.plan.points[0].key = "another";
  assert_int_equal(resume(path, read), 1);
}

// The places of a group's points in a chart, as attribute `name`; smaller ones are farther up.
std::vector<double> places(const std::string &svg, const std::string &group, const char *name) {
  std::vector<double> found;
  const size_t begin = svg.find("<g id=\"" + group + "\"");
  const size_t end = svg.find("<g id=", begin + 1);
  for (size_t at = svg.find("<use ", begin); at < end; at = svg.find("<use ", at + 1)) {
    const size_t value = svg.find(" " + std::string(name) + "=\"", at) + std::strlen(name) + 3;
    found.push_back(std::stod(svg.substr(value)));
  }
  return found;
}

// A setting that blew up does not press the others together; what is better than any lies below.
void charts_keep_their_points_inside(void **) {
  Chart chart;
  chart.series.push_back(
      {"a",
       {{0.01, 0, 0.01, 0.01, true, "<none> & \"0\"", "default"}, {1, 0.5, 0.9, 1.2, true, "b"}}});
  Chart with = chart;
  with.series[0].points.push_back({0.1, 1e6, 0.1, 0.1, false, "c"});
  const std::vector<std::string> drawn = draw_charts({chart, with, Chart()});
  assert_int_equal(drawn.size(), 3);
  if (drawn[0].find("No chart") != std::string::npos) {
    std::puts("skipped: Matplotlib draws the chart, and is not there");
    return skip();
  }
  expect_contains(drawn[0], "&lt;none&gt; &amp; \"0\"</title>");
  expect_contains(drawn[0], "default</text>");
  const std::vector<double> alone = places(drawn[0], "front0", "y");
  assert_int_equal(alone.size(), 2);
  assert_true(alone[1] > 0 && alone[1] < alone[0] && alone[0] < chart.height);
  assert_true(places(drawn[1], "front0", "y") == alone);
  const std::vector<double> worse = places(drawn[1], "rest0", "y");
  assert_int_equal(worse.size(), 1);
  assert_true(worse[0] > 0 && worse[0] < alone[1]);
  expect_contains(drawn[2], "</svg>");
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_front_has_what_nothing_beats),
      cmocka_unit_test(between_points_the_front_is_straight),
      cmocka_unit_test(an_error_of_0_is_reached_at_its_point),
      cmocka_unit_test(advantages_compare_where_both_have_something),
      cmocka_unit_test(ratios_say_when_they_are_bounds),
      cmocka_unit_test(a_sweep_takes_every_combination),
      cmocka_unit_test(errors_are_for_the_scenes_they_name),
      cmocka_unit_test(the_built_in_sweeps_are_whole),
      cmocka_unit_test(wrong_sweeps_are_refused_with_the_place),
      cmocka_unit_test(finer_time_steps_keep_the_simulated_time),
      cmocka_unit_test(support_keeps_the_spacing),
      cmocka_unit_test(walls_stand_at_one_place),
      cmocka_unit_test(keys_change_with_whatever_changes_an_outcome),
      cmocka_unit_test(a_value_that_no_scene_takes_is_refused_with_the_sweeps_line),
      cmocka_unit_test(means_leave_the_start_out),
      cmocka_unit_test(results_are_read_back),
      cmocka_unit_test(charts_keep_their_points_inside),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
