/* Creation of a solver, also as a world of a batch. */
#ifndef PBF_LIB_SOLVER_CREATE_H
#define PBF_LIB_SOLVER_CREATE_H

#include <pbf/pbf.h>

/* pbf_create, of one of the `worlds` of a batch (0: of none); no pointer is null but for `params`.
 */
pbf_status pbf_create_world(const pbf_desc *desc, const pbf_params *params, uint32_t worlds,
                            pbf_solver **solver);

#endif
