#include "collider_way.h"

#include <math.h>
#include <string.h>

#include "collider.h"
#include "physics/elementary.h"
#include "physics/motion.h"
#include "shape/growth.h"

static const double most_per_sine = 1.5708; /* asin x <= pi / 2 x */

static double distance2(const double a[3], const double b[3]) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
  return sum;
}

static int is_zero(const double v[3]) { return v[0] == 0 && v[1] == 0 && v[2] == 0; }

static double length_of(const double v[3]) { return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

/* ---- Paths ---------------------------------------------------------------------------------- */

/* How far from where it is set now a collider that was set before would be by that path. */
static double miss_of(const pbf_collider *before, uint32_t path, double elapsed,
                      const pbf_collider *now) {
  double position[3];
  pbf_motion_position(before, path, elapsed, position);
  return distance2(position, now->position);
}

uint32_t pbf_collider_path_after(const pbf_collider *before, double elapsed,
                                 const pbf_collider *now) {
  if (!pbf_motion_turns(before) || is_zero(before->velocity)) return before->path;
  const double straight = miss_of(before, PBF_PATH_STRAIGHT, elapsed, now);
  const double screw = miss_of(before, PBF_PATH_SCREW, elapsed, now);
  if (straight == screw) return before->path;
  return screw < straight ? PBF_PATH_SCREW : PBF_PATH_STRAIGHT;
}

/* ---- Ways ----------------------------------------------------------------------------------- */

/* The farthest point of its surface from the axes that it turns about. */
static double size_of(const pbf_collider *c) {
  if (c->shape == PBF_COLLIDER_BOX) return length_of(c->half_extents);
  return c->shape == PBF_COLLIDER_SHAPE ? c->scale * c->geometry->bound
                                        : c->radius + c->half_length;
}

static double cosine_of_half_turn(const pbf_collider *a, const pbf_collider *b) {
  double dot = 0;
  for (int k = 0; k < 4; ++k) dot += a->orientation[k] * b->orientation[k];
  return fmin(fabs(dot), 1);
}

/* How far the surface of a collider goes at most as it turns from one pose to another. */
static double turn_between(const pbf_collider *a, const pbf_collider *b) {
  const double cosine = cosine_of_half_turn(a, b);
  return 2 * pbf_angle(sqrt((1 - cosine) * (1 + cosine)), cosine) * size_of(a);
}

static double distance_of(const double a[3], const double b[3]) { return sqrt(distance2(a, b)); }

static double dot_of(const double a[3], const double b[3], uint32_t dimension) {
  double dot = 0;
  for (uint32_t k = 0; k < dimension; ++k) dot += a[k] * b[k];
  return dot;
}

/* How far its surface goes at most as it takes on another one's axis, beside its orientation. */
static double axis_between(const pbf_collider *a, const pbf_collider *b, uint32_t dimension) {
  if (!pbf_collider_has_axis(a)) return 0;
  if (memcmp(a->axis, b->axis, dimension * sizeof a->axis[0]) == 0) return 0;
  const double lengths =
      sqrt(dot_of(a->axis, a->axis, dimension)) * sqrt(dot_of(b->axis, b->axis, dimension));
  const double cosine = dot_of(a->axis, b->axis, dimension) / lengths;
  const double sine = sqrt(fmax(0.5 * (1 - cosine), 0)); /* of half of the angle */
  return 2 * most_per_sine * sine * size_of(a);
}

/* How far its surface goes at most between solids of shapes, of which one may be baked anew for
 * each frame. */
static double shape_growth_between(const pbf_collider *a, const pbf_collider *b, double most) {
  const pbf_scaled_shape before = {a->geometry, a->scale}, next = {b->geometry, b->scale};
  if (a->geometry == b->geometry) return fabs(a->scale - b->scale) * a->geometry->bound;
  return pbf_shape_growth(&before, &next, (int)a->inverted, most);
}

/* How far its surface goes at most as it takes on another one's sizes; without end, if that is no
 * matter of sizes. More than `most` may be any such number. */
static double growth_between(const pbf_collider *a, const pbf_collider *b, double most) {
  if (a->shape != b->shape || a->inverted != b->inverted) return INFINITY;
  if (a->shape == PBF_COLLIDER_PLANE) return 0;
  if (a->shape == PBF_COLLIDER_BOX) return distance_of(a->half_extents, b->half_extents);
  if (a->shape == PBF_COLLIDER_SHAPE) return shape_growth_between(a, b, most);
  return fabs(a->radius - b->radius) + fabs(a->half_length - b->half_length);
}

static int keeps_size(const pbf_collider *c) {
  return c->radius_rate == 0 && c->half_length_rate == 0 && c->scale_rate == 0 &&
         is_zero(c->half_extents_rate);
}

int pbf_collider_is_surely_near(const pbf_collider_change *change, const pbf_collider *before,
                                const pbf_collider *next) {
  const double by_norm = 0.004; /* that orientations have to 1e-6 */
  if (!keeps_size(before)) return 0;
  if (growth_between(before, next, change->most_growth) > change->most_growth) return 0;
  const double cosine = cosine_of_half_turn(before, next);
  const double sine = sqrt(0.5 * (1 - cosine)); /* of a quarter of the turn between the poses */
  const double turn =
      by_norm + 4 * most_per_sine * sine + change->elapsed * length_of(before->angular_velocity);
  const double way =
      distance_of(before->position, next->position) + change->elapsed * length_of(before->velocity);
  const double axis = axis_between(before, next, change->dimension);
  return way + axis + turn * size_of(before) < 0.999 * change->near;
}

double pbf_collider_find_way(const pbf_collider_change *change, const pbf_collider *before,
                             const pbf_collider *next, double way[3]) {
  pbf_collider now = *next;
  if (before) pbf_motion_collider(before, change->elapsed, &now);
  for (int a = 0; a < 3; ++a) way[a] = next->position[a] - now.position[a];
  const int is_it =
      before && growth_between(&now, next, change->most_growth) <= change->most_growth;
  if (!is_it) return INFINITY;
  return turn_between(&now, next) + axis_between(&now, next, change->dimension);
}
