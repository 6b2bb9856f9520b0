#include "report/portrait.h"

#include <pbf/diffuse.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/error.h"
#include "core/surroundings.h"
#include "report/picture.h"

namespace bench {
namespace {

void check(pbf_status status) {
  if (status != PBF_OK) throw Error(exit_failure, pbf_last_error());
}

std::vector<double> numbers(pbf_solver *solver, uint32_t field, uint32_t count,
                            unsigned dimension) {
  std::vector<double> all(static_cast<size_t>(count) * dimension);
  pbf_read_desc read = {};
  read.struct_size = sizeof read;
  read.field = field;
  read.count = count;
  read.element_type = PBF_TYPE_FLOAT64;
  read.data = all.data();
  if (count > 0) check(pbf_read(solver, &read));
  return all;
}

std::vector<Vector> diffuse_of(pbf_solver *solver) {
  pbf_diffuse_info info = {};
  info.struct_size = sizeof info;
  check(pbf_get_diffuse_info(solver, &info));
  std::vector<Vector> all(info.count);
  pbf_diffuse_read read = {};
  read.struct_size = sizeof read;
  read.count = info.count;
  read.element_type = PBF_TYPE_FLOAT64;
  read.components = 3;
  read.positions = all.data();
  if (info.count > 0) check(pbf_read_diffuse(solver, &read));
  return all;
}

// Lower corner, upper corner.
void show(const std::vector<double> &part, unsigned dimension, View &view) {
  if (part.size() != 2 * dimension)
    throw Error(exit_usage, "--view has " + std::to_string(part.size()) + " numbers; it takes " +
                                std::to_string(2 * dimension) + " in " + std::to_string(dimension) +
                                "D");
  for (unsigned k = 0; k < dimension; ++k) {
    view.lower[k] = part[k];
    view.upper[k] = part[dimension + k];
    if (!(view.lower[k] < view.upper[k]) || !std::isfinite(view.upper[k] - view.lower[k]))
      throw Error(exit_usage, std::string("--view: along ") + "xyz"[k] +
                                  " the lower corner is not below the upper one");
  }
}

double fast(std::vector<double> speeds) {
  if (speeds.empty()) return 1;
  const auto at =
      speeds.begin() + static_cast<std::ptrdiff_t>(0.995 * static_cast<double>(speeds.size() - 1));
  std::nth_element(speeds.begin(), at, speeds.end());
  return std::max(*at, 1e-6);
}

struct Destroy {
  void operator()(pbf_solver *solver) const { pbf_destroy(solver); }
};
using Handle = std::unique_ptr<pbf_solver, Destroy>;

// A state says its dimension and precision to pbf_load alone: the solver that takes it has them.
// Not every build has all four. That other solvers refuse it says nothing of the state.
Handle solver_of(const std::string &state) {
  std::string reason;
  for (const uint32_t precision : {PBF_FLOAT32, PBF_FLOAT64}) {
    for (const uint32_t dimension : {3u, 2u}) {
      pbf_desc desc;
      check(pbf_desc_init(&desc, sizeof desc));
      desc.dimension = dimension;
      desc.precision = precision;
      desc.capacity = static_cast<uint32_t>(std::clamp<uint64_t>(
          state.size() / (uint64_t{2} * dimension * precision), 1, PBF_MAX_CAPACITY));
      pbf_solver *solver = nullptr;
      if (pbf_create(&desc, nullptr, &solver) != PBF_OK) continue;
      Handle handle(solver);
      if (pbf_load(solver, state.data(), state.size()) == PBF_OK) return handle;
      const std::string refusal = pbf_last_error();
      if (reason.empty() || refusal.find("; this solver is ") == std::string::npos)
        reason = refusal;
    }
  }
  throw Error(exit_failure, reason.empty() ? pbf_last_error() : reason);
}

}  // namespace

std::string draw_solver(pbf_solver *solver, const Portrait &portrait) {
  pbf_info info = {};
  info.struct_size = sizeof info;
  check(pbf_get_info(solver, &info));
  pbf_params params = {};
  params.struct_size = sizeof params;
  check(pbf_get_params(solver, &params));
  uint32_t count = 0;
  check(pbf_get_count(solver, &count));
  Frame frame =
      particles_of(numbers(solver, PBF_FIELD_POSITION, count, info.dimension),
                   numbers(solver, PBF_FIELD_VELOCITY, count, info.dimension), info.dimension);
  frame.colliders = colliders_of(solver);
  frame.diffuse = diffuse_of(solver);
  View view;
  view.width = portrait.width;
  view.particle_radius = 0.5 * (params.spacing > 0 ? params.spacing : params.smoothing_radius / 2);
  view.fastest = portrait.fastest > 0 ? portrait.fastest : fast(frame.speeds);
  const Box domain = domain_at(params, info.dimension, info.time);
  view.lower = domain.lower;
  view.upper = domain.upper;
  if (!portrait.view.empty()) show(portrait.view, info.dimension, view);
  return draw_png(frame, view);
}

std::string draw_state(const std::string &state, const Portrait &portrait) {
  return draw_solver(solver_of(state).get(), portrait);
}

}  // namespace bench
