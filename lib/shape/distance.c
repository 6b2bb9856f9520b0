/* The distance that colliders see, for a caller. */
#include "distance.h"

#include <math.h>

#include "common/fp_environment.h"
#include "check.h"
#include "error.h"
#include "lock.h"
#include "registry.h"

/* At a place, in cells from the first node, as in backends/physics/surfaces/field.h. */
static double interpolate(const pbf_shape *s, const double place[3], double slope[3]) {
  uint64_t first = 0;
  const uint64_t stride[3] = {1, s->nodes[0], (uint64_t)s->nodes[0] * s->nodes[1]};
  const int deep = s->dimension == 3 ? 3 : 1;
  double weight[3][3] = {{1, 0, 0}, {1, 0, 0}, {1, 0, 0}}, rise[3][3] = {{0}}, value = 0;
  for (uint32_t k = 0; k < s->dimension; ++k) {
    const double middle = fmin(fmax(floor(place[k] + 0.5), 1), s->nodes[k] - 2.0);
    const double u = place[k] - middle, below = 0.5 - u, above = 0.5 + u;
    const double w[3] = {0.5 * below * below, 0.75 - u * u, 0.5 * above * above};
    const double r[3] = {-below, -2 * u, above};
    for (int i = 0; i < 3; ++i) weight[k][i] = w[i], rise[k][i] = r[i];
    first += (uint64_t)(middle - 1) * stride[k];
  }
  for (int k = 0; k < 3; ++k) slope[k] = 0;
  for (int k = 0; k < deep; ++k)
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) {
        const uint64_t index =
            first + (uint64_t)i + stride[1] * (uint64_t)j + stride[2] * (uint64_t)k;
        const double here = (double)s->values[index], x = weight[0][i], y = weight[1][j],
                     z = weight[2][k];
        value += x * y * z * here;
        slope[0] += rise[0][i] * y * z * here / s->cell;
        slope[1] += x * rise[1][j] * z * here / s->cell;
        slope[2] += x * y * rise[2][k] * here / s->cell;
      }
  return value;
}

/* Outside of the grid: the solid ends within, so that nothing of it is nearer than the hypotenuse
 * of the way to the grid and the distance there. */
double pbf_shape_distance_at(const pbf_shape *s, const double *point, double normal[3]) {
  double place[3] = {0, 0, 0}, beyond[3] = {0, 0, 0}, beyond2 = 0;
  for (uint32_t k = 0; k < s->dimension; ++k) {
    const double at = (point[k] - s->origin[k]) / s->cell;
    place[k] = fmin(fmax(at, 0.5), s->nodes[k] - 1.5);
    beyond[k] = s->cell * (at - place[k]);
    beyond2 += beyond[k] * beyond[k];
  }
  const double there = interpolate(s, place, normal);
  if (!(beyond2 > 0)) return there;
  const double distance = sqrt(beyond2 + there * there);
  for (uint32_t k = 0; k < s->dimension; ++k)
    normal[k] = (beyond[k] != 0 ? beyond[k] : there * normal[k]) / distance;
  return distance;
}

static pbf_status get_distance(const pbf_shape *s, const double *point, double *distance,
                               double *normal) {
  double slope[3] = {0, 0, 0}, length2 = 0;
  for (uint32_t k = 0; k < s->dimension; ++k)
    if (!(fabs(point[k]) < 1e150)) {
      return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                      "point[%u] is not between -1e150 and 1e150, as it must be", k);
    }
  *distance = pbf_shape_distance_at(s, point, slope);
  for (uint32_t k = 0; k < s->dimension; ++k) length2 += slope[k] * slope[k];
  for (uint32_t k = 0; k < s->dimension && normal; ++k)
    normal[k] = length2 > 0 ? slope[k] / sqrt(length2) : k == 0;
  return PBF_OK;
}

pbf_status pbf_get_shape_distance(pbf_shape *shape, const double *point, double *distance,
                                  double *normal) {
  pbf_status status = pbf_lock_check();
  if (status != PBF_OK) return status;
  status = pbf_check_pointer("point", point, sizeof *point);
  if (status == PBF_OK) status = pbf_check_pointer("distance", distance, sizeof *distance);
  if (status == PBF_OK && normal) status = pbf_check_pointer("normal", normal, sizeof *normal);
  if (status == PBF_OK) status = pbf_shape_hold(shape, "shape");
  if (status != PBF_OK) return status;
  const pbf_fp_environment before = pbf_fp_begin();
  status = get_distance(shape, point, distance, normal);
  pbf_fp_end(before);
  pbf_shape_let_go(shape);
  return status;
}
