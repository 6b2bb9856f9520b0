/* Fills bench/report/page.html with the results. */
#include <algorithm>
#include <cmath>
#include <set>

#include <kainjow/mustache.hpp>

#include "core/machine.h"
#include "core/resources.h"
#include "core/scalars.h"
#include "report/base64.h"
#include "report/date.h"
#include "report/render.h"
#include "report/picture.h"
#include "speedup/speedup.h"

namespace bench {
namespace {

using kainjow::mustache::data;

// Threads go without saying where nothing ran.
std::string label_of(const Result &result) {
  const std::string &name = result.contestant.name;
  if (threads_text(result) == "GPU" || (!result.ran() && result.contestant.threads == 1))
    return name;
  const unsigned n = result.contestant.threads;
  return name + ", " + std::to_string(n) + (n == 1 ? " thread" : " threads");
}

std::string percent_of(double part) { return std::to_string(100 * part) + "%"; }

// ---- Figures ----

const Result *fastest(const Speedup &speedup) {
  const Result *best = nullptr;
  for (const Result &result : speedup.results) {
    if (result.ran() && (!best || median_ms(result) < median_ms(*best))) best = &result;
  }
  return best;
}

std::string headline(const Speedup &speedup) {
  const Result *best = fastest(speedup);
  if (!best) return "Nothing ran here";
  std::string text = rounded(ms_per_step(speedup, *best), 3) + " ms a step with " + label_of(*best);
  const auto factor = speedup_vs_naive(speedup, *best);
  if (factor && best->contestant.name != "naive") {
    text += ": " + rounded(*factor, 3) + " × the naive program";
  }
  return text;
}

// Bars of speed on a logarithmic axis of whole decades.
struct SpeedAxis {
  double low = 0, high = 1;  // powers of ten

  explicit SpeedAxis(const Speedup &speedup) {
    double slow = 1e300, fast = 0;
    for (const Result &result : speedup.results) {
      if (!result.ran()) continue;
      slow = std::min(slow, particle_iterations_per_second(speedup, result));
      fast = std::max(fast, particle_iterations_per_second(speedup, result));
    }
    if (fast <= 0) return;
    low = std::floor(std::log10(slow) - 0.05);
    high = std::max(std::ceil(std::log10(fast)), low + 1);
  }

  double place(double value) const { return (std::log10(value) - low) / (high - low); }
};

std::string decade_text(int power) {
  static const char *const units[] = {"", " thousand", " million", " billion", " trillion"};
  const int unit = std::clamp(power / 3, 0, 4);
  return rounded(std::pow(10.0, power - 3 * unit), 1) + units[unit];
}

data ticks_of(const SpeedAxis &axis) {
  data ticks{data::type::list};
  for (int power = static_cast<int>(axis.low); power <= static_cast<int>(axis.high); ++power) {
    data tick;
    tick.set("left", percent_of((power - axis.low) / (axis.high - axis.low)));
    tick.set("text", decade_text(power));
    ticks << tick;
  }
  return ticks;
}

data figures_of(const Speedup &speedup, const Result &result) {
  data row;
  const double ms = median_ms(result);
  row.set("ms", rounded(ms, 4));
  row.set("range", rounded(min_ms(result), 4) + " – " + rounded(max_ms(result), 4));
  row.set("ms_per_step", rounded(ms_per_step(speedup, result), 3));
  row.set("rate", rounded(1e-6 * particle_iterations_per_second(speedup, result), 3));
  const auto factor = speedup_vs_naive(speedup, result);
  row.set("over_naive", factor ? rounded(*factor, 3) : "–");
  row.set("report_naive", rounded(report_ms[0] / ms, 3));
  row.set("report_openmp", rounded(report_ms[1] / ms, 3));
  row.set("report_cuda", rounded(report_ms[2] / ms, 3));
  row.set("error_mean", rounded(100 * result.stats.density_error_mean, 3));
  row.set("error_max", rounded(100 * result.stats.density_error_max, 3));
  return row;
}

data rows_of(const Speedup &speedup) {
  const SpeedAxis axis(speedup);
  data rows{data::type::list};
  for (const Result &result : speedup.results) {
    data row = result.ran() ? figures_of(speedup, result) : data();
    row.set("label", label_of(result));
    row.set("ran", result.ran());
    row.set("reason", result.reason);
    row.set("report", speedup.is_the_report);
    if (result.ran()) {
      row.set("device", result.info.device_name);
      const double rate = particle_iterations_per_second(speedup, result);
      row.set("bar", percent_of(axis.place(rate)));
      row.set("naive", result.contestant.name == "naive");
    }
    rows << row;
  }
  return rows;
}

// "1 of naive, 5 of serial": how many times each ran.
std::string runs_text(const Speedup &speedup) {
  std::string text;
  std::set<std::string> told;
  for (const Result &result : speedup.results) {
    if (!result.ran() || !told.insert(result.contestant.name).second) continue;
    text += (text.empty() ? "" : ", ") + std::to_string(result.milliseconds.size()) + " of " +
            result.contestant.name;
  }
  return text;
}

data builds_of(const Speedup &speedup) {
  data builds{data::type::list};
  std::set<std::string> told;
  for (const Result &result : speedup.results) {
    if (!result.ran() || !told.insert(result.contestant.name).second) continue;
    data build;
    build.set("backend", result.contestant.name);
    build.set("device", result.info.device_name);
    build.set("build", result.info.build_id);
    builds << build;
  }
  return builds;
}

// ---- Pictures ----

Frame frame_of(const Result &result) {
  return particles_of(from_precision(result.positions, result.info.precision),
                      from_precision(result.velocities, result.info.precision),
                      result.info.dimension);
}

// One frame a contestant is enough: thread counts differ in nothing that shows.
std::vector<const Result *> shown_results(const Speedup &speedup) {
  std::vector<const Result *> shown;
  std::set<std::string> seen;
  for (const Result &result : speedup.results) {
    if (!result.positions.empty() && seen.insert(result.contestant.name).second) {
      shown.push_back(&result);
    }
  }
  return shown;
}

double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<size_t>(at)];
}

