/* A scene with another number of particles: spacing, time step and steps that go with it. */
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "scene/fit.h"

namespace bench {
namespace {

uint32_t scaled_steps(uint32_t steps, double finer, uint32_t least) {
  const double scaled = std::round(steps * finer);
  if (scaled > std::numeric_limits<uint32_t>::max()) {
    throw Error(exit_usage,
                "--particles: the same simulated time would take more than 4294967295 steps");
  }
  return std::max(static_cast<uint32_t>(scaled), least);
}

uint32_t scaled_capacity(uint32_t capacity, double more) {
  const double scaled = std::ceil(capacity * more);
  return static_cast<uint32_t>(std::clamp(scaled, 1.0, double{PBF_MAX_CAPACITY}));
}

// A grid of distances follows the fluid's spacing, so that what is finer finds edges as sharp; it
// is never coarser than the scene has it, which may be as coarse as its solid stands. Distances
// that the scene gives have the grid that they have.
void refine_shape(SceneShape &shape, double finer) {
  if (shape.source.from != ShapeSource::From::grid) shape.source.cell /= std::max(finer, 1.0);
}

// The same shapes, filled more finely. Lengths of the discretisation and the time step shrink
// together (displacements in units of h stay), and the steps make up for it in simulated time.
// Emitters, drains and colliders are shapes: their openings, rates and lifetimes stay.
void refine(Scene &scene, double finer) {
  pbf_params &params = scene.params;
  params.smoothing_radius /= finer;
  params.spacing /= finer;
  params.particle_volume /= std::pow(finer, scene.dimension);
  params.search_cell_width /= finer;
  params.time_step /= finer;
  for (Block &block : scene.blocks) {
    if (block.shape == Block::Shape::lattice) {
      throw Error(exit_usage,
                  "--particles, --finer: scene " + scene.name +
                      " has a lattice of fixed counts; only boxes and balls are refined");
    }
    block.spacing /= finer;
  }
  for (SceneShape &shape : scene.shapes) refine_shape(shape, finer);
  if (scene.capacity > 0)
    scene.capacity = scaled_capacity(scene.capacity, std::pow(finer, scene.dimension));
  scene.steps = scaled_steps(scene.steps, finer, 1);
  scene.lead_in_steps = scaled_steps(scene.lead_in_steps, finer, 0);
}

// The same particles, more of them: the lattice grows, and the upper walls move away with it.
void grow(Scene &scene, double more) {
  if (scene.blocks.size() != 1 || scene.blocks[0].shape != Block::Shape::lattice) {
    throw Error(exit_usage, "--particles: scene " + scene.name +
                                " grows, which needs exactly one block, a lattice");
  }
  if (!scene.emitters.empty() || !scene.drains.empty() || !scene.reservoirs.empty()) {
    throw Error(exit_usage,
                "--particles: scene " + scene.name +
                    " grows, and its emitters, drains and reservoirs would stay where they are; "
                    "the rule \"refine\" keeps all places");
  }
  if (scene.capacity > 0) scene.capacity = scaled_capacity(scene.capacity, more);
  Block &block = scene.blocks[0];
  int axes = 0;
  for (unsigned axis = 0; axis < scene.dimension; ++axis) axes += scene.scaling->axes[axis];
  const double longer = std::pow(more, 1.0 / std::max(axes, 1));
  for (unsigned axis = 0; axis < scene.dimension; ++axis) {
    if (!scene.scaling->axes[axis]) continue;
    const uint32_t before = block.counts[axis];
    const double counts = std::clamp(std::round(before * longer), 1.0, double{PBF_MAX_CAPACITY});
    block.counts[axis] = static_cast<uint32_t>(counts);
    const double growth = (static_cast<double>(block.counts[axis]) - before) * block.spacing;
    scene.params.domain_max[axis] += scene.scaling->upper_walls[axis] * growth;
  }
}

}  // namespace

void scale_scene(Scene &scene, uint64_t particles) {
  if (!scene.scaling) {
    throw Error(exit_usage, "--particles: scene " + scene.name +
                                " has no \"scaling\", so its number of particles is fixed");
  }
  if (particles > PBF_MAX_CAPACITY) {
    throw Error(exit_usage, "--particles " + std::to_string(particles) + " is above " +
                                std::to_string(PBF_MAX_CAPACITY));
  }
  const uint64_t before = count_particles(scene);
  if (before == 0) {
    throw Error(exit_usage, "--particles: scene " + scene.name +
                                " holds no particles, so there is nothing to have more of");
  }
  const double more = static_cast<double>(particles) / static_cast<double>(before);
  if (scene.scaling->rule == Scaling::Rule::refine) {
    refine(scene, fitting_finer(scene, std::pow(more, 1.0 / scene.dimension), particles));
  } else {
    grow(scene, more);
  }
  const uint64_t after = count_particles(scene);
  if (after <= PBF_MAX_CAPACITY) return;
  throw Error(exit_usage, "--particles: scene " + scene.name + " would have more than the " +
                              std::to_string(PBF_MAX_CAPACITY) + " particles that fit");
}

void refine_scene(Scene &scene, double finer) {
  if (!scene.scaling || scene.scaling->rule != Scaling::Rule::refine) {
    throw Error(exit_usage,
                "--finer: scene " + scene.name +
                    " has no \"scaling\" with the rule \"refine\", so its spacing is fixed");
  }
  refine(scene, finer);
}

}  // namespace bench
