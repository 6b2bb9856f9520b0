/* Colliders that move in stretches, through any number of steps a call, and from a loaded state. */
#include "bench_test.h"
#include "core/error.h"
#include "core/solver.h"
#include "scene/scene.h"

namespace {

using namespace bench;

Scene paddle() {
  SceneOptions options;
  options.name = "moving-paddle";
  options.particles = 300;
  // Refining shortens the step; the stretches below want 120 steps a second.
  Scene scene = load_scene(options);
  scene.params.time_step = 1.0 / 120;
  return scene;
}

std::string any_backend() {
  for (const pbf_backend_info &backend : list_backends({}, nullptr)) {
    if (backend.available) return backend.name;
  }
  print_message("SKIPPED: no backend can serve\n");
  exit(test_skipped);
}

double paddle_x(const Solver &solver) { return solver.collider(0).position[0]; }

SolverOptions options() {
  SolverOptions options;
  options.backend = any_backend();
  options.threads = 1;
  return options;
}

// 0.4 for 30 steps, 0.8 for 60, 0.4 for 30, and back.
void a_paddle_goes_and_comes_back(void **) {
  Solver solver(paddle(), options());
  const double start = 0.45;
  const struct {
    uint32_t steps;
    double x;
  } stops[] = {{15, 0.05}, {15, 0.1}, {60, 0.5}, {30, 0.6}, {30, 0.5},
               {60, 0.1},  {30, 0},   {240, 0},  {30, 0.1}};
  assert_float_equal(paddle_x(solver), start, 1e-12);
  for (const auto &stop : stops) {
    solver.step(stop.steps);
    assert_float_equal(paddle_x(solver), start + stop.x, 1e-6);
  }
}

void one_call_is_as_many(void **) {
  Solver whole(paddle(), options()), pieces(paddle(), options());
  whole.step(100);
  for (int i = 0; i < 100; ++i) pieces.step(1);
  assert_true(whole.hash() == pieces.hash());
}

void a_loaded_state_goes_on_in_the_middle_of_a_stretch(void **) {
  Solver solver(paddle(), options());
  solver.step(50);
  const Bytes state = solver.save();
  solver.step(100);
  const uint64_t once = solver.hash();
  solver.load(state);
  solver.step(100);
  assert_true(solver.hash() == once);
  assert_float_equal(paddle_x(solver), 0.45 + 0.5, 1e-6);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_paddle_goes_and_comes_back),
      cmocka_unit_test(one_call_is_as_many),
      cmocka_unit_test(a_loaded_state_goes_on_in_the_middle_of_a_stretch),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
