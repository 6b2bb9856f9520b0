#include "core/dump.h"

#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/manifest.h"
#include "core/npy.h"

namespace bench {

namespace {

// "positions_000120.npy" and its like, the names that write gives.
bool is_frame(const std::string &name) {
  const size_t bar = name.find('_');
  const size_t dot = name.find('.');
  if (bar == std::string::npos || dot == std::string::npos || dot <= bar + 1) return false;
  const std::string field = name.substr(0, bar);
  return (field == "positions" || field == "velocities" || field == "pressures" ||
          field == "lambdas") &&
         name.substr(dot) == ".npy" && name.find_first_not_of("0123456789", bar + 1) == dot;
}

// pbf-check would take frames that another run left in the folder for this one's.
void remove_frames(const std::filesystem::path &folder) {
  if (!std::filesystem::exists(folder / "dump.json")) return;
  std::vector<std::filesystem::path> frames;
  for (const auto &entry : std::filesystem::directory_iterator(folder))
    if (is_frame(entry.path().filename().string())) frames.push_back(entry.path());
  for (const auto &path : frames) std::filesystem::remove(path);
}

}  // namespace

Dump::Dump(const std::string &folder, uint64_t every, const Scene &scene, const pbf_info &info)
    : folder_(folder), every_(every) {
  if (folder_.empty()) return;
  std::error_code failed;
  std::filesystem::create_directories(folder_, failed);
  if (failed) throw Error(exit_failure, folder_ + " can't be made: " + failed.message());
  remove_frames(folder_);
  write_manifest(folder_ + "/dump.json", scene, info);
}

uint64_t Dump::steps_to_next(uint64_t step) const {
  return folder_.empty() || every_ == 0 ? UINT64_MAX : every_ - step % every_;
}

bool Dump::due(uint64_t step) const { return !folder_.empty() && every_ > 0 && step % every_ == 0; }

void Dump::write(const Solver &solver) {
  if (folder_.empty()) return;
  const pbf_info info = solver.info();
  if (written_ && info.step == last_step_) return;
  char name[32];
  std::snprintf(name, sizeof name, "%06llu.npy", static_cast<unsigned long long>(info.step));
  const uint32_t count = solver.count();
  const Bytes positions = solver.positions();
  const Bytes velocities = solver.velocities();
  write_npy(folder_ + "/positions_" + name, positions.data(), count, info.dimension,
            info.precision);
  write_npy(folder_ + "/velocities_" + name, velocities.data(), count, info.dimension,
            info.precision);
  // Before the first step there is none.
  if (info.step > 0 && solver.has_pressures()) {
    const Bytes pressures = solver.pressures();
    write_npy(folder_ + "/pressures_" + name, pressures.data(), count, 0, info.precision);
  }
  written_ = true;
  last_step_ = info.step;
}

}  // namespace bench
