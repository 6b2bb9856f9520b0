/* The particles of a scene: its blocks, as lattices. */
#include <cmath>

#include "scene/document.h"
#include "scene/scene.h"

namespace bench {
namespace {

using Counts = std::array<uint64_t, 3>;

// Any block is a lattice, of which a ball keeps the points within its radius, and `within` those
// that lie in all its regions.
struct Lattice {
  Vector first;
  Counts counts;
};

Lattice lattice_of(const Block &block, unsigned dimension) {
  Lattice lattice{block.first, {1, 1, 1}};
  for (unsigned axis = 0; axis < dimension; ++axis) {
    double low = 0, high = 0;
    if (block.shape == Block::Shape::lattice) {
      lattice.counts[axis] = block.counts[axis];
      continue;
    }
    if (block.shape == Block::Shape::box) {
      low = block.min[axis];
      high = block.max[axis];
    } else {
      // An even number of cells on either side of the middle.
      const double half = std::ceil(block.radius / block.spacing) * block.spacing;
      low = block.center[axis] - half;
      high = block.center[axis] + half;
    }
    // More than any solver holds in one row is as good as infinite, and fits an integer. The order
    // of the arguments makes 0 of what is not a number.
    const double cells =
        std::fmin(std::fmax(0.0, std::round((high - low) / block.spacing)), 4.0 * PBF_MAX_CAPACITY);
    lattice.counts[axis] = static_cast<uint64_t>(cells);
    lattice.first[axis] = low + block.spacing / 2;
  }
  return lattice;
}

Vector middle_of(const Lattice &lattice, double spacing) {
  Vector middle{};
  for (unsigned axis = 0; axis < 3; ++axis) {
    const auto cells = static_cast<double>(lattice.counts[axis]);
    middle[axis] = lattice.first[axis] + spacing * (cells - 1) / 2;
  }
  return middle;
}

bool inside_region(const Region &region, const Vector &x) {
  double sum = 0;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const double r = x[axis] - region.center[axis];
    sum += (region.squares[axis] * r + region.slopes[axis]) * r;
  }
  return sum < region.below;
}

bool inside_regions(const Block &block, const Vector &x) {
  for (const Region &region : block.within) {
    if (!inside_region(region, x)) return false;
  }
  return true;
}

bool inside_ball(const Block &block, const Vector &x) {
  double square = 0;
  for (unsigned axis = 0; axis < 3; ++axis) {
    square += (x[axis] - block.center[axis]) * (x[axis] - block.center[axis]);
  }
  return square < block.radius * block.radius;
}

Vector velocity_at(const Block &block, const Vector &x, const Vector &middle) {
  const Vector &w = block.angular_velocity;
  const Vector r{x[0] - middle[0], x[1] - middle[1], x[2] - middle[2]};
  Vector v{block.velocity[0] + w[1] * r[2] - w[2] * r[1],
           block.velocity[1] + w[2] * r[0] - w[0] * r[2],
           block.velocity[2] + w[0] * r[1] - w[1] * r[0]};
  for (unsigned axis = 0; axis < 3; ++axis) {
    const Vector &gradient = block.velocity_gradient[axis];
    v[axis] += gradient[0] * r[0] + gradient[1] * r[1] + gradient[2] * r[2];
  }
  return v;
}

Vector point_of(const Block &block, const Lattice &lattice, uint64_t i, uint64_t j, uint64_t k) {
  return {lattice.first[0] + block.spacing * static_cast<double>(i),
          lattice.first[1] + block.spacing * static_cast<double>(j),
          lattice.first[2] + block.spacing * static_cast<double>(k)};
}

// The points of one row that the shape holds, regions aside: without a gap, as a ball is convex.
// Found by halving from the row's middle, so that a ball of a thousand million points is counted in
// no time.
struct Row {
  uint64_t begin, end;
};

Row row_of(const Block &block, const Lattice &lattice, uint64_t j, uint64_t k) {
  const uint64_t length = lattice.counts[0];
  if (block.shape != Block::Shape::ball) return {0, length};
  const auto first_where = [&](uint64_t low, uint64_t high, bool wanted) {
    while (low < high) {
      const uint64_t middle = low + (high - low) / 2;
      if (inside_ball(block, point_of(block, lattice, middle, j, k)) == wanted) {
        high = middle;
      } else {
        low = middle + 1;
      }
    }
    return low;
  };
  return {first_where(0, length / 2, true), first_where(length / 2, length, false)};
}

template <typename Visit>
void for_each_row(const Block &block, const Lattice &lattice, Visit visit) {
  if (lattice.counts[0] == 0) return;  // of however many rows
  for (uint64_t k = 0; k < lattice.counts[2]; ++k) {
    for (uint64_t j = 0; j < lattice.counts[1]; ++j) visit(row_of(block, lattice, j, k), j, k);
  }
}

template <typename Visit>
void for_each_point(const Block &block, const Lattice &lattice, Visit visit) {
  for_each_row(block, lattice, [&](Row row, uint64_t j, uint64_t k) {
    for (uint64_t i = row.begin; i < row.end; ++i) {
      const Vector x = point_of(block, lattice, i, j, k);
      if (inside_regions(block, x)) visit(x);
    }
  });
}

// Of the shape, regions aside.
uint64_t count_points(const Block &block, const Lattice &lattice) {
  const double points = static_cast<double>(lattice.counts[0]) *
                        static_cast<double>(lattice.counts[1]) *
                        static_cast<double>(lattice.counts[2]);
  // Half of a ball's lattice belongs to it: one so large is refused without being counted.
  if (points > 4.0 * PBF_MAX_CAPACITY) return uint64_t{4} * PBF_MAX_CAPACITY;
  if (block.shape != Block::Shape::ball) return static_cast<uint64_t>(points);
  uint64_t count = 0;
  for_each_row(block, lattice, [&](Row row, uint64_t, uint64_t) { count += row.end - row.begin; });
  return count;
}

double spacing_in(const Scene &scene) {
  const pbf_params &params = scene.params;
  return params.spacing > 0 ? params.spacing : params.smoothing_radius / 2;
}

// Of particles in so much volume.
double particles_in(const Scene &scene, double volume) {
  return std::ceil(volume / std::pow(spacing_in(scene), scene.dimension));
}

// No more volume a time unit than its columns carry, of which a side has one at least.
double rate_of(const pbf_emitter &emitter, unsigned dimension, double spacing) {
  if (emitter.rate > 0) return emitter.rate;
  const double *v = emitter.velocity;
  const bool disc = emitter.shape == PBF_EMITTER_DISC;
  const double a = 2 * (disc ? emitter.radius : emitter.half_width) + spacing;
  const double b = 2 * (disc ? emitter.radius : emitter.half_height) + spacing;
  return dimension == 2 ? a * std::hypot(v[0], v[1]) : a * b * std::hypot(v[0], v[1], v[2]);
}

// By all emitters in all steps, and one more each where a step ends.
double emitted_by(const Scene &scene) {
  const double time =
      (static_cast<double>(scene.lead_in_steps) + scene.steps) * scene.params.time_step;
  double emitted = 0;
  for (const pbf_emitter &emitter : scene.emitters) {
    const double lasts = emitter.lifetime > 0 ? std::fmin(emitter.lifetime, time) : time;
    const double rate = rate_of(emitter, scene.dimension, spacing_in(scene));
    emitted += particles_in(scene, rate * lasts) + 1;
  }
  return emitted;
}

// A domain that is full, with a quarter more for what is squeezed and lies on its walls.
double held_by(const Scene &scene) {
  double volume = 1.25;
  for (unsigned axis = 0; axis < scene.dimension; ++axis)
    volume *= scene.params.domain_max[axis] - scene.params.domain_min[axis] + spacing_in(scene);
  return particles_in(scene, volume);
}

// What regions leave is counted point by point: `looked_at` adds up what that costs.
uint64_t count_block(const Block &block, unsigned dimension, uint64_t &looked_at) {
  const Lattice lattice = lattice_of(block, dimension);
  const uint64_t points = count_points(block, lattice);
  if (block.within.empty()) return points;
  looked_at += points * block.within.size();
  if (looked_at > PBF_MAX_CAPACITY) {
    throw ValueError{
        nlohmann::json::json_pointer("/blocks"),
        "the regions leave some of so many points that looking at them takes more than " +
            std::to_string(PBF_MAX_CAPACITY) + " tests"};
  }
  uint64_t count = 0;
  for_each_point(block, lattice, [&](const Vector &) { ++count; });
  return count;
}

}  // namespace

