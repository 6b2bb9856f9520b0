/* Checks of single numbers by table: a row has a field's name, offset and range. */
#ifndef PBF_LIB_CHECK_H
#define PBF_LIB_CHECK_H

#include <stddef.h>

#include <pbf/pbf.h>

/* What kind of solver a value must suit. */
typedef struct pbf_check_kind {
  uint32_t dimension;
  uint32_t precision;
} pbf_check_kind;

typedef enum pbf_range {
  PBF_ANY, /* finite */
  PBF_AT_LEAST_ZERO,
  PBF_ABOVE_ZERO,
  PBF_FRACTION,
  PBF_FRACTION_OR_CHOICE, /* or -1: the solver's choice */
  PBF_FRACTION_OF_RADIUS, /* between 0 and 1, in units of smoothing_radius */
  PBF_GRID_WIDTH,         /* of a coarse grid, in the same units; or none, or the solver's choice */
} pbf_range;

/* `components`: 1, 3 (an axis each, of which 2D has two) or 6 (a wall each, of which 2D has
 * four). `only_with`: the offset of a double that must be above 0 for the rule to hold, or 0. */
typedef struct pbf_real_rule {
  const char *name;
  size_t offset;
  uint32_t components;
  pbf_range range;
  size_t only_with;
} pbf_real_rule;

typedef struct pbf_count_rule {
  const char *name;
  size_t offset;
  uint32_t min;
  uint32_t max;
  const char *hint; /* appended to the range in the message; may be empty */
  size_t only_with;
} pbf_count_rule;

/* `object` is the struct, `label` what the message calls it. */
pbf_status pbf_check_real(const pbf_real_rule *rule, const char *label, const void *object,
                          pbf_check_kind kind);
pbf_status pbf_check_count(const pbf_count_rule *rule, const char *label, const void *object);

pbf_status pbf_check_reals(const pbf_real_rule *rules, size_t count, const char *label,
                           const void *object, pbf_check_kind kind);
pbf_status pbf_check_counts(const pbf_count_rule *rules, size_t count, const char *label,
                            const void *object);

/* The largest size of a number that is accepted: squares of it, and sums of them, are finite in
 * float64, in which also float32's are computed where they would overflow. */
extern const double pbf_check_most;

/* A unit quaternion x, y, z, w, in 2D of a turn about z. */
pbf_status pbf_check_orientation(const double orientation[4], const char *label,
                                 uint32_t dimension);

/* A direction: neither zero nor so long that its square overflows. */
pbf_status pbf_check_axis(const double *axis, const char *label, uint32_t dimension);

/* Null when the number is finite in the solver's precision, else what it must be. */
const char *pbf_check_finite(double value, uint32_t precision);

/* Not null and aligned to its elements. */
pbf_status pbf_check_pointer(const char *name, const void *values, uint32_t element_size);

#endif
