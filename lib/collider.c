#include "collider.h"

#include <float.h>
#include <string.h>

#include <pbf/pbf_backend.h>

#include "error.h"

#define COUNT(member, max, hint) \
  { #member, offsetof(pbf_collider, member), 0, max, hint, 0 }
#define REAL(member, components, range) \
  { #member, offsetof(pbf_collider, member), components, range, 0 }
#define LENGTH(array) (sizeof(array) / sizeof((array)[0]))

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

/* Nearly all that callers give meets the rules above, which say what is wrong with the rest. It is
 * found to without a look at them. */

enum {
  NUMBERS = (offsetof(pbf_collider, geometry) - offsetof(pbf_collider, position)) / sizeof(double),
  MORE_NUMBERS =
      (offsetof(pbf_collider, last_velocity) - offsetof(pbf_collider, scale)) / sizeof(double)
};

/* Bits of sizes are ordered as these are, with infinity and what is no number behind them; several
 * are compared at once. */
static int are_finite(const double *numbers, int count) {
  const uint64_t size = UINT64_MAX >> 1, most = UINT64_C(0x47EFFFFFE0000000); /* FLT_MAX */
  uint64_t beyond = 0;
  for (int i = 0; i < count; ++i) {
    uint64_t bits;
    memcpy(&bits, &numbers[i], sizeof bits);
    beyond |= most - (bits & size);
  }
  return !(beyond & ~size);
}

static int is_fraction(double number) { return number >= 0 && number <= 1; }

static int is_ordinary(const pbf_collider *c) {
  return c->shape <= PBF_COLLIDER_SHAPE && c->inverted <= 1 && c->path <= PBF_PATH_SCREW &&
         are_finite(c->position, NUMBERS) && are_finite(&c->scale, MORE_NUMBERS) &&
         c->duration >= 0 && c->friction >= 0 && c->static_friction >= 0 &&
         is_fraction(c->no_slip) && is_fraction(c->adhesion);
}

/* The same for sizes, of an ordinary one. */
static int has_ordinary_sizes(const pbf_collider *collider) {
  const double *extents = collider->half_extents;
  if (collider->shape == PBF_COLLIDER_SPHERE) return collider->radius >= FLT_MIN;
  if (collider->shape == PBF_COLLIDER_CAPSULE)
    return collider->radius >= FLT_MIN && collider->half_length >= 0;
  return collider->shape == PBF_COLLIDER_BOX && extents[0] >= FLT_MIN && extents[1] >= FLT_MIN &&
         extents[2] >= FLT_MIN;
}

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

static pbf_status check_axis(const pbf_collider *collider, const char *label, uint32_t dimension) {
  if (!pbf_collider_has_axis(collider)) return PBF_OK;
  return pbf_check_axis(collider->axis, label, dimension);
}

static pbf_status check_numbers(const pbf_collider *collider, const char *label,
                                pbf_check_kind kind) {
  const pbf_real_rule *turn = kind.dimension == 2 ? &turn_2d : &turn_3d;
  pbf_status status = pbf_check_counts(counts, LENGTH(counts), label, collider);
  if (status == PBF_OK) status = pbf_check_reals(reals, LENGTH(reals), label, collider, kind);
  return status == PBF_OK ? pbf_check_real(turn, label, collider, kind) : status;
}

static pbf_status check(const pbf_collider *collider, const char *label, pbf_check_kind kind,
                        pbf_range sizes) {
  const int ordinary = is_ordinary(collider);
  pbf_status status = ordinary ? PBF_OK : check_numbers(collider, label, kind);
  if (status == PBF_OK) status = check_geometry(collider, label, kind);
  if (status == PBF_OK && !(ordinary && has_ordinary_sizes(collider)))
    status = check_sizes(collider, label, kind, sizes);
  if (status == PBF_OK)
    status = pbf_check_orientation(collider->orientation, label, kind.dimension);
  if (status == PBF_OK) status = check_axis(collider, label, kind.dimension);
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
