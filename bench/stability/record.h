/* What a stability case leaves behind for the judge: facts.json beside the dumps of its trials. */
#ifndef PBF_BENCH_STABILITY_RECORD_H
#define PBF_BENCH_STABILITY_RECORD_H

#include <pbf/pbf.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <string>

#include "core/solver.h"

namespace bench::stability {

class Record {
 public:
  // Makes `folder`. Throws Error when that fails.
  Record(std::string folder, const SolverOptions &options, bool quick);

  const SolverOptions &options() const { return options_; }
  const std::string &folder() const { return folder_; }

  // Smaller numbers, for a run that everyone waits for.
  bool quick() const { return quick_; }

  template <typename T>
  T quick_or(T quick, T full) const {
    return quick_ ? quick : full;
  }

  void note(const std::string &key, nlohmann::json value);
  void append(const std::string &key, nlohmann::json value);

  // A call whose outcome is part of the case: its status, and the library's sentence if it failed.
  pbf_status call(const std::string &what, pbf_status status);

  // A call that must be refused: the sentence has to say `names`, and the solver must be as it was.
  void refusal(const std::string &what, pbf_status status, const std::string &names,
               bool unchanged);

  // Memory of the process now, with a name for when.
  void memory(const std::string &when);

  // Writes facts.json.
  void finish();

 private:
  std::string folder_;
  SolverOptions options_;
  bool quick_;
  nlohmann::json facts_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace bench::stability

#endif
