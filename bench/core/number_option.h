/* Numbers of a command line, for the programs beside pbf-bench, too. The ranges of CLI11 let NaN
 * in. */
#ifndef PBF_BENCH_NUMBER_OPTION_H
#define PBF_BENCH_NUMBER_OPTION_H

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <string>

namespace bench {

// Beyond that are no lengths, times or speeds of a scene.
constexpr double largest_number = 1e30;

template <typename Holds>
CLI::Validator number_that(Holds holds, const std::string &words) {
  return CLI::Validator(
      [holds, words](std::string &text) {
        char *end = nullptr;
        const double number = std::strtod(text.c_str(), &end);
        const bool is_number = end != text.c_str() && *end == 0;
        return is_number && holds(number) ? std::string() : text + " is not a number " + words;
      },
      "");
}

inline CLI::Validator above_zero() {
  return number_that([](double x) { return x > 0 && x < largest_number; },
                     "above 0 and below 1e30");
}

inline CLI::Validator at_least_zero() {
  return number_that([](double x) { return x >= 0 && x < largest_number; },
                     "of at least 0 and below 1e30");
}

inline CLI::Validator times_as_fine() {
  return number_that([](double x) { return x >= 0.01 && x <= 100; }, "of 0.01 to 100");
}

}  // namespace bench

#endif
