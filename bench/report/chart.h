/* Scatter plots with both axes logarithmic, as SVG whose colours are the page's. The fronts set the
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

std::string draw_chart(const Chart &chart);

}  // namespace bench

#endif
