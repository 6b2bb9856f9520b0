/* Numbers of particles, as they lie in the memory of a backend, where that is the host's, or in a
 * copy by rows. */
#ifndef PBF_LIB_PARTICLES_NUMBERS_H
#define PBF_LIB_PARTICLES_NUMBERS_H

#include <string.h>

#include "solver/solver.h"

typedef struct pbf_numbers {
  const char *data; /* null: none */
  int64_t particle_stride, component_stride;
  uint32_t elements;
  const uint32_t *ids; /* of elements; null: they are the rows that were asked for */
  void *copy;          /* or null */
  uint64_t bytes;
} pbf_numbers;

/* Position or velocity, of all particles or of these rows; with any result to be freed. */
pbf_status pbf_numbers_find(pbf_solver *solver, uint32_t field, uint32_t first, uint32_t count,
                            pbf_numbers *numbers);

/* Whether that has to copy them: in *copies. */
pbf_status pbf_numbers_need_copies(pbf_solver *solver, int *copies);

/* The same, where a copy goes to memory of the caller's, which has room for it. */
pbf_status pbf_numbers_find_in(pbf_solver *solver, uint32_t field, uint32_t first, uint32_t count,
                               void *memory, pbf_numbers *numbers);

/* A field of these rows, copied; with any result to be freed. */
pbf_status pbf_numbers_copy(pbf_solver *solver, uint32_t field, uint32_t first, uint32_t count,
                            pbf_numbers *numbers);

void pbf_numbers_free(const pbf_solver *solver, const pbf_numbers *numbers);

static inline double pbf_numbers_get(const pbf_numbers *n, uint64_t element, uint32_t component,
                                     uint32_t precision) {
  const char *at =
      n->data + (int64_t)element * n->particle_stride + component * n->component_stride;
  float single;
  double number;
  if (precision == PBF_FLOAT32) {
    memcpy(&single, at, sizeof single);
    return (double)single;
  }
  memcpy(&number, at, sizeof number);
  return number;
}

#endif
