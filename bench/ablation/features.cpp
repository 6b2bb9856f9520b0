#include "ablation/features.h"

#include <algorithm>
#include <cmath>

namespace bench {
namespace {

constexpr double two_pi = 6.283185307179586;

bool walls_move(const pbf_params &params) {
  const auto moves = [](double value) { return value != 0; };
  return std::any_of(params.wall_velocity, params.wall_velocity + 6, moves) ||
         std::any_of(params.wall_amplitude, params.wall_amplitude + 6, moves);
}

double spacing_of(const pbf_params &params) {
  return params.spacing > 0 ? params.spacing : params.smoothing_radius / 2;
}

// A ball in the middle of the floor.
Collider ball(const Scene &scene) {
  Collider collider;
  pbf_collider_init(&collider.start, sizeof collider.start, PBF_COLLIDER_SPHERE);
  for (unsigned k = 0; k < scene.dimension; ++k)
    collider.start.position[k] = (scene.params.domain_min[k] + scene.params.domain_max[k]) / 2;
  collider.start.position[1] = scene.params.domain_min[1];
  collider.start.radius = 2 * spacing_of(scene.params);
  return collider;
}

double own_or(double own, double usual) { return own > 0 ? own : usual; }

// As pbf.h recommends.
double sleep_speed_for(const pbf_params &params) {
  const double *g = params.gravity;
  return 0.1 * std::sqrt(std::hypot(g[0], g[1], g[2]) * spacing_of(params));
}

struct Feature {
  const char *name;
  void (*put)(Variant &variant, const Scene &whole);
};

const Feature features[] = {
    {"scorr",
     [](Variant &v, const Scene &w) { v.scene.params.scorr_k = own_or(w.params.scorr_k, 0.01); }},
    {"vorticity",
     [](Variant &v, const Scene &w) {
       v.scene.params.vorticity = own_or(w.params.vorticity, 0.01);
     }},
    {"viscosity",
     [](Variant &v, const Scene &w) {
       v.scene.params.viscosity = own_or(w.params.viscosity, 0.01);
     }},
    {"colliders",
     [](Variant &v, const Scene &w) {
       v.scene.colliders = w.colliders;
       if (w.colliders.empty()) v.scene.colliders.push_back(ball(w));
     }},
    {"wall_density",
     [](Variant &v, const Scene &w) {
       v.scene.params.wall_density = own_or(w.params.wall_density, 1);
     }},
    {"chebyshev", [](Variant &v, const Scene &) { v.scene.params.solver = PBF_SOLVER_CHEBYSHEV; }},
    {"undamping",  // with the acceleration that it wants
     [](Variant &v, const Scene &w) {
       v.scene.params.solver = PBF_SOLVER_CHEBYSHEV;
       v.scene.params.undamping = own_or(w.params.undamping, 1);
     }},
    {"torque correction",  // likewise
     [](Variant &v, const Scene &w) {
       v.scene.params.solver = PBF_SOLVER_CHEBYSHEV;
       v.scene.params.torque_correction = own_or(w.params.torque_correction, 1);
     }},
    {"tolerance",
     [](Variant &v, const Scene &w) {
       v.scene.params.tolerance = own_or(w.params.tolerance, 1e-9);
     }},
    {"pressure grid",
     [](Variant &v, const Scene &w) {
       v.scene.params.pressure_grid = own_or(w.params.pressure_grid, 2);
     }},
    {"attraction",
     [](Variant &v, const Scene &w) {
       v.scene.params.attraction = own_or(w.params.attraction, 0.1);
     }},
    {"moving walls",
     [](Variant &v, const Scene &w) {
       pbf_params &p = v.scene.params;
       std::copy_n(w.params.wall_velocity, 6, p.wall_velocity);
       std::copy_n(w.params.wall_amplitude, 6, p.wall_amplitude);
       if (walls_move(w.params)) return;
       p.wall_amplitude[PBF_WALL_X_MAX] = spacing_of(p) / 2;
       p.wall_frequency[PBF_WALL_X_MAX] = two_pi;
     }},
    {"sleep",
     [](Variant &v, const Scene &w) {
       v.scene.params.sleep_speed = own_or(w.params.sleep_speed, sleep_speed_for(w.params));
       v.scene.params.sleep_time = own_or(w.params.sleep_time, 0.5);
     }},
    {"timing", [](Variant &v, const Scene &) { v.requests.timing = true; }},
    {"stats", [](Variant &v, const Scene &) { v.requests.stats = true; }},
};

}  // namespace

Variant minimal(const Scene &scene) {
  Variant bare{"minimal", scene, {}};
  pbf_params &p = bare.scene.params;
  p.scorr_k = p.vorticity = p.viscosity = p.wall_density = p.attraction = p.sleep_speed = 0;
  p.tolerance = p.pressure_grid = p.undamping = p.torque_correction = 0;
  p.solver = PBF_SOLVER_JACOBI;
  std::fill_n(p.wall_velocity, 6, 0.0);
  std::fill_n(p.wall_amplitude, 6, 0.0);
  bare.scene.colliders.clear();
  return bare;
}

std::vector<Variant> one_at_a_time(const Scene &scene) {
  std::vector<Variant> variants;
  Variant all = minimal(scene);
  for (const Feature &feature : features) {
    Variant one = minimal(scene);
    one.name = std::string("+ ") + feature.name;
    feature.put(one, scene);
    feature.put(all, scene);
    all.requests = {};
    variants.push_back(one);
  }
  all.name = "+ all in the solver";
  variants.push_back(all);
  return variants;
}

}  // namespace bench
