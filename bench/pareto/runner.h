/* Runs a study: every point once for its errors, then all of them by turns for their times. */
#ifndef PBF_BENCH_RUNNER_H
#define PBF_BENCH_RUNNER_H

#include "pareto/judge.h"
#include "pareto/results.h"

namespace bench {

struct RunnerOptions {
  std::string json;       // results, written after every run; empty: none
  std::string dumps;      // keep the dumps in this folder; empty: they go once judged
  std::string scratch;    // an empty folder
  double patience = 120;  // seconds after which a run is given up
};

// Stops early after Ctrl-C, with what there is.
void run_study(Study &study, const Judge &judge, const RunnerOptions &options);

}  // namespace bench

#endif
