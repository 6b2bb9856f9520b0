/* pbf-forces: what the fluid does to solids, against what it must be. Prints a table, and fails
 * where a bar is missed.
 *
 *   pbf-forces [--spacing D] [CASE …]        buoyancy, dam-break, tow; without a name all */
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "cases.h"
#include "core/standard_streams.h"

namespace {

struct NamedCase {
  const char *name;
  int (*run)(double spacing);  // figures that miss their bars
  double spacing;              // its own
};

constexpr NamedCase cases[] = {
    {"buoyancy", run_buoyancy, 0.025}, {"dam-break", run_dam_break, 0.02}, {"tow", run_tow, 0.025}};

enum { exit_failure = 1, exit_usage = 2 };

int refuse(const char *what, const char *word) {
  std::fprintf(stderr,
               "pbf-forces: %s%s\nUsage: pbf-forces [--spacing D] [buoyancy] [dam-break] [tow]\n",
               what, word);
  return exit_usage;
}

// All of the word.
bool read_length(const char *word, double &length) {
  char *end = nullptr;
  length = std::strtod(word, &end);
  return end != word && *end == 0 && length > 0 && std::isfinite(length);
}

bool is_case(const char *name) {
  for (const NamedCase &one : cases)
    if (std::strcmp(one.name, name) == 0) return true;
  return false;
}

bool is_wanted(const char *name, int count, char **names) {
  for (int i = 0; i < count; ++i)
    if (std::strcmp(names[i], name) == 0) return true;
  return count == 0;
}

int run_cases(double spacing, int count, char **names) {
  int missed = 0;
  std::printf(
      "| case | figure | is | must be | error | bar |\n| --- | --- | --: | --: | --: | --- |\n");
  for (const NamedCase &one : cases)
    if (is_wanted(one.name, count, names)) missed += one.run(spacing > 0 ? spacing : one.spacing);
  return missed ? exit_failure : 0;
}

}  // namespace

int main(int argc, char **argv) {
  bench::prepare_standard_streams();
  double spacing = 0;
  int first = 1;
  if (argc > 1 && std::strcmp(argv[1], "--spacing") == 0) {
    if (argc == 2) return refuse("--spacing has no length", "");
    if (!read_length(argv[2], spacing)) return refuse("--spacing is no length above 0: ", argv[2]);
    first = 3;
  }
  for (int i = first; i < argc; ++i)
    if (!is_case(argv[i])) return refuse("there is no case ", argv[i]);
  const int code = run_cases(spacing, argc - first, argv + first);
  return bench::exit_after_output(code, exit_failure, "pbf-forces");
}
