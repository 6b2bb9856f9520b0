/* What a caller who sets nothing gets. */
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
      .kernel = PBF_KERNEL_WENDLAND_C2,
      .smoothing_radius = 0.1,
      .time_step = 1.0 / 120,
      .iterations = 4,
      .collide = PBF_COLLIDE_AFTER_PREDICTION | PBF_COLLIDE_IN_ITERATION,
      .gravity = {0, -9.81, 0},
      .solver = PBF_SOLVER_CHEBYSHEV,
      .separation = 1,
      .pressure_grid = -1,
      .min_diagonal = 1,
      .wall_density = 1,
      .scorr_dq = 0.2,
      .scorr_n = 4,
      .domain_max = {1, 1, 1},
      .prestabilization = 0.02,
  };
  return init(&pbf_kind_params, &defaults, params, struct_size);
}

pbf_status pbf_collider_init(pbf_collider *collider, uint32_t struct_size, uint32_t shape) {
  if (shape > PBF_COLLIDER_BOX) {
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "shape is %u; it must be 0 … %d (PBF_COLLIDER_…)",
                    shape, PBF_COLLIDER_BOX);
  }
  const pbf_collider defaults = {
      .shape = shape,
      .orientation = {0, 0, 0, 1},
      .axis = {0, 1, 0},
      .half_extents = {1, 1, 1},
      .radius = 1,
      .half_length = 1,
  };
  return init(&pbf_kind_collider, &defaults, collider, struct_size);
}
