#include "core/checker.h"

#include <cstdlib>
#include <filesystem>

#include "core/resources.h"

namespace bench {

std::string checker_folder() { return data_folder("check", PBF_BENCH_SOURCE_CHECK); }

std::string python_program() {
  const char *wanted = std::getenv("PBF_PYTHON");
  if (wanted && *wanted) return wanted;
  std::error_code failed;
  return std::filesystem::exists(PBF_BENCH_PYTHON, failed) ? PBF_BENCH_PYTHON : "python3";
}

}  // namespace bench
