/* Spheres and capsules that fluid stays outside of, in 3D: they hide what is behind them. */
#ifndef PBF_VIEW_ROUND_SOLIDS_H
#define PBF_VIEW_ROUND_SOLIDS_H

#include <vector>

#include "simulation.h"
#include "spheres.h"

namespace view {

class RoundSolids {
 public:
  void set(const Reading &reading);
  void draw(const Matrix &to_eye, const Matrix &projection, int height) const;

 private:
  struct Solid {
    std::vector<std::array<float, 4>> points;  // centres of spheres that make it up
    float radius;
  };
  std::vector<Solid> solids_;
  mutable Spheres spheres_;  // what one of them after the other is drawn by
};

}  // namespace view

#endif
