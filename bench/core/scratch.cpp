#include "core/scratch.h"

#include <stdlib.h>

#include <filesystem>

#include "core/error.h"

namespace bench {

namespace fs = std::filesystem;

Scratch::Scratch(const std::string &purpose) {
  const std::string letters = "XXXXXX";  // mkdtemp's to fill in
  path_ = fs::temp_directory_path() / ("pbf-" + purpose + "-" + letters);
  if (!mkdtemp(path_.data())) throw Error(exit_failure, path_ + " can't be made");
}

Scratch::~Scratch() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

}  // namespace bench
