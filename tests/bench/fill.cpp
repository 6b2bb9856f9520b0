/* Particles of blocks, and what --particles does to a scene. */
#include <cmath>

#include "bench_test.h"
#include "core/error.h"
#include "scene/scene.h"

namespace {

using namespace bench;

Scene load(const char *name, uint64_t particles = 0) {
  SceneOptions options;
  options.name = name;
  options.particles = particles;
  return load_scene(options);
}

// x = 0.25 + 0.575 (i mod 500), y = 0.25 + 0.575 (i div 500), at rest.
void the_report_starts_where_it_says(void **) {
  const Scene scene = load("report-30k");
  const Particles particles = fill_scene(scene);
  assert_int_equal(particles.count, 30000);
  for (uint64_t i = 0; i < particles.count; ++i) {
    assert_float_equal(particles.positions[2 * i], 0.25 + 0.575 * static_cast<double>(i % 500),
                       1e-12);
    assert_float_equal(particles.positions[2 * i + 1], 0.25 + 0.575 * static_cast<double>(i / 500),
                       1e-12);
    assert_float_equal(particles.velocities[2 * i], 0, 0);
    assert_float_equal(particles.velocities[2 * i + 1], 0, 0);
  }
}

// The right wall: 409.6 (0.9 + 0.1 sin(n pi / 450)) - 0.25 in step n.
void the_reports_wall_moves_as_it_says(void **) {
  const pbf_params params = load("report-30k").params;
  for (int n = 1; n <= 100; ++n) {
    const double wall = params.domain_max[0] +
                        params.wall_amplitude[PBF_WALL_X_MAX] *
                            std::sin(params.wall_frequency[PBF_WALL_X_MAX] * n * params.time_step);
    const double said = 409.6 * (0.9 + 0.1 * std::sin(n * 3.14159265358979323846 / 450)) - 0.25;
    assert_float_equal(wall, said, 1e-9);
  }
}

void the_cube_grows_with_its_box(void **) {
  for (const double n : {31.0, 50.0, 80.0}) {
    const Scene scene = load("cube-collapse", static_cast<uint64_t>(n * n * n));
    const double d = 0.05;
    assert_int_equal(count_particles(scene), n * n * n);
    assert_float_equal(scene.params.domain_max[0], 2 * (n + 2) * d, 1e-9);
    assert_float_equal(scene.params.domain_max[1], 1.5 * (n + 2) * d, 1e-9);
    assert_float_equal(scene.params.domain_max[2], (n + 2) * d, 1e-9);
    assert_float_equal(fill_scene(scene).positions[0], 1.5 * d, 1e-12);
    assert_float_equal(scene.params.smoothing_radius, 0.1, 0);
  }
}

void the_shallow_block_stays_30_layers_high(void **) {
  const Scene scene = load("shallow-dam-break", 1000000);
  assert_int_equal(scene.blocks[0].counts[0], 183);
  assert_int_equal(scene.blocks[0].counts[1], 30);
  assert_int_equal(scene.blocks[0].counts[2], 183);
  assert_float_equal(scene.params.domain_max[0], 2 * 183 * 0.05, 1e-9);
  assert_float_equal(scene.params.domain_max[1], 3, 0);
  assert_float_equal(scene.params.domain_max[2], 183 * 0.05, 1e-9);
}

// Eight times the particles in the same column: half of everything that resolves it.
void refining_keeps_the_shape_and_the_time(void **) {
  const Scene before = load("dam-break-3d");
  const Scene after = load("dam-break-3d", 8 * count_particles(before));
  assert_int_equal(count_particles(after), 8 * count_particles(before));
  assert_float_equal(after.params.smoothing_radius, before.params.smoothing_radius / 2, 1e-9);
  assert_float_equal(after.params.spacing, before.params.spacing / 2, 1e-9);
  assert_float_equal(after.params.time_step, before.params.time_step / 2, 1e-9);
  assert_float_equal(after.params.domain_max[0], before.params.domain_max[0], 0);
  assert_int_equal(after.steps, 2 * before.steps);
}

void as_fine_as_asked_for(void **) {
  SceneOptions options;
  options.name = "dam-break-2d";
  const Scene before = load_scene(options);
  options.finer = 2;
  const Scene after = load_scene(options);
  assert_int_equal(count_particles(after), 4 * count_particles(before));
  assert_float_equal(after.params.spacing, before.params.spacing / 2, 1e-12);
  assert_float_equal(after.params.time_step, before.params.time_step / 2, 1e-12);
  assert_int_equal(after.steps, 2 * before.steps);
  options.name = "report-30k";
  try {
    load_scene(options);
    fail();
  } catch (const Error &error) {
    expect_contains(error.what(), "--finer: scene report-30k has no \"scaling\"");
  }
}

void a_box_is_filled_in_the_middles_of_its_cells(void **) {
  const Scene scene = load("still-tank");
  const Particles particles = fill_scene(scene);
  assert_int_equal(particles.count, 32 * 20 * 32);
  double low[3] = {1e9, 1e9, 1e9}, high[3] = {-1e9, -1e9, -1e9};
  for (uint64_t i = 0; i < 3 * particles.count; ++i) {
    low[i % 3] = std::fmin(low[i % 3], particles.positions[i]);
    high[i % 3] = std::fmax(high[i % 3], particles.positions[i]);
  }
  const double top[3] = {1.6, 1, 1.6};
  for (int axis = 0; axis < 3; ++axis) {
    assert_float_equal(low[axis], 0.025, 1e-9);
    assert_float_equal(high[axis], top[axis] - 0.025, 1e-9);
  }
}

// Two drops of opposite velocities: no momentum; each turns about its middle with angular velocity
// 1 about z, so that v = w × r beside its own velocity.
void balls_are_round_and_turn(void **) {
  const Scene scene = load("zero-gravity-drop");
  const Particles particles = fill_scene(scene);
  const Block &first = scene.blocks[0];
  double momentum[3] = {0, 0, 0};
  for (uint64_t i = 0; i < particles.count; ++i) {
    const double *x = &particles.positions[3 * i], *v = &particles.velocities[3 * i];
    for (int axis = 0; axis < 3; ++axis) momentum[axis] += v[axis];
    if (i >= particles.count / 2) continue;
    const double r[3] = {x[0] - first.center[0], x[1] - first.center[1], x[2] - first.center[2]};
    assert_true(r[0] * r[0] + r[1] * r[1] + r[2] * r[2] < first.radius * first.radius);
    assert_float_equal(v[0], 0.5 - r[1], 1e-9);
    assert_float_equal(v[1], r[0], 1e-9);
  }
  for (const double p : momentum) assert_float_equal(p, 0, 1e-9);
  // The volume of a ball, to a few per cent at this spacing.
  const double volume = 4.0 / 3 * 3.14159265358979 * std::pow(first.radius / 0.05, 3);
  assert_float_equal(static_cast<double>(particles.count) / 2, volume, 0.05 * volume);
}

// The lower half (y < 0.3) of an upright cylinder of radius 0.4 round (0.5, 0.5), from which a
// paraboloid is taken; each particle with the affine velocity of its place.
void regions_cut_and_gradients_shear(void **) {
  write_text(PBF_TEST_WORK "/cut.json", R"({
    "version": 1, "description": "A cut block", "purpose": "The tests.", "dimension": 3,
    "params": {"smoothing_radius": 0.04},
    "blocks": [{
      "shape": "box", "min": [0, 0, 0], "max": [1, 1, 1], "velocity": [7, 0, 0],
      "velocity_gradient": [[1, 2, 3], [0, -4, 0], [5, 0, 6]],
      "within": [
        {"center": [0.5, 0, 0.5], "squares": [1, 0, 1], "below": 0.16},
        {"slopes": [0, 1, 0], "below": 0.3},
        {"center": [0.5, 0.1, 0.5], "squares": [-1, 0, -1], "slopes": [0, 1, 0], "below": 0}
      ]
    }],
    "steps": 1
  })");
  const Scene scene = load(PBF_TEST_WORK "/cut.json");
  const Particles particles = fill_scene(scene);
  assert_int_equal(particles.count, count_particles(scene));
  double volume = 0, expected = 0;
  for (uint64_t i = 0; i < particles.count; ++i) {
    const double *x = &particles.positions[3 * i], *v = &particles.velocities[3 * i];
    const double r[3] = {x[0] - 0.5, x[1] - 0.5, x[2] - 0.5};
    const double radius2 = r[0] * r[0] + r[2] * r[2];
    assert_true(radius2 < 0.16 && x[1] < 0.3 && x[1] - 0.1 < radius2);
    assert_float_equal(v[0], 7 + r[0] + 2 * r[1] + 3 * r[2], 1e-9);
    assert_float_equal(v[1], -4 * r[1], 1e-9);
    assert_float_equal(v[2], 5 * r[0] + 6 * r[2], 1e-9);
    volume += 0.02 * 0.02 * 0.02;
  }
  // Integral of 2 pi r (0.1 + r²) from 0 to 0.4: the paraboloid is below y = 0.3 throughout.
  expected = 3.14159265358979 * (0.1 * 0.16 + 0.16 * 0.16 / 2);
  assert_float_equal(volume, expected, 0.02 * expected);
}

