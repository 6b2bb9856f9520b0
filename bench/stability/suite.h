/* Runs the cases, each in a process of its own, and has them judged. */
#ifndef PBF_BENCH_STABILITY_SUITE_H
#define PBF_BENCH_STABILITY_SUITE_H

#include <string>
#include <vector>

#include "core/solver.h"
#include "stability/cases.h"

namespace bench::stability {

struct SuiteOptions {
  std::vector<std::string> backends;  // none: all that the library knows
  std::vector<int> cases;             // none: all
  SolverOptions solver;               // precision and device
  std::vector<std::string> settings;  // key=value, in place of the library's defaults
  bool quick = false;
  std::string dump;  // folder of the dumps
};

// One case on one backend, here and now; facts and dumps go into the folder of both.
void run_alone(const SuiteOptions &options);

// All of them. A case that crashes or does not end has failed, and the others go on.
void run_all(const SuiteOptions &options);

struct Figure {
  std::string name, value, bound;
  bool holds = false;
};

struct Verdict {
  int number = 0;
  std::string backend;
  std::string outcome;  // holds, fails, absent, unavailable
  std::string reason;   // a sentence where there is no figure
  std::string note;
  double seconds = 0;
  std::vector<Figure> figures;                                // the nearest to its bound first
  std::vector<std::pair<std::string, std::string>> pictures;  // file, caption
};

struct Judgement {
  std::vector<Verdict> verdicts;
  std::string text;  // pbf-check's report, JSON
};

// Runs pbf-check over what the options choose of the dumps. Throws Error when that is not possible.
Judgement judge(const SuiteOptions &options);

// In the order of the verdicts, each once.
std::vector<std::string> backends_of(const Judgement &judgement);

std::string verdict_table(const Judgement &judgement);
void write_verdict_page(const Judgement &judgement, const std::string &path);

}  // namespace bench::stability

#endif
