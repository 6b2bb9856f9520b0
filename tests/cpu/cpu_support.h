/* What the tests of the CPU backends share. */
#ifndef PBF_TESTS_CPU_SUPPORT_H
#define PBF_TESTS_CPU_SUPPORT_H

#include "support.h"

/* A strict description for the backend of that name. */
pbf_desc cpu_desc(const char *backend, uint32_t dimension, uint32_t precision, uint32_t capacity,
                  uint32_t threads);

/* Adds particles at positions given in double. */
void cpu_add(pbf_solver *solver, uint32_t precision, uint32_t dimension, uint32_t count,
             const double *x, const double *v);

/* A column of 10 x 10 particles a layer, a little too dense, in 3D and float32. */
void cpu_add_column(pbf_solver *solver, uint32_t count);

/* All positions or velocities (PBF_FIELD_…) or densities in double; freed by the caller. */
double *cpu_get(pbf_solver *solver, uint32_t field);

/* Largest difference of two solvers' fields. */
double cpu_difference(pbf_solver *a, pbf_solver *b, uint32_t field);

/* Threads of the process. One that has been joined may be listed for a moment more. */
int cpu_threads_now(void);

/* Pseudo-random, in [0, 1); the same everywhere. */
double cpu_random(uint64_t *state);

/* A block of fluid, jittered by 2 % of the spacing, that moves as a gentle shear. Distances between
 * particles keep clear of the smoothing radius, 2.12 spacings, so that for a few short steps every
 * way of finding neighbours finds the same. */
typedef struct cpu_block {
  uint32_t dimension, count;
  double *x, *v;
} cpu_block;
cpu_block cpu_make_block(uint32_t dimension);
void cpu_free_block(cpu_block *block);
pbf_params cpu_block_params(void);

#endif