// 1.6 x 1.6 x 1.5: spacings of 0.1 over a whole number fit, and no others.
void what_does_not_fit_between_the_walls(void **) {
  assert_string_equal(lattice_misfit(load("dam-break-3d")).c_str(), "");
  assert_string_equal(lattice_misfit(load("dam-break-3d", 3840)).c_str(), "");
  expect_contains(lattice_misfit(load("dam-break-3d", 10000)),
                  "of a spacing behind the wall at z = 1.5; 3840 and 30720 particles fit");
  assert_string_equal(lattice_misfit(load("dam-break-2d", 1234)).c_str(), "");
  assert_string_equal(lattice_misfit(load("zero-gravity-drop", 1234)).c_str(), "");
}

// 1.6 x 1 x 1.6: any whole number of cells along x fits, and one of about as many particles is had.
void a_number_that_fits_is_taken(void **) {
  for (const uint64_t particles : {1000, 3840, 9000, 10000, 77777}) {
    const Scene scene = load("still-tank", particles);
    const double cells = 1.6 / scene.params.spacing;
    assert_float_equal(cells, std::round(cells), 0.05);
    assert_string_equal(lattice_misfit(scene).c_str(), "");
    const double count = static_cast<double>(count_particles(scene));
    assert_float_equal(count / static_cast<double>(particles), 1, 0.17);
  }
}

