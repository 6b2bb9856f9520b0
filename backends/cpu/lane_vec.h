/* Vectors, a particle's in each lane. */
#ifndef PBF_CPU_LANE_VEC_H
#define PBF_CPU_LANE_VEC_H

#include "cpu/blocks.h"

typedef struct lane_vec {
  lane c[PBF_DIM];
} lane_vec;

typedef struct table_vec {
  table c[PBF_DIM];
} table_vec;

PBF_FN lane_vec lane_vec_zero(void) {
  lane_vec a;
  for (int k = 0; k < PBF_DIM; ++k) a.c[k] = lane_set(0);
  return a;
}

PBF_FN lane_vec lane_vec_load(const field *f, uint32_t i) {
  lane_vec a;
  for (int k = 0; k < PBF_DIM; ++k) a.c[k] = lane_load(f->c[k] + i);
  return a;
}

PBF_FN table_vec table_vec_of(const field *f, const block *b, pbf_real sentinel) {
  table_vec t;
  for (int k = 0; k < PBF_DIM; ++k) t.c[k] = table_of(f->c[k], b->first, k ? 0 : sentinel);
  return t;
}

/* a - table[p] */
PBF_FN lane_vec lane_vec_minus(const lane_vec *a, const table_vec *t, place p) {
  lane_vec d;
  for (int k = 0; k < PBF_DIM; ++k) d.c[k] = a->c[k] - table_at(&t->c[k], p);
  return d;
}

PBF_FN lane lane_vec_dot(const lane_vec *a, const lane_vec *b) {
  lane sum = a->c[0] * b->c[0];
  for (int k = 1; k < PBF_DIM; ++k) sum = lane_fma(a->c[k], b->c[k], sum);
  return sum;
}

PBF_FN lane_vec lane_vec_apart(const lane_vec *a, const lane_vec *b) {
  lane_vec apart;
  for (int k = 0; k < PBF_DIM; ++k) apart.c[k] = a->c[k] - b->c[k];
  return apart;
}

PBF_FN void lane_vec_add_scaled(lane_vec *a, lane s, const lane_vec *b) {
  for (int k = 0; k < PBF_DIM; ++k) a->c[k] = lane_fma(s, b->c[k], a->c[k]);
}

PBF_FN void lane_vec_scale(lane_vec *a, lane s) {
  for (int k = 0; k < PBF_DIM; ++k) a->c[k] = a->c[k] * s;
}

/* The lanes' values, one after another. */
typedef struct lane_values {
  _Alignas(64) pbf_real c[PBF_DIM][WIDTH];
} lane_values;

PBF_FN lane_values lane_vec_values(const lane_vec *a) {
  lane_values v;
  for (int k = 0; k < PBF_DIM; ++k) lane_store(v.c[k], a->c[k]);
  return v;
}

PBF_FN pbf_vec lane_value(const lane_values *v, uint32_t l) {
  pbf_vec a;
  for (int k = 0; k < PBF_DIM; ++k) a.c[k] = v->c[k][l];
  return a;
}

/* Of as many particles as there are lanes, or fewer. */
PBF_FN lane_values load_lanes(const field *f, uint32_t first, uint32_t lanes) {
  lane_values a;
  memset(&a, 0, sizeof a);
  for (int k = 0; k < PBF_DIM; ++k) memcpy(a.c[k], f->c[k] + first, lanes * sizeof(pbf_real));
  return a;
}

PBF_FN void store_lanes(const field *f, uint32_t first, uint32_t lanes, const lane_values *a) {
  for (int k = 0; k < PBF_DIM; ++k) memcpy(f->c[k] + first, a->c[k], lanes * sizeof(pbf_real));
}

PBF_FN void set_lane(lane_values *a, uint32_t l, pbf_vec value) {
  for (int k = 0; k < PBF_DIM; ++k) a->c[k][l] = value.c[k];
}

#endif
