/* Parameters by name: in scene files, by --set, and all of them. */
#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>

#include "bench_test.h"
#include "core/error.h"
#include "scene/objects.h"
#include "scene/params.h"
#include "scene/scene.h"

namespace {

using namespace bench;

Scene with(const std::vector<std::string> &settings, const char *name = "report-30k") {
  SceneOptions options;
  options.name = name;
  options.settings = settings;
  return load_scene(options);
}

std::string refusal(const std::string &setting) {
  try {
    with({setting});
    return "";
  } catch (const Error &error) {
    assert_int_equal(error.code, exit_usage);
    return error.what();
  }
}

size_t size_of(FieldType type) {
  switch (type) {
    case FieldType::number:
      return sizeof(double);
    case FieldType::vector:
    case FieldType::vector3:
      return 3 * sizeof(double);
    case FieldType::quaternion:
      return 4 * sizeof(double);
    case FieldType::other:
      return sizeof(void *);
    case FieldType::walls:
      return 6 * sizeof(double);
    default:
      return sizeof(uint32_t);
  }
}

// A field that the library has and the table lacks leaves a hole. `unnamed`: of a reserved one.
void expect_no_holes(const std::vector<Field> &fields, size_t unnamed, size_t size) {
  std::vector<std::pair<size_t, size_t>> taken = {{0, sizeof(uint32_t)}};  // struct_size
  if (unnamed > 0) taken.push_back({unnamed, sizeof(uint32_t)});
  for (const Field &field : fields) taken.push_back({field.offset, size_of(field.type)});
  std::sort(taken.begin(), taken.end());
  size_t end = 0;
  for (const auto &[offset, room] : taken) {
    assert_int_equal(offset, end);
    end = offset + room;
  }
  assert_int_equal(end, size);
}

void the_tables_cover_the_whole_structs(void **) {
  expect_no_holes(param_fields(), 0, sizeof(pbf_params));
  expect_no_holes(phase_fields(), 0, sizeof(pbf_phase));
  expect_no_holes(emitter_fields(), offsetof(pbf_emitter, reserved), sizeof(pbf_emitter));
  expect_no_holes(drain_fields(), 0, sizeof(pbf_volume));
  if (sizeof(void *) == sizeof(double))  // others have a gap behind the pointer
    expect_no_holes(collider_fields(), 0, offsetof(pbf_collider, last_velocity));
}

void the_schema_knows_the_same_names(void **) {
  const auto schema = nlohmann::json::parse(read_text(PBF_TEST_SCENES "/scene.schema.json"));
  const auto &known = schema.at("definitions").at("params").at("properties");
  assert_int_equal(known.size(), param_fields().size());
  for (const Field &field : param_fields()) assert_true(known.contains(field.name));
  const std::pair<const char *, const std::vector<Field> &> objects[] = {
      {"phase", phase_fields()},
      {"collider", collider_fields()},
      {"emitter", emitter_fields()},
      {"drain", drain_fields()}};
  for (const auto &[name, fields] : objects)
    for (const Field &field : fields)
      assert_true(schema.at("definitions").at(name).at("properties").contains(field.name));
}

void a_setting_replaces_the_scenes_value(void **) {
  const Scene scene =
      with({"gravity.1=-5", "time_step=0.01", "iterations=9", "kernel=wendland_c2",
            "collide=in_iteration,after_solve", "attraction_center.0=2", "domain_min=[-1,-2]"});
  assert_float_equal(scene.params.gravity[0], 0, 0);
  assert_float_equal(scene.params.gravity[1], -5, 0);
  assert_float_equal(scene.params.time_step, 0.01, 0);
  assert_int_equal(scene.params.iterations, 9);
  assert_int_equal(scene.params.kernel, PBF_KERNEL_WENDLAND_C2);
  assert_int_equal(scene.params.collide, PBF_COLLIDE_IN_ITERATION | PBF_COLLIDE_AFTER_SOLVE);
  assert_float_equal(scene.params.attraction_center[0], 2, 0);
  assert_float_equal(scene.params.domain_min[1], -2, 0);
}

void what_a_scene_leaves_out_is_the_librarys_default(void **) {
  pbf_params defaults;
  assert_int_equal(pbf_params_init(&defaults, sizeof defaults), PBF_OK);
  const Scene scene = with({}, "still-tank");
  assert_int_equal(scene.params.iterations, defaults.iterations);
  assert_float_equal(scene.params.scorr_k, defaults.scorr_k, 0);
  assert_int_equal(scene.params.kernel, defaults.kernel);
}

void wrong_settings_are_refused(void **) {
  const char *const wrong[][2] = {
      {"gravitty=3", "did you mean gravity?"},
      {"xyzzy=3", "there is no parameter \"xyzzy\""},
      {"gravity", "no \"=\""},
      {"gravity.2=1", "\"2\" is no index; it must be 0 … 1"},
      {"gravity.x=1", "\"x\" is no index"},
      {"gravity.-1=1", "is no index"},
      {"iterations.0=1", "iterations is not a list"},
      {"gravity.1=down", "--set gravity.1=down: /params/gravity/1: the value is \"down\""},
      {"gravity=[0,1,2]", "this scene's dimension wants 2"},
      {"gravity=1", "wanted: a list"},
      {"iterations=0", "--set iterations=0: /params/iterations: the value is 0"},
      {"iterations=", "the value is \"\""},
      {"time_step=nan", "the value is \"nan\""},
      {"kernel=gauss", "the value is \"gauss\""},
      {"collide=after_solve,sometimes", "--set collide=after_solve,sometimes: /params/collide/1"},
  };
  for (const auto &[setting, words] : wrong) expect_contains(refusal(setting), words);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(the_tables_cover_the_whole_structs),
      cmocka_unit_test(the_schema_knows_the_same_names),
      cmocka_unit_test(a_setting_replaces_the_scenes_value),
      cmocka_unit_test(what_a_scene_leaves_out_is_the_librarys_default),
      cmocka_unit_test(wrong_settings_are_refused),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
