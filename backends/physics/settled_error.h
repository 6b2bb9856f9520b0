/* What steps leave of a density error, by how deep the fluid stands and whether a grid carries its
 * weight. Host only, float64. */
#ifndef PBF_PHYSICS_SETTLED_ERROR_H
#define PBF_PHYSICS_SETTLED_ERROR_H

#include "physics/pressure_grid/grid.h"
#include "physics/schedule.h"

/* How many layers of so many particles stand upon each other. Where no grid could be wanted between
 * colliders, how deep fluid is there is not looked for. */
static inline double pbf_settled_layers(const pbf_params *params, pbf_basins *basins,
                                        uint32_t colliders, const pbf_collider *list,
                                        uint32_t count) {
  const pbf_settled s = pbf_settled_of(params, colliders, list, count);
  double depth = s.depth, deepest = pbf_basins_deepest(basins, params, colliders, list, s.axis);
  if (deepest > depth && pbf_depth_is_beyond_left(params, s.axis, fmin(deepest, s.height))) {
    pbf_basins_find(basins, params);
    depth = fmax(depth, pbf_basins_depth(basins, s.fluid));
  }
  return depth / pbf_derive_spacing(params);
}

/* What steps that leave `error` for each layer leave under all fluid at rest: all of that, or what
 * a grid leaves, which carries a part of several fluids (phases.h). */
static inline double pbf_settled_error(const pbf_params *params, pbf_basins *basins,
                                       uint32_t colliders, const pbf_collider *list, uint32_t count,
                                       const pbf_phase_table *phases, double error, double most) {
  if (!(PBF_BUILT & PBF_FEATURE_CHEBYSHEV)) return -1; /* no overlap is undone */
  if (!(pbf_error_per_layer(params, PBF_DIM) > 0)) return -1;
  const pbf_params p = pbf_with_error_per_layer(params, error);
  const double layers = pbf_settled_layers(&p, basins, colliders, list, count);
  const double cells = PBF_BUILT & PBF_FEATURE_PRESSURE_GRID
                           ? pbf_depth_grid(&p, basins, colliders, list, count, most, phases)
                           : 0;
  if (!(cells > 0)) return error * layers;
  const double width = cells * p.smoothing_radius;
  const double push = pbf_weight_of(&p, PBF_DIM) * p.time_step * p.time_step / width;
  const int corrects_shear = pbf_depth_corrects_shear(&p, basins, colliders, list, count);
  pbf_pressure_grid c;
  memset(&c, 0, sizeof c);
  c.error = pbf_depth_error(&p, width * width);
  c.max_left = corrects_shear ? PBF_DEPTH_SHEARED_LEFT : 1;
  c.left_cells = PBF_DEPTH_SHEARED_LEFT_LAYERS * pbf_derive_spacing(&p) / width;
  const double carried = pbf_carried_density(phases);
  const double all = c.error * push * layers * pbf_derive_spacing(&p) / width;
  return (1 - carried * pbf_pressure_grid_part(&c, all, push)) * error * layers;
}

#endif
