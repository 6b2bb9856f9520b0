#include <algorithm>
#include <cmath>
#include <cstdio>

#include "scene/fit.h"

namespace bench {
namespace {

// As much of a spacing as a lattice may be off a wall.
constexpr double fits_within = 0.05;

// Where a box's lattice ends off the upper wall at which the box ends.
struct Gap {
  unsigned axis = 0;
  double spacings = 0;  // below 0: behind the wall
};

Gap widest_gap(const Scene &scene) {
  Gap widest;
  for (const Block &block : scene.blocks) {
    if (block.shape != Block::Shape::box) continue;
    for (unsigned axis = 0; axis < scene.dimension; ++axis) {
      const double wall = scene.params.domain_max[axis], side = block.max[axis] - block.min[axis];
      if (std::fabs(block.max[axis] - wall) > 1e-6 * side) continue;
      const double cells = side / block.spacing, gap = cells - std::round(cells);
      if (std::fabs(gap) > std::fabs(widest.spacings)) widest = {axis, gap};
    }
  }
  return widest;
}

bool fits(const Scene &scene) { return std::fabs(widest_gap(scene).spacings) < fits_within; }

bool is_a_box(const Scene &scene) {
  return !scene.blocks.empty() && scene.blocks[0].shape == Block::Shape::box;
}

double cells_along(const Scene &scene) {
  const Block &block = scene.blocks[0];
  return (block.max[0] - block.min[0]) / block.spacing;
}

Scene made_finer(Scene scene, double finer) {
  for (Block &block : scene.blocks) block.spacing /= finer;
  return scene;
}

// Numbers of particles that fit, the nearest on either side: 0 where there is none up to eight
// times as coarse or fine.
struct Fitting {
  uint64_t fewer = 0, more = 0;
};

Fitting fitting_counts(const Scene &scene) {
  const double cells = cells_along(scene);
  Fitting found;
  const auto try_cells = [&](double n, uint64_t &count) {
    const Scene other = made_finer(scene, n / cells);
    if (fits(other)) count = count_particles(other);
  };
  for (double n = std::floor(cells); n >= std::max(1.0, cells / 8) && !found.fewer; --n)
    try_cells(n, found.fewer);
  for (double n = std::floor(cells) + 1; n <= 8 * cells && !found.more; ++n)
    try_cells(n, found.more);
  return found;
}

std::string advice(const Fitting &fitting) {
  const bool both = fitting.fewer && fitting.more;
  if (!fitting.fewer && !fitting.more) return "";
  return "; " + (fitting.fewer ? std::to_string(fitting.fewer) : "") + (both ? " and " : "") +
         (fitting.more ? std::to_string(fitting.more) : "") +
         (both ? " particles fit" : " particles would fit");
}

// How far a number of particles is from the one asked for: factors either way are as far.
double distance(uint64_t count, uint64_t asked) {
  return std::fabs(std::log(static_cast<double>(count) / static_cast<double>(asked)));
}

}  // namespace

double fitting_finer(const Scene &scene, double finer, uint64_t particles) {
  constexpr double about = 0.15;
  if (!is_a_box(scene) || fits(made_finer(scene, finer))) return finer;
  const double cells = cells_along(scene), wanted = finer * cells;
  double best = finer, nearest = about;
  for (double n = std::max(1.0, std::floor(0.8 * wanted)); n <= 1.25 * wanted; ++n) {
    const Scene other = made_finer(scene, n / cells);
    const double off = fits(other) ? distance(count_particles(other), particles) : about;
    if (off >= nearest) continue;
    nearest = off;
    best = n / cells;
  }
  return best;
}

std::string lattice_misfit(const Scene &scene) {
  const Gap gap = widest_gap(scene);
  if (std::fabs(gap.spacings) < fits_within || scene.blocks[0].shape != Block::Shape::box)
    return "";
  char text[160];
  std::snprintf(text, sizeof text,
                "scene %s: with %llu particles the lattice ends %.2f of a spacing %s the wall at "
                "%c = %g",
                scene.name.c_str(), static_cast<unsigned long long>(count_particles(scene)),
                std::fabs(gap.spacings), gap.spacings > 0 ? "short of" : "behind", "xyz"[gap.axis],
                scene.params.domain_max[gap.axis]);
  return text + advice(fitting_counts(scene));
}

void tell_of_misfit(const SceneOptions &options, const Scene &scene) {
  const std::string misfit =
      options.particles > 0 || options.finer != 1 ? lattice_misfit(scene) : "";
  if (!misfit.empty()) std::fprintf(stderr, "pbf-bench: %s\n", one_line(misfit).c_str());
}

}  // namespace bench
