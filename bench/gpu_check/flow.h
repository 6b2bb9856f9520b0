/* What comes into a scene and leaves it: an emitter above the fluid, for which the oldest particles
 * make way, a drain in a corner, a reservoir in another one. */
#ifndef PBF_BENCH_GPU_CHECK_FLOW_H
#define PBF_BENCH_GPU_CHECK_FLOW_H

#include "scenes.h"

/* Whether it is the name of one of them, or "flow", which is all. */
int is_flow(const char *name);

/* Adds what the scene's `flow` names. */
void add_flow(const scene *s, pbf_solver *solver);

#endif
