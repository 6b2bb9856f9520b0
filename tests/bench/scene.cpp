/* Scene files that are wrong: each gets file, line, column and reason. */
#include <vector>

#include "bench_test.h"
#include "core/error.h"
#include "scene/scene.h"

namespace {

using namespace bench;

// Line by line, so that the table below can name lines.
const char *const good[] = {
    R"({)",                                                                          // 1
    R"(  "version": 1,)",                                                            // 2
    R"(  "description": "A block",)",                                                // 3
    R"(  "purpose": "The tests.",)",                                                 // 4
    R"(  "dimension": 3,)",                                                          // 5
    R"(  "params": {)",                                                              // 6
    R"(    "kernel": "wendland_c2",)",                                               // 7
    R"(    "gravity": [0, -9.81, 0],)",                                              // 8
    R"(    "iterations": 3)",                                                        // 9
    R"(  },)",                                                                       // 10
    R"(  "blocks": [{"shape": "box", "min": [0, 0, 0], "max": [0.5, 0.5, 0.5]}],)",  // 11
    R"(  "colliders": [{"shape": "sphere", "position": [0.8, 0.1, 0.5]}],)",         // 12
    R"(  "steps": 7)",                                                               // 13
    R"(})",                                                                          // 14
};

struct Case {
  int line;  // to replace; 0: none
  const char *with;
  const char *place;   // what the message must say after the file's name
  const char *reason;  // … and must hold
};

const Case cases[] = {
    {0, "", "", ""},
    // Wrong keys
    {13, R"(  "stepps": 7)", ":13:13: ", "\"stepps\" does not belong here (did you mean steps?)"},
    {9, R"(    "itterations": 3)", ":9:20: ", "did you mean iterations?"},
    {11, R"(  "blocks": [{"shape": "box", "min": [0,0,0], "max": [1,1,1], "counts": [1,1,1]}],)",
     ":11:73: ", "\"counts\" does not belong here"},
    {12, R"(  "colliders": [{"shape": "box", "position": [0,0,0], "colour": 3}],)",
     ":12:65: ", "\"colour\" does not belong here"},
    {12, R"(  "colliders": [{"shape": "box", "position": [0,0,0], "radius": 3}],)",
     ":12:65: ", "\"radius\" does not belong here"},
    {13, R"(  "steps": 7, "scaling": {"rule": "refine", "axes": ["x"]})",
     ":13:53: ", "\"axes\" does not belong here"},
    {9, R"(    "iterations": 3, "iterations": 4)", ":9:22: ", "stands twice"},
    // Wrong types
    {5, R"(  "dimension": "3",)", ":5:16: ", "the value is \"3\"; wanted: 2 or 3"},
    {6, R"(  "params": [],  "params_": {)", ":6:13: ", "wanted: an object of fields of pbf_params"},
    {8, R"(    "gravity": -9.81,)", ":8:16: ", "wanted: a list"},
    {8, R"(    "gravity": [0, true, 0],)", ":8:20: ", "the value is true; wanted: a number"},
    {9, R"(    "iterations": 3.5)", ":9:19: ", "wanted: an integer"},
    {13, R"(  "steps": "7")", ":13:12: ", "the value is \"7\""},
    {12, R"(  "colliders": [{"shape": "box", "position": [0,0,0], "inverted": 1}],)",
     ":12:67: ", "wanted: true or false"},
    // Wrong values
    {2, R"(  "version": 2,)", ":2:14: ", "the value is 2"},
    {5, R"(  "dimension": 4,)", ":5:16: ", "the value is 4; wanted: 2 or 3"},
    {7, R"(    "kernel": "gauss",)", ":7:15: ", "the value is \"gauss\"; wanted: \"wendland_c2\""},
    {7, R"(    "smoothing_radius": 0,)", ":7:25: ", "wanted: a number above 0"},
    {7, R"(    "time_step": -1,)", ":7:18: ", "wanted: a number above 0"},
    {7, R"(    "collide": [],)", ":7:16: ", "wanted: a list"},
    {7, R"(    "collide": ["after_solve", "after_solve"],)", ":7:16: ", "each at most once"},
    {7, R"(    "collide": ["after_solve", "sometimes"],)", ":7:32: ", "the value is \"sometimes\""},
    {9, R"(    "iterations": 0)", ":9:19: ", "the value is 0"},
    {9, R"(    "iterations": 4294967296)", ":9:19: ", "the value is 4294967296"},
    {13, R"(  "steps": 0)", ":13:12: ", "the value is 0"},
    {13, R"(  "steps": -7)", ":13:12: ", "the value is -7"},
    {11, R"(  "blocks": [],)", ":11:13: ", "wanted: a list of blocks"},
    {11, R"(  "blocks": [{"shape": "cone", "min": [0,0,0], "max": [1,1,1]}],)",
     ":11:24: ", "\"cone\""},
    {11, R"(  "blocks": [{"shape": "ball", "center": [0,0,0], "radius": 0}],)",
     ":11:61: ", "a number above 0"},
    {12, R"(  "colliders": [{"shape": "box", "position": [0,0,0], "motion": [{"duration": 0}]}],)",
     ":12:79: ", "a number above 0"},
    // Lists that do not fit the dimension
    {8, R"(    "gravity": [0, -9.81],)",
     ":8:16: ", "the list has 2 numbers; this scene's dimension wants 3"},
    {8, R"(    "wall_phase": [0, 0, 0, 0],)", ":8:19: ", "wants 6"},
    {11, R"(  "blocks": [{"shape": "box", "min": [0, 0], "max": [1, 1, 1]}],)",
     ":11:38: ", "wants 3"},
    {12, R"(  "colliders": [{"shape": "box", "position": [0, 0]}],)", ":12:46: ", "wants 3"},
    {11,
     R"(  "blocks": [{"shape": "ball", "center": [0,0,0], "radius": 1, "velocity_gradient": [[0,0,0],[0,0,0]]}],)",
     ":11:85: ", "the list has 2 rows; this scene's dimension wants 3"},
    {11,
     R"(  "blocks": [{"shape": "ball", "center": [0,0,0], "radius": 1, "velocity_gradient": [[0,0,0],[0,0],[0,0,0]]}],)",
     ":11:94: ", "the list has 2 numbers; this scene's dimension wants 3"},
    {11,
     R"(  "blocks": [{"shape": "ball", "center": [0,0,0], "radius": 1, "within": [{"slopes": [0,1], "below": 0}]}],)",
     ":11:86: ", "the list has 2 numbers; this scene's dimension wants 3"},
    // Missing
    {4, "", ":1:1: ", "\"purpose\" is missing"},
    {11, R"(  "blocks": [{"shape": "box", "min": [0,0,0]}],)", ":11:14: ", "\"max\" is missing"},
    {11, R"(  "blocks": [{"min": [0,0,0]}],)", ":11:14: ", "\"shape\" is missing"},
    {13, R"(  "steps": 7, "scaling": {"rule": "grow"})", ":13:26: ", "is missing"},
    {11,
     R"(  "blocks": [{"shape": "ball", "center": [0,0,0], "radius": 1, "within": [{"slopes": [0,1,0]}]}],)",
     ":11:75: ", "\"below\" is missing"},
    // Too many
    {11, R"(  "blocks": [{"shape": "lattice", "first": [0,0,0], "counts": [99999,99999,9]}],)",
     ":11:13: ", "at most 1073741823 fit"},
    {11, R"(  "blocks": [{"shape": "ball", "center": [0,0,0], "radius": 1e300}],)",
     ":11:13: ", "at most 1073741823 fit"},
    // Not JSON
    {2, R"(  "version": 1)", ":3:15: ", "this is not JSON"},
    {13, R"(  "steps": 1e999)", ":13:16: ", "number overflow"},
    {14, "", ":15:1: ", "this is not JSON"},
    {14, "}}", ":14:2", "this is not JSON"},
    {9, R"(    "iterations": NaN)", ":9:19: ", "this is not JSON"},
    {12, R"(  "colliders": [[[[[[[[[[[[[[[[[[[[[[[[)", ":12:31: ", "nested deeper"},
};

std::string text_of(const Case &wrong) {
  std::string text;
  for (size_t i = 0; i < sizeof good / sizeof *good; ++i) {
    const bool replaced = static_cast<int>(i) + 1 == wrong.line;
    text += std::string(replaced ? wrong.with : good[i]) + "\n";
  }
  return text;
}

// Empty: the scene was read.
std::string message_of(const std::string &text) {
  const std::string path = PBF_TEST_WORK "/scene.json";
  write_text(path, text);
  SceneOptions options;
  options.name = path;
  try {
    load_scene(options);
    return "";
  } catch (const Error &error) {
    assert_int_equal(error.code, exit_usage);
    return error.what();
  }
}

void wrong_scenes_are_refused_with_place_and_reason(void **) {
  for (const Case &wrong : cases) {
    const std::string message = message_of(text_of(wrong));
    if (wrong.line == 0) {
      assert_string_equal(message.c_str(), "");
      continue;
    }
    expect_contains(message, std::string("scene.json") + wrong.place);
    expect_contains(message, wrong.reason);
  }
}

void hostile_text_is_refused(void **) {
  expect_contains(message_of(""), "this is not JSON");
  expect_contains(message_of(std::string(100000, '[')), "nested deeper");
  expect_contains(message_of(std::string("\0\0\0\0", 4)), "this is not JSON");
  expect_contains(message_of("{\"\xff\xfe\": 1}"), "this is not JSON");
  expect_contains(message_of("null"), "wanted: a scene");
  expect_contains(message_of("{\"" + std::string(5000, 'x') + "\": 1}"), "does not belong here");
  expect_contains(message_of("{\"a~b/c'd\": 1}"), "does not belong here");
}

void a_missing_file_and_a_misspelt_name_are_told(void **) {
  SceneOptions options;
  for (const char *name : {"/nowhere/at-all.json", PBF_TEST_WORK "/", "reprot-30k"}) {
    options.name = name;
    try {
      load_scene(options);
      fail();
    } catch (const Error &error) {
      assert_int_equal(error.code, exit_usage);
      expect_contains(error.what(), name);
    }
  }
  options.name = "dam-brake-3d";
  try {
    load_scene(options);
    fail();
  } catch (const Error &error) {
    expect_contains(error.what(), "or dam-break-3d?)");
  }
}

void every_scene_that_comes_along_is_read(void **) {
  const std::vector<std::string> names = scene_names();
  assert_true(names.size() >= 10);
  for (const std::string &name : names) {
    SceneOptions options;
    options.name = name;
    const Scene scene = load_scene(options);
    assert_string_equal(scene.name.c_str(), name.c_str());
    assert_true(count_particles(scene) > 0 || !scene.emitters.empty());
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(wrong_scenes_are_refused_with_place_and_reason),
      cmocka_unit_test(hostile_text_is_refused),
      cmocka_unit_test(a_missing_file_and_a_misspelt_name_are_told),
      cmocka_unit_test(every_scene_that_comes_along_is_read),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
