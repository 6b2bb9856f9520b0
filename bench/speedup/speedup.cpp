#include "speedup/speedup.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/table.h"

namespace bench {
namespace {

std::string with_commas(std::string digits) {
  const size_t point = std::min(digits.find('.'), digits.size());
  for (size_t i = point; i > 3; i -= 3) digits.insert(i - 3, ",");
  return digits;
}

std::string spread_text(const Result &result) {
  if (result.milliseconds.size() < 2) return "–";
  const double spread = (max_ms(result) - min_ms(result)) / median_ms(result);
  char text[32];
  std::snprintf(text, sizeof text, "%.1f %%", 100 * spread);
  return text;
}

std::string percent(double value) { return rounded(100 * value, 3) + " %"; }

std::vector<std::string> header(const Speedup &speedup) {
  std::vector<std::string> cells = {
      "backend", "device", "threads", "ms for " + std::to_string(speedup.scene.steps) + " steps",
      "min",     "spread", "ms/step", "M particle-iterations/s",
      "× naive"};
  if (speedup.is_the_report) {
    cells.insert(cells.end(), {"× report naive", "× its OpenMP", "× its CUDA"});
  }
  cells.insert(cells.end(), {"density error mean", "max"});
  return cells;
}

std::vector<std::string> cells_of(const Speedup &speedup, const Result &result) {
  if (!result.ran()) {
    std::vector<std::string> cells(header(speedup).size(), "–");
    cells[0] = result.contestant.name;
    cells[2] = threads_text(result);
    cells.push_back(result.reason);
    return cells;
  }
  const double ms = median_ms(result);
  const auto over_naive = speedup_vs_naive(speedup, result);
  std::vector<std::string> cells = {
      result.contestant.name,
      result.info.device_name,
      threads_text(result),
      rounded(ms, 4),
      rounded(min_ms(result), 4),
      spread_text(result),
      rounded(ms_per_step(speedup, result), 3),
      rounded(1e-6 * particle_iterations_per_second(speedup, result), 3),
      over_naive ? rounded(*over_naive, 3) : "–"};
  if (speedup.is_the_report) {
    for (const double report : report_ms) cells.push_back(rounded(report / ms, 3));
  }
  cells.push_back(percent(result.stats.density_error_mean));
  cells.push_back(percent(result.stats.density_error_max));
  return cells;
}

}  // namespace

double ms_per_step(const Speedup &speedup, const Result &result) {
  return median_ms(result) / speedup.scene.steps;
}

double particle_iterations_per_second(const Speedup &speedup, const Result &result) {
  const double iterations = speedup.scene.params.iterations;
  return 1e3 * result.stats.count * iterations / ms_per_step(speedup, result);
}

std::optional<double> speedup_vs_naive(const Speedup &speedup, const Result &result) {
  for (const Result &other : speedup.results) {
    if (other.contestant.name == "naive" && other.ran())
      return median_ms(other) / median_ms(result);
  }
  return std::nullopt;
}

std::string threads_text(const Result &result) {
  if (result.ran() && result.info.device_type != PBF_DEVICE_CPU) return "GPU";
  return std::to_string(result.contestant.threads);
}

std::string rounded(double value, int digits) {
  if (value == 0 || !std::isfinite(value)) return value == 0 ? "0" : "–";
  const int magnitude = static_cast<int>(std::floor(std::log10(std::fabs(value))));
  if (magnitude < -5) {
    char tiny[32];
    std::snprintf(tiny, sizeof tiny, "%.*g", digits, value);
    return tiny;
  }
  const int decimals = std::max(digits - 1 - magnitude, 0);
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return with_commas(text);
}

std::string counted(uint64_t count) { return with_commas(std::to_string(count)); }

std::string speedup_table(const Speedup &speedup) {
  std::vector<std::string> head = header(speedup);
  const size_t figures = head.size();
  const auto ran = [](const Result &result) { return result.ran(); };
  if (!std::all_of(speedup.results.begin(), speedup.results.end(), ran)) head.push_back("why not");
  Table table(head);
  table.align_right(2, figures - 1);
  for (const Result &result : speedup.results) table.add(cells_of(speedup, result));
  return table.text();
}

}  // namespace bench
