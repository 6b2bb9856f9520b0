#include "pareto/analysis.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace bench {
namespace {

using nlohmann::json;

double longest_time(const std::vector<Sample> &samples) {
  double longest = 0;
  for (const Sample &sample : samples) longest = std::max(longest, sample.time);
  return longest;
}

bool same_but_precision(const Point &a, const Point &b) {
  return a.solver.backend == b.solver.backend && a.solver.threads == b.solver.threads &&
         a.scene.steps == b.scene.steps &&
         std::memcmp(&a.scene.params, &b.scene.params, sizeof b.scene.params) == 0;
}

const char *bound_text(TimeRatio::Bound bound) {
  return bound == TimeRatio::Bound::exact      ? "exact"
         : bound == TimeRatio::Bound::at_least ? "at_least"
                                               : "at_most";
}

json comparison_json(const Study &study, const Comparison &comparison) {
  json text = json::object();
  json front = json::array();
  for (const Sample &sample : comparison.front) {
    front.push_back({{"seconds_per_simulated", sample.time},
                     {"error", sample.error},
                     {"label", study.plan.points[sample.point].label}});
  }
  text["front"] = front;
  if (const auto &equal = comparison.equal_time) {
    text["at_equal_time"] = {{"least", equal->least},
                             {"median", equal->median},
                             {"most", equal->most},
                             {"from", equal->from},
                             {"to", equal->to}};
  }
  for (size_t i = 0; i < error_levels.size(); ++i) {
    json level = {{"error", error_levels[i]}};
    if (const auto &reach = comparison.reach[i]) {
      level["seconds_per_simulated"] = reach->time;
      if (reach->at_most) level["bound"] = "at_most";
    }
    if (const auto &ratio = comparison.ratio[i]) {
      level["baseline_over_this"] = ratio->ratio;
      level["ratio_is"] = bound_text(ratio->bound);
    }
    text["levels"].push_back(level);
  }
  return text;
}

}  // namespace

bool operator==(const Series &a, const Series &b) {
  return a.family == b.family && a.backend == b.backend;
}

std::vector<Series> series_of(const Study &study) {
  std::vector<Series> all;
  for (const Point &point : study.plan.points) {
    const Series series{point.family, point.solver.backend};
    if (std::find(all.begin(), all.end(), series) == all.end()) all.push_back(series);
  }
  return all;
}

std::string title_of(const Study &study, const Series &series) {
  const std::string &title = study.sweep.families[series.family].title;
  for (const Point &point : study.plan.points) {
    if (point.solver.backend != series.backend) return title + ", " + series.backend;
  }
  return title;
}

bool was_timed(const Point &point) { return !point.outcome.seconds.empty(); }

std::vector<Sample> samples_of(const Study &study, const std::string &figure,
                               const Series &series) {
  std::vector<Sample> samples;
  for (size_t i = 0; i < study.plan.points.size(); ++i) {
    const Point &point = study.plan.points[i];
    const auto error = point.outcome.errors.find(figure);
    if (!(series == Series{point.family, point.solver.backend}) || !was_timed(point)) continue;
    if (error == point.outcome.errors.end()) continue;
    samples.push_back({median_cost(point), error->second, i});
  }
  return samples;
}

std::vector<Sample> front_of_all(const Study &study, const std::string &figure) {
  std::vector<Sample> all;
  for (const Series &series : series_of(study)) {
    const std::vector<Sample> samples = samples_of(study, figure, series);
    all.insert(all.end(), samples.begin(), samples.end());
  }
  return front_of(all);
}

Comparison compare(const Study &study, const std::string &figure, const Series &series) {
  const std::vector<Sample> base_samples =
      samples_of(study, figure, {study.sweep.baseline, series.backend});
  const std::vector<Sample> base = front_of(base_samples);
  Comparison comparison;
  comparison.front = front_of(samples_of(study, figure, series));
  comparison.equal_time = at_equal_time(base, comparison.front);
  for (size_t i = 0; i < error_levels.size(); ++i) {
    comparison.reach[i] = time_at_error(comparison.front, error_levels[i]);
    comparison.ratio[i] =
        at_equal_error(base, longest_time(base_samples), comparison.front, error_levels[i]);
  }
  return comparison;
}

std::vector<Twin> twins_of(const Study &study) {
  std::vector<Twin> twins;
  const std::vector<Point> &points = study.plan.points;
  for (size_t wide = 0; wide < points.size(); ++wide) {
    if (points[wide].solver.precision != PBF_FLOAT64 || !was_timed(points[wide])) continue;
    for (size_t single = 0; single < points.size(); ++single) {
      if (points[single].solver.precision != PBF_FLOAT32 || !was_timed(points[single])) continue;
      if (!same_but_precision(points[single], points[wide])) continue;
      twins.push_back({single, wide});
      break;
    }
  }
  return twins;
}

std::optional<double> float32_floor(const Study &study, const std::string &figure) {
  std::optional<double> floor;
  for (const Twin &twin : twins_of(study)) {
    const Outcome &single = study.plan.points[twin.single].outcome;
    const Outcome &wide = study.plan.points[twin.wide].outcome;
    const auto a = single.start.find(figure), b = wide.start.find(figure);
    if (a == single.start.end() || b == wide.start.end()) continue;
    const double apart = std::fabs(a->second - b->second);
    floor = std::max(floor.value_or(0), apart);
  }
  return floor;
}

json analysis_json(const Study &study) {
  json all = json::array();
  for (const ErrorFigure &error : study.sweep.errors) {
    json families = json::array();
    for (const Series &series : series_of(study)) {
      const Comparison comparison = compare(study, error.figure, series);
      if (comparison.front.empty()) continue;
      json text = comparison_json(study, comparison);
      text["family"] = study.sweep.families[series.family].name;
      text["title"] = title_of(study, series);
      text["backend"] = series.backend;
      families.push_back(text);
    }
    json entry = {{"figure", error.figure}, {"families", families}};
    if (const auto floor = float32_floor(study, error.figure)) entry["float32_floor"] = *floor;
    all.push_back(entry);
  }
  return all;
}

}  // namespace bench
