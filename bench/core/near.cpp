#include "core/near.h"

#include <algorithm>
#include <numeric>

namespace bench {
namespace {

// Levenshtein distance.
size_t edit_distance(const std::string &a, const std::string &b) {
  std::vector<size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), size_t{0});
  for (size_t i = 1; i <= a.size(); ++i) {
    size_t diagonal = row[0];
    row[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      const size_t substituted = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row[b.size()];
}

bool is_near(const std::string &name, const std::string &known) {
  if (name.size() >= 4 && known.find(name) != std::string::npos) return true;
  return edit_distance(name, known) <= std::max<size_t>(1, known.size() / 3);
}

}  // namespace

std::string did_you_mean(const std::string &name, const std::vector<std::string> &known) {
  std::string text;
  if (name.size() > 64) return text;
  for (const std::string &candidate : known) {
    if (is_near(name, candidate)) text += (text.empty() ? "" : " or ") + candidate;
  }
  return text.empty() ? text : " (did you mean " + text + "?)";
}

}  // namespace bench
