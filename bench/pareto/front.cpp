#include "pareto/front.h"

#include <algorithm>
#include <cmath>

namespace bench {
namespace {

double clamped(double error) { return std::max(error, least_error); }

bool is_none(double error) { return error <= least_error; }

// y at x on the straight line through (x0, y0) and (x1, y1), all on logarithmic axes.
double between(double x, double x0, double y0, double x1, double y1) {
  const double share = std::log(x / x0) / std::log(x1 / x0);
  return y0 * std::pow(y1 / y0, share);
}

}  // namespace

std::vector<Sample> front_of(std::vector<Sample> samples) {
  for (Sample &sample : samples) sample.error = clamped(sample.error);
  std::sort(samples.begin(), samples.end(), [](const Sample &a, const Sample &b) {
    return a.time != b.time ? a.time < b.time : a.error < b.error;
  });
  std::vector<Sample> front;
  for (const Sample &sample : samples) {
    if (front.empty() || sample.error < front.back().error) front.push_back(sample);
  }
  return front;
}

std::optional<double> error_at_time(const std::vector<Sample> &front, double time) {
  if (front.empty() || time < front.front().time) return std::nullopt;
  if (time >= front.back().time) return front.back().error;
  const auto after = std::find_if(front.begin(), front.end(),
                                  [time](const Sample &sample) { return sample.time > time; });
  const Sample &a = *(after - 1), &b = *after;
  if (is_none(b.error)) return a.error;  // no line leads to 0 on a logarithmic axis
  return between(time, a.time, a.error, b.time, b.error);
}

std::optional<Reach> time_at_error(const std::vector<Sample> &front, double error) {
  error = clamped(error);
  if (front.empty() || error < front.back().error) return std::nullopt;
  if (error > front.front().error) return Reach{front.front().time, true};
  const auto after = std::find_if(front.begin(), front.end(),
                                  [error](const Sample &sample) { return sample.error <= error; });
  if (after == front.begin()) return Reach{after->time, false};
  const Sample &a = *(after - 1), &b = *after;
  if (is_none(b.error)) return Reach{b.time, false};
  return Reach{between(error, a.error, a.time, b.error, b.time), false};
}

std::optional<Advantage> at_equal_time(const std::vector<Sample> &base,
                                       const std::vector<Sample> &other) {
  std::vector<double> times, ratios;
  for (const auto *front : {&base, &other}) {
    for (const Sample &sample : *front) times.push_back(sample.time);
  }
  std::sort(times.begin(), times.end());
  double from = 0, to = 0;
  for (const double time : times) {
    const auto a = error_at_time(base, time), b = error_at_time(other, time);
    if (!a || !b || is_none(*a) || is_none(*b)) continue;
    if (ratios.empty()) from = time;
    to = time;
    ratios.push_back(*a / *b);
  }
  if (ratios.empty()) return std::nullopt;
  std::sort(ratios.begin(), ratios.end());
  const size_t middle = ratios.size() / 2;
  const double median =
      ratios.size() % 2 == 1 ? ratios[middle] : std::sqrt(ratios[middle - 1] * ratios[middle]);
  return Advantage{ratios.front(), median, ratios.back(), from, to};
}

std::optional<TimeRatio> at_equal_error(const std::vector<Sample> &base, double longest_base_time,
                                        const std::vector<Sample> &other, double error) {
  using Bound = TimeRatio::Bound;
  const auto b = time_at_error(other, error);
  if (base.empty() || !b) return std::nullopt;
  const auto a = time_at_error(base, error);
  if (!a) return TimeRatio{longest_base_time / b->time, Bound::at_least};
  if (a->at_most && b->at_most) return std::nullopt;  // either could be cheaper still
  const Bound bound = a->at_most ? Bound::at_most : b->at_most ? Bound::at_least : Bound::exact;
  return TimeRatio{a->time / b->time, bound};
}

}  // namespace bench
