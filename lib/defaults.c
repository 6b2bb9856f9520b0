/* The values of what a caller does not set. */
#include <pbf/pbf.h>

#include "error.h"
#include "structs.h"

static pbf_status init(const pbf_struct_kind *kind, const void *defaults, void *theirs,
                       uint32_t size) {
  if (!theirs) {
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "the %s to fill is null", kind->name);
  }
  pbf_status status = pbf_struct_check_size(kind, size);
  if (status == PBF_OK) pbf_struct_out(kind, defaults, theirs, size);
  return status;
}

pbf_status pbf_desc_init(pbf_desc *desc, uint32_t struct_size) {
  static const pbf_desc defaults = {
      .api_version = PBF_API_VERSION,
      .dimension = 3,
      .precision = PBF_FLOAT32,
      .capacity = 100000,
      .backend = "auto",
  };
  return init(&pbf_kind_desc, &defaults, desc, struct_size);
}

pbf_status pbf_params_init(pbf_params *params, uint32_t struct_size) {
  static const pbf_params defaults = {
#define PBF_PARAM_INTEGER(offset, name, initial, type, min, max, hint, when, feature, doc) \
  .name = initial,
#define PBF_PARAM_REAL(offset, name, initial, range, when, min_solver, low, high, usual, feature, \
                       projected, unit, doc)                                                      \
  .name = initial,
#define PBF_PARAM_REALS(offset, name, count, initial, low, high, projected, unit, doc) \
  .name = initial,
#include "physics/params.def"
  };
  return init(&pbf_kind_params, &defaults, params, struct_size);
}

pbf_status pbf_collider_init(pbf_collider *collider, uint32_t struct_size, uint32_t shape) {
  if (shape > PBF_COLLIDER_SHAPE) {
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "shape is %u; it must be 0 … %d (PBF_COLLIDER_…)",
                    shape, PBF_COLLIDER_SHAPE);
  }
  const pbf_collider defaults = {
      .shape = shape,
      .orientation = {0, 0, 0, 1},
      .axis = {0, 1, 0},
      .half_extents = {1, 1, 1},
      .radius = 1,
      .half_length = 1,
      .scale = 1,
  };
  return init(&pbf_kind_collider, &defaults, collider, struct_size);
}
