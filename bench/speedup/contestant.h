/* What takes part in a speed-up table, and what came of it. */
#ifndef PBF_BENCH_CONTESTANT_H
#define PBF_BENCH_CONTESTANT_H

#include <string>
#include <vector>

#include "core/solver.h"

namespace bench {

struct Contestant {
  std::string name;  // "naive", or the backend's
  SolverOptions solver;
  unsigned threads;  // 1 unless the contestant is a number of threads
  unsigned repetitions;
};

struct LineUpOptions {
  std::vector<std::string> backends = {"naive", "serial", "threads", "openmp", "cuda"};
  std::vector<unsigned> threads;  // of openmp; empty: powers of two up to the machine's CPUs
  uint32_t precision = PBF_FLOAT32;
  int32_t device = 0;
  unsigned repetitions = 5;
  unsigned naive_repetitions = 1;
};

std::vector<Contestant> line_up(const LineUpOptions &options);

struct Result {
  Contestant contestant;
  std::string row_name;              // "<scene>/<backend>/threads:<n>"
  std::string reason;                // why there are no times; empty when there are
  bool unavailable = false;          // … because the backend can't serve here
  pbf_info info = {};                // of the solver that ran
  pbf_stats stats = {};              // after the last step
  std::vector<double> milliseconds;  // one a repetition, for all the scene's steps
  Bytes positions, velocities;       // after the last step, when frames were asked for

  bool ran() const { return !milliseconds.empty(); }
};

// Of a result that ran.
double median_ms(const Result &result);
double min_ms(const Result &result);
double max_ms(const Result &result);

}  // namespace bench

#endif
