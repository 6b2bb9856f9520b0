#include "collider.h"

#include <math.h>

#include <pbf/pbf_backend.h>

#include "error.h"
#include "text.h"

#define COUNT(member, max, hint) \
  { #member, offsetof(pbf_collider, member), 0, max, hint, 0 }
#define REAL(member, components, range) \
  { #member, offsetof(pbf_collider, member), components, range, 0 }
#define LENGTH(array) (sizeof(array) / sizeof((array)[0]))

static const double quaternion_tolerance = 1e-6;

static const pbf_count_rule counts[] = {
    COUNT(shape, PBF_COLLIDER_SHAPE, " (PBF_COLLIDER_…)"),
    COUNT(inverted, 1, ""),
    COUNT(path, PBF_PATH_SCREW, " (PBF_PATH_…)"),
};

static const pbf_real_rule reals[] = {
    REAL(position, 3, PBF_ANY),
    REAL(velocity, 3, PBF_ANY),
    REAL(axis, 3, PBF_ANY),
    REAL(half_extents, 3, PBF_ANY),
    REAL(radius, 1, PBF_ANY),
    REAL(half_length, 1, PBF_ANY),
    REAL(half_extents_rate, 3, PBF_ANY),
    REAL(radius_rate, 1, PBF_ANY),
    REAL(half_length_rate, 1, PBF_ANY),
    REAL(duration, 1, PBF_AT_LEAST_ZERO),
    REAL(scale, 1, PBF_ANY),
    REAL(scale_rate, 1, PBF_ANY),
    REAL(friction, 1, PBF_AT_LEAST_ZERO),
    REAL(static_friction, 1, PBF_AT_LEAST_ZERO),
    REAL(no_slip, 1, PBF_FRACTION),
    REAL(adhesion, 1, PBF_FRACTION),
};

/* 2D turns about z alone: the four and the third component are not what 2D leaves out. */
static const pbf_real_rule turn_3d = REAL(angular_velocity, 3, PBF_ANY);
static const pbf_real_rule turn_2d = {"angular_velocity[2]",
                                      offsetof(pbf_collider, angular_velocity[2]), 1, PBF_ANY, 0};

/* The sizes that the shape has, which are above 0, or, of one that has shrunk, at least that. */
static pbf_status check_sizes(const pbf_collider *collider, const char *label, pbf_check_kind kind,
                              pbf_range range) {
  const pbf_real_rule box = REAL(half_extents, 3, range), scale = REAL(scale, 1, range),
                      radius = REAL(radius, 1, range),
                      half_length = REAL(half_length, 1, PBF_AT_LEAST_ZERO);
  if (collider->shape == PBF_COLLIDER_PLANE) return PBF_OK;
  if (collider->shape == PBF_COLLIDER_BOX) return pbf_check_real(&box, label, collider, kind);
  if (collider->shape == PBF_COLLIDER_SHAPE) return pbf_check_real(&scale, label, collider, kind);
  pbf_status status = pbf_check_real(&radius, label, collider, kind);
  if (status == PBF_OK && collider->shape == PBF_COLLIDER_CAPSULE)
    status = pbf_check_real(&half_length, label, collider, kind);
  return status;
}

static pbf_status check_geometry(const pbf_collider *collider, const char *label,
                                 pbf_check_kind kind) {
  const pbf_shape *geometry = collider->geometry;
  if (collider->shape != PBF_COLLIDER_SHAPE) {
    if (!geometry) return PBF_OK;
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "%s.geometry is set, and shape %u; it must be PBF_COLLIDER_SHAPE, %u", label,
                    collider->shape, (unsigned)PBF_COLLIDER_SHAPE);
  }
  if (!geometry) {
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "%s.geometry is null; with PBF_COLLIDER_SHAPE it must be a pbf_shape", label);
  }
  if (geometry->dimension == kind.dimension) return PBF_OK;
  return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "%s.geometry is a shape in %uD; the solver is in %uD",
                  label, geometry->dimension, kind.dimension);
}

static double norm(const double *v, uint32_t components) {
  double sum = 0;
  for (uint32_t i = 0; i < components; ++i) sum += v[i] * v[i];
  return sqrt(sum);
}

static pbf_status check_orientation(const pbf_collider *collider, const char *label,
                                    pbf_check_kind kind) {
  const double *q = collider->orientation;
  double length = norm(q, 4);
  char number[5][PBF_NUMBER_SIZE];
  if (!(fabs(length - 1) <= quaternion_tolerance)) {
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "%s.orientation is (%s, %s, %s, %s), of norm %s; it must be a unit quaternion "
                    "x, y, z, w to within %g",
                    label, pbf_text_number(number[0], q[0]), pbf_text_number(number[1], q[1]),
                    pbf_text_number(number[2], q[2]), pbf_text_number(number[3], q[3]),
                    pbf_text_number(number[4], length), quaternion_tolerance);
  }
  if (kind.dimension == 2 && (q[0] != 0 || q[1] != 0)) {
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "%s.orientation is (%.9g, %.9g, %.9g, %.9g); in 2D x and y must be 0, a turn "
                    "about z",
                    label, q[0], q[1], q[2], q[3]);
  }
  return PBF_OK;
}

static pbf_status check_axis(const pbf_collider *collider, const char *label, pbf_check_kind kind) {
  if (collider->shape != PBF_COLLIDER_PLANE && collider->shape != PBF_COLLIDER_CAPSULE)
    return PBF_OK;
  double length = norm(collider->axis, kind.dimension);
  if (length > 0 && isfinite(length)) return PBF_OK;
  return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                  "%s.axis has length %.9g; it must be a direction, not zero and not so long that "
                  "its square overflows",
                  label, length);
}

static pbf_status check(const pbf_collider *collider, const char *label, pbf_check_kind kind,
                        pbf_range sizes) {
  pbf_status status = pbf_check_counts(counts, LENGTH(counts), label, collider);
  if (status == PBF_OK) status = pbf_check_reals(reals, LENGTH(reals), label, collider, kind);
  if (status == PBF_OK)
    status = pbf_check_real(kind.dimension == 2 ? &turn_2d : &turn_3d, label, collider, kind);
  if (status == PBF_OK) status = check_geometry(collider, label, kind);
  if (status == PBF_OK) status = check_sizes(collider, label, kind, sizes);
  if (status == PBF_OK) status = check_orientation(collider, label, kind);
  if (status == PBF_OK) status = check_axis(collider, label, kind);
  return status;
}

pbf_status pbf_collider_check(const pbf_collider *collider, const char *label,
                              pbf_check_kind kind) {
  return check(collider, label, kind, PBF_ABOVE_ZERO);
}

pbf_status pbf_collider_check_moving(const pbf_collider *collider, const char *label,
                                     pbf_check_kind kind) {
  return check(collider, label, kind, PBF_AT_LEAST_ZERO);
}

pbf_collider pbf_collider_for_backend(const pbf_collider *collider, uint32_t dimension) {
  pbf_collider clean = *collider;
  if (dimension == 3) return clean;
  clean.position[2] = clean.velocity[2] = clean.axis[2] = clean.half_extents[2] = 0;
  clean.half_extents_rate[2] = 0;
  clean.angular_velocity[0] = clean.angular_velocity[1] = 0;
  return clean;
}
