/* Threads beside the actors, that disturb them. */
#ifndef PBF_TESTS_SOAK_HELPERS_H
#define PBF_TESTS_SOAK_HELPERS_H

#include "actor.h"

/* As the settings say; returns when they run, as many as could be started. */
void helpers_begin(const settings *with, uint64_t seed, actor *actors);
void helpers_end(void);

/* Shows a solver to them, or takes it away. */
void helpers_show(const actor *a);

/* Has a helper cancel what runs in this solver, again and again; 0: there is none for it. */
int helpers_cancel_soon(pbf_solver *solver);
void helpers_cancel_no_more(void);

#endif
