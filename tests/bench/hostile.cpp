/* Scenes that keep to the schema and ask for too much, or for nothing: refused, or run, in no time.
 * And a parent that lets none of its children be waited for. */
#include <csignal>
#include <vector>

#include "bench_test.h"
#include "core/error.h"
#include "core/process.h"
#include "core/solver.h"
#include "core/standard_streams.h"
#include "scene/scene.h"

namespace {

using namespace bench;

std::string scene_text(const std::string &blocks, const std::string &more = "") {
  return R"({"version": 1, "description": "a", "purpose": "b", "dimension": 3, "params": {},)"
         R"("blocks": [)" +
         blocks + "], \"steps\": 100" + more + "}";
}

SceneOptions with(const std::string &text, uint64_t particles = 0) {
  SceneOptions options;
  options.name = PBF_TEST_WORK "/hostile.json";
  options.particles = particles;
  write_text(options.name, text);
  return options;
}

std::string refusal(const SceneOptions &options) {
  try {
    load_scene(options);
    return "";
  } catch (const Error &error) {
    assert_int_equal(error.code, exit_usage);
    return error.what();
  }
}

// Each ball is inside a lattice of 4e9 points, a thousand of them in one file.
void balls_too_large_to_be_counted(void **) {
  const std::string ball = R"({"shape": "ball", "center": [0.5, 0.5, 0.5], "radius": 40.5})";
  std::string balls = ball;
  for (int i = 0; i < (PBF_TEST_INSTRUMENTED ? 50 : 1000); ++i) balls += "," + ball;
  expect_contains(refusal(with(scene_text(balls))), "at most 1073741823 fit");
}

// Nothing is left of them, which only looking at each point tells.
void regions_of_too_many_points(void **) {
  if (PBF_TEST_INSTRUMENTED) return;  // a thousand million looks, in code that is not optimised
  const char *const block =
      R"({"shape": "box", "min": [0, 0, 0], "max": [55, 55, 55], "within": [{"below": -1}]})";
  expect_contains(refusal(with(scene_text(block))), "more than 1073741823 tests");
}

void a_ball_holds_what_is_inside_it(void **) {
  const Scene scene = load_scene(
      with(scene_text(R"({"shape": "ball", "center": [0.5, 0.51, 0.52], "radius": 0.33})")));
  uint64_t expected = 0;
  const double d = 0.05, first = -7 * d + d / 2;
  for (int k = 0; k < 14; ++k) {
    for (int j = 0; j < 14; ++j) {
      for (int i = 0; i < 14; ++i) {
        const double x = first + i * d, y = first + j * d, z = first + k * d;
        expected += x * x + y * y + z * z < 0.33 * 0.33;
      }
    }
  }
  assert_int_equal(count_particles(scene), expected);
  assert_int_equal(fill_scene(scene).count, expected);
}

void more_of_nothing(void **) {
  const char *const nothing = R"({"shape": "box", "min": [0.5, 0, 0], "max": [0.5, 1, 1]})";
  const std::string text = scene_text(nothing, R"(, "scaling": {"rule": "refine"})");
  assert_int_equal(count_particles(load_scene(with(text))), 0);
  expect_contains(refusal(with(text, 100)), "holds no particles");
}

// A row of more than all, of which there are two; and rows without end, of nothing.
void rows_without_end(void **) {
  const char *const rows = R"({"shape": "box", "min": [0, 0, 0], "max": [1e38, 0.1, 0.05]})";
  expect_contains(refusal(with(scene_text(rows))), "at most 1073741823 fit");
  const char *const nothing = R"({"shape": "box", "min": [0.5, 0, 0], "max": [0.5, 1e38, 1e38]})";
  assert_int_equal(fill_scene(load_scene(with(scene_text(nothing)))).count, 0);
}

void more_than_there_can_be(void **) {
  const char *const one =
      R"({"shape": "lattice", "first": [0.5, 0.5, 0.5], "counts": [1000000, 1, 1]})";
  const std::string grow =
      R"(, "scaling": {"rule": "grow", "axes": ["y"], "upper_walls": [0, 1, 0]})";
  expect_contains(refusal(with(scene_text(one, grow), 1073741823)), "particles that fit");
  const char *const few = R"({"shape": "box", "min": [0, 0, 0], "max": [0.05, 0.05, 0.05]})";
  std::string text = scene_text(few, R"(, "scaling": {"rule": "refine"})");
  text.replace(text.find("\"steps\": 100"), 12, "\"steps\": 4294967295");
  expect_contains(refusal(with(text, 1000)), "more than 4294967295 steps");
}

void fewer_steps_than_one(void **) {
  const char *const many = R"({"shape": "box", "min": [0, 0, 0], "max": [1, 1, 1]})";
  std::string text = scene_text(many, R"(, "scaling": {"rule": "refine"})");
  text.replace(text.find("\"steps\": 100"), 12, "\"steps\": 1");
  assert_int_equal(load_scene(with(text, 8)).steps, 1);
}

void a_spacing_that_halving_makes_nothing(void **) {
  std::string text = scene_text(R"({"shape": "box", "min": [0, 0, 0], "max": [0, 1, 1]})");
  text.replace(text.find("{}"), 2, R"({"smoothing_radius": 5e-324})");
  expect_contains(refusal(with(text)), "/blocks/0/spacing");
}

// 2^63 steps twice, and longer than any number of steps: the sum must not be 0 steps.
void motion_without_end(void **) {
  const char *const paddles = R"(, "colliders": [{"shape": "box", "position": [0.5, 0.5, 0.5],
    "motion": [{"duration": 92233720368547758.08}, {"duration": 92233720368547758.08}]},
    {"shape": "box", "position": [3, 0.5, 0.5], "motion": [{"duration": 1e300}, {"duration": 1}]}])";
  Scene scene = load_scene(with(scene_text(
      R"({"shape": "lattice", "first": [0.5, 0.5, 0.5], "counts": [1, 1, 1]})", paddles)));
  scene.params.time_step = 0.01;
  SolverOptions options;
  for (const pbf_backend_info &backend : list_backends({}, nullptr)) {
    if (backend.available) options.backend = backend.name;
  }
  if (options.backend.empty()) return;
  Solver solver(scene, options);
  solver.step(3);
  assert_int_equal(solver.info().step, 3);
}

