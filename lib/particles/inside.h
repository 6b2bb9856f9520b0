/* Particles by where they are. */
#ifndef PBF_LIB_PARTICLES_INSIDE_H
#define PBF_LIB_PARTICLES_INSIDE_H

#include <pbf/pbf_backend.h>

#include "numbers.h"
#include "row_set.h"

/* Positions and, where not null, velocities of at least the particles in any of these boxes, in the
 * same order; with any result both to be freed. A backend that finds them itself gives no others,
 * so that of fluid on a device little comes to the host. */
pbf_status pbf_numbers_in_boxes(pbf_solver *solver, uint32_t count, const pbf_backend_box *boxes,
                                pbf_numbers *positions, pbf_numbers *velocities);

/* The row of an element of these, which are of all particles or of some; 0 where it is none. */
int pbf_numbers_row(const pbf_solver *solver, const pbf_numbers *numbers, uint32_t element,
                    uint32_t *row);

/* Whether a point is in what is meant, which is within the boxes. */
typedef int (*pbf_has_point_fn)(const void *what, const double point[3]);

/* Adds the rows of the particles there. */
pbf_status pbf_row_set_add_inside(pbf_solver *solver, uint32_t count, const pbf_backend_box *boxes,
                                  pbf_has_point_fn has, const void *what, pbf_row_set *set);

#endif
