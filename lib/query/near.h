/* Particles of a run near a point. That they are found first and summed up then keeps branches that
 * go one way as often as the other out of both. */
#ifndef PBF_LIB_QUERY_NEAR_H
#define PBF_LIB_QUERY_NEAR_H

#include "index.h"

enum { PBF_NEAR = 64 };

/* Of a part of a run. */
typedef struct pbf_near {
  uint32_t count, particles[PBF_NEAR];
  double squares[PBF_NEAR], ways[PBF_NEAR][3]; /* from the point, in units of the radius */
} pbf_near;

/* Those of a run from *begin on, which goes to where the next ones begin. */
void pbf_near_find(const pbf_query_index *index, const double *point, double inv_radius,
                   const pbf_query_run *run, uint32_t *begin, pbf_near *n);

#endif
