#include "stability/record.h"

#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>

#include "core/error.h"
#include "core/output_file.h"

namespace bench::stability {
namespace {

uint64_t resident_bytes() {
  std::ifstream file("/proc/self/statm");
  uint64_t pages = 0, resident = 0;
  file >> pages >> resident;
  return resident * static_cast<uint64_t>(sysconf(_SC_PAGESIZE));
}

uint64_t peak_bytes() {
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  return uint64_t{1024} * static_cast<uint64_t>(usage.ru_maxrss);
}

}  // namespace

Record::Record(std::string folder, const SolverOptions &options, bool quick)
    : folder_(std::move(folder)),
      options_(options),
      quick_(quick),
      facts_(nlohmann::json::object()),
      start_(std::chrono::steady_clock::now()) {
  std::error_code failed;
  std::filesystem::remove_all(folder_, failed);
  std::filesystem::create_directories(folder_, failed);
  if (failed) throw Error(exit_failure, folder_ + " can't be made: " + failed.message());
  facts_["backend"] = options_.backend;
  facts_["precision"] = options_.precision == PBF_FLOAT64 ? "f64" : "f32";
  facts_["quick"] = quick_;
}

void Record::note(const std::string &key, nlohmann::json value) { facts_[key] = std::move(value); }

void Record::append(const std::string &key, nlohmann::json value) {
  facts_[key].push_back(std::move(value));
}

pbf_status Record::call(const std::string &what, pbf_status status) {
  append("calls", {{"call", what},
                   {"status", pbf_status_string(status)},
                   {"sentence", status == PBF_OK ? "" : pbf_last_error()}});
  return status;
}

void Record::refusal(const std::string &what, pbf_status status, const std::string &names,
                     bool unchanged) {
  append("refusals", {{"call", what},
                      {"status", pbf_status_string(status)},
                      {"sentence", status == PBF_OK ? "" : pbf_last_error()},
                      {"names", names},
                      {"unchanged", unchanged}});
}

void Record::memory(const std::string &when) {
  append("memory", {{"when", when}, {"resident", resident_bytes()}});
}

void Record::finish() {
  const auto spent = std::chrono::steady_clock::now() - start_;
  facts_["seconds"] = std::chrono::duration<double>(spent).count();
  facts_["peak_bytes"] = peak_bytes();
  const std::string path = folder_ + "/facts.json";
  write_file(path, facts_.dump(1) + '\n');
}

}  // namespace bench::stability
