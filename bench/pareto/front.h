/* Which points nothing beats, and what lies between them. */
#ifndef PBF_BENCH_FRONT_H
#define PBF_BENCH_FRONT_H

#include <cstddef>
#include <optional>
#include <vector>

namespace bench {

struct Sample {
  double time;
  double error;
  size_t point;  // that it is of
};

// The samples that no other one is at least as good as in both: time rises, error falls.
std::vector<Sample> front_of(std::vector<Sample> samples);

// Errors below this count as this: logarithms need a number above 0, and float32 rounds here.
constexpr double least_error = 1e-8;

// Straight lines between a front's points on logarithmic axes.
// None before the first point; the last point's error after it.
std::optional<double> error_at_time(const std::vector<Sample> &front, double time);

// None when no point is that good. The first point's time when even that one is better: then a
// time not above this is enough, which `at_most` tells.
struct Reach {
  double time;
  bool at_most;
};
std::optional<Reach> time_at_error(const std::vector<Sample> &front, double error);

// Error of `base` over that of `other` at equal run time, at every time of either front at which
// both have something, and neither has no error at all.
struct Advantage {
  double least, median, most;
  double from, to;  // run times
};
std::optional<Advantage> at_equal_time(const std::vector<Sample> &base,
                                       const std::vector<Sample> &other);

// Time of `base` over that of `other` at equal error. A bound where one of them is only known to
// be too fast or too poor for the error: the base that never gets there has `longest_base_time`.
struct TimeRatio {
  enum class Bound { exact, at_least, at_most };
  double ratio;
  Bound bound;
};
std::optional<TimeRatio> at_equal_error(const std::vector<Sample> &base, double longest_base_time,
                                        const std::vector<Sample> &other, double error);

}  // namespace bench

#endif
