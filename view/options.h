/* The command line. */
#ifndef PBF_VIEW_OPTIONS_H
#define PBF_VIEW_OPTIONS_H

#include <cstdint>
#include <string>

#include "core/solver.h"
#include "scene/scene.h"
#include "simulation.h"

namespace view {

struct Options {
  bench::SceneOptions scene;
  bench::SolverOptions solver;
  Coloring coloring = Coloring::speed;
  double top = 0;  // the number of the last colour; 0: by itself
  int width = 1280, height = 720;
  uint32_t steps_a_picture = 1;
  std::string record;  // a video or a folder
  bool headless = false;
  uint32_t steps = 0;    // headless: so many
  std::string picture;   // headless: of the state after them
  bool panel = false;    // headless: in the picture, too
  bool measure = false;  // headless: how many pictures a second
};

}  // namespace view

#endif
