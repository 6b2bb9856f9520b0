/* Checks of an emitter. */
#ifndef PBF_LIB_EMISSION_EMITTER_H
#define PBF_LIB_EMISSION_EMITTER_H

#include <pbf/emit.h>

#include "solver/solver.h"

/* Its numbers by themselves; messages call it emitters[index]. */
pbf_status pbf_emitter_check(const pbf_emitter *emitter, uint32_t index, pbf_check_kind kind);

/* In the solver as it is now: its columns are in the domain, and its rate is one that they carry
 * and the solver can hold. */
pbf_status pbf_emitter_check_place(const pbf_emitter *emitter, uint32_t index,
                                   const pbf_solver *solver);

/* Whether columns of both are at the same places, and their streams one. */
int pbf_emitters_share(const pbf_emitter *one, const pbf_emitter *other, uint32_t dimension);

/* What its shape and the dimension ignore becomes as pbf_emitter_init gives it. */
void pbf_emitter_clean(pbf_emitter *emitter, uint32_t dimension);

#endif
