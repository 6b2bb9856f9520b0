#include "report/chart.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>

namespace bench {
namespace {

constexpr double left = 66, right = 14, top = 12, bottom = 48;

std::string format(const char *pattern, ...) __attribute__((format(printf, 1, 2)));
std::string format(const char *pattern, ...) {
  char text[512];
  va_list values;
  va_start(values, pattern);
  std::vsnprintf(text, sizeof text, pattern, values);
  va_end(values);
  return text;
}

std::string escaped(const std::string &text) {
  std::string out;
  for (const char c : text) {
    if (c == '&') {
      out += "&amp;";
    } else if (c == '<') {
      out += "&lt;";
    } else {
      out += c;
    }
  }
  return out;
}

// 1, 2 or 5 times a power of ten, at or beyond the value.
double nice(double value, bool upwards) {
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  double best = upwards ? 10 * decade : decade;
  for (const double step : {2.0, 5.0}) {
    const double candidate = step * decade;
    if (upwards && candidate >= value * 0.999) best = std::min(best, candidate);
    if (!upwards && candidate <= value * 1.001) best = std::max(best, candidate);
  }
  if (upwards && decade >= value * 0.999) best = decade;
  return best;
}

class Axis {
 public:
  Axis(double least, double most, double from, double to) : from_(from), to_(to) {
    low_ = nice(least / 1.15, false);
    high_ = nice(most * 1.15, true);
    if (high_ < 9 * low_) high_ = nice(9 * low_, true);
  }

  double place(double value) const {
    const double share = std::log(std::clamp(value, low_, high_) / low_) / std::log(high_ / low_);
    return from_ + share * (to_ - from_);
  }

  struct Tick {
    double value;
    bool labelled, decade;
  };

  // Every decade, and 2 and 5 times it: with numbers where there is room for them.
  std::vector<Tick> ticks() const {
    const double decades = std::log10(high_ / low_);
    std::vector<Tick> ticks;
    const double first = std::floor(std::log10(low_) + 1e-9);
    for (double power = first; power <= std::log10(high_) + 1e-9; ++power) {
      for (const double step : {1.0, 2.0, 5.0}) {
        const double value = step * std::pow(10.0, power);
        if (value < low_ * 0.999 || value > high_ * 1.001) continue;
        ticks.push_back({value, step == 1 || decades < 2.6, step == 1});
      }
    }
    return ticks;
  }

  double low() const { return low_; }

 private:
  double low_, high_, from_, to_;
};

std::string plain(double value) { return format("%.4g", value); }

std::string percent(double value) { return format("%.4g %%", 100 * value); }

class Drawing {
 public:
  explicit Drawing(const Chart &chart) : chart_(chart), x_(x_axis(chart)), y_(y_axis(chart)) {}

  std::string draw() {
    svg_ = format(
        "<svg viewBox=\"0 0 %d %d\" role=\"img\">"
        "<title>%s against %s</title>",
        chart_.width, chart_.height, escaped(chart_.y_title).c_str(),
        escaped(chart_.x_title).c_str());
    grid();
    titles();
    floor();
    for (const ChartSeries &series : chart_.series) draw_rest(series);
    for (const ChartSeries &series : chart_.series) draw_front(series);
    for (const ChartSeries &series : chart_.series) draw_names(series);
    return svg_ + "</svg>";
  }

 private:
  static Axis x_axis(const Chart &chart) {
    double least = 1e300, most = 0;
    for (const ChartSeries &series : chart.series) {
      for (const ChartPoint &point : series.points) {
        least = std::min(least, point.x);
        most = std::max(most, point.x);
      }
    }
    if (most <= 0) least = most = 1;
    return Axis(least, most, left, chart.width - right);
  }

  static Axis y_axis(const Chart &chart) {
    double least = 1e300, most = 0;
    for (const ChartSeries &series : chart.series) {
      for (const ChartPoint &point : series.points) {
        if (point.y > chart.least_y) least = std::min(least, point.y);
        if (point.on_front) most = std::max(most, point.y);
      }
    }
    if (most <= chart.least_y) least = most = 1e-2;
    return Axis(least, most, chart.height - bottom, top);
  }

  void line(double x0, double y0, double x1, double y1, const char *css) {
    svg_ += format("<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\" class=\"%s\"/>", x0, y0,
                   x1, y1, css);
  }

  void text(double x, double y, const char *css, const std::string &words) {
    svg_ +=
        format("<text x=\"%.1f\" y=\"%.1f\" class=\"%s\">", x, y, css) + escaped(words) + "</text>";
  }

  void grid() {
    const double bottom_edge = chart_.height - bottom;
    for (const Axis::Tick &tick : x_.ticks()) {
      const double at = x_.place(tick.value);
      line(at, top, at, bottom_edge, tick.decade ? "grid decade" : "grid");
      if (tick.labelled) text(at, bottom_edge + 17, "tick middle", plain(tick.value));
    }
    for (const Axis::Tick &tick : y_.ticks()) {
      const double at = y_.place(tick.value);
      line(left, at, chart_.width - right, at, tick.decade ? "grid decade" : "grid");
      if (tick.labelled) text(left - 8, at + 4, "tick end", percent(tick.value));
    }
  }

  void titles() {
    text((left + chart_.width - right) / 2, chart_.height - 8, "axis middle", chart_.x_title);
    text(left + 10, chart_.height - bottom - 10, "hint", "↙ better");
  }

  void floor() {
    if (!chart_.floor || *chart_.floor < y_.low()) return;
    const double at = y_.place(*chart_.floor);
    line(left, at, chart_.width - right, at, "floor");
    text(chart_.width - right - 6, at - 6, "tick end", chart_.floor_name);
  }

  void draw_rest(const ChartSeries &series) {
    svg_ += "<g class=\"" + series.css_class + " rest\">";
    for (const ChartPoint &point : series.points) {
      if (!point.on_front) draw_point(point, 3);
    }
    svg_ += "</g>";
  }

  void draw_front(const ChartSeries &series) {
    svg_ += "<g class=\"" + series.css_class + " front\"><polyline points=\"";
    for (const ChartPoint &point : series.points) {
      if (point.on_front) svg_ += format("%.1f,%.1f ", x_.place(point.x), y_.place(point.y));
    }
    svg_ += "\"/>";
    for (const ChartPoint &point : series.points) {
      if (!point.on_front) continue;
      const double y = y_.place(point.y);
      line(x_.place(point.x_low), y, x_.place(point.x_high), y, "spread");
      draw_point(point, 4.5);
    }
    svg_ += "</g>";
  }

  void draw_names(const ChartSeries &series) {
    svg_ += "<g class=\"" + series.css_class + " named\">";
    for (const ChartPoint &point : series.points) {
      if (point.name.empty()) continue;
      const double x = x_.place(point.x), y = y_.place(point.y);
      svg_ += format("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"8\"/>", x, y);
      text(x + 9, y - 9, "name", point.name);
    }
    svg_ += "</g>";
  }

  void draw_point(const ChartPoint &point, double radius) {
    svg_ += format("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\"><title>", x_.place(point.x),
                   y_.place(point.y), radius) +
            escaped(point.tip) + "</title></circle>";
  }

  const Chart &chart_;
  Axis x_, y_;
  std::string svg_;
};

}  // namespace

std::string draw_chart(const Chart &chart) { return Drawing(chart).draw(); }

}  // namespace bench
