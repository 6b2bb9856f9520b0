/* Fills bench/report/pareto.html with the results of a sweep. */
#include "report/pareto.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>

#include <kainjow/mustache.hpp>

#include "core/resources.h"
#include "pareto/words.h"
#include "report/chart.h"
#include "report/date.h"
#include "report/render.h"
#include "speedup/speedup.h"

namespace bench {
namespace {

using kainjow::mustache::data;

// ---- Series ----

// The baseline is grey, the subject stands out, the others have what is left.
std::string css_class(const Study &study, const std::vector<Series> &all, size_t index) {
  if (all[index].family == study.sweep.baseline) return "baseline";
  if (all[index].family == study.sweep.subject) return "subject";
  size_t number = 0;
  for (size_t i = 0; i < index; ++i) {
    if (all[i].family != study.sweep.baseline && all[i].family != study.sweep.subject) ++number;
  }
  return "c" + std::to_string(number % 6);
}

data legend_of(const Study &study) {
  const std::vector<Series> all = series_of(study);
  data legend{data::type::list};
  for (size_t i = 0; i < all.size(); ++i) {
    data entry;
    entry.set("class", css_class(study, all, i));
    entry.set("title", title_of(study, all[i]));
    legend << entry;
  }
  return legend;
}

std::string spread_text(const Point &point) {
  return rounded(least_cost(point), 3) + " – " + rounded(most_cost(point), 3);
}

// The scene with all defaults.
bool is_default(const Study &study, const Point &point) {
  const pbf_params &params = point.scene.params;
  return point.solver.precision == PBF_FLOAT32 && point.divide == 1 &&
         std::memcmp(&params, &study.plan.scene.params, sizeof params) == 0;
}

ChartSeries chart_series(const Study &study, const std::string &figure, const Series &series) {
  ChartSeries drawn;
  const std::vector<Sample> samples = samples_of(study, figure, series);
  const std::vector<Sample> front = front_of(samples);
  const auto add = [&](const Sample &sample, bool on_front) {
    const Point &point = study.plan.points[sample.point];
    drawn.points.push_back({sample.time, sample.error, least_cost(point), most_cost(point),
                            on_front,
                            title_of(study, series) + ": " + point.label + "\n" +
                                error_text(sample.error) + " in " + cost_text(sample.time),
                            is_default(study, point) ? "default" : ""});
  };
  for (const Sample &sample : front) add(sample, true);
  for (const Sample &sample : samples) {
    const auto same = [&](const Sample &other) { return other.point == sample.point; };
    if (std::none_of(front.begin(), front.end(), same)) add(sample, false);
  }
  return drawn;
}

Chart chart_of(const Study &study, const ErrorFigure &error, bool large) {
  Chart chart;
  chart.width = large ? 820 : 620;
  chart.height = large ? 480 : 400;
  chart.x_title = "seconds of computing for each simulated second";
  chart.y_title = error.title;
  chart.least_y = least_error;
  chart.floor = float32_floor(study, error.figure);
  chart.floor_name = "float32 floor";
  const std::vector<Series> all = series_of(study);
  std::vector<ChartSeries> on_top;
  for (size_t i = 0; i < all.size(); ++i) {
    ChartSeries series = chart_series(study, error.figure, all[i]);
    series.css_class = css_class(study, all, i);
    const bool last = series.css_class == "baseline" || series.css_class == "subject";
    (last ? on_top : chart.series).push_back(series);
  }
  chart.series.insert(chart.series.end(), on_top.begin(), on_top.end());
  return chart;
}

// ---- Tables ----

data comparisons_of(const Study &study, const std::string &figure) {
  const std::vector<Series> all = series_of(study);
  data rows{data::type::list};
  for (size_t i = 0; i < all.size(); ++i) {
    const Comparison comparison = compare(study, figure, all[i]);
    if (comparison.front.empty()) continue;
    data row;
    row.set("class", css_class(study, all, i));
    row.set("title", title_of(study, all[i]));
    row.set("least", error_text(comparison.front.back().error));
    const bool is_baseline = all[i].family == study.sweep.baseline;
    row.set("equal_time", is_baseline ? "–" : advantage_text(comparison.equal_time));
    data levels{data::type::list};
    for (size_t level = 0; level < error_levels.size(); ++level) {
      data cell;
      const auto &reach = comparison.reach[level];
      cell.set("reach", reach ? reach_text(reach) : "–");
      cell.set("ratio", time_ratio_text(comparison.ratio[level]));
      cell.set("compared", comparison.ratio[level].has_value() && !is_baseline);
      levels << cell;
    }
    row.set("levels", levels);
    rows << row;
  }
  return rows;
}

data hull_of(const Study &study, const std::string &figure) {
  const std::vector<Series> all = series_of(study);
  data rows{data::type::list};
  for (const Sample &sample : front_of_all(study, figure)) {
    const Point &point = study.plan.points[sample.point];
    const Series series{point.family, point.solver.backend};
    const auto base = front_of(samples_of(study, figure, {study.sweep.baseline, series.backend}));
    const auto base_error = error_at_time(base, sample.time);
    data row;
    row.set("title", title_of(study, series));
    row.set("label", point.label);
    row.set("cost", rounded(sample.time, 3));
    row.set("spread", spread_text(point));
    row.set("error", error_text(sample.error));
    row.set("over_base", base_error ? ratio_text(*base_error / sample.error) : "–");
    rows << row;
  }
  return rows;
}

data errors_of(const Study &study) {
  std::vector<const ErrorFigure *> figures;
  std::vector<Chart> charts;
  for (const ErrorFigure &error : study.sweep.errors) {
    if (front_of_all(study, error.figure).empty()) continue;
    figures.push_back(&error);
    charts.push_back(chart_of(study, error, &error == &study.sweep.errors.front()));
  }
  const std::vector<std::string> drawn = draw_charts(charts);
  data errors{data::type::list};
  for (size_t i = 0; i < figures.size(); ++i) {
    const ErrorFigure &error = *figures[i];
    const bool first = &error == &study.sweep.errors.front();
    data entry;
    entry.set("first", first);
    entry.set("title", error.title);
    entry.set("explains", error.explains);
    entry.set("figure", error.figure);
    entry.set("chart", drawn[i]);
    entry.set("rows", comparisons_of(study, error.figure));
    entry.set("hull", hull_of(study, error.figure));
    const auto floor = float32_floor(study, error.figure);
    entry.set("have_floor", floor.has_value());
    entry.set("floor", floor ? error_text(*floor) : "");
    errors << entry;
  }
  return errors;
}

data twin_rows(const Study &study) {
  data rows{data::type::list};
  for (const Twin &twin : twins_of(study)) {
    const Point &single = study.plan.points[twin.single], &wide = study.plan.points[twin.wide];
    for (const ErrorFigure &error : study.sweep.errors) {
      const auto a = single.outcome.errors.find(error.figure);
      const auto b = wide.outcome.errors.find(error.figure);
      if (a == single.outcome.errors.end() || b == wide.outcome.errors.end()) continue;
      data row;
      row.set("title", study.sweep.families[single.family].title + ": " + single.label);
      row.set("error", error.title);
      row.set("single", error_text(a->second));
      row.set("wide", error_text(b->second));
      rows << row;
    }
  }
  return rows;
}

data points_of(const Study &study) {
  data rows{data::type::list};
  for (const Point &point : study.plan.points) {
    if (!was_timed(point)) continue;
    data row;
    row.set("title", title_of(study, {point.family, point.solver.backend}));
    row.set("label", point.label);
    row.set("cost", rounded(median_cost(point), 3));
    row.set("spread", spread_text(point));
    row.set("runs", std::to_string(point.outcome.seconds.size()));
    data cells{data::type::list};
    for (const ErrorFigure &error : study.sweep.errors) {
      const auto found = point.outcome.errors.find(error.figure);
      data cell;
      cell.set("error", found == point.outcome.errors.end() ? "–" : error_text(found->second));
      cells << cell;
    }
    row.set("cells", cells);
    rows << row;
  }
  return rows;
}

data failures_of(const Study &study) {
  data rows{data::type::list};
  for (const Point &point : study.plan.points) {
    if (point.outcome.reason.empty()) continue;
    data row;
    row.set("title", title_of(study, {point.family, point.solver.backend}));
    row.set("label", point.label);
    row.set("reason", point.outcome.reason);
    rows << row;
  }
  return rows;
}

// ---- Tiles: the three figures that a newcomer takes away ----

void add_tile(data &tiles, const std::string &value, const std::string &words) {
  data tile;
  tile.set("value", value);
  tile.set("words", words);
  tiles << tile;
}

// The least of the levels that the family gets down to.
void add_reach(data &tiles, const Comparison &comparison, const std::string &base) {
  for (size_t i = error_levels.size(); i-- > 0;) {
    if (!comparison.reach[i]) continue;
    const std::string also =
        "; " + base + " takes " + time_ratio_text(comparison.ratio[i]) + " that";
    add_tile(tiles, reach_text(comparison.reach[i]),
             "of computing for each simulated second until " + rounded(100 * error_levels[i], 1) +
                 " %" + (comparison.ratio[i] ? also : ""));
    return;
  }
}

data tiles_of(const Study &study) {
  data tiles{data::type::list};
  const ErrorFigure &error = study.sweep.errors.front();
  const std::string base = study.sweep.families[study.sweep.baseline].title;
  for (const Series &series : series_of(study)) {
    if (series.family != study.sweep.subject) continue;
    const Comparison comparison = compare(study, error.figure, series);
    if (const auto &equal = comparison.equal_time) {
      add_tile(tiles, ratio_text(equal->median),
               "smaller than with " + base + " at equal run time (median; " +
                   rounded(equal->least, 2) + " to " + rounded(equal->most, 2) + " between " +
                   cost_text(equal->from) + " and " + cost_text(equal->to) + ")");
    }
    add_reach(tiles, comparison, base);
    if (!comparison.front.empty()) {
      add_tile(tiles, error_text(comparison.front.back().error),
               "is the least reached, in " + cost_text(comparison.front.back().time));
    }
    break;
  }
  return tiles;
}

// ---- Page ----

data builds_of(const Study &study) {
  data builds{data::type::list};
  for (const auto &[backend, build] : study.builds) {
    data entry;
    entry.set("backend", backend);
    entry.set("device", build.device);
    entry.set("build", build.build_id);
    builds << entry;
  }
  return builds;
}

std::string commits_of(const Study &study) {
  std::set<std::string> commits;
  for (const Point &point : study.plan.points) {
    if (!point.outcome.commit.empty()) commits.insert(point.outcome.commit);
  }
  std::string text;
  for (const std::string &commit : commits) text += (text.empty() ? "" : ", ") + commit;
  return text;
}

unsigned fewest_runs(const Study &study) {
  size_t fewest = SIZE_MAX;
  for (const Point &point : study.plan.points) {
    if (was_timed(point)) fewest = std::min(fewest, point.outcome.seconds.size());
  }
  return fewest == SIZE_MAX ? 0 : static_cast<unsigned>(fewest);
}

void add_scene(const Study &study, data &page) {
  const Scene &scene = study.plan.scene;
  const pbf_params &params = scene.params;
  const double spacing = params.spacing > 0 ? params.spacing : params.smoothing_radius / 2;
  page.set("scene", scene.name);
  page.set("description", scene.description);
  page.set("particles", counted(count_particles(scene)));
  page.set("dimension", std::to_string(scene.dimension) + "D");
  page.set("simulated", rounded(scene.steps * params.time_step, 3));
  page.set("time_step", rounded(params.time_step, 3));
  page.set("support", rounded(params.smoothing_radius / spacing, 3));
  page.set("frames", std::to_string(study.frames));
}

void add_machine(const Study &study, data &page) {
  const Machine machine = this_machine();
  page.set("builds", builds_of(study));
  page.set("cpu", machine.cpu);
  page.set("cpus", std::to_string(machine.cpus));
  page.set("system", machine.system);
  page.set("compiler", machine.compiler);
  page.set("commit", commits_of(study));
  page.set("date", today());
}

data page_data(const Study &study) {
  data page;
  const data failures = failures_of(study), twins = twin_rows(study);
  page.set("headline", headline(study));
  page.set("sweep", study.sweep.description);
  page.set("baseline", study.sweep.families[study.sweep.baseline].title);
  page.set("tiles", tiles_of(study));
  page.set("legend", legend_of(study));
  page.set("errors", errors_of(study));
  page.set("points", points_of(study));
  data titles{data::type::list};
  for (const ErrorFigure &error : study.sweep.errors) {
    data title;
    title.set("title", error.title);
    titles << title;
  }
  page.set("titles", titles);
  page.set("have_failures", !failures.is_empty_list());
  page.set("failures", failures);
  page.set("have_twins", !twins.is_empty_list());
  page.set("twins", twins);
  page.set("clock", study.cpu_time ? "processor time, of all threads" : "wall time");
  page.set("runs", std::to_string(fewest_runs(study)));
  add_scene(study, page);
  add_machine(study, page);
  return page;
}

}  // namespace

void write_pareto_page(const Study &study, const std::string &path) {
  render_page("pareto.html", pareto_page_text(), page_data(study), path);
}

}  // namespace bench
