#include "core/surroundings.h"

#include <cmath>

#include "core/error.h"

namespace bench {
namespace {

void must(pbf_status status) {
  if (status != PBF_OK) throw Error(exit_failure, pbf_last_error());
}

double wall_at(const pbf_params &params, unsigned wall, double time) {
  const double bound = wall % 2 ? params.domain_max[wall / 2] : params.domain_min[wall / 2];
  return bound + params.wall_velocity[wall] * time +
         params.wall_amplitude[wall] *
             std::sin(params.wall_frequency[wall] * time + params.wall_phase[wall]);
}

}  // namespace

Box domain_at(const pbf_params &params, unsigned dimension, double time) {
  Box box;
  for (unsigned axis = 0; axis < dimension; ++axis) {
    box.lower[axis] = wall_at(params, 2 * axis, time);
    box.upper[axis] = wall_at(params, 2 * axis + 1, time);
  }
  return box;
}

std::vector<pbf_collider> colliders_of(pbf_solver *solver) {
  uint32_t count = 0;
  must(pbf_get_collider_count(solver, &count));
  std::vector<pbf_collider> colliders(count);
  for (uint32_t i = 0; i < count; ++i) {
    colliders[i].struct_size = sizeof colliders[i];
    must(pbf_get_collider(solver, i, &colliders[i]));
  }
  return colliders;
}

}  // namespace bench
