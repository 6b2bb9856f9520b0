/* Colliders in a picture: those that are round hide what is behind them, boxes and containers only
 * tint it, since the fluid is often inside. Planes have no edge and are not drawn. */
#ifndef PBF_BENCH_SOLIDS_H
#define PBF_BENCH_SOLIDS_H

#include <pbf/pbf.h>

#include <functional>

#include "report/canvas.h"

namespace bench {

class Solid {
 public:
  // `pixel` takes a point of space to the canvas, where a length is `scale` times as long.
  Solid(const pbf_collider &collider, unsigned dimension, double scale,
        std::function<Vector(const Vector &)> pixel)
      : collider_(collider), flat_(dimension == 2), scale_(scale), pixel_(std::move(pixel)) {}

  bool opaque() const;
  void draw(Canvas &canvas) const;

 private:
  void draw_box(Canvas &canvas) const;
  void draw_capsule(Canvas &canvas, double half_length) const;
  void draw_rim(Canvas &canvas, const Vector &middle) const;
  Vector turned(Vector x) const;
  Vector place(const Vector &local) const;  // from the collider's own axes onto the canvas

  const pbf_collider &collider_;
  bool flat_;
  double scale_;
  std::function<Vector(const Vector &)> pixel_;
};

}  // namespace bench

#endif
