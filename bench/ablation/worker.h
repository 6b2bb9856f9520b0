/* One variant on one build of a backend, in a process of its own: two builds of a backend have one
 * name, and a process takes the first that it finds. */
#ifndef PBF_BENCH_WORKER_H
#define PBF_BENCH_WORKER_H

#include <sys/types.h>

#include <string>

#include "ablation/features.h"
#include "core/solver.h"

namespace bench {

// Where the particles of all variants start.
struct Start {
  Bytes positions, velocities;
};

// A row's facts after its last run.
struct Facts {
  pbf_info info;
  pbf_plan plan;
  pbf_stats stats;
  uint64_t hash;
  uint32_t has_stats;  // 0: built without them
};

struct Job {
  Variant variant;
  SolverOptions solver;
  std::string folder;     // of the build's backends; empty: those that pbf-bench finds
  bool cpu_time = false;  // what the process has worked, and not what the clock says
};

// All throw Error with the worker's sentence. The library must not have been used before in this
// process: the worker begins as a copy of it.
class Worker {
 public:
  Worker(const Job &job, const Start &start);
  ~Worker();
  Worker(const Worker &) = delete;
  Worker &operator=(const Worker &) = delete;

  double run();  // the variant's steps from the start; seconds
  Facts facts();

 private:
  template <class Value>
  Value ask(char request);

  pid_t child_ = -1;
  int to_ = -1, from_ = -1;
};

// The state after the scene's lead-in and `steps` more, in the scene's own way, held into the
// domain as it is at time 0.
Start run_up(const Scene &scene, const SolverOptions &solver, uint32_t steps);

}  // namespace bench

#endif
