/* Views on ranks, of which each has a part of the particles: of a copy of all, in the order of
 * adding, in host memory that stays until pbf_destroy. */
#ifndef PBF_LIB_PARTICLES_RANK_VIEWS_H
#define PBF_LIB_PARTICLES_RANK_VIEWS_H

#include "solver/solver.h"

/* All but what pbf_view_of fills in. On all ranks. */
pbf_status pbf_rank_view_of(pbf_solver *solver, uint32_t field, pbf_view *view);

void pbf_rank_views_free(pbf_solver *solver);

#endif
