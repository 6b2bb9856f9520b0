/* The numbers of pbf_params, by params.def: a new parameter is in every test that goes through
 * them. */
#ifndef PBF_TESTS_PARAM_TABLE_H
#define PBF_TESTS_PARAM_TABLE_H

#include <stddef.h>
#include <string.h>

#include <pbf/pbf.h>

#include "physics/features.h"

typedef struct table_param {
  const char *name;
  size_t offset;
  uint32_t components;
  int conditional; /* its range holds only where another parameter is above 0 */
  double usual;    /* 0, or it is optional: 0 turns it off, this on */
  uint32_t min_solver;
  int feature;
} table_param;

/* The column `when`. */
#define CONDITIONAL_ALWAYS 0
#define CONDITIONAL_WITH(member) 1

static const table_param table_params[] = {
#define PBF_PARAM_REAL(offset, name, initial, range, when, min_solver, low, high, usual, feature, \
                       projected, unit, doc)                                                      \
  {#name,                                                                                         \
   offsetof(pbf_params, name),                                                                    \
   1,                                                                                             \
   CONDITIONAL_##when,                                                                            \
   usual,                                                                                         \
   PBF_SOLVER_##min_solver,                                                                       \
   PBF_FEATURE_##feature},
#define PBF_PARAM_REALS(offset, name, count, initial, low, high, projected, unit, doc) \
  {#name, offsetof(pbf_params, name), count, 0, 0, PBF_SOLVER_JACOBI, PBF_FEATURE_NONE},
#include "physics/params.def"
};

enum { TABLE_PARAMS = sizeof table_params / sizeof table_params[0] };

static inline void table_put(pbf_params *params, const table_param *param, uint32_t component,
                             double value) {
  memcpy((char *)params + param->offset + component * sizeof value, &value, sizeof value);
}

/* An optional parameter, with what it needs of others. */
static inline void table_turn_on(pbf_params *params, const table_param *param) {
  table_put(params, param, 0, param->usual);
  if (params->solver < param->min_solver) params->solver = param->min_solver;
  if (params->sleep_speed > 0) params->sleep_time = 0.5;
}

#endif
