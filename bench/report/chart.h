/* Scatter plots with both axes logarithmic, which chart.py draws by Matplotlib. The fronts set the
 * upper end: what is worse than all of them lies on the edge. */
#ifndef PBF_BENCH_CHART_H
#define PBF_BENCH_CHART_H

#include <optional>
#include <string>
#include <vector>

namespace bench {

struct ChartPoint {
  double x, y;
  double x_low, x_high;  // spread
  bool on_front;
  std::string tip;
  std::string name = {};  // beside the point, which then has a ring
};

struct ChartSeries {
  std::string css_class;
  std::vector<ChartPoint> points;  // those on the front in the order of x
};

struct Chart {
  int width = 640, height = 440;
  std::string x_title, y_title;
  std::vector<ChartSeries> series;
  double least_y = 1e-8;        // smaller ones lie on the lower edge
  std::optional<double> floor;  // a line across, and its name
  std::string floor_name;
};

// An SVG text each, for a place in a page; without Matplotlib a sentence that says so.
std::vector<std::string> draw_charts(const std::vector<Chart> &charts);

}  // namespace bench

#endif
