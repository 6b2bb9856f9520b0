/* Part of driver.h. What pair loops look up of neighbours: where they are, one number more, and
 * some other vector. Either the windows of a block are in registers, field by field, or the four
 * reals of each particle lie side by side in memory, a quad, and a lane gets all of its neighbour's
 * with one load. */
#ifndef PBF_CPU_NEIGHBORS_H
#define PBF_CPU_NEIGHBORS_H

#include "cpu/lane_values.h"

namespace {

/* A pair in each lane: particle i, and the one at a place in the block's windows. */
struct pair_lanes {
#ifdef LANES_QUADS
  const uint8_t *j; /* slots */
#else
  lane_indices j;
#endif
  lane_vector<lane> x_ij;
  lane r2;
#ifdef LANES_QUADS
  lane number;
#endif
};

PBF_FN lane dot(const lane_vector<lane> &a, const lane_vector<lane> &b) {
  lane sum = a.c[0] * b.c[0];
  for (int k = 1; k < PBF_DIM; ++k) sum = ops<lane>::multiply_add(a.c[k], b.c[k], sum);
  return sum;
}

#ifdef LANES_QUADS

/* Where the quads of a block's slots begin, in halves of a quad. */
struct block_places {
  alignas(64) int32_t of[PARTS * SLOTS];
};

struct neighbor_table {
  const pbf_real *quads;
  const int32_t *places;
};

PBF_FN void lay_out(const block *b, block_places *places) {
  for (uint32_t part = 0; part < b->parts; ++part)
    for (uint32_t slot = 0; slot < SLOTS; ++slot)
      places->of[part * SLOTS + slot] = (int32_t)(2 * (b->first[part] + slot - 1));
  places->of[0] = -2;
}

/* `number` is in the quads already. */
PBF_FN neighbor_table neighbors_in(const block *b, const pair_pass *p, const pbf_real *number,
                                   block_places *places) {
  (void)number;
  lay_out(b, places);
  return {p->quads, places->of};
}

PBF_FN pair_lanes pairs_listed(const block *b, const uint8_t *list, const lane_vector<lane> &x,
                               const neighbor_table *around) {
  lane quad[4];
  (void)b;
  pair_lanes p = {.j = list};
  load_packed(around->quads, around->places, p.j, quad);
  for (int k = 0; k < PBF_DIM; ++k) p.x_ij.c[k] = x.c[k] - quad[k];
  p.r2 = dot(p.x_ij, p.x_ij);
  p.number = quad[3];
  return p;
}

PBF_FN lane number_of(const neighbor_table *around, const pair_lanes *p) {
  (void)around;
  return p->number;
}

/* Of another vector, and a second number with it: what pack has made of them. */
typedef neighbor_table vector_table;

PBF_FN vector_table vectors_in(const block *b, const pair_pass *p, const field *v,
                               const pbf_real *second, const block_places *places) {
  (void)b;
  (void)v;
  (void)second;
  return {p->vectors, places->of};
}

/* `second` null: without. */
PBF_FN lane_vector<lane> vector_of(const vector_table *t, const uint8_t *j, lane *second) {
  lane quad[4];
  lane_vector<lane> v;
  load_packed(t->quads, t->places, j, quad);
  for (int k = 0; k < PBF_DIM; ++k) v.c[k] = quad[k];
  if (second) *second = quad[3];
  return v;
}

static inline void pack(field x, const pbf_real *number, pbf_real *quads, uint32_t first,
                        uint32_t last) {
  uint32_t i = first;
  for (; last - i >= WIDTH; i += WIDTH) {
    lane quad[4] = {lane_load(x.c[0] + i), lane_load(x.c[1] + i), ops<lane>::set(0),
                    ops<lane>::set(0)};
    if (PBF_DIM == 3) quad[2] = lane_load(x.c[PBF_DIM - 1] + i);
    if (number) quad[3] = lane_load(number + i);
    store_packed(quads + 4 * (uint64_t)i, quad);
  }
  for (; i < last; ++i) {
    pbf_real *quad = quads + 4 * (uint64_t)i;
    for (int k = 0; k < PBF_DIM; ++k) quad[k] = x.c[k][i];
    quad[3] = number ? number[i] : 0;
  }
}

#else

/* Tables of a vector's components, and of a number with it; `sentinel` is the first of what is no
 * neighbour. */
struct vector_table {
  window c[PBF_DIM], second;
};

PBF_FN vector_table vector_table_of(const field *f, const block *b, pbf_real sentinel) {
  vector_table t;
  for (int k = 0; k < PBF_DIM; ++k) t.c[k] = window_of(f->c[k], b->first, k ? 0 : sentinel);
  return t;
}

struct neighbor_table {
  vector_table x;
  window number;
};

struct block_places {};

PBF_FN neighbor_table neighbors_in(const block *b, const pair_pass *p, const pbf_real *number,
                                   block_places *) {
  neighbor_table around = {.x = vector_table_of(&p->x, b, p->lists.far)};
  if (number) around.number = window_of(number, b->first, 0);
  return around;
}

PBF_FN pair_lanes pairs_listed(const block *b, const uint8_t *list, const lane_vector<lane> &x,
                               const neighbor_table *around) {
  pair_lanes p;
  p.j = lane_indices_of(b->first, u32_of_bytes(list));
  for (int k = 0; k < PBF_DIM; ++k) p.x_ij.c[k] = x.c[k] - window_at(&around->x.c[k], p.j);
  p.r2 = dot(p.x_ij, p.x_ij);
  return p;
}

PBF_FN lane number_of(const neighbor_table *around, const pair_lanes *p) {
  return window_at(&around->number, p->j);
}

PBF_FN vector_table vectors_in(const block *b, const pair_pass *p, const field *v,
                               const pbf_real *second, const block_places *) {
  (void)p;
  vector_table t = vector_table_of(v, b, 0);
  if (second) t.second = window_of(second, b->first, 0);
  return t;
}

/* `second` null: without. */
PBF_FN lane_vector<lane> vector_of(const vector_table *t, lane_indices j, lane *second) {
  lane_vector<lane> v;
  for (int k = 0; k < PBF_DIM; ++k) v.c[k] = window_at(&t->c[k], j);
  if (second) *second = window_at(&t->second, j);
  return v;
}

#endif

}  // namespace

#endif
