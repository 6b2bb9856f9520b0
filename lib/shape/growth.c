#include "growth.h"

#include <math.h>

#include "distance.h"

static double distance_of(const pbf_scaled_shape *solid, const double point[3]) {
  double place[3], slope[3];
  for (int k = 0; k < 3; ++k) place[k] = point[k] / solid->scale;
  return solid->scale * pbf_shape_distance_at(solid->shape, place, slope);
}

/* At most, by the nearest node: of a point that is farther from the grid than a cell it is no less
 * than nothing. */
static double most_distance_of(const pbf_scaled_shape *solid, double sign, const double point[3]) {
  const pbf_shape *s = solid->shape;
  uint64_t node = 0, stride = 1;
  double way2 = 0;
  for (uint32_t k = 0; k < s->dimension; ++k) {
    const double place = (point[k] / solid->scale - s->origin[k]) / s->cell;
    const double at = fmin(fmax(floor(place + 0.5), 0), s->nodes[k] - 1.0);
    way2 += (place - at) * (place - at);
    node += stride * (uint64_t)at;
    stride *= s->nodes[k];
  }
  /* The spline is a mean over a cell to each side. */
  const double most = sign * (double)s->values[node] + (sqrt(way2) + 2) * s->steepest * s->cell;
  return way2 > s->dimension ? INFINITY : solid->scale * most;
}

/* Of one node of it: how far outside of `before` that is, if it is solid. Next to the surface the
 * solid goes on beyond a node by as much as that is in it. Both distances are as colliders see
 * them, which round edges alike. */
static double growth_at(const pbf_scaled_shape *before, const pbf_scaled_shape *next, double sign,
                        const uint32_t at[3], double value) {
  const pbf_shape *s = next->shape;
  double point[3] = {0, 0, 0};
  if (!(sign * value <= s->cell)) return 0;
  for (uint32_t k = 0; k < s->dimension; ++k)
    point[k] = (s->origin[k] + s->cell * at[k]) * next->scale;
  if (most_distance_of(before, sign, point) <= 0) return 0;
  const double outside = sign * distance_of(before, point);
  return outside > 0 ? outside - fmax(sign * distance_of(next, point), 0) : 0;
}

double pbf_shape_growth(const pbf_scaled_shape *before, const pbf_scaled_shape *next, int inverted,
                        double most) {
  const pbf_shape *s = next->shape;
  const float *value = s->values;
  double growth = 0;
  uint32_t at[3];
  for (at[2] = 0; at[2] < s->nodes[2]; ++at[2])
    for (at[1] = 0; at[1] < s->nodes[1]; ++at[1])
      for (at[0] = 0; at[0] < s->nodes[0] && growth <= most; ++at[0])
        growth = fmax(growth, growth_at(before, next, inverted ? -1 : 1, at, (double)*value++));
  return growth;
}
