#include "simulation.h"

#include <algorithm>
#include <chrono>

#include "core/error.h"

namespace view {
namespace {

using bench::Error;

void check(pbf_status status) {
  if (status != PBF_OK) throw Error(bench::exit_failure, pbf_last_error());
}

uint32_t w_of(Coloring coloring) {
  switch (coloring) {
    case Coloring::pressure:
      return PBF_W_PRESSURE;
    case Coloring::density_error:
      return PBF_W_DENSITY;
    default:
      return PBF_W_SPEED;
  }
}

}  // namespace

const std::vector<const char *> &coloring_names() {
  static const std::vector<const char *> names = {"speed", "pressure", "density_error"};
  return names;
}

Simulation::Simulation(const bench::SceneOptions &scene, const bench::SolverOptions &solver)
    : scene_(bench::load_scene(scene)),
      options_(solver),
      params_(scene_.params),
      solver_(std::make_unique<bench::Solver>(scene_, options_)) {}

void Simulation::step(uint32_t steps) {
  if (steps == 0) return;
  const auto start = std::chrono::steady_clock::now();
  solver_->step(steps);
  solver_->synchronize();
  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
  milliseconds_ = took.count() / steps;
}

void Simulation::reset() {
  scene_.params = params_;
  solver_.reset();  // two at once may be more than the memory holds
  solver_ = std::make_unique<bench::Solver>(scene_, options_);
}

void Simulation::set_params(const pbf_params &params) {
  check(pbf_set_params(solver_->handle(), &params));
  params_ = params;
}

Reading Simulation::read(Coloring coloring) const {
  Reading reading;
  const pbf_info info = solver_->info();
  reading.dimension = scene_.dimension;
  reading.radius = static_cast<float>(
      0.5 * (params_.spacing > 0 ? params_.spacing : params_.smoothing_radius / 2));
  reading.particles.resize(solver_->count());
  pbf_read_desc read = {};
  read.struct_size = sizeof read;
  read.field = PBF_FIELD_POSITION;
  read.count = solver_->count();
  read.element_type = PBF_TYPE_FLOAT32;
  read.components = 4;
  read.w = w_of(coloring);
  read.order = PBF_ORDER_STORED;
  read.data = reading.particles.data();
  if (read.count > 0) check(pbf_read(solver_->handle(), &read));
  if (coloring == Coloring::density_error) {  // a free surface is no error
    for (auto &particle : reading.particles) particle[3] = std::max(particle[3] - 1, 0.0f);
  }
  reading.domain = bench::domain_at(params_, scene_.dimension, info.time);
  reading.colliders = bench::colliders_of(solver_->handle());
  reading.step = info.step;
  reading.time = info.time;
  reading.milliseconds = milliseconds_;
  reading.backend = info.backend;
  return reading;
}

}  // namespace view
