/* Starts that are too dense are moved apart before they are stepped. */
#ifndef PBF_LIB_PRESTABILIZE_H
#define PBF_LIB_PRESTABILIZE_H

#include "solver.h"

/* Where the next step is the first since a start, and params.prestabilization asks for it. */
pbf_status pbf_prestabilize(pbf_solver *solver);

/* 1 where fluid at rest before this change of parameters may be too dense after it. */
int pbf_params_make_start(const pbf_params *before, const pbf_params *after);

#endif
