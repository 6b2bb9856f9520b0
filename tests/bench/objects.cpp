/* Scenes with shapes, emitters, drains, phases and periodic axes: what comes out is what the file
 * says, and what can't be is refused with its place in the file. */
#include <cmath>
#include <vector>

#include "bench_test.h"
#include "core/error.h"
#include "core/manifest.h"
#include "core/solver.h"
#include "scene/objects.h"
#include "scene/shape.h"
#include "scene/scene.h"

namespace {

using namespace bench;

// serial where there is one, which is the fastest of those that are built everywhere.
std::string a_backend() {
  std::string found;
  for (const pbf_backend_info &backend : list_backends({}, nullptr))
    if (backend.available && (found.empty() || std::string(backend.name) == "serial"))
      found = backend.name;
  if (!found.empty()) return found;
  print_message("SKIPPED: no backend can serve\n");
  exit(test_skipped);
}

SolverOptions options(uint32_t precision = PBF_FLOAT32) {
  SolverOptions options;
  options.backend = a_backend();
  options.threads = 1;
  options.precision = precision;
  return options;
}

Scene load(const std::string &name, double finer = 1) {
  SceneOptions options;
  options.name = name;
  options.finer = finer;
  return load_scene(options);
}

pbf_in_out in_out_of(const Solver &solver) {
  pbf_in_out in_out = {};
  in_out.struct_size = sizeof in_out;
  check_call(pbf_get_in_out(solver.handle(), &in_out));
  return in_out;
}

// Numbers of one row a particle, in float32.
std::vector<float> rows(const Bytes &bytes) {
  std::vector<float> numbers(bytes.size() / sizeof(float));
  std::memcpy(numbers.data(), bytes.data(), bytes.size());
  return numbers;
}

// ---- What comes out ----

// 0.06 of volume a second in particles of 0.05³, to one; and what came is there, or has gone.
void an_emitter_brings_what_its_rate_says(void **) {
  const Scene scene = load("mill-wheel");
  Solver solver(scene, options());
  const uint64_t placed = count_particles(scene);
  for (int half_second = 1; half_second <= 4; ++half_second) {
    solver.step(60);
    const pbf_in_out in_out = in_out_of(solver);
    const double due = 0.06 * 0.5 * half_second / (0.05 * 0.05 * 0.05);
    assert_true(std::fabs(static_cast<double>(in_out.emitted) - due) <= 1);
    assert_int_equal(in_out.refused, 0);
    assert_int_equal(solver.count(), placed + in_out.emitted - in_out.drained);
  }
  assert_true(in_out_of(solver).drained > 0);
}

// What is in the river stands above its bed, as the file's heights say, and on it: fluid before a
// wall keeps half a spacing off, and centres never come through.
void a_bed_of_heights_holds_the_river(void **) {
  Solver solver(load("mill-wheel"), options());
  solver.step(120);
  const std::vector<float> x = rows(solver.positions());
  double lowest = 1;
  for (size_t i = 0; i < x.size(); i += 3) {
    const double off = std::fmax(std::fabs(x[i + 2] - 0.5) - 0.2, 0);
    const double bed = 0.3 - 0.05 * x[i] + std::fmin(1.5 * off, 0.3);
    lowest = std::fmin(lowest, x[i + 1] - bed);
  }
  assert_true(lowest > -0.0125);  // edges of the bed are rounded within half a cell
  assert_true(lowest < 0.05);
}

// 0.01 a second for 4 seconds into a cup of radius 0.18 and height 0.38: 0.039 fit.
void a_cup_is_filled_from_a_tap(void **) {
  Scene scene = load("fill-a-cup", 0.5);
  const double d = 0.05;
  assert_int_equal(count_particles(scene), 0);
  Solver solver(scene, options());
  solver.step(scene.steps / 2);
  const pbf_in_out in_out = in_out_of(solver);
  assert_true(std::fabs(static_cast<double>(in_out.emitted) - 0.02 / (d * d * d)) <= 1);
  assert_int_equal(solver.count(), in_out.emitted - in_out.drained);
  size_t within = 0;
  const std::vector<float> x = rows(solver.positions());
  for (size_t i = 0; i < x.size(); i += 3)
    within += std::hypot(x[i] - 0.5, x[i + 2] - 0.5) < 0.2 && x[i + 1] > 0.1;
  assert_true(static_cast<double>(within) > 0.97 * solver.count());
}

double mean_height(const Solver &solver, uint32_t phase) {
  std::vector<uint32_t> phases(solver.count());
  check_call(pbf_get_particle_phases(solver.handle(), 0, solver.count(), phases.data()));
  const std::vector<float> x = rows(solver.positions());
  double sum = 0, count = 0;
  for (size_t i = 0; i < phases.size(); ++i) {
    if (phases[i] != phase) continue;
    sum += x[2 * i + 1];
    ++count;
  }
  return sum / count;
}

// Layers of 0.2 each at rest would have their middles 0.2 apart.
void oil_comes_to_lie_above_water(void **) {
  const Scene scene = load("oil-on-water");
  Solver solver(scene, options());
  assert_float_equal(mean_height(solver, 1), mean_height(solver, 0), 1e-6);
  solver.step(scene.steps);
  assert_true(mean_height(solver, 1) - mean_height(solver, 0) > 0.1);
}

// Plane Poiseuille flow: the mean velocity is g H² / (12 viscosity).
void a_periodic_channel_flows_as_poiseuille_says(void **) {
  const Scene scene = load("periodic-channel");
  Solver solver(scene, options());
  solver.step(scene.steps);
  const std::vector<float> v = rows(solver.velocities());
  double sum = 0;
  for (size_t i = 0; i < v.size(); i += 2) sum += v[i];
  const double mean = 2 * sum / static_cast<double>(v.size());
  assert_float_equal(mean, 1.0 / 12, 0.05 / 12);
}

// What judges a dump takes the faces of a periodic axis for open, and knows of several masses.
void a_dump_says_what_is_no_wall(void **) {
  pbf_info info = {};
  const nlohmann::json channel = manifest_of(load("periodic-channel"), info);
  assert_true(channel.at("walls").at("present") == nlohmann::json({false, false, true, true}));
  assert_false(channel.contains("phases"));
  const nlohmann::json oil = manifest_of(load("oil-on-water"), info);
  assert_false(oil.at("walls").contains("present"));
  assert_true(oil.at("phases") == nlohmann::json({1.0, 0.7}));
}

// ---- What scaling does ----

void cells_follow_what_is_finer(void **) {
  const Scene usual = load("mill-wheel"), finer = load("mill-wheel", 2),
              coarser = load("mill-wheel", 0.8);
  for (size_t i = 0; i < usual.shapes.size(); ++i) {
    assert_float_equal(finer.shapes[i].source.cell, usual.shapes[i].source.cell / 2, 1e-15);
    assert_float_equal(coarser.shapes[i].source.cell, usual.shapes[i].source.cell, 1e-15);
    pbf_shape_info one = {}, two = {};
    one.struct_size = two.struct_size = sizeof one;
    check_call(pbf_get_shape_info(usual.shapes[i].handle.get(), &one));
    check_call(pbf_get_shape_info(finer.shapes[i].handle.get(), &two));
    assert_float_equal(two.cell, one.cell / 2, 1e-12);
    assert_float_equal(two.volume, one.volume, 0.03 * one.volume);
  }
  // Places, rates and sizes of what is no discretisation stay.
  assert_memory_equal(usual.emitters.data(), finer.emitters.data(), sizeof(pbf_emitter));
  assert_memory_equal(usual.drains.data(), finer.drains.data(), sizeof(pbf_volume));
  assert_float_equal(finer.colliders[2].start.scale, 1.2, 0);
}

Scene with_text(const std::string &more, const std::string &blocks, unsigned dimension = 3,
                const std::string &params = "") {
  const std::string path = PBF_TEST_WORK "/objects.json";
  write_text(path,
             R"({"version": 1, "description": "a", "purpose": "b", "steps": 120, "dimension": )" +
                 std::to_string(dimension) + ",\n\"params\": {" + params +
                 "},\n\"blocks\": " + blocks + ",\n" + more + "}");
  return load(path);
}

// ---- Files that are baked ----

// A tetrahedron of volume 0.1³ / 6, as pbf_save_shape writes it.
std::string baked_tetrahedron() {
  const double vertices[] = {0, 0, 0, 0.1, 0, 0, 0, 0.1, 0, 0, 0, 0.1};
  const uint32_t faces[] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  pbf_mesh_desc mesh = {};
  mesh.struct_size = sizeof mesh;
  mesh.dimension = 3;
  mesh.vertex_count = mesh.face_count = 4;
  mesh.vertices = vertices;
  mesh.faces = faces;
  mesh.cell = 0.005;
  pbf_shape *shape = nullptr;
  check_call(pbf_shape_from_mesh(&mesh, &shape));
  uint64_t size = 0;
  check_call(pbf_save_shape(shape, nullptr, &size));
  std::string bytes(size, 0);
  check_call(pbf_save_shape(shape, &bytes[0], &size));
  pbf_release_shape(shape);
  return bytes;
}

pbf_shape_info info_of(const SceneShape &shape) {
  pbf_shape_info info = {};
  info.struct_size = sizeof info;
  check_call(pbf_get_shape_info(shape.handle.get(), &info));
  return info;
}

// It is the shape that was saved, as the scene's own line in a recording is; in 2D it is none.
void a_baked_file_is_the_shape_that_was_saved(void **) {
  const std::string bytes = baked_tetrahedron(), blocks = R"([{"shape": "ball", "radius": 0.1, )";
  write_text(PBF_TEST_WORK "/tetrahedron.pbfshape", bytes);
  const Scene scene =
      with_text(R"("shapes": {"it": {"from": "baked", "file": "tetrahedron.pbfshape"}})",
                blocks + R"("center": [0.5, 0.5, 0.5]}])");
  const pbf_shape_info info = info_of(scene.shapes.at(0));
  uint64_t saved = 0;  // the header's hash
  std::memcpy(&saved, bytes.data() + 64, sizeof saved);
  assert_true(info.hash == saved);
  assert_float_equal(info.volume, 1e-3 / 6, 0.05e-3 / 6);
  const ShapeSource again =
      read_shape(shape_json(scene.shapes[0].source, 3), nlohmann::json::json_pointer(), 3, "");
  SceneShape recorded = scene.shapes[0];
  recorded.handle = bake_shape(again, 3);
  assert_true(info_of(recorded).hash == saved);
}

// A tap of 4 x 4 columns at 1 a second: 0.04 a second for a second is 320; of 0.25 s a quarter.
void there_is_room_for_what_comes(void **) {
  const std::string tap =
      R"("emitters": [{"shape": "rectangle", "position": [0.5, 0.9, 0.5], "half_width": 0.1, )"
      R"("half_height": 0.1)";
  assert_int_equal(capacity_of(with_text(tap + R"(, "rate": 0.04}])", "[]")), 320 + 1);
  assert_int_equal(capacity_of(with_text(tap + R"(, "rate": 0.04, "lifetime": 0.25}])", "[]")), 81);
  assert_int_equal(capacity_of(with_text(tap + R"(}], "capacity": 70)", "[]")), 70);
  const Scene full = with_text(tap + "}]", "[]");
  Solver solver(full, options());
  solver.step(120);
  assert_int_equal(in_out_of(solver).refused, 0);
  // No more than the domain holds, however long it goes on.
  Scene long_one = full;
  long_one.steps = 4000000000u;
  assert_true(capacity_of(long_one) < 1.6 * 8000);
  const Scene blocks = with_text(R"("drains": [])",
                                 R"([{"shape": "box", "min": [0, 0, 0], "max": [0.5, 0.5, 0.5]}])");
  assert_int_equal(capacity_of(blocks), 1000);
}

// ---- What is refused ----

std::string refusal(const std::string &more, const std::string &blocks = "", unsigned dimension = 3,
                    const std::string &params = "") {
  const char *const some[] = {R"([{"shape": "box", "min": [0, 0], "max": [0.2, 0.2]}])",
                              R"([{"shape": "box", "min": [0, 0, 0], "max": [0.2, 0.2, 0.2]}])"};
  try {
    const Scene scene =
        with_text(more, blocks.empty() ? some[dimension - 2] : blocks, dimension, params);
    Solver solver(scene, options());
    return "";
  } catch (const Error &error) {
    return error.what();
  }
}

struct Refused {
  const char *more, *place, *reason;
};

// The fourth line is that of `more`.
const Refused cases[] = {
    {R"("emitters": [{"shape": "disc", "position": [0.5, 0.99, 0.5], "radius": 0.2, "velocity": [1, 0, 0]}])",
     ":4:14: ", "emitters[0] reaches to 1.015 along axis 1; it must be inside the domain"},
    {R"("emitters": [{"shape": "disc", "position": [0.5, 0.5, 0.5], "velocity": [0, 0, 0]}])",
     ":4:73: ", "emitters[0].velocity has the size 0"},
    {R"("emitters": [{"shape": "disc", "position": [0.5, 0.5, 0.5], "radius": 0.1, "rate": 9}])",
     ":4:84: ", "carry at most"},
    {R"("emitters": [{"shape": "disc", "position": [0.5, 0.5, 0.5], "half_width": 0.1}])",
     ":4:75: ", "\"half_width\" does not belong here; wanted: an object of fields of pbf_emitter"},
    {R"("phases": [{}, {}], "emitters": [{"shape": "disc", "position": [0.5, 0.5, 0.5], "radius": 0.1, "phase": 2}])",
     ":4:105: ", "the value is 2; the scene has 2 phases, counted from 0"},
    {R"("phases": [{}, {"rest_density": 2000}])", ":4:33: ", "phases[1].rest_density is 2000"},
    {R"("phases": [{"colour": 3}])", ":4:23: ", "\"colour\" does not belong here"},
    {R"("drains": [{"shape": "sphere", "position": [0, 0, 0], "orientation": [0, 0, 0, 2]}])",
     ":4:70: ", "drains[0].orientation"},
    {R"("drains": [{"shape": "sphere"}])", ":4:12: ", "\"position\" is missing"},
    {R"("colliders": [{"shape": "shape", "position": [0, 0, 0]}])",
     ":4:15: ", "\"geometry\" is missing"},
    {R"("colliders": [{"shape": "sphere", "geometry": "a", "position": [0, 0, 0]}])",
     ":4:47: ", "\"geometry\" does not belong here"},
    {R"("shapes": {"wheel": {"from": "points", "points": [[0,0,0],[1,0,0],[0,1,0],[0,0,1]], "cell": 0.1}}, "colliders": [{"shape": "shape", "geometry": "weel", "position": [0, 0, 0]}])",
     ":4:145: ", "there is no shape \"weel\" (did you mean wheel?)"},
    {R"("shapes": {"wheel": {"from": "mesh", "vertices": [[0,0,0],[1,0,0],[0,1,0],[0,0,1]], "faces": [[0,2,1],[0,1,3],[0,3,2]], "cell": 0.1}})",
     ":4:21: ", "mesh is open"},
    {R"("shapes": {"wheel": {"from": "mesh", "vertices": [[0,0,0],[1,0],[0,1,0],[0,0,1]], "faces": [[0,2,1]], "cell": 0.1}})",
     ":4:59: ", "the list has 2 numbers; wanted: 3"},
    {R"("shapes": {"wheel": {"from": "mesh", "file": "wheel.obj", "faces": [[0,2,1]], "cell": 0.1}})",
     ":4:68: ", "\"faces\" does not belong here"},
    {R"("shapes": {"wheel": {"from": "mesh", "file": "wheel.obj", "cell": 0.1}})",
     ":4:46: ", "wheel.obj can't be read"},
    {R"("shapes": {"wheel": {"from": "mesh", "cell": 0.1}})",
     ":4:21: ", "is missing; wanted: what a solid is made from"},
    {R"("shapes": {"bed": {"from": "heights", "heights": [[1, 2], [1, 2, 3]], "spacing": 1, "base": 0, "cell": 0.1}})",
     ":4:59: ", "the list has 3 numbers; wanted: 2"},
    {R"("shapes": {"bed": {"from": "heights", "heights": [[1, 2], [1, 0]], "spacing": 1, "base": 0, "cell": 0.1}})",
     ":4:19: ", "heights.heights[3] is 0; it must be above base"},
    {R"("shapes": {"bed": {"from": "grid", "nodes": [3, 3, 3], "origin": [0, 0, 0], "values": [1, 1], "cell": 0.1}})",
     ":4:87: ", "the list has 2 numbers; the nodes are 27"},
    {R"("shapes": {"cup": {"from": "baked", "file": "none.pbfshape"}})",
     ":4:45: ", "none.pbfshape can't be read: No such file"},
    {R"("shapes": {"cup": {"from": "baked", "file": "cut.pbfshape"}})",
     ":4:45: ", "cut.pbfshape: the saved shape has 100 bytes; by its header it has"},
    {R"("shapes": {"cup": {"from": "baked", "file": "cup.obj"}})",
     ":4:45: ", "cup.obj: the saved shape is cut short"},
    {R"("shapes": {"cup": {"from": "baked"}})", ":4:19: ", "\"file\" is missing"},
    {R"("shapes": {"cup": {"from": "baked", "file": "cut.pbfshape", "cell": 0.1}})",
     ":4:69: ", "\"cell\" does not belong here"},
    {R"("shapes": {"cup": {"from": "mesh", "file": "cut.pbfshape", "cell": 0.1}})",
     ":4:44: ", "shapes of pbf-bake where \"from\" is \"baked\""},
    {R"("capacity": 10)", ":3:11: ", "PBF_ERROR_CAPACITY"},
    {R"("capacity": 0)", ":4:13: ", "wanted: a count of particles"},
};

void what_can_not_be_is_refused_with_its_place(void **) {
  write_text(PBF_TEST_WORK "/tetrahedron.pbfshape", baked_tetrahedron());
  write_text(PBF_TEST_WORK "/cut.pbfshape", baked_tetrahedron().substr(0, 100));
  write_text(PBF_TEST_WORK "/cup.obj", "v 0 0 0\n");
  for (const Refused &wrong : cases) {
    const std::string message = refusal(wrong.more);
    expect_contains(message, std::string("objects.json") + wrong.place);
    expect_contains(message, wrong.reason);
  }
  expect_contains(
      refusal(R"("shapes": {"it": {"from": "baked", "file": "tetrahedron.pbfshape"}})", "", 2),
      "tetrahedron.pbfshape holds a shape of dimension 3; the scene has 2");
  expect_contains(refusal(R"("steps_": 1)", "[]"), ":3:11: ");
  expect_contains(refusal(R"("capacity": 1)", "[]"), "at least one where there are no emitters");
  expect_contains(refusal(R"("colliders": [])",
                          R"([{"shape": "ball", "center": [0,0,0], "radius": 1, "phase": 1}])"),
                  ":3:71: /blocks/0/phase: the value is 1; the scene has 0 phases");
}

// A tetrahedron of which a word is another; pbf.read_mesh has the same list.
void words_of_meshes_are_whole(void **) {
  const std::string of = R"("shapes": {"it": {"from": "mesh", "file": "words.obj", "cell": 0.1}})";
  const std::string faces = "f 1 3 2\nf 1 2 4\nf 1 4 3\n";
  for (const char *word : {"1,5", "1.5.2", "0x1", "1_0", "nan", "inf", "1e999", "1f", "--1", "+"}) {
    write_text(PBF_TEST_WORK "/words.obj", std::string("v 0 0 0\nv 1 0 ") + word + "\n" + faces);
    expect_contains(refusal(of), std::string("words.obj:2: \"") + word + "\" is no number");
  }
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
  for (const char *word : {"4x", "4.5", "1_0", "0x4", "/4", "99999999999999999999"}) {
    write_text(PBF_TEST_WORK "/words.obj", corners + "f 2 3 " + word + "\n");
    expect_contains(refusal(of), std::string("words.obj:5: \"") + word + "\" is none of the 4");
  }
  write_text(PBF_TEST_WORK "/words.obj", "\xef\xbb\xbf" + corners + "f 2 3 4\n" + faces);
  assert_string_equal(refusal(of).c_str(), ""); /* the first vertex is there */
}

void parameters_that_do_not_agree_are_refused_with_their_place(void **) {
  const std::string some = R"("capacity": 1000)";
  const std::string walls =
      refusal(some, "", 3, R"("periodic": ["x"], "wall_velocity": [0.1, 0, 0, 0, 0, 0])");
  expect_contains(walls, "objects.json:2:");
  expect_contains(walls, "wall_velocity");
  expect_contains(
      refusal(R"("phases": [{}, {"rest_density": 0.25}])", "", 3, R"("pressure_grid": 2)"),
      "objects.json:4:");
  expect_contains(refusal(some, "", 3, R"("periodic": ["x"], "smoothing_radius": 0.3)"),
                  "params.periodic");
  expect_contains(refusal(some, "", 2, R"("periodic": ["w"])"),
                  ":2:25: /params/periodic/0: the value is \"w\"");
  assert_string_equal(refusal(some, "", 3, R"("periodic": ["x", "z"])").c_str(), "");
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(an_emitter_brings_what_its_rate_says),
      cmocka_unit_test(a_bed_of_heights_holds_the_river),
      cmocka_unit_test(a_cup_is_filled_from_a_tap),
      cmocka_unit_test(oil_comes_to_lie_above_water),
      cmocka_unit_test(a_periodic_channel_flows_as_poiseuille_says),
      cmocka_unit_test(a_dump_says_what_is_no_wall),
      cmocka_unit_test(cells_follow_what_is_finer),
      cmocka_unit_test(a_baked_file_is_the_shape_that_was_saved),
      cmocka_unit_test(there_is_room_for_what_comes),
      cmocka_unit_test(what_can_not_be_is_refused_with_its_place),
      cmocka_unit_test(words_of_meshes_are_whole),
      cmocka_unit_test(parameters_that_do_not_agree_are_refused_with_their_place),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
