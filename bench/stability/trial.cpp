#include "stability/trial.h"

#include <algorithm>
#include <filesystem>

#include "core/error.h"
#include "core/manifest.h"
#include "core/npy.h"
#include "core/output_file.h"
#include "report/picture.h"
#include "scene/params.h"

namespace bench::stability {
namespace {

View view_of(const Scene &scene, const Frame &frame) {
  View view;
  const pbf_params &params = scene.params;
  view.particle_radius = 0.5 * (params.spacing > 0 ? params.spacing : params.smoothing_radius / 2);
  for (unsigned axis = 0; axis < scene.dimension; ++axis) {
    view.lower[axis] = params.domain_min[axis];
    view.upper[axis] = params.domain_max[axis];
  }
  view.fastest = 1e-9;
  for (const double speed : frame.speeds) view.fastest = std::max(view.fastest, speed);
  view.width = 480;
  return view;
}

}  // namespace

void must(pbf_status status) {
  if (status == PBF_OK) return;
  throw Error(status == PBF_ERROR_UNAVAILABLE ? exit_unavailable : exit_failure,
              std::string(pbf_status_string(status)) + ": " + pbf_last_error());
}

namespace {

pbf_params &kept_params() {
  static pbf_params params = [] {
    pbf_params fresh;
    must(pbf_params_init(&fresh, sizeof fresh));
    return fresh;
  }();
  return params;
}

}  // namespace

void set_default_params(const std::vector<std::string> &settings) {
  Document scene("--set", R"({"dimension": 3, "params": {}})");
  for (const std::string &setting : settings) apply_setting(setting, scene);
  try {
    read_params(scene.value["params"], nlohmann::json::json_pointer("/params"), 3, kept_params());
  } catch (const ValueError &error) {
    throw scene.error(error);
  }
}

pbf_params default_params() { return kept_params(); }

pbf_desc desc_for(const Record &record, unsigned dimension, uint32_t capacity, uint32_t threads) {
  pbf_desc desc;
  must(pbf_desc_init(&desc, sizeof desc));
  desc.backend = record.options().backend.c_str();
  desc.precision = record.options().precision;
  desc.device = record.options().device;
  desc.strict = 1;
  desc.dimension = dimension;
  desc.capacity = capacity;
  desc.threads = threads;
  return desc;
}

Trial::Trial(Record &record, const std::string &label, const Start &start) : record_(record) {
  const auto count = static_cast<uint32_t>(start.particles.count);
  const uint32_t capacity = start.capacity > 0 ? start.capacity : std::max(count, 1u);
  const pbf_desc desc = desc_for(record, start.dimension, capacity, start.threads);
  scene_.dimension = start.dimension;
  scene_.params = start.params;
  pbf_solver *solver = nullptr;
  must(pbf_create(&desc, &start.params, &solver));
  solver_.reset(solver);
  const pbf_info made = info();
  record_.note("device", made.device_name);
  record_.note("build_id", made.build_id);
  if (!start.colliders.empty()) {
    must(pbf_set_colliders(solver, static_cast<uint32_t>(start.colliders.size()),
                           start.colliders.data()));
  }
  if (count > 0) {
    const Bytes x = scalars(start.particles.positions);
    const Bytes v = scalars(start.particles.velocities);
    must(pbf_add_particles(solver, count, x.data(), v.data(), nullptr));
  }
  begin(label);
}

void Trial::begin(const std::string &label) {
  label_ = label;
  times_.clear();
  scene_.name = label;
  std::error_code failed;
  std::filesystem::create_directories(record_.folder() + "/" + label, failed);
  if (failed) throw Error(exit_failure, label + " can't be made: " + failed.message());
  record_.append("trials", label);
  frame();
}

uint32_t Trial::count() const {
  uint32_t count = 0;
  must(pbf_get_count(solver(), &count));
  return count;
}

uint64_t Trial::hash() const {
  uint64_t hash = 0;
  must(pbf_hash(solver(), &hash));
  return hash;
}

pbf_info Trial::info() const {
  pbf_info info = {};
  info.struct_size = sizeof info;
  must(pbf_get_info(solver(), &info));
  return info;
}

pbf_stats Trial::stats() const {
  pbf_stats stats = {};
  stats.struct_size = sizeof stats;
  must(pbf_get_stats(solver(), &stats));
  return stats;
}

void Trial::step(uint32_t steps) {
  must(pbf_step(solver(), steps));
  must(pbf_synchronize(solver()));
}

void Trial::run(uint32_t steps, uint32_t frames) {
  uint32_t done = 0;
  for (uint32_t k = 1; k <= frames; ++k) {
    const auto until = static_cast<uint32_t>(uint64_t{steps} * k / frames);
    if (until == done) continue;
    step(until - done);
    done = until;
    frame();
  }
}

Bytes Trial::scalars(const std::vector<double> &values) const {
  return to_precision(values, record_.options().precision);
}

Bytes Trial::read(pbf_status (*getter)(pbf_solver *, uint32_t, uint32_t, void *),
                  uint32_t columns) const {
  const uint32_t rows = count();
  Bytes bytes(size_t{rows} * columns * record_.options().precision);
  must(getter(solver(), 0, rows, bytes.data()));
  return bytes;
}

Bytes Trial::positions() const { return read(pbf_get_positions, scene_.dimension); }
Bytes Trial::velocities() const { return read(pbf_get_velocities, scene_.dimension); }

void Trial::write_rows(const char *what, const Bytes &bytes, uint32_t columns) const {
  char name[48];
  const auto step = static_cast<unsigned long long>(info().step);
  std::snprintf(name, sizeof name, "/%s_%06llu.npy", what, step);
  write_npy(record_.folder() + "/" + label_ + name, bytes.data(), count(), columns,
            record_.options().precision);
}

void Trial::frame() {
  write_rows("positions", positions(), scene_.dimension);
  write_rows("velocities", velocities(), scene_.dimension);
  const pbf_info now = info();
  times_[now.step] = now.time;
  nlohmann::json manifest = manifest_of(scene_, now);
  for (const auto &[step, time] : times_) manifest["times"][std::to_string(step)] = time;
  write_file(record_.folder() + "/" + label_ + "/dump.json", manifest.dump(1) + '\n');
}

void Trial::densities() { write_rows("densities", read(pbf_get_densities, 1), 0); }

void Trial::change(const pbf_params &params, const std::string &label) {
  must(pbf_set_params(solver(), &params));
  scene_.params = params;
  begin(label);
}

void Trial::draw(const std::string &caption) {
  const uint32_t precision = record_.options().precision;
  const Frame frame = particles_of(from_precision(positions(), precision),
                                   from_precision(velocities(), precision), scene_.dimension);
  const std::string name = label_ + ".png";
  write_file(record_.folder() + "/" + name, draw_png(frame, view_of(scene_, frame)));
  record_.append("pictures", {{"file", name}, {"caption", caption}});
}

}  // namespace bench::stability
