/* The panel beside the picture: what plays, what colours, and a slider for each parameter. */
#ifndef PBF_VIEW_PANEL_H
#define PBF_VIEW_PANEL_H

#include <string>
#include <vector>

#include "simulation.h"

namespace view {

// What the panel shows, and what is asked for by it; the loop sets the requests back.
struct Controls {
  std::vector<std::string> scenes;
  int scene = -1;  // of these; -1: a file
  pbf_params params{};
  unsigned dimension = 3;
  Coloring coloring = Coloring::speed;
  double top = 0;  // of the colours; 0: as fast as the fastest
  int steps_a_picture = 1;
  bool playing = true;
  std::string record_to = "water.mp4";
  bool recording = false;
  std::string message;  // the last error's sentence
  // Requests.
  bool step = false, reset = false, load = false, params_changed = false, look = false;
};

// `shown_top`: the number of the last colour in the picture.
void draw_panel(Controls &controls, const Reading &reading, double shown_top);

}  // namespace view

#endif
