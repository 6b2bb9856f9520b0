/* The errors of a dump, as check/pbf-check finds them: a program that shares no code with any
 * solver. */
#ifndef PBF_BENCH_JUDGE_H
#define PBF_BENCH_JUDGE_H

#include "pareto/point.h"

namespace bench {

class Judge {
 public:
  // Throws Error when there is no Python that can run the checker. Its files go into `scratch`.
  Judge(const std::string &scratch, const std::vector<ErrorFigure> &errors);

  // What identifies it: a digest of its sources.
  const std::string &id() const { return id_; }

  // Fills the outcome's errors, or its reason when the dump can't be judged.
  void judge(const std::string &dump, Outcome &outcome) const;

 private:
  // The exit code, or what ended it otherwise; what it said on standard error goes to `said`.
  int run(const std::vector<std::string> &arguments, std::string &said) const;

  std::string scratch_, id_;
  std::vector<ErrorFigure> errors_;
  std::string keys_;  // "E1,E2"
};

// From a report of pbf-check. "@mean" leaves the first frame out, which is the start and the same
// for all.
void read_report(const nlohmann::json &report, const std::vector<ErrorFigure> &errors,
                 Outcome &outcome);

}  // namespace bench

#endif
