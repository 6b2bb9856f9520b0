/* Names that a misspelt one may have meant. */
#ifndef PBF_BENCH_NEAR_H
#define PBF_BENCH_NEAR_H

#include <string>
#include <vector>

namespace bench {

// " (did you mean a or b?)", or nothing when no known name is close.
std::string did_you_mean(const std::string &name, const std::vector<std::string> &known);

}  // namespace bench

#endif
