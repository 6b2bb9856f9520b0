/* Where a reservoir's fluid stands. */
#include <math.h>
#include <string.h>

#include "reservoir.h"

pbf_volume pbf_reservoir_box(const pbf_reservoir *r) {
  pbf_volume box = {.struct_size = sizeof box, .shape = PBF_VOLUME_BOX};
  memcpy(box.position, r->position, sizeof box.position);
  memcpy(box.orientation, r->orientation, sizeof box.orientation);
  memcpy(box.half_extents, r->half_extents, sizeof box.half_extents);
  return box;
}

pbf_reservoir_frame pbf_reservoir_frame_of(const pbf_reservoir *r, uint32_t dimension,
                                           double spacing) {
  const pbf_volume box = pbf_reservoir_box(r);
  pbf_reservoir_frame f = {.box = pbf_volume_frame_of(&box, dimension),
                           .spacing = spacing,
                           .lower = -r->half_extents[1],
                           .upper = -r->half_extents[1] + r->depth,
                           .particles = r->depth / spacing};
  for (uint32_t side = 0; side < 2; ++side) {
    const double width = 2 * r->half_extents[2 * side];
    /* A hair more, for widths that are whole numbers of spacings but for rounding. */
    const double fit = floor(width / spacing + 0.01);
    const int is_flat = side == 1 && dimension == 2;
    f.cells[side] = is_flat || fit < 1 ? 1 : (uint32_t)fmin(fit, PBF_MAX_CAPACITY);
    f.cell[side] = is_flat ? 0 : width / f.cells[side];
    if (!is_flat) f.particles *= width / spacing;
  }
  f.particles = floor(f.particles + 0.5);
  return f;
}
