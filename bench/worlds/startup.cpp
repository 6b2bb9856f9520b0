/* How long it takes to create a solver or a batch, to its first step, and to destroy it. */
#include <pbf/batch.h>

#include <chrono>

#include "ablation/ablation.h"
#include "core/error.h"
#include "core/interrupt.h"
#include "worlds/worlds.h"

namespace bench {
namespace {

using StartupClock = std::chrono::steady_clock;

// Milliseconds since it was made, or last asked.
class Stopwatch {
 public:
  double lap() {
    const auto now = StartupClock::now();
    const double ms = 1e3 * std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return ms;
  }

 private:
  StartupClock::time_point last_ = StartupClock::now();
};

struct Laps {
  std::vector<double> create, step, destroy;
};

// One solver's whole life; milliseconds until its first step is done.
double live(const pbf_desc &desc, const Scene &scene, const Bytes &positions, Laps &laps) {
  pbf_solver *solver = nullptr;
  Stopwatch watch;
  check_call(pbf_create(&desc, &scene.params, &solver));
  const double create = watch.lap();
  check_call(pbf_add_particles(solver, desc.capacity, positions.data(), nullptr, nullptr));
  check_call(pbf_step(solver, 1));
  check_call(pbf_synchronize(solver));
  const double step = watch.lap();
  pbf_destroy(solver);
  laps.destroy.push_back(watch.lap());
  laps.create.push_back(create);
  laps.step.push_back(step);
  return create + step;
}

void measure_batch(const pbf_desc &desc, const Scene &scene, const Bytes &start, uint32_t worlds,
                   StartupRow &row) {
  pbf_batch *batch = nullptr;
  Stopwatch watch;
  check_call(pbf_batch_create(&desc, &scene.params, worlds, &batch));
  row.world_ms = watch.lap() / worlds;
  check_call(pbf_batch_set_start(batch, nullptr, start.data(), start.size()));
  check_call(pbf_batch_reset(batch, nullptr));
  watch.lap();
  check_call(pbf_batch_reset(batch, nullptr));
  row.reset_ms = watch.lap() / worlds;
  pbf_batch_destroy(batch);
}

void measure_backend(const Scene &scene, const SolverOptions &options, uint32_t worlds,
                     uint32_t cycles, StartupRow &row) {
  const pbf_desc desc = desc_of(options, &scene);
  const Bytes positions = to_precision(fill_scene(scene).positions, options.precision);
  Laps first, laps;
  row.first_ms = live(desc, scene, positions, first);
  for (uint32_t k = 0; k < cycles && !interrupted(); ++k) live(desc, scene, positions, laps);
  if (laps.create.empty()) throw Error(exit_interrupted, "interrupted");
  row.create_ms = median_of(laps.create);
  row.step_ms = median_of(laps.step);
  row.destroy_ms = median_of(laps.destroy);
  const Solver solver(scene, options);
  row.device = solver.info().device_name;
  measure_batch(desc, scene, solver.save(), worlds, row);
}

}  // namespace

std::vector<StartupRow> measure_startup(const Scene &scene, const WorldsOptions &options,
                                        uint32_t cycles) {
  std::vector<StartupRow> rows;
  list_backends(SolverOptions(), nullptr);  // the search for plugins is none of these
  for (const std::string &backend : options.backends) {
    const SolverOptions own = solver_options(backend, options);
    StartupRow row;
    row.backend = backend;
    row.particles = count_particles(scene);
    try {
      measure_backend(scene, own, options.worlds, cycles, row);
    } catch (const Error &error) {
      if (error.code == exit_usage) throw;
      row.reason = error.what();
    }
    rows.push_back(row);
  }
  return rows;
}

}  // namespace bench
