/* Many small worlds: in a batch, one solver after another, and as one large world. */
#ifndef PBF_BENCH_WORLDS_H
#define PBF_BENCH_WORLDS_H

#include <string>
#include <vector>

#include "core/solver.h"
#include "scene/scene.h"

namespace bench {

struct WorldsOptions {
  std::vector<std::string> backends{"serial", "threads"};
  uint32_t precision = PBF_FLOAT32;
  uint32_t threads = 0;
  int32_t device = 0;
  uint32_t worlds = 64;
  uint32_t repetitions = 5;
};

// Of a solver of one of the backends.
SolverOptions solver_options(const std::string &backend, const WorldsOptions &options);

// One way to step them all. `reason` is why it could not run, else empty.
struct WorldsRow {
  std::string backend, way, device, reason;
  uint32_t worlds = 0, threads = 0;
  uint64_t particles = 0;                    // of a world
  std::vector<double> milliseconds;          // of a step of all worlds, a repetition each
  double particle_steps_per_second() const;  // by the median
};

// `small` is one world's scene, `large` one of as many particles as all worlds have together. The
// ways of a backend take turns.
std::vector<WorldsRow> measure_worlds(const Scene &small, const Scene &large,
                                      const WorldsOptions &options);

std::string worlds_table(const std::vector<WorldsRow> &rows);
void write_worlds_json(const Scene &scene, const std::vector<WorldsRow> &rows,
                       const std::string &path);

// ---- Until the first step -------------------------------------------------------------------

struct StartupRow {
  std::string backend, device, reason;
  uint64_t particles = 0;
  double first_ms = 0;  // the first solver of this backend in this process, with its first step
  // Medians, of one solver: to create it, to add its particles and step once, to destroy it; of a
  // world of a batch: to create it, and to go back to its start.
  double create_ms = 0, step_ms = 0, destroy_ms = 0, world_ms = 0, reset_ms = 0;
};

std::vector<StartupRow> measure_startup(const Scene &scene, const WorldsOptions &options,
                                        uint32_t cycles);
std::string startup_table(const std::vector<StartupRow> &rows);
void write_startup_json(const Scene &scene, const std::vector<StartupRow> &rows,
                        const std::string &path);

}  // namespace bench

#endif
