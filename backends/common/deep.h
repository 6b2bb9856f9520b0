/* The coarse grid's memory on a host, and what there is to do about the fluid on it. */
#ifndef PBF_COMMON_DEEP_H
#define PBF_COMMON_DEEP_H

#include "common/memory.h"
#include "physics/coarse_nodes.h"
#include "physics/constants.h"

/* Nodes first … last - 1. */
typedef struct pbf_deep_run {
  uint32_t first, last;
} pbf_deep_run;

typedef struct pbf_deep {
  pbf_coarse grid;                 /* of this step */
  int64_t *sums;                   /* of cells: pbf_coarse_entry; the first of all arrays */
  int64_t *places;                 /* of cells: pbf_coarse_place_entry */
  double *rooms, *parts, *weights; /* of cells: weights are rooms over parts */
  double *depths, *right, *inverse, *lambda, *before; /* of nodes */
  pbf_deep_run *runs; /* all nodes that are not in the open are in one, in their order … */
  uint32_t count;     /* of so many; unless every node is looked at */
} pbf_deep;

/* Words of 8 bytes in all arrays. */
static inline uint64_t pbf_deep_words(uint32_t capacity) {
  enum { ARRAYS = 11 };
  return ARRAYS * (uint64_t)pbf_coarse_limit(capacity);
}

/* Takes the memory or releases it; false when there is none. What lies behind the last node is
 * read, and counts for nothing unless it is no number: it begins as 0. */
static inline bool pbf_deep_keep(pbf_memory *memory, pbf_deep *deep, bool wanted, const char *name,
                                 uint32_t capacity) {
  bool taken = wanted && !deep->sums;
  if (!pbf_memory_keep(memory, wanted, name, pbf_deep_words(capacity), 0, &deep->sums))
    return false;
  if (!taken) return true;
  uint64_t limit = pbf_coarse_limit(capacity);
  deep->places = deep->sums + limit;
  double *next = (double *)deep->places;
  double **const arrays[] = {&deep->rooms, &deep->parts,   &deep->weights, &deep->depths,
                             &deep->right, &deep->inverse, &deep->lambda,  &deep->before};
  for (unsigned k = 0; k < sizeof arrays / sizeof arrays[0]; ++k) *arrays[k] = next += limit;
  deep->runs = (pbf_deep_run *)(next + limit);
  return true;
}

/* Before particles add to the sums. */
static inline void pbf_deep_begin(pbf_deep *deep, const pbf_params *params, uint32_t capacity,
                                  const pbf_obstacles *o) {
  pbf_domain domain = o->domain;
  for (int k = 0; k < pbf_surface_count(*o); ++k)
    domain = pbf_domain_within(domain, &o->surfaces[k]);
  deep->grid = pbf_coarse_between(params, &domain, pbf_coarse_limit(capacity));
  memset(deep->sums, 0, deep->grid.nodes * sizeof *deep->sums);
  memset(deep->places, 0, deep->grid.nodes * sizeof *deep->places);
}

/* Indices, up to the last of them along each axis. */
typedef struct pbf_deep_box {
  int first[PBF_DIM], last[PBF_DIM];
} pbf_deep_box;

/* A walk through the rows of a box along the first axis: the index of the place (0, i[1], i[2]),
 * and on to the next. Returns 0 after the last. */
static inline uint32_t pbf_deep_row(const pbf_coarse *c, const int i[PBF_DIM]) {
  uint32_t row = 0;
  for (int k = PBF_DIM - 1; k > 0; --k) row = (row + (uint32_t)i[k]) * c->size[k - 1];
  return row;
}

static inline int pbf_deep_next_row(const pbf_deep_box *box, int i[PBF_DIM]) {
  for (int k = 1; k < PBF_DIM; ++k) {
    if (++i[k] <= box->last[k]) return 1;
    i[k] = box->first[k];
  }
  return 0;
}

static inline void pbf_deep_extend(const pbf_coarse *c, pbf_coarse_extent *extent,
                                   const int i[PBF_DIM]) {
  for (int k = 0; k < PBF_DIM; ++k) {
    uint32_t above = (uint32_t)i[k], below = (uint32_t)(c->n[k] + 1 - i[k]);
    if (above > extent->above[k]) extent->above[k] = above;
    if (below > extent->below[k]) extent->below[k] = below;
  }
}

