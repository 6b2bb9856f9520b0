#include "pareto/words.h"

#include "core/table.h"
#include "speedup/speedup.h"

namespace bench {
namespace {

bool has_subject(const Study &study, Series &found) {
  for (const Series &series : series_of(study)) {
    if (series.family != study.sweep.subject) continue;
    found = series;
    return true;
  }
  return false;
}

}  // namespace

std::string error_text(double error) {
  return error <= least_error ? "0" : rounded(100 * error, 3) + " %";
}

std::string cost_text(double seconds_per_simulated) {
  return rounded(seconds_per_simulated, 3) + " s";
}

std::string ratio_text(double ratio) { return rounded(ratio, 3) + " ×"; }

std::string reach_text(const std::optional<Reach> &reach) {
  if (!reach) return "not reached";
  return (reach->at_most ? "≤ " : "") + cost_text(reach->time);
}

std::string time_ratio_text(const std::optional<TimeRatio> &ratio) {
  if (!ratio) return "–";
  const char *bound = ratio->bound == TimeRatio::Bound::exact      ? ""
                      : ratio->bound == TimeRatio::Bound::at_least ? "≥ "
                                                                   : "≤ ";
  return bound + ratio_text(ratio->ratio);
}

std::string advantage_text(const std::optional<Advantage> &advantage) {
  if (!advantage) return "–";
  return ratio_text(advantage->median) + " (" + rounded(advantage->least, 2) + " – " +
         rounded(advantage->most, 2) + ")";
}

std::string headline(const Study &study) {
  const ErrorFigure &error = study.sweep.errors.front();
  Series subject{};
  if (!has_subject(study, subject)) return "Nothing to compare yet";
  const Comparison comparison = compare(study, error.figure, subject);
  if (!comparison.equal_time) return "Nothing to compare yet";
  const double ratio = comparison.equal_time->median;
  return error.title + " at equal run time: " + ratio_text(ratio >= 1 ? ratio : 1 / ratio) +
         (ratio >= 1 ? " smaller" : " larger") + " with " + title_of(study, subject) +
         " than with " + study.sweep.families[study.sweep.baseline].title;
}

std::string study_table(const Study &study) {
  std::string text;
  for (const ErrorFigure &error : study.sweep.errors) {
    Table table(
        {error.title, "least", "× smaller at equal time", "1 %", "×", "0.1 %", "×", "0.01 %", "×"});
    table.align_right(1, 8);
    for (const Series &series : series_of(study)) {
      const Comparison comparison = compare(study, error.figure, series);
      if (comparison.front.empty()) continue;
      std::vector<std::string> row = {title_of(study, series),
                                      error_text(comparison.front.back().error),
                                      advantage_text(comparison.equal_time)};
      for (size_t i = 0; i < error_levels.size(); ++i) {
        row.push_back(reach_text(comparison.reach[i]));
        row.push_back(time_ratio_text(comparison.ratio[i]));
      }
      table.add(row);
    }
    text += table.text() + "\n";
  }
  return text;
}

}  // namespace bench
