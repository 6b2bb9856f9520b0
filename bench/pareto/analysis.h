/* What the points say: fronts, times to an error, ratios to the baseline. */
#ifndef PBF_BENCH_ANALYSIS_H
#define PBF_BENCH_ANALYSIS_H

#include <array>

#include "pareto/front.h"
#include "pareto/results.h"

namespace bench {

constexpr std::array<double, 3> error_levels = {1e-2, 1e-3, 1e-4};

// A family on one backend.
struct Series {
  size_t family;
  std::string backend;
};
bool operator==(const Series &a, const Series &b);
std::vector<Series> series_of(const Study &study);
std::string title_of(const Study &study, const Series &series);

bool was_timed(const Point &point);

// Of the points that have this error and were timed.
std::vector<Sample> samples_of(const Study &study, const std::string &figure, const Series &series);
std::vector<Sample> front_of_all(const Study &study, const std::string &figure);

// One series against the baseline on its backend.
struct Comparison {
  std::vector<Sample> front;
  std::optional<Advantage> equal_time;
  std::array<std::optional<Reach>, 3> reach;      // by error_levels
  std::array<std::optional<TimeRatio>, 3> ratio;  // … to the baseline
};
Comparison compare(const Study &study, const std::string &figure, const Series &series);

// How far float32 is from the same settings in float64, where both were run.
struct Twin {
  size_t single, wide;  // points
};
std::vector<Twin> twins_of(const Study &study);

// What rounding the start's positions to float32 alone does to an error; none without twins.
std::optional<double> float32_floor(const Study &study, const std::string &figure);

nlohmann::json analysis_json(const Study &study);

}  // namespace bench

#endif
