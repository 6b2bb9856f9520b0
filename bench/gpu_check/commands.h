/* The commands; each prints a JSON object a line. */
#ifndef PBF_BENCH_GPU_CHECK_COMMANDS_H
#define PBF_BENCH_GPU_CHECK_COMMANDS_H

#include "scenes.h"

/* Distances to the float64 reference, of the scenes of that name, of a part of them ("2d-f32",
 * "2d-f64", "3d-f32", "3d-f64", "large") or, where it is null, of all. Returns how many were too
 * far. */
int verify_all(const char *name);

/* Whether two runs, and one from a saved state, have the same bits. Returns how many had not. */
int same_all(void);

/* Every call and stage once, small. */
void exercise_all(void);

/* Scenes drawn from these seeds, held against the reference: returns how many came out otherwise.
 */
int random_all(uint64_t first, uint64_t count);

/* `steps` steps after `lead_in`, five times. */
void time_scene(const scene *s, uint32_t precision, uint32_t lead_in, uint32_t steps);

/* A dam of so many particles that breaks over solids ("box", "hull" or "mesh"), all over the water;
 * returns 0 where there is no such solid. `moves`: they move and turn. */
int time_solids(uint32_t particles, uint32_t solids, const char *shape, int moves);

#endif
