/* A vector per particle, as one array for each component. */
#ifndef PBF_CPU_FIELD_H
#define PBF_CPU_FIELD_H

#include <stdint.h>

#include "physics/real.h"

/* Elements that may be read before the first and behind the last particle, for whole vectors and
 * tables; they hold numbers that do not matter. */
enum { FIELD_FRONT = 16, FIELD_BACK = 48 };

typedef struct field {
  pbf_real *c[PBF_DIM];
} field;

PBF_FN pbf_vec field_at(const field *f, uint32_t i) {
  pbf_vec a;
  for (int k = 0; k < PBF_DIM; ++k) a.c[k] = f->c[k][i];
  return a;
}

PBF_FN void field_set(const field *f, uint32_t i, pbf_vec a) {
  for (int k = 0; k < PBF_DIM; ++k) f->c[k][i] = a.c[k];
}

#endif
