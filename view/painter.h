/* A picture of a reading, in the OpenGL context and frame buffer that are current. */
#ifndef PBF_VIEW_PAINTER_H
#define PBF_VIEW_PAINTER_H

#include "camera.h"
#include "outlines.h"
#include "round_solids.h"
#include "simulation.h"
#include "spheres.h"

namespace view {

class Painter {
 public:
  void set(const Reading &reading);

  // `top`: the number at the upper end of the colours; 0: that of the 99.5th percentile, followed
  // slowly, so that the colours of a film do not flicker.
  void draw(const Camera &camera, int width, int height, double top) const;

  double top() const { return top_; }

 private:
  Spheres spheres_;
  RoundSolids solids_;
  Outlines outlines_;
  double top_ = 0;
};

}  // namespace view

#endif
