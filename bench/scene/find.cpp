#include "scene/find.h"

#include <algorithm>
#include <filesystem>

#include "core/error.h"
#include "core/near.h"
#include "core/resources.h"
#include "scene/scene.h"

namespace bench {
namespace {

namespace fs = std::filesystem;

fs::path scene_folder() { return data_folder("scenes", PBF_BENCH_SOURCE_SCENES); }

bool is_path(const std::string &name) {
  return name.find('/') != std::string::npos || fs::path(name).extension() == ".json";
}

}  // namespace

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  std::error_code failed;
  for (const auto &entry : fs::directory_iterator(scene_folder(), failed)) {
    const fs::path file = entry.path().filename();
    if (file.extension() == ".json" && file.stem().extension() != ".schema") {
      names.push_back(file.stem().string());
    }
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::string find_scene_file(const std::string &name) {
  if (is_path(name)) return name;
  const std::vector<std::string> known = scene_names();
  if (std::find(known.begin(), known.end(), name) == known.end()) {
    throw Error(exit_usage, "there is no scene \"" + name + "\" in " + scene_folder().string() +
                                did_you_mean(name, known) + "; `pbf-bench list` shows them");
  }
  return (scene_folder() / (name + ".json")).string();
}

}  // namespace bench
