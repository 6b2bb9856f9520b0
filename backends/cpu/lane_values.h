/* Vectors of a group's particles: in lanes, or the lanes' values one after another. */
#ifndef PBF_CPU_LANE_VALUES_H
#define PBF_CPU_LANE_VALUES_H

#include "cpu/blocks.h"

PBF_FN lane_vector<lane> load_vector(const field &f, uint32_t i) {
  lane_vector<lane> a;
  for (int k = 0; k < PBF_DIM; ++k) a.c[k] = lane_load(f.c[k] + i);
  return a;
}

/* The lanes' values, one after another. */
typedef struct lane_values {
  _Alignas(64) pbf_real c[PBF_DIM][WIDTH];
} lane_values;

PBF_FN lane_values values_of(const lane_vector<lane> &a) {
  lane_values v;
  for (int k = 0; k < PBF_DIM; ++k) lane_store(v.c[k], a.c[k]);
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

/* The same, with the first one in all other lanes. */
PBF_FN lane_values load_some_lanes(const field *f, uint32_t first, uint32_t lanes) {
  lane_values a = load_lanes(f, first, lanes);
  for (uint32_t l = lanes; l < WIDTH; ++l)
    for (int k = 0; k < PBF_DIM; ++k) a.c[k][l] = a.c[k][0];
  return a;
}

PBF_FN void store_lanes(const field *f, uint32_t first, uint32_t lanes, const lane_values *a) {
  for (int k = 0; k < PBF_DIM; ++k) memcpy(f->c[k] + first, a->c[k], lanes * sizeof(pbf_real));
}

PBF_FN void set_lane(lane_values *a, uint32_t l, pbf_vec value) {
  for (int k = 0; k < PBF_DIM; ++k) a->c[k][l] = value.c[k];
}

#endif