// All frames of a page share view and colours. The empty part above the fluid is left out.
View view_of(const Speedup &speedup, const std::vector<Frame> &frames) {
  const pbf_params &params = speedup.scene.params;
  View view;
  view.particle_radius = 0.5 * (params.spacing > 0 ? params.spacing : params.smoothing_radius / 2);
  double highest = params.domain_min[1], rightmost = params.domain_min[0];
  view.fastest = 0;
  for (const Frame &frame : frames) {
    for (const Vector &x : frame.positions) {
      highest = std::max(highest, x[1]);
      rightmost = std::max(rightmost, x[0]);
    }
    view.fastest = std::max(view.fastest, percentile(frame.speeds, 0.995));
  }
  if (view.fastest <= 0) view.fastest = 1;
  for (unsigned axis = 0; axis < speedup.scene.dimension; ++axis) {
    view.lower[axis] = params.domain_min[axis];
    view.upper[axis] = params.domain_max[axis];
  }
  // A wall that moves may have moved outwards.
  view.upper[0] = std::max(view.upper[0], rightmost);
  view.upper[1] = std::min(view.upper[1], highest + 4 * view.particle_radius);
  view.width = speedup.scene.dimension == 2 ? 1600 : 900;
  return view;
}

std::string color_stops() {
  std::string stops;
  for (const Color &color : speed_colors()) {
    stops += (stops.empty() ? "rgb(" : ", rgb(") + std::to_string(static_cast<int>(color[0])) +
             " " + std::to_string(static_cast<int>(color[1])) + " " +
             std::to_string(static_cast<int>(color[2])) + ")";
  }
  return stops;
}

void add_pictures(const Speedup &speedup, data &page) {
  const std::vector<const Result *> shown = shown_results(speedup);
  std::vector<Frame> frames;
  frames.reserve(shown.size());
  for (const Result *result : shown) frames.push_back(frame_of(*result));
  const View view = view_of(speedup, frames);
  data pictures{data::type::list};
  for (size_t i = 0; i < shown.size(); ++i) {
    data picture;
    picture.set("label", shown[i]->contestant.name);
    picture.set("png", base64(draw_png(frames[i], view)));
    pictures << picture;
  }
  page.set("have_pictures", !shown.empty());
  page.set("flat", speedup.scene.dimension == 2);
  page.set("pictures", pictures);
  page.set("fastest", rounded(view.fastest, 2));
  page.set("color_stops", color_stops());
}

// ---- Page ----

data page_data(const Speedup &speedup) {
  const Scene &scene = speedup.scene;
  const Machine machine = this_machine();
  data page;
  page.set("headline", headline(speedup));
  page.set("scene", scene.name);
  page.set("description", scene.description);
  page.set("particles", counted(count_particles(scene)));
  page.set("dimension", std::to_string(scene.dimension) + "D");
  page.set("steps", std::to_string(scene.steps));
  page.set("iterations", std::to_string(scene.params.iterations));
  page.set("time", rounded(scene.steps * scene.params.time_step, 4));
  page.set("report", speedup.is_the_report);
  page.set("runs", runs_text(speedup));
  page.set("rows", rows_of(speedup));
  page.set("ticks", ticks_of(SpeedAxis(speedup)));
  page.set("builds", builds_of(speedup));
  page.set("cpu", machine.cpu);
  page.set("cpus", std::to_string(machine.cpus));
  page.set("system", machine.system);
  page.set("compiler", machine.compiler);
  page.set("commit", machine.commit);
  page.set("date", today());
  add_pictures(speedup, page);
  return page;
}

}  // namespace

void write_speedup_page(const Speedup &speedup, const std::string &path) {
  render_page("page.html", report_page_text(), page_data(speedup), path);
}

}  // namespace bench
