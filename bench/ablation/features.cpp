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

// As pbf/params.h recommends.
double sleep_speed_for(const pbf_params &params) {
  const double *g = params.gravity;
  return 0.1 * std::sqrt(std::hypot(g[0], g[1], g[2]) * spacing_of(params));
}

// An optional parameter, by params.def: 0 turns it off.
struct Optional {
  const char *name;
  double pbf_params::*value;
  double usual;
  uint32_t min_solver;
};

const std::vector<Optional> &optional_params() {
  static const std::vector<Optional> params = [] {
    std::vector<Optional> found;
#define PBF_PARAM_REAL(offset, name, initial, range, when, min_solver, low, high, usual, feature, \
                       projected, unit, doc)                                                      \
  if (usual != 0) found.push_back({#name, &pbf_params::name, usual, PBF_SOLVER_##min_solver});
#include "physics/params.def"
    return found;
  }();
  return params;
}

// With what it needs of others.
void put(const Optional &param, pbf_params &params, const pbf_params &whole) {
  params.*param.value = own_or(whole.*param.value, param.usual);
  params.solver = std::max(params.solver, param.min_solver);
  if (param.value != &pbf_params::sleep_speed) return;
  params.sleep_speed = own_or(whole.sleep_speed, sleep_speed_for(whole));
  params.sleep_time = own_or(whole.sleep_time, 0.5);
}

// What is no number of its own.
struct Feature {
  const char *name;
  void (*put)(Variant &variant, const Scene &whole);
};

const Feature others[] = {
    {"colliders",
     [](Variant &v, const Scene &w) {
       v.scene.colliders = w.colliders;
       if (w.colliders.empty()) v.scene.colliders.push_back(ball(w));
     }},
    {"chebyshev", [](Variant &v, const Scene &) { v.scene.params.solver = PBF_SOLVER_CHEBYSHEV; }},
    {"moving walls",
     [](Variant &v, const Scene &w) {
       pbf_params &p = v.scene.params;
       std::copy_n(w.params.wall_velocity, 6, p.wall_velocity);
       std::copy_n(w.params.wall_amplitude, 6, p.wall_amplitude);
       if (walls_move(w.params)) return;
       p.wall_amplitude[PBF_WALL_X_MAX] = spacing_of(p) / 2;
       p.wall_frequency[PBF_WALL_X_MAX] = two_pi;
     }},
    {"loads", [](Variant &v, const Scene &) { v.scene.params.loads = 1; }},
    {"timing", [](Variant &v, const Scene &) { v.requests.timing = true; }},
    {"stats", [](Variant &v, const Scene &) { v.requests.stats = true; }},
};

}  // namespace

Variant minimal(const Scene &scene) {
  Variant bare{"minimal", scene, {}};
  pbf_params &p = bare.scene.params;
  for (const Optional &param : optional_params()) p.*param.value = 0;
  p.solver = PBF_SOLVER_JACOBI;
  p.loads = 0;
  std::fill_n(p.wall_velocity, 6, 0.0);
  std::fill_n(p.wall_amplitude, 6, 0.0);
  bare.scene.colliders.clear();
  bare.scene.phases.clear();
  return bare;
}

std::vector<Variant> one_at_a_time(const Scene &scene) {
  std::vector<Variant> variants;
  Variant all = minimal(scene);
  for (const Optional &param : optional_params()) {
    Variant one = minimal(scene);
    one.name = std::string("+ ") + param.name;
    put(param, one.scene.params, scene.params);
    put(param, all.scene.params, scene.params);
    variants.push_back(one);
  }
  for (const Feature &feature : others) {
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
