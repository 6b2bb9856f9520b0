/* A scene's solver with its particles as numbers. */
#ifndef PBF_BENCH_PHYSICS_FLUID_H
#define PBF_BENCH_PHYSICS_FLUID_H

#include <vector>

#include "physics/run.h"

namespace bench::physics {

constexpr double pi = 3.14159265358979323846;

class Fluid {
 public:
  Fluid(Run &run, const Scene &scene);

  void step(uint32_t steps) { solver_.step(steps); }
  double time() const { return solver_.info().time; }
  pbf_solver *handle() const { return solver_.handle(); }

  void look();  // positions and velocities, in the order of adding
  void put();   // those back
  // Moves each particle by up to half of so many spacings along each axis.
  void shake(double spacings, uint32_t start);
  void set_params();  // params as they are now

  uint32_t count() const { return static_cast<uint32_t>(x.size() / dimension); }
  double *at(uint32_t i) { return &x[size_t{i} * dimension]; }
  double *speed(uint32_t i) { return &v[size_t{i} * dimension]; }
  std::vector<double> pressures() const;
  std::vector<uint32_t> phases() const;
  std::vector<pbf_collider_load> wall_loads() const;  // since they were last read
  pbf_collider_load collider_load(uint32_t index) const;
  pbf_in_out in_out() const;
  // The volume that a reservoir has given so far, less what it has taken.
  double given_by(uint32_t reservoir) const;
  double mean_level(const std::vector<double> &points) const;
  double particle_volume() const;

  const unsigned dimension;
  pbf_params params;
  std::vector<double> x, v;

 private:
  uint32_t precision_;
  Solver solver_;
};

}  // namespace bench::physics

#endif
