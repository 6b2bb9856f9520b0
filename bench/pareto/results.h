/* The results file of a sweep: written after every run, read back to go on. */
#ifndef PBF_BENCH_RESULTS_H
#define PBF_BENCH_RESULTS_H

#include "core/machine.h"
#include "pareto/plan.h"

namespace bench {

struct BackendBuild {
  std::string device, build_id;
};

struct Study {
  Sweep sweep;
  Plan plan;
  unsigned repetitions = 5;
  unsigned frames = 10;
  bool cpu_time = false;  // times are the processor's, of all threads; else a clock's on the wall
  std::map<std::string, BackendBuild> builds;  // by backend
};

// Gives the points of `study` the outcomes that the file has under the same keys. Returns how many
// outcomes it has that fit none. Throws Error when it holds something else; no file is no error.
size_t resume(const std::string &path, Study &study);

void write_results(const Study &study, const std::string &path);

}  // namespace bench

#endif
