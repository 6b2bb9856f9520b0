/* What the fluid makes: the births of diffuse.h. */
#ifndef PBF_LIB_DIFFUSE_GENERATE_H
#define PBF_LIB_DIFFUSE_GENERATE_H

#include "fluid.h"
#include "solids.h"

/* In a time that has passed, to the solver's time. */
void pbf_diffuse_generate(const pbf_solver *solver, pbf_fluid *fluid,
                          const pbf_diffuse_walls *walls, double elapsed);

/* By how many neighbours of the fluid there are. */
uint32_t pbf_diffuse_kind(const pbf_diffuse_desc *desc, uint32_t neighbors);

#endif
