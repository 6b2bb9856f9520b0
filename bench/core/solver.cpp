#include "core/solver.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "core/error.h"

namespace bench {
namespace {

ExitCode exit_code_of(pbf_status status) {
  switch (status) {
    case PBF_ERROR_UNAVAILABLE:
    case PBF_ERROR_NOT_FOUND:
    case PBF_ERROR_UNSUPPORTED:
      return exit_unavailable;
    case PBF_ERROR_INVALID_ARGUMENT:
      return exit_usage;
    default:
      return exit_failure;
  }
}

// Of "emitters[3].rate is …" in a scene with emitters that is /emitters/3/rate, and so on, as far
// as the file has it.
nlohmann::json::json_pointer named_by(const std::string &sentence, const char *key) {
  nlohmann::json::json_pointer pointer;
  pointer /= std::string(key);
  size_t at = sentence.find(key);
  if (at == std::string::npos) return pointer;
  at += std::strlen(key);
  if (sentence[at] == '[') {
    pointer /= static_cast<size_t>(std::strtoul(sentence.c_str() + at + 1, nullptr, 10));
    at = std::min(sentence.find(']', at), sentence.size() - 1) + 1;
  }
  if (sentence[at] != '.') return pointer;
  const size_t end = sentence.find_first_of(" [.,:;", at + 1);
  return pointer / sentence.substr(at + 1, end - at - 1);
}

}  // namespace

void check_call(pbf_status status) {
  if (status == PBF_OK) return;
  throw Error(exit_code_of(status),
              std::string(pbf_status_string(status)) + ": " + pbf_last_error());
}

void check_scene_call(const Scene &scene, const char *key, pbf_status status) {
  if (status == PBF_OK || !scene.document) return check_call(status);
  const std::string sentence = pbf_last_error();
  throw Error(exit_code_of(status), scene.document->place(named_by(sentence, key)) + ": " +
                                        pbf_status_string(status) + ": " + sentence);
}

pbf_desc desc_of(const SolverOptions &options, const Scene *scene) {
  pbf_desc desc;
  check_call(pbf_desc_init(&desc, sizeof desc));
  desc.backend = options.backend.c_str();
  desc.precision = options.precision;
  desc.threads = options.threads;
  desc.device = options.device;
  desc.determinism =
      options.is_per_machine ? PBF_DETERMINISM_PER_MACHINE : PBF_DETERMINISM_ACROSS_MACHINES;
  desc.strict = 1;
  if (scene) {
    desc.dimension = scene->dimension;
    desc.capacity = capacity_of(*scene);
  }
  return desc;
}

namespace {

// Whole steps, so that stretches that mirror each other bring a collider back to where it was. One
// beyond any run's end may end there, so that the sum of all is a number of steps, too.
uint64_t steps_of(const Stretch &stretch, double time_step) {
  const double steps = std::round(stretch.duration / time_step);
  return static_cast<uint64_t>(std::clamp(steps, 1.0, 0x1p34));
}

// The stretch that the step after `step` belongs to, and how many steps of it are left.
struct Turn {
  size_t stretch;
  uint64_t steps_left;
};

Turn turn_at(const std::vector<Stretch> &motion, double time_step, uint64_t step) {
  uint64_t period = 0;
  for (const Stretch &stretch : motion) period += steps_of(stretch, time_step);
  uint64_t into = step % period;
  size_t index = 0;
  while (into >= steps_of(motion[index], time_step)) into -= steps_of(motion[index++], time_step);
  return {index, steps_of(motion[index], time_step) - into};
}

}  // namespace

Solver::Solver(const Scene &scene, const SolverOptions &options)
    : colliders_(scene.colliders),
      shapes_(scene.shapes),
      dimension_(scene.dimension),
      precision_(options.precision),
      time_step_(scene.params.time_step) {
  const pbf_desc desc = desc_of(options, &scene);
  pbf_solver *solver = nullptr;
  check_scene_call(scene, "params", pbf_create(&desc, &scene.params, &solver));
  solver_.reset(solver);
  if (!scene.phases.empty())
    check_scene_call(
        scene, "phases",
        pbf_set_phases(solver, static_cast<uint32_t>(scene.phases.size()), scene.phases.data()));
  add(scene);
  set_objects(scene);
}

// What is none is not set: a solver without emitters, drains and reservoirs has no
// memory for them.
void Solver::set_objects(const Scene &scene) {
  std::vector<pbf_collider> start;
  for (const Collider &collider : colliders_) start.push_back(collider.start);
  const auto count = [](const auto &list) { return static_cast<uint32_t>(list.size()); };
  pbf_solver *solver = solver_.get();
  if (!start.empty())
    check_scene_call(scene, "colliders", pbf_set_colliders(solver, count(start), start.data()));
  if (!scene.emitters.empty())
    check_scene_call(scene, "emitters",
                     pbf_set_emitters(solver, count(scene.emitters), scene.emitters.data()));
  if (!scene.drains.empty())
    check_scene_call(scene, "drains",
                     pbf_set_drains(solver, count(scene.drains), scene.drains.data()));
  if (!scene.reservoirs.empty())
    check_scene_call(scene, "reservoirs",
                     pbf_set_reservoirs(solver, count(scene.reservoirs), scene.reservoirs.data()));
}

void Solver::add(const Scene &scene) {
  const Particles particles = fill_scene(scene);
  if (particles.count == 0) return;  // emitters bring them
  const Bytes positions = to_precision(particles.positions, precision_);
  const Bytes velocities = to_precision(particles.velocities, precision_);
  const auto count = static_cast<uint32_t>(particles.count);
  check_scene_call(
      scene, "blocks",
      pbf_add_particles(solver_.get(), count, positions.data(), velocities.data(), nullptr));
  if (!particles.phases.empty())
    check_scene_call(scene, "blocks",
                     pbf_set_particle_phases(solver_.get(), 0, count, particles.phases.data()));
}

void Solver::set_colliders(const std::vector<pbf_collider> &colliders) {
  check_call(
      pbf_set_colliders(solver_.get(), static_cast<uint32_t>(colliders.size()), colliders.data()));
}

uint32_t Solver::steps_to_next_turn() const {
  uint64_t steps = UINT32_MAX;
  for (const Collider &collider : colliders_) {
    if (collider.motion.size() < 2) continue;
    steps = std::min(steps, turn_at(collider.motion, time_step_, step_).steps_left);
  }
  return static_cast<uint32_t>(steps);
}

void Solver::turn_colliders() {
  std::vector<pbf_collider> now(colliders_.size());
  for (uint32_t i = 0; i < now.size(); ++i) {
    now[i] = collider(i);
    if (colliders_[i].motion.empty()) continue;
    const Turn turn = turn_at(colliders_[i].motion, time_step_, step_);
    const Stretch &stretch = colliders_[i].motion[turn.stretch];
    std::copy(stretch.velocity.begin(), stretch.velocity.end(), now[i].velocity);
    std::copy(stretch.angular_velocity.begin(), stretch.angular_velocity.end(),
              now[i].angular_velocity);
  }
  set_colliders(now);
}

void Solver::step(uint32_t steps) {
  while (steps > 0) {
    const uint32_t until_turn = steps_to_next_turn();
    const uint32_t now = std::min(steps, until_turn);
    check_call(pbf_step(solver_.get(), now));
    step_ += now;
    steps -= now;
    if (now == until_turn) turn_colliders();
  }
}

void Solver::synchronize() { check_call(pbf_synchronize(solver_.get())); }

pbf_info Solver::info() const {
  pbf_info info = {};
  info.struct_size = sizeof info;
  check_call(pbf_get_info(solver_.get(), &info));
  return info;
}

pbf_stats Solver::stats() const {
  pbf_stats stats = {};
  stats.struct_size = sizeof stats;
  check_call(pbf_get_stats(solver_.get(), &stats));
  return stats;
}

void Solver::set_timing(bool enabled) { check_call(pbf_set_timing(solver_.get(), enabled)); }

pbf_timings Solver::timings() const {
  pbf_timings timings = {};
  timings.struct_size = sizeof timings;
  check_call(pbf_get_timings(solver_.get(), &timings));
  return timings;
}

pbf_plan Solver::plan() const {
  pbf_plan plan = {};
  plan.struct_size = sizeof plan;
  check_call(pbf_get_plan(solver_.get(), &plan));
  return plan;
}

void Solver::place(const Bytes &positions, const Bytes &velocities) {
  check_call(pbf_set_positions(solver_.get(), 0, count(), positions.data()));
  check_call(pbf_set_velocities(solver_.get(), 0, count(), velocities.data()));
}

uint64_t Solver::hash() const {
  uint64_t hash = 0;
  check_call(pbf_hash(solver_.get(), &hash));
  return hash;
}

uint32_t Solver::count() const {
  uint32_t count = 0;
  check_call(pbf_get_count(solver_.get(), &count));
  return count;
}

pbf_collider Solver::collider(uint32_t index) const {
  pbf_collider collider = {};
  collider.struct_size = sizeof collider;
  check_call(pbf_get_collider(solver_.get(), index, &collider));
  return collider;
}

Bytes Solver::read(Getter getter) const {
  const uint32_t rows = count();
  Bytes bytes(size_t{rows} * dimension_ * precision_);
  check_call(getter(solver_.get(), 0, rows, bytes.data()));
  return bytes;
}

bool Solver::has_pressures() const {
  return pbf_get_pressures(solver_.get(), 0, 0, nullptr) == PBF_OK;
}

Bytes Solver::pressures() const {
  const uint32_t rows = count();
  Bytes bytes(size_t{rows} * precision_);
  check_call(pbf_get_pressures(solver_.get(), 0, rows, bytes.data()));
  return bytes;
}

Bytes Solver::save() const {
  uint64_t size = 0;
  check_call(pbf_save(solver_.get(), nullptr, &size));
  Bytes state(size);
  check_call(pbf_save(solver_.get(), state.data(), &size));
  return state;
}

void Solver::load(const Bytes &state) {
  check_call(pbf_load(solver_.get(), state.data(), state.size()));
  step_ = info().step;
}

std::vector<pbf_backend_info> list_backends(const SolverOptions &options, const Scene *scene) {
  const pbf_desc desc = desc_of(options, scene);
  uint32_t count = 0;
  check_call(pbf_get_backend_count(&count));
  std::vector<pbf_backend_info> backends(count);
  for (uint32_t i = 0; i < count; ++i) {
    backends[i].struct_size = sizeof backends[i];
    check_call(pbf_get_backend_info(&desc, i, &backends[i]));
  }
  return backends;
}

std::string reason_against(const SolverOptions &options, const Scene &scene) {
  for (const pbf_backend_info &backend : list_backends(options, &scene)) {
    if (options.backend == backend.name) return backend.available ? "" : backend.reason;
  }
  return "there is no backend of this name; `pbf-bench list` shows them";
}

void load_plugin(const std::string &path) { check_call(pbf_load_backend(path.c_str())); }

}  // namespace bench
