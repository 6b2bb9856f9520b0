/* The figures of a study in words, for the terminal and the page. */
#ifndef PBF_BENCH_WORDS_H
#define PBF_BENCH_WORDS_H

#include "pareto/analysis.h"

namespace bench {

std::string error_text(double error);  // "0.12 %"
std::string cost_text(double seconds_per_simulated);
std::string ratio_text(double ratio);  // "12 ×"
std::string reach_text(const std::optional<Reach> &reach);
std::string time_ratio_text(const std::optional<TimeRatio> &ratio);
std::string advantage_text(const std::optional<Advantage> &advantage);  // "12 × (3.4 – 30)"

// "At equal run time …", about the first error.
std::string headline(const Study &study);

// For the terminal: every family under every error.
std::string study_table(const Study &study);

}  // namespace bench

#endif
