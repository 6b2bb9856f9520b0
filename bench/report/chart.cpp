#include "report/chart.h"

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/checker.h"
#include "core/output_file.h"
#include "core/process.h"
#include "core/resources.h"
#include "core/scratch.h"

namespace bench {
namespace {

using nlohmann::json;

json described(const ChartPoint &point) {
  return {{"x", point.x},
          {"y", point.y},
          {"x_low", point.x_low},
          {"x_high", point.x_high},
          {"tip", point.tip},
          {"name", point.name},
          {"on_front", point.on_front}};
}

json described(const Chart &chart) {
  json series = json::array();
  for (const ChartSeries &each : chart.series) {
    json points = json::array();
    for (const ChartPoint &point : each.points) points.push_back(described(point));
    series.push_back({{"class", each.css_class}, {"points", points}});
  }
  return {{"width", chart.width},           {"height", chart.height},
          {"x_title", chart.x_title},       {"y_title", chart.y_title},
          {"least_y", chart.least_y},       {"floor", chart.floor ? json(*chart.floor) : json()},
          {"floor_name", chart.floor_name}, {"series", series}};
}

}  // namespace

std::vector<std::string> draw_charts(const std::vector<Chart> &charts) {
  const Scratch scratch("charts");
  const std::string given = scratch.path() + "/charts.json", made = scratch.path() + "/svg.json";
  json all = json::array();
  for (const Chart &chart : charts) all.push_back(described(chart));
  write_file(given, all.dump());
  const std::string program = data_folder("report", PBF_BENCH_SOURCE_REPORT) + "/chart.py";
  const Ended ended =
      run_program({python_program(), "-B", program, given, made}, scratch.path() + "/errors");
  std::ifstream in(made);
  const json drawn = json::parse(in, nullptr, false);
  if (ended.code == 0 && drawn.is_array()) return drawn.get<std::vector<std::string>>();
  return std::vector<std::string>(charts.size(),
                                  "<p class=\"soft\">No chart: Python has no Matplotlib "
                                  "(python3-matplotlib).</p>");
}

}  // namespace bench
