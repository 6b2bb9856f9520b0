#include "speedup/contestant.h"

#include <algorithm>

#include "core/machine.h"

namespace bench {
namespace {

std::vector<unsigned> powers_of_two_up_to(unsigned cpus) {
  std::vector<unsigned> threads;
  for (unsigned n = 1; n < cpus; n *= 2) threads.push_back(n);
  threads.push_back(cpus);
  return threads;
}

}  // namespace

std::vector<Contestant> line_up(const LineUpOptions &options) {
  const std::vector<unsigned> threads =
      options.threads.empty() ? powers_of_two_up_to(this_machine().cpus) : options.threads;
  std::vector<Contestant> contestants;
  for (const std::string &name : options.backends) {
    Contestant contestant{
        name, {name, options.precision, 0, options.device}, 1, options.repetitions};
    if (name == "naive") {
      // The oracle in float32 does the report's own work, in its way.
      contestant.solver.backend = "reference";
      contestant.solver.precision = PBF_FLOAT32;
      contestant.repetitions = options.naive_repetitions;
    }
    if (name != "threads" && name != "openmp") {
      contestants.push_back(contestant);
      continue;
    }
    for (const unsigned n : threads) {
      contestant.solver.threads = contestant.threads = n;
      contestants.push_back(contestant);
    }
  }
  return contestants;
}

double median_ms(const Result &result) {
  std::vector<double> ms = result.milliseconds;
  std::sort(ms.begin(), ms.end());
  const size_t middle = ms.size() / 2;
  return ms.size() % 2 == 1 ? ms[middle] : (ms[middle - 1] + ms[middle]) / 2;
}

double min_ms(const Result &result) {
  return *std::min_element(result.milliseconds.begin(), result.milliseconds.end());
}

double max_ms(const Result &result) {
  return *std::max_element(result.milliseconds.begin(), result.milliseconds.end());
}

}  // namespace bench
