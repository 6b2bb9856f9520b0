/* pbf-bench validate: what the fluid does, against closed forms. A case is a function that runs a
 * scene of bench/scenes/validation/ and adds figures. */
#ifndef PBF_BENCH_PHYSICS_RUN_H
#define PBF_BENCH_PHYSICS_RUN_H

#include <string>
#include <vector>

#include "core/solver.h"
#include "scene/scene.h"

namespace bench::physics {

// A figure that is measured, and what it must be.
struct Figure {
  std::string name;
  double is, must, error, bar;  // error: relative, or the difference in `unit`; bar 0: none
  std::string unit;             // of the difference; empty: relative
};

struct Options {
  SolverOptions solver;
  std::vector<std::string> settings;  // key=value, in place of the scenes'
  double finer = 1;
  bool quick = false;  // fewer starts, or the coarsest of several runs
};

class Run {
 public:
  explicit Run(const Options &options) : options_(options) {}

  bool quick() const { return options_.quick; }
  double finer() const { return options_.finer; }
  const SolverOptions &solver() const { return options_.solver; }

  // A scene of bench/scenes/validation/ with what the command line changes.
  Scene scene(const std::string &name) const;

  void ratio(const std::string &name, double is, double must, double bar);
  void difference(const std::string &name, double is, double must, double bar,
                  const std::string &unit);
  void plain(const std::string &name, double is);  // without anything that it must be

  void took(uint32_t particles) { particles_ = particles > particles_ ? particles : particles_; }
  uint32_t particles() const { return particles_; }  // of the largest fluid
  const std::vector<Figure> &figures() const { return figures_; }

 private:
  Options options_;
  std::vector<Figure> figures_;
  uint32_t particles_ = 0;
};

struct Case {
  const char *name, *title;
  void (*run)(Run &run);
};

extern const std::vector<Case> cases;

void laplace(Run &run);
void rayleigh(Run &run);
void contact_angles(Run &run);
void couette(Run &run);
void poiseuille(Run &run);
void stokes(Run &run);
void layers(Run &run);
void rayleigh_taylor(Run &run);
void lock_exchange(Run &run);
void taylor_green(Run &run);
void volume_flow(Run &run);
void current_tank(Run &run);
void reservoir_level(Run &run);
void reservoir_channel(Run &run);
void reservoir_pressure(Run &run);
void buoyancy(Run &run);
void wall_force(Run &run);
void jet(Run &run);
void towed_ball(Run &run);
void friction(Run &run);
void queries(Run &run);

}  // namespace bench::physics

#endif
