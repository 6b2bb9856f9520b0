#include "check.h"

#include <float.h>
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "error.h"
#include "text.h"

const char *pbf_check_finite(double value, uint32_t precision) {
  if (!isfinite(value)) return "finite";
  if (precision == PBF_FLOAT32 && fabs(value) > FLT_MAX) return "finite in float32";
  return NULL;
}

const double pbf_check_most = 1e150;

static const char *unmet_above_zero(double value, uint32_t precision) {
  int single = precision == PBF_FLOAT32;
  if (value <= 0) return "above 0";
  if (value >= (single ? (double)FLT_MIN : DBL_MIN)) return NULL;
  return single ? "a normal number in float32, at least 1.2e-38"
                : "a normal number, at least 2.3e-308";
}

/* Cells narrower than h would hold too few particles, and wider ones than this none. */
static const char *unmet_grid_width(double value) {
  if (value == 0 || value == -1 || (value >= 1 && value <= 1000)) return NULL;
  return "1 … 1000, in units of smoothing_radius, 0 for none, or -1 for one where water could be "
         "deep";
}

/* Null when the value will do, else what it must be. */
static const char *unmet_requirement(double value, pbf_range range, uint32_t precision) {
  const char *requirement = pbf_check_finite(value, precision);
  if (requirement) return requirement;
  if (fabs(value) > pbf_check_most) return "at most 1e150 in size";
  switch (range) {
    case PBF_ANY:
      return NULL;
    case PBF_AT_LEAST_ZERO:
      return value < 0 ? "at least 0" : NULL;
    case PBF_ABOVE_ZERO:
      return unmet_above_zero(value, precision);
    case PBF_FRACTION:
      return value < 0 || value > 1 ? "from 0 to 1" : NULL;
    case PBF_FRACTION_OR_CHOICE:
      return value != -1 && (value < 0 || value > 1) ? "from 0 to 1, or -1 for what the scene needs"
                                                     : NULL;
    case PBF_FRACTION_OF_RADIUS:
      return value < 1 ? unmet_above_zero(value, precision)
                       : "below 1, in units of smoothing_radius";
    case PBF_GRID_WIDTH:
      return unmet_grid_width(value);
  }
  return NULL;
}

static double real_at(const void *object, size_t offset) {
  double value;
  memcpy(&value, (const unsigned char *)object + offset, sizeof value);
  return value;
}

static int is_off(size_t only_with, const void *object) {
  return only_with && !(real_at(object, only_with) > 0);
}

pbf_status pbf_check_real(const pbf_real_rule *rule, const char *label, const void *object,
                          pbf_check_kind kind) {
  uint32_t used = is_off(rule->only_with, object) ? 0 : rule->components;
  if (kind.dimension == 2 && used > 1) used = used / 3 * 2;
  for (uint32_t i = 0; i < used; ++i) {
    double value = real_at(object, rule->offset + i * sizeof value);
    const char *requirement = unmet_requirement(value, rule->range, kind.precision);
    if (!requirement) continue;
    char index[16] = "", number[PBF_NUMBER_SIZE];
    if (rule->components > 1) snprintf(index, sizeof index, "[%u]", i);
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "%s.%s%s is %s; it must be %s", label, rule->name,
                    index, pbf_text_number(number, value), requirement);
  }
  return PBF_OK;
}

pbf_status pbf_check_count(const pbf_count_rule *rule, const char *label, const void *object) {
  uint32_t value;
  memcpy(&value, (const unsigned char *)object + rule->offset, sizeof value);
  if (value >= rule->min && value <= rule->max) return PBF_OK;
  if (is_off(rule->only_with, object)) return PBF_OK;
  char range[48];
  if (rule->min == rule->max) {
    snprintf(range, sizeof range, "%u", rule->min);
  } else if (rule->max == UINT32_MAX) {
    snprintf(range, sizeof range, "at least %u", rule->min);
  } else {
    snprintf(range, sizeof range, "%u … %u", rule->min, rule->max);
  }
  return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "%s.%s is %u; it must be %s%s", label, rule->name,
                  value, range, rule->hint);
}

pbf_status pbf_check_reals(const pbf_real_rule *rules, size_t count, const char *label,
                           const void *object, pbf_check_kind kind) {
  for (size_t i = 0; i < count; ++i) {
    pbf_status status = pbf_check_real(&rules[i], label, object, kind);
    if (status != PBF_OK) return status;
  }
  return PBF_OK;
}

pbf_status pbf_check_counts(const pbf_count_rule *rules, size_t count, const char *label,
                            const void *object) {
  for (size_t i = 0; i < count; ++i) {
    pbf_status status = pbf_check_count(&rules[i], label, object);
    if (status != PBF_OK) return status;
  }
  return PBF_OK;
}

static double norm(const double *v, uint32_t components) {
  double sum = 0;
  for (uint32_t i = 0; i < components; ++i) sum += v[i] * v[i];
  return sqrt(sum);
}

pbf_status pbf_check_orientation(const double orientation[4], const char *label,
                                 uint32_t dimension) {
  const double *q = orientation, length = norm(q, 4), tolerance = 1e-6;
  char number[5][PBF_NUMBER_SIZE];
  if (!(fabs(length - 1) <= tolerance))
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "%s.orientation is (%s, %s, %s, %s), of norm %s; it must be a unit quaternion "
                    "x, y, z, w to within %g",
                    label, pbf_text_number(number[0], q[0]), pbf_text_number(number[1], q[1]),
                    pbf_text_number(number[2], q[2]), pbf_text_number(number[3], q[3]),
                    pbf_text_number(number[4], length), tolerance);
  if (dimension == 2 && (q[0] != 0 || q[1] != 0))
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "%s.orientation is (%.9g, %.9g, %.9g, %.9g); in 2D x and y must be 0, a turn "
                    "about z",
                    label, q[0], q[1], q[2], q[3]);
  return PBF_OK;
}

pbf_status pbf_check_axis(const double *axis, const char *label, uint32_t dimension) {
  const double length = norm(axis, dimension);
  if (length > 0 && isfinite(length)) return PBF_OK;
  return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                  "%s.axis has length %.9g; it must be a direction, not zero and not so long that "
                  "its square overflows",
                  label, length);
}

/* As arrays of a program's lie: on 32-bit x86 doubles are aligned to 4 bytes. */
static uint32_t alignment_of(uint32_t element_size) {
  typedef struct behind_a_byte {
    char byte;
    double number;
  } behind_a_byte;
  const uint32_t most = offsetof(behind_a_byte, number);
  return element_size < most ? element_size : most;
}

pbf_status pbf_check_pointer(const char *name, const void *values, uint32_t element_size) {
  const uint32_t alignment = alignment_of(element_size);
  if (!values) return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "%s is null", name);
  if ((uintptr_t)values % alignment == 0) return PBF_OK;
  return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "%s is %p; it must be aligned to %u bytes", name,
                  (void *)(uintptr_t)values, alignment);
}
