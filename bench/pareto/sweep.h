/* What a Pareto sweep runs: families of settings, read from a JSON file (bench/sweeps/). */
#ifndef PBF_BENCH_SWEEP_H
#define PBF_BENCH_SWEEP_H

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scene/document.h"

namespace bench {

// A figure of pbf-check, and how the page calls it.
struct ErrorFigure {
  std::string figure;  // "E1.measure.interior.mean_abs@mean"
  std::string title, explains;
};

struct Family {
  std::string name, title;
};

// A parameter of pbf_params or one of sweep_names(), its value, and where the file says so.
struct Choice {
  std::string name;
  nlohmann::json value;
  std::string origin;
  bool varied;  // else the same for the whole family
};

struct Candidate {
  size_t family;
  std::vector<Choice> choices;
};

struct Sweep {
  std::string description;
  size_t baseline = 0, subject = 0;  // indices of families
  std::vector<ErrorFigure> errors;
  std::vector<Family> families;
  std::vector<Candidate> candidates;
};

// What a sweep can choose besides the fields of pbf_params: backend, precision, threads,
// divide_time_step, by which the scene's time step is divided and its number of steps multiplied,
// and support, which is h over the spacing, the spacing being the scene's.
const std::vector<std::string> &sweep_names();

// All throw Error(exit_usage) with file, line, column and reason. `scene` picks the errors.
Sweep read_sweep(const Document &document, const std::string &scene);
Sweep default_sweep(const std::string &scene);
Sweep quick_sweep(const std::string &scene);

}  // namespace bench

#endif
