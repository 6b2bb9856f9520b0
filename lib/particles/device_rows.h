/* Rows of particles in the caller's memory on the device that a solver runs on. */
#ifndef PBF_LIB_PARTICLES_DEVICE_ROWS_H
#define PBF_LIB_PARTICLES_DEVICE_ROWS_H

#include "solver/solver.h"

/* Whether `device_type` is that of the solver's device, and not the host's memory, in *is_device;
 * `call` is "read" or "write". */
pbf_status pbf_device_rows_check(const pbf_solver *solver, const char *call, uint32_t device_type,
                                 uint32_t reserved, const void *stream, int *is_device);

/* By the backend's extension. */
pbf_status pbf_device_rows_read(pbf_solver *solver, const pbf_device_rows *to);
pbf_status pbf_device_rows_write(pbf_solver *solver, const pbf_device_rows *from);
pbf_status pbf_device_rows_fetch(pbf_solver *solver, const pbf_device_rows *from, void *to);

#endif
