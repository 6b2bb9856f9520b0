/* A scene in a solver, and what of it is drawn. */
#ifndef PBF_VIEW_SIMULATION_H
#define PBF_VIEW_SIMULATION_H

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "core/solver.h"
#include "core/surroundings.h"
#include "scene/scene.h"

namespace view {

enum class Coloring { speed, pressure, density_error };

const std::vector<const char *> &coloring_names();

// What a picture shows, apart from the solver, which may go on.
struct Reading {
  unsigned dimension = 3;
  float radius = 0;                             // of a particle: half a spacing
  std::vector<std::array<float, 4>> particles;  // position, and the number that colours it
  bench::Box domain;
  std::vector<pbf_collider> colliders;
  uint64_t step = 0;
  double time = 0;
  double milliseconds = 0;  // a step
  std::string backend;
};

class Simulation {
 public:
  // Throws bench::Error.
  Simulation(const bench::SceneOptions &scene, const bench::SolverOptions &solver);

  void step(uint32_t steps);
  void reset();  // to the scene's start, with the present parameters
  Reading read(Coloring coloring) const;

  const pbf_params &params() const { return params_; }
  void set_params(const pbf_params &params);  // throws, and keeps the ones before

  unsigned dimension() const { return scene_.dimension; }
  const std::string &scene() const { return scene_.name; }

 private:
  bench::Scene scene_;
  bench::SolverOptions options_;
  pbf_params params_;
  std::unique_ptr<bench::Solver> solver_;
  double milliseconds_ = 0;
};

}  // namespace view

#endif
