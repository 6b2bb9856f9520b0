/* Boxes in which the fluid always stands equally deep. */
#ifndef PBF_LIB_EMISSION_RESERVOIR_H
#define PBF_LIB_EMISSION_RESERVOIR_H

#include "emission.h"
#include "particles/inside.h"
#include "query/volume.h"

/* A reservoir as its points are asked for. */
typedef struct pbf_reservoir_frame {
  pbf_volume_frame box;
  double spacing;
  double lower, upper; /* along the box's y axis, from its middle: where fluid stands */
  uint32_t cells[2];   /* across it; in 2D one of them is 1 */
  double cell[2];      /* their sizes, a spacing or a little more */
  double particles;    /* that fill it, a whole number */
} pbf_reservoir_frame;

pbf_volume pbf_reservoir_box(const pbf_reservoir *reservoir);
pbf_reservoir_frame pbf_reservoir_frame_of(const pbf_reservoir *reservoir, uint32_t dimension,
                                           double spacing);

/* Its numbers by themselves; messages call it reservoirs[index]. */
pbf_status pbf_reservoir_check(const pbf_reservoir *reservoir, uint32_t index, pbf_check_kind kind);

/* What 2D ignores becomes as pbf_reservoir_init gives it. */
void pbf_reservoir_clean(pbf_reservoir *reservoir, uint32_t dimension);

/* Adds the highest particles to `out` that are too many in it, of those that are not there yet. */
pbf_status pbf_reservoir_mark(pbf_solver *solver, const pbf_reservoir *reservoir, pbf_row_set *out,
                              uint64_t *removed);

/* What comes into the one of that number; counted on from the last one on, what each pushes. */
pbf_status pbf_reservoir_stage(pbf_solver *solver, pbf_emission *e, uint32_t number);

#endif
