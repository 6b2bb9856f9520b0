/* Points that a caller gives. */
#ifndef PBF_LIB_QUERY_POINTS_H
#define PBF_LIB_QUERY_POINTS_H

#include "solver/solver.h"

/* `count` vectors of the solver's dimension: not null, aligned, every number finite. */
pbf_status pbf_query_check_points(const pbf_solver *solver, const char *name, uint32_t count,
                                  const double *points);

#endif
