/* What each feature costs, and what it costs those who do not use it. */
#ifndef PBF_BENCH_ABLATION_H
#define PBF_BENCH_ABLATION_H

#include <string>
#include <vector>

#include "ablation/worker.h"

namespace bench {

// One row: a variant, or a build; its times and those of the row that it is compared with, in the
// same rounds.
struct AblationRow {
  std::string name;
  std::string reason;               // why there are no times; empty when there are
  std::vector<double> ms_per_step;  // one a round
  std::vector<double> ratios;       // to the first row's, round by round
  Facts facts = {};
};

struct Ablation {
  Scene scene;  // as it is run, with the steps of a round
  SolverOptions solver;
  bool cpu_time;
  std::vector<AblationRow> variants;  // the first is the minimal plan
  std::vector<AblationRow> builds;    // the minimal plan: this build, it again, then the others
};

// Another build, by the folder of its backends.
struct LibraryBuild {
  std::string name, folder;
};

struct AblationOptions {
  SolverOptions solver;
  unsigned rounds = 9;
  bool cpu_time = false;
  uint32_t run_up = 0;  // steps before the measured ones
  std::vector<LibraryBuild> against;
};

// Rounds in which every row runs once, in one order and then in the other, each from the same
// particles. Stops between two rounds at Ctrl-C.
Ablation ablate(const Scene &scene, const AblationOptions &options);

double median_of(std::vector<double> values);

std::string ablation_table(const Ablation &ablation);
void write_ablation_json(const Ablation &ablation, const std::string &path);
void write_ablation_page(const Ablation &ablation, const std::string &path);

}  // namespace bench

#endif
