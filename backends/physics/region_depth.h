/* How deep fluid stands in the parts of a region that hold it, told level by level. Host only. */
#ifndef PBF_PHYSICS_REGION_DEPTH_H
#define PBF_PHYSICS_REGION_DEPTH_H

#include <math.h>

#include "physics/real.h"

/* Points are spaced evenly in a region. */
enum {
  PBF_BASIN_POINTS = 12, /* along an axis */
  PBF_BASIN_LEVEL = PBF_DIM == 3 ? PBF_BASIN_POINTS * PBF_BASIN_POINTS : PBF_BASIN_POINTS,
  PBF_BASIN_ALL = PBF_BASIN_LEVEL * PBF_BASIN_POINTS
};

/* Of the parts with so many levels the fewest points, 0 where there are none, and how many of these
 * are below the highest level. For any amount of fluid one of these is the deepest. */
typedef struct pbf_region_basins {
  uint32_t fewest[PBF_BASIN_POINTS + 1], below[PBF_BASIN_POINTS + 1];
  double height, volume; /* that a point stands for */
} pbf_region_basins;

static inline void pbf_basin_note(pbf_region_basins *basins, int levels, uint32_t points,
                                  uint32_t below) {
  uint32_t *fewest = &basins->fewest[levels];
  if (*fewest && points >= *fewest) return;
  *fewest = points;
  basins->below[levels] = below;
}

/* The largest depth of so much fluid in one of them. What does not fill the levels below another
 * one is found in those. */
static inline double pbf_region_depth(const pbf_region_basins *basins, double fluid) {
  const double points = fluid / basins->volume;
  double depth = 0;
  for (int levels = 1; levels <= PBF_BASIN_POINTS; ++levels) {
    const double fewest = basins->fewest[levels], below = basins->below[levels];
    if (!(fewest > 0 && points > below)) continue;
    const double part = fmin((points - below) / (fewest - below), 1);
    depth = fmax(depth, (levels - 1 + part) * basins->height);
  }
  return depth;
}

#endif
