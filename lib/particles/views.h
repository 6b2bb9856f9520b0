/* Views of fields in the memory of a backend. */
#ifndef PBF_LIB_PARTICLES_VIEWS_H
#define PBF_LIB_PARTICLES_VIEWS_H

#include "solver/solver.h"

/* A backend's view of a field with every member checked; counts nothing. */
pbf_status pbf_view_of(pbf_solver *solver, uint32_t field, pbf_view *view);

#endif
