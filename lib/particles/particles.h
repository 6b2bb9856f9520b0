/* Rows of particles: checks of them, and fields that are read and written. */
#ifndef PBF_LIB_PARTICLES_PARTICLES_H
#define PBF_LIB_PARTICLES_PARTICLES_H

#include "solver/solver.h"

/* Fails where the backend, or the way in which it solves now, keeps no pressures. */
pbf_status pbf_check_pressures(const pbf_solver *solver);

/* Fails where there are no such rows. */
pbf_status pbf_check_rows(const pbf_solver *solver, uint32_t first, uint32_t count);

/* Reads a field of rows that there are, ascending by id. */
pbf_status pbf_read_rows(pbf_solver *solver, uint32_t field, uint32_t first, uint32_t count,
                         void *out);

/* Overwrites PBF_FIELD_POSITION or PBF_FIELD_VELOCITY, checked. */
pbf_status pbf_write_field(pbf_solver *solver, uint32_t field, uint32_t first, uint32_t count,
                           const void *in);

/* Reads a field (PBF_BACKEND_FIELD_REST, too) of all particles, ascending by id. */
pbf_status pbf_read_all(pbf_solver *solver, uint32_t field, void *out);

#endif
