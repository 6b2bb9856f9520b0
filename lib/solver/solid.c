#include "solid.h"

#include <math.h>
#include <string.h>

#include "collider.h"
#include "physics/motion.h"
#include "shape/distance.h"

static void turn(const double q[4], const double v[3], double turned[3]) {
  const double p[4] = {v[0], v[1], v[2], 0}, back[4] = {-q[0], -q[1], -q[2], q[3]};
  double half[4], whole[4];
  pbf_motion_quaternion_product(q, p, half);
  pbf_motion_quaternion_product(half, back, whole);
  memcpy(turned, whole, 3 * sizeof *turned);
}

static void set_frame(pbf_solid *s) {
  const double length = pbf_motion_length(s->now.axis);
  const int has_axis = pbf_collider_has_axis(&s->now);
  for (int row = 0; row < 3; ++row) {
    double own[3] = {row == 0, row == 1, row == 2};
    for (int k = 0; k < 3 && has_axis; ++k) own[k] = s->now.axis[k] / length;
    turn(s->now.orientation, own, s->frame[row]);
  }
}

static double bound_of(const pbf_collider *c, uint32_t dimension) {
  double square = 0;
  if (c->inverted || c->shape == PBF_COLLIDER_PLANE) return INFINITY;
  if (c->shape == PBF_COLLIDER_SHAPE) return c->scale * c->geometry->bound;
  if (c->shape == PBF_COLLIDER_SPHERE) return c->radius;
  if (c->shape == PBF_COLLIDER_CAPSULE) return c->radius + c->half_length;
  for (uint32_t k = 0; k < dimension; ++k) square += c->half_extents[k] * c->half_extents[k];
  return sqrt(square);
}

pbf_solid pbf_solid_at(const pbf_solver *solver, uint32_t index, double time) {
  pbf_solid s = {.dimension = solver->kind.dimension};
  pbf_collider moving = solver->colliders[index];
  pbf_collider_clean(&moving, s.dimension);
  pbf_motion_collider_state(&moving, time - solver->collider_time, &s.now);
  set_frame(&s);
  s.bound = bound_of(&s.now, s.dimension);
  return s;
}

static double dot(const double *a, const double *b, uint32_t n) {
  double sum = 0;
  for (uint32_t k = 0; k < n; ++k) sum += a[k] * b[k];
  return sum;
}

/* Out of the very centre it is along x. */
static double from_centre(const double p[3], double radius, uint32_t n, double normal[3]) {
  const double r = sqrt(dot(p, p, n));
  for (uint32_t k = 0; k < n; ++k) normal[k] = r > 0 ? p[k] / r : k == 0;
  return r - radius;
}

static double from_box(const double p[3], const double half[3], uint32_t n, double normal[3]) {
  double inside = -INFINITY, outside = 0, out[3] = {0, 0, 0};
  uint32_t face = 0;
  for (uint32_t k = 0; k < n; ++k) {
    const double d = fabs(p[k]) - half[k];
    if (d > inside) inside = d, face = k;
    out[k] = d > 0 ? copysign(d, p[k]) : 0;
    outside += out[k] * out[k];
  }
  const double distance = sqrt(outside);
  for (uint32_t k = 0; k < n; ++k)
    normal[k] = distance > 0 ? out[k] / distance : k == face ? copysign(1, p[k]) : 0;
  return distance > 0 ? distance : inside;
}

static double from_field(const pbf_solid *s, const double p[3], double normal[3]) {
  const uint32_t n = s->dimension;
  double place[3] = {0, 0, 0};
  if (!(s->now.scale > 0)) return INFINITY;
  for (uint32_t k = 0; k < n; ++k) place[k] = p[k] / s->now.scale;
  const double distance = s->now.scale * pbf_shape_distance_at(s->now.geometry, place, normal);
  const double length = sqrt(dot(normal, normal, n));
  for (uint32_t k = 0; k < n; ++k) normal[k] = length > 0 ? normal[k] / length : k == 0;
  return distance;
}

/* In its own frame. */
static double local_distance(const pbf_solid *s, double p[3], double normal[3]) {
  const uint32_t n = s->dimension;
  if (s->now.shape == PBF_COLLIDER_BOX) return from_box(p, s->now.half_extents, n, normal);
  if (s->now.shape == PBF_COLLIDER_SHAPE) return from_field(s, p, normal);
  return from_centre(p, s->now.radius, n, normal);
}

double pbf_solid_distance(const pbf_solid *s, const double *x, double normal[3]) {
  const uint32_t n = s->dimension;
  const double sign = s->now.inverted ? -1 : 1;
  double p[3] = {0, 0, 0}, local[3] = {0, 0, 0}, found[3] = {0, 0, 0}, distance;
  for (uint32_t k = 0; k < n; ++k) p[k] = x[k] - s->now.position[k];
  if (s->now.shape == PBF_COLLIDER_PLANE) {
    memcpy(normal, s->frame[0], sizeof s->frame[0]);
    distance = dot(p, normal, n);
  } else if (s->now.shape == PBF_COLLIDER_CAPSULE) {
    const double h = s->now.half_length, along = fmax(fmin(dot(p, s->frame[0], n), h), -h);
    for (uint32_t k = 0; k < n; ++k) p[k] -= along * s->frame[0][k];
    distance = from_centre(p, s->now.radius, n, normal);
  } else {
    for (uint32_t k = 0; k < n; ++k) local[k] = dot(p, s->frame[k], n);
    distance = local_distance(s, local, found);
    for (uint32_t k = 0; k < n; ++k) {
      normal[k] = 0;
      for (uint32_t row = 0; row < n; ++row) normal[k] += s->frame[row][k] * found[row];
    }
  }
  for (uint32_t k = 0; k < n; ++k) normal[k] *= sign;
  return sign * distance;
}

int pbf_solid_is_beyond(const pbf_solid *s, const double *x, double reach) {
  double square = 0;
  for (uint32_t k = 0; k < s->dimension; ++k)
    square += (x[k] - s->now.position[k]) * (x[k] - s->now.position[k]);
  return square > (s->bound + reach) * (s->bound + reach);
}