/* The room of the cells in a box outside which there is no fluid, and what is to be done about that
 * in them. */
static inline pbf_pressure_grid_source_scale pbf_grid_pressure_source_scale(
    pbf_deep *deep, const pbf_obstacles *o, const pbf_deep_box *box) {
  const pbf_coarse *c = &deep->grid;
  pbf_coarse_extent extent = {{0}, {0}};
  int i[PBF_DIM];
  memcpy(i, box->first, sizeof i);
  do {
    uint32_t row = pbf_deep_row(c, i);
    for (i[0] = box->first[0]; i[0] <= box->last[0]; ++i[0]) {
      uint32_t cell = row + (uint32_t)i[0];
      deep->rooms[cell] = pbf_coarse_room_at(c, *o, i);
      if (pbf_coarse_is_filled(c, deep->sums[cell], deep->rooms[cell]))
        pbf_deep_extend(c, &extent, i);
    }
  } while (pbf_deep_next_row(box, i));
  return pbf_pressure_grid_source_scale_of(c, &extent);
}

/* How far the nodes of the cells in a box are below the surface. */
static inline void pbf_deep_find_surface(pbf_deep *deep, const pbf_deep_box *box) {
  const pbf_coarse *c = &deep->grid;
  pbf_deep_box nodes = *box;
  int i[PBF_DIM];
  for (int k = 0; k < PBF_DIM; ++k) {
    i[k] = nodes.first[k] = box->first[k] > 1 ? box->first[k] : 1;
    nodes.last[k] = (box->last[k] < c->n[k] ? box->last[k] : c->n[k]) + 1;
  }
  do {
    uint32_t row = pbf_deep_row(c, i);
    for (i[0] = nodes.first[0]; i[0] <= nodes.last[0]; ++i[0])
      deep->depths[row + (uint32_t)i[0]] =
          pbf_coarse_node_depth(c, deep->sums, deep->places, deep->rooms, (int64_t)row + i[0], i);
  } while (pbf_deep_next_row(&nodes, i));
}

/* What of the cells in a box, outside which there is no fluid, is below the surface. */
static inline void pbf_deep_cut(pbf_deep *deep, const pbf_deep_box *box) {
  const pbf_coarse *c = &deep->grid;
  int i[PBF_DIM];
  pbf_deep_find_surface(deep, box);
  memcpy(i, box->first, sizeof i);
  do {
    uint32_t row = pbf_deep_row(c, i);
    for (int x = box->first[0]; x <= box->last[0]; ++x) {
      uint32_t cell = row + (uint32_t)x;
      pbf_coarse_cut(c, deep->depths, deep->rooms, cell, &deep->parts[cell], &deep->weights[cell]);
    }
  } while (pbf_deep_next_row(box, i));
}

/* Where the solve starts, once all have an equation. */
static inline void pbf_deep_guess(pbf_deep *deep,
                                  const pbf_pressure_grid_source_scale *source_scale) {
  const pbf_coarse *c = &deep->grid;
  for (uint32_t column = 0; column < pbf_coarse_columns(c); ++column)
    pbf_coarse_guess(c, source_scale->part, deep->inverse, deep->rooms, deep->weights, column,
                     deep->lambda);
  memcpy(deep->before, deep->lambda, c->nodes * sizeof *deep->lambda);
}

/* An iteration has written to `before`. */
static inline void pbf_deep_swap(pbf_deep *deep) {
  double *now = deep->before;
  deep->before = deep->lambda;
  deep->lambda = now;
}

/* The lambda over particles that has the grid's pressure at x. */
static inline pbf_real pbf_deep_lambda(const pbf_deep *deep, const pbf_constants *c,
                                       pbf_real inv_time_step, pbf_vec x) {
  double at[PBF_DIM];
  uint32_t cell = pbf_coarse_cell(&deep->grid, x, at);
  double lambda = pbf_coarse_lambda(&deep->grid, deep->lambda, deep->parts, cell, at);
  return (pbf_real)(lambda * (double)inv_time_step * (double)inv_time_step / (double)c->pressure);
}

#endif
