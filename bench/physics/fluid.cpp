#include "physics/fluid.h"

#include <algorithm>
#include <cmath>

namespace bench::physics {

Fluid::Fluid(Run &run, const Scene &scene)
    : dimension(scene.dimension),
      params(scene.params),
      precision_(run.solver().precision),
      solver_(scene, run.solver()) {
  look();
  run.took(count());
}

void Fluid::look() {
  x = from_precision(solver_.positions(), precision_);
  v = from_precision(solver_.velocities(), precision_);
}

void Fluid::put() { solver_.place(to_precision(x, precision_), to_precision(v, precision_)); }

void Fluid::shake(double spacings, uint32_t start) {
  uint32_t random = start;
  for (size_t i = 0; i < x.size(); ++i, random = random * 1664525u + 1013904223u) {
    const unsigned axis = static_cast<unsigned>(i % dimension);
    const double way = params.spacing * spacings * ((random >> 8) / 16777216.0 - 0.5);
    x[i] = std::clamp(x[i] + way, params.domain_min[axis], params.domain_max[axis]);
  }
  put();
}

void Fluid::set_params() { check_call(pbf_set_params(handle(), &params)); }

std::vector<double> Fluid::pressures() const {
  return from_precision(solver_.pressures(), precision_);
}

std::vector<uint32_t> Fluid::phases() const {
  std::vector<uint32_t> phases(count());
  check_call(pbf_get_particle_phases(handle(), 0, count(), phases.data()));
  return phases;
}

std::vector<pbf_collider_load> Fluid::wall_loads() const {
  std::vector<pbf_collider_load> loads(2 * size_t{dimension});
  for (pbf_collider_load &load : loads) load.struct_size = sizeof load;
  check_call(pbf_get_wall_loads(handle(), 2 * dimension, loads.data()));
  return loads;
}

pbf_collider_load Fluid::collider_load(uint32_t index) const {
  std::vector<pbf_collider_load> loads(size_t{index} + 1);
  for (pbf_collider_load &load : loads) load.struct_size = sizeof load;
  check_call(pbf_get_collider_loads(handle(), index + 1, loads.data()));
  return loads[index];
}

pbf_in_out Fluid::in_out() const {
  pbf_in_out in_out = {};
  in_out.struct_size = sizeof in_out;
  check_call(pbf_get_in_out(handle(), &in_out));
  return in_out;
}

double Fluid::given_by(uint32_t reservoir) const {
  pbf_reservoir r = {};
  r.struct_size = sizeof r;
  check_call(pbf_get_reservoir(handle(), reservoir, &r));
  return (static_cast<double>(r.added) - static_cast<double>(r.removed)) * particle_volume();
}

double Fluid::mean_level(const std::vector<double> &points) const {
  const auto count = static_cast<uint32_t>(points.size() / dimension);
  std::vector<double> levels(count);
  double sum = 0;
  check_call(pbf_get_levels(handle(), count, points.data(), levels.data()));
  for (double level : levels) sum += level / count;
  return sum;
}

double Fluid::particle_volume() const { return std::pow(params.spacing, dimension); }

}  // namespace bench::physics