uint64_t count_particles(const Scene &scene) {
  uint64_t count = 0, looked_at = 0;
  for (const Block &block : scene.blocks) {
    count += count_block(block, scene.dimension, looked_at);
    if (count > PBF_MAX_CAPACITY) break;  // too many, however many more
  }
  return count;
}

uint32_t capacity_of(const Scene &scene) {
  if (scene.capacity > 0) return scene.capacity;
  const double most = PBF_MAX_CAPACITY, placed = static_cast<double>(count_particles(scene));
  const double held = held_by(scene);
  // A reservoir adds as many as there is room for.
  const double emitted = scene.reservoirs.empty() ? emitted_by(scene) : held;
  // As many as the domain holds, but never fewer than are placed.
  const double wanted = std::fmin(placed + emitted, std::fmax(placed, held));
  return static_cast<uint32_t>(std::fmin(std::fmax(wanted, 1), most));
}

Particles fill_scene(const Scene &scene) {
  Particles particles;
  for (const Block &block : scene.blocks) {
    const Lattice lattice = lattice_of(block, scene.dimension);
    const Vector middle = middle_of(lattice, block.spacing);
    for_each_point(block, lattice, [&](const Vector &x) {
      const Vector v = velocity_at(block, x, middle);
      particles.positions.insert(particles.positions.end(), x.data(), x.data() + scene.dimension);
      particles.velocities.insert(particles.velocities.end(), v.data(), v.data() + scene.dimension);
      if (!scene.phases.empty()) particles.phases.push_back(block.phase);
      ++particles.count;
    });
  }
  return particles;
}

}  // namespace bench
