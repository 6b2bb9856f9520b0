/* A cup: a floor and four walls, which move as one. */
#ifndef PBF_TUTORIAL_CUP_H
#define PBF_TUTORIAL_CUP_H

#include <math.h>
#include <pbf/pbf.h>

enum { CUP_PARTS = 5 };

/* code: cup */
static const double cup_inside = 0.225; /* half the inner width: nine particles side by side */
static const double cup_wall = 0.03;    /* half the thickness of its walls */

/* The five boxes of a cup with its middle at (x, y), turned by `tilt` radians about z. */
static inline void place_cup(double x, double y, double tilt, pbf_collider parts[CUP_PARTS]) {
  const double out = cup_inside + cup_wall, half = cup_inside + 2 * cup_wall;
  const double centers[CUP_PARTS][3] = {
      {0, -out, 0}, {-out, 0, 0}, {out, 0, 0}, {0, 0, -out}, {0, 0, out}};
  for (int i = 0; i < CUP_PARTS; ++i) {
    pbf_collider *part = &parts[i];
    pbf_collider_init(part, sizeof *part, PBF_COLLIDER_BOX);
    for (int k = 0; k < 3; ++k) part->half_extents[k] = centers[i][k] != 0 ? cup_wall : half;
    part->position[0] = x + cos(tilt) * centers[i][0] - sin(tilt) * centers[i][1];
    part->position[1] = y + sin(tilt) * centers[i][0] + cos(tilt) * centers[i][1];
    part->position[2] = 0.3 + centers[i][2];
    part->orientation[2] = sin(tilt / 2);
    part->orientation[3] = cos(tilt / 2);
  }
}
/* end */

/* code: motion */
/* Hangs for half a second, is carried to the left for one, and is tipped in the next. */
static inline void cup_at(double time, pbf_collider parts[CUP_PARTS]) {
  const double carried = fmin(fmax(time - 0.5, 0), 1), tipped = fmin(fmax(time - 1.5, 0), 1);
  const double smooth = carried * carried * (3 - 2 * carried);
  place_cup(2.4 - 0.6 * smooth, 1.05, 2.1 * tipped * tipped * (3 - 2 * tipped), parts);
}
/* end */

#endif
