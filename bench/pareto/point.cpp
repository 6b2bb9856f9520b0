#include "pareto/point.h"

#include <algorithm>

namespace bench {

double simulated_time(const Point &point) {
  return point.scene.steps * point.scene.params.time_step;
}

double median_cost(const Point &point) {
  std::vector<double> seconds = point.outcome.seconds;
  std::sort(seconds.begin(), seconds.end());
  const size_t middle = seconds.size() / 2;
  const double median =
      seconds.size() % 2 == 1 ? seconds[middle] : (seconds[middle - 1] + seconds[middle]) / 2;
  return median / simulated_time(point);
}

double least_cost(const Point &point) {
  const std::vector<double> &seconds = point.outcome.seconds;
  return *std::min_element(seconds.begin(), seconds.end()) / simulated_time(point);
}

double most_cost(const Point &point) {
  const std::vector<double> &seconds = point.outcome.seconds;
  return *std::max_element(seconds.begin(), seconds.end()) / simulated_time(point);
}

}  // namespace bench