// Looked up once for each line, not once for each number.
void arrays_without_end(void **) {
  std::string numbers = "[1";
  for (int i = 0; i < 1000000; ++i) numbers += ",1";
  const char *const one = R"({"shape": "lattice", "first": [0.5, 0.5, 0.5], "counts": [1, 1, 1]})";
  const std::string text = scene_text(one, ",\n \"more\": " + numbers + "]");
  expect_contains(refusal(with(text)), "hostile.json:2:10: /more");
}

void a_sentence_is_no_longer_than_one(void **) {
  const std::string digits = ", \"more\": " + std::string(1000000, '1');
  const std::string sentence = refusal(with(scene_text("", digits)));
  expect_contains(sentence, "number overflow");
  assert_true(sentence.size() < 1000);
}

// A program inherits it, and the system then forgets how its own children end.
void a_parent_that_ignores_its_children(void **) {
  std::signal(SIGCHLD, SIG_IGN);
  prepare_standard_streams();
  const Ended ended = run_program({"sh", "-c", "exit 7"});
  assert_string_equal(ended.reason.c_str(), "");
  assert_int_equal(ended.code, 7);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(balls_too_large_to_be_counted),
      cmocka_unit_test(regions_of_too_many_points),
      cmocka_unit_test(a_ball_holds_what_is_inside_it),
      cmocka_unit_test(more_of_nothing),
      cmocka_unit_test(rows_without_end),
      cmocka_unit_test(more_than_there_can_be),
      cmocka_unit_test(fewer_steps_than_one),
      cmocka_unit_test(a_spacing_that_halving_makes_nothing),
      cmocka_unit_test(motion_without_end),
      cmocka_unit_test(arrays_without_end),
      cmocka_unit_test(a_sentence_is_no_longer_than_one),
      cmocka_unit_test(a_parent_that_ignores_its_children),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
