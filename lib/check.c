#include "check.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "error.h"
#include "text.h"

const char *pbf_check_finite(double value, uint32_t precision) {
  if (!isfinite(value)) return "finite";
  if (precision == PBF_FLOAT32 && fabs(value) > FLT_MAX) return "finite in float32";
  return NULL;
}

/* Null when the value will do, else what it must be. */
static const char *unmet_requirement(double value, pbf_range range, uint32_t precision) {
  const char *requirement = pbf_check_finite(value, precision);
  if (requirement) return requirement;
  if (range == PBF_AT_LEAST_ZERO && value < 0) return "at least 0";
  if (range == PBF_FRACTION && (value < 0 || value > 1)) return "from 0 to 1";
  if (range == PBF_ABOVE_ZERO && value <= 0) return "above 0";
  int single = precision == PBF_FLOAT32;
  if (range != PBF_ABOVE_ZERO || value >= (single ? (double)FLT_MIN : DBL_MIN)) return NULL;
  return single ? "a normal number in float32, at least 1.2e-38"
                : "a normal number, at least 2.3e-308";
}

pbf_status pbf_check_real(const pbf_real_rule *rule, const char *label, const void *object,
                          pbf_check_kind kind) {
  uint32_t used = rule->components;
  if (kind.dimension == 2 && used > 1) used = used / 3 * 2;
  for (uint32_t i = 0; i < used; ++i) {
    double value;
    memcpy(&value, (const unsigned char *)object + rule->offset + i * sizeof value, sizeof value);
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