void a_scene_without_a_rule_has_a_fixed_number(void **) {
  std::string text = read_text(PBF_TEST_SCENES "/still-tank.json");
  const std::string rule = ",\n  \"scaling\": {\"rule\": \"refine\"}";
  assert_true(text.find(rule) != std::string::npos);
  text.erase(text.find(rule), rule.size());
  write_text(PBF_TEST_WORK "/fixed.json", text);
  try {
    load(PBF_TEST_WORK "/fixed.json", 1000);
    fail();
  } catch (const Error &error) {
    expect_contains(error.what(), "its number of particles is fixed");
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(the_report_starts_where_it_says),
      cmocka_unit_test(the_reports_wall_moves_as_it_says),
      cmocka_unit_test(the_cube_grows_with_its_box),
      cmocka_unit_test(the_shallow_block_stays_30_layers_high),
      cmocka_unit_test(refining_keeps_the_shape_and_the_time),
      cmocka_unit_test(as_fine_as_asked_for),
      cmocka_unit_test(a_box_is_filled_in_the_middles_of_its_cells),
      cmocka_unit_test(balls_are_round_and_turn),
      cmocka_unit_test(regions_cut_and_gradients_shear),
      cmocka_unit_test(what_does_not_fit_between_the_walls),
      cmocka_unit_test(a_number_that_fits_is_taken),
      cmocka_unit_test(a_scene_without_a_rule_has_a_fixed_number),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
