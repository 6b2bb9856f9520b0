#include "core/manifest.h"

#include <nlohmann/json.hpp>

#include "core/output_file.h"

namespace bench {
namespace {

nlohmann::json list(const double *values, size_t count) {
  return std::vector<double>(values, values + count);
}

nlohmann::json walls_of(const pbf_params &params, unsigned dimension) {
  nlohmann::json walls = {
      {"velocity", list(params.wall_velocity, 2 * dimension)},
      {"amplitude", list(params.wall_amplitude, 2 * dimension)},
      {"frequency", list(params.wall_frequency, 2 * dimension)},
      {"phase", list(params.wall_phase, 2 * dimension)},
  };
  // Walls that contribute density keep particles half a spacing off: they begin where the domain
  // ends.
  if (params.wall_density > 0) walls["offset"] = 0;
  if (params.periodic == 0) return walls;
  // Along a periodic axis there are none: what lies behind a face, a judge takes for open.
  std::vector<bool> present;
  for (unsigned wall = 0; wall < 2 * dimension; ++wall)
    present.push_back((params.periodic >> wall / 2 & 1) == 0);
  walls["present"] = present;
  return walls;
}

// Rest densities, where there are several fluids.
nlohmann::json densities_of(const Scene &scene) {
  nlohmann::json densities = nlohmann::json::array();
  for (const pbf_phase &phase : scene.phases) densities.push_back(phase.rest_density);
  return densities;
}

}  // namespace

nlohmann::json manifest_of(const Scene &scene, const pbf_info &info) {
  const pbf_params &p = scene.params;
  const unsigned dimension = scene.dimension;
  nlohmann::json manifest = {
      {"scene", scene.name},
      {"backend", info.backend},
      {"build_id", info.build_id},
      {"precision", info.precision == PBF_FLOAT64 ? "f64" : "f32"},
      {"dimension", dimension},
      {"smoothing_radius", p.smoothing_radius},
      {"spacing", p.spacing},
      {"particle_volume", p.particle_volume},
      {"kernel", p.kernel == PBF_KERNEL_POLY6_SPIKY ? "poly6_spiky" : "wendland_c2"},
      {"gravity", list(p.gravity, dimension)},
      {"attraction", p.attraction},
      {"attraction_center", list(p.attraction_center, dimension)},
      {"domain_min", list(p.domain_min, dimension)},
      {"domain_max", list(p.domain_max, dimension)},
      {"time_step", p.time_step},
      {"iterations", p.iterations},
      {"walls", walls_of(p, dimension)},
  };
  if (!scene.phases.empty()) manifest["phases"] = densities_of(scene);
  return manifest;
}

void write_manifest(const std::string &path, const Scene &scene, const pbf_info &info) {
  write_file(path, manifest_of(scene, info).dump(2) + '\n');
}

}  // namespace bench
