/* What ranks must have in common that the library keeps itself, as emitters. */
#ifndef PBF_LIB_SOLVER_RANK_SETTINGS_H
#define PBF_LIB_SOLVER_RANK_SETTINGS_H

#include "solver.h"

/* Has the backend of a solver on ranks compare `bytes` that a call has set with those of the other
 * ranks, in the next call that needs all. `call` is that call's name. */
void pbf_rank_settings_note(pbf_solver *solver, const char *call, const void *data, uint64_t bytes);

/* The same of what steps read for, which may be set and taken back: snapshots, previous positions.
 */
void pbf_rank_settings_tell(pbf_solver *solver);

#endif
