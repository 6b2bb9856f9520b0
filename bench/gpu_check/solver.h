/* Solvers of scenes, through the public API alone. */
#ifndef PBF_BENCH_GPU_CHECK_SOLVER_H
#define PBF_BENCH_GPU_CHECK_SOLVER_H

#include "scenes.h"

/* "cuda" unless told otherwise. */
extern const char *checked_backend;

/* Ends the program where a call has failed: with 2 when there is no device, else with 1. */
void must(pbf_status status, const char *what);

/* Adds the scene's particles, by parts that need little memory, and sets its colliders. */
void fill(const scene *s, pbf_solver *solver, uint32_t precision);

pbf_solver *solver_for(const scene *s, const char *backend, uint32_t precision);

/* count x dim, to be freed. */
double *positions_of(pbf_solver *solver, uint32_t count, uint32_t dim, uint32_t precision);

pbf_stats stats_of(pbf_solver *solver);
uint64_t hash_of(pbf_solver *solver);

/* A saved state, to be freed. */
void *saved(pbf_solver *solver, uint64_t *size);

#endif
