/* Neighbour search of the `reference` backend: a grid of cells, an unsorted list in each. */
#ifndef PBF_REFERENCE_GRID_H
#define PBF_REFERENCE_GRID_H

#include <stdint.h>
#include <string.h>

#include "physics/periodic.h"

/* Lists of the particles in each cell, at the positions the grid was built from. Cells far apart
 * may share a list (indices are taken modulo `cells`), which costs distance tests and loses none.
 */
typedef struct grid {
  double width[PBF_DIM];
  double origin[PBF_DIM];
  uint32_t cells[PBF_DIM];
  pbf_periods periods;
  uint32_t *cell_of; /* particle -> cell */
  uint32_t *start;   /* cell -> first entry in `list`; one more at the end */
  uint32_t *list;    /* particles, cell by cell */
} grid;

/* Largest number of cells for so many particles. */
static inline uint32_t grid_cell_limit(uint32_t count) { return 2 * count + 1024; }

/* A box around the particles, and its number of cells, halved along the longest side until they
 * fit. Three cells along an axis are needed to tell the left neighbour from the right one. Along a
 * periodic axis they fill the period. */
static inline void size_grid(grid *g, const pbf_params *params, uint32_t limit, uint32_t count,
                             const pbf_vec *x) {
  double width = params->search_cell_width;
  double cells[PBF_DIM], total = 1;
  if (!(width > params->smoothing_radius)) width = params->smoothing_radius;
  g->periods = pbf_periods_of(params);
  for (int k = 0; k < PBF_DIM; ++k) {
    double lower = x[0].c[k], upper = x[0].c[k];
    for (uint32_t i = 1; i < count; ++i) {
      lower = fmin(lower, x[i].c[k]);
      upper = fmax(upper, x[i].c[k]);
    }
    g->origin[k] = lower;
    g->width[k] = width;
    cells[k] = fmax(3, fmin(1e9, floor((upper - lower) / width) + 1));
    if (pbf_is_periodic(params, k)) {
      g->origin[k] = params->domain_min[k];
      cells[k] = fmax(3, fmin(1e9, floor((double)g->periods.length.c[k] / width)));
    }
    total *= cells[k];
  }
  while (total > limit) {
    int longest = 0;
    for (int k = 1; k < PBF_DIM; ++k)
      if (cells[k] > cells[longest]) longest = k;
    total /= cells[longest];
    cells[longest] = fmax(3, ceil(cells[longest] / 2));
    total *= cells[longest];
  }
  for (int k = 0; k < PBF_DIM; ++k) {
    g->cells[k] = (uint32_t)cells[k];
    if (pbf_is_periodic(params, k)) g->width[k] = (double)g->periods.length.c[k] / cells[k];
  }
}

static inline uint32_t cell_at(const grid *g, pbf_vec x) {
  uint32_t cell = 0;
  for (int k = PBF_DIM - 1; k >= 0; --k) {
    double c = floor((x.c[k] - g->origin[k]) / g->width[k]);
    c = g->periods.length.c[k] > 0 ? fmin(c, g->cells[k] - 1.0) : fmod(c, g->cells[k]);
    cell = cell * g->cells[k] + (c > 0 ? (uint32_t)c : 0); /* 0 also for NaN */
  }
  return cell;
}

/* Sorts the particles at positions x into cells. */
static inline void grid_build(grid *g, const pbf_params *params, uint32_t limit, uint32_t count,
                              const pbf_vec *x) {
  size_grid(g, params, limit, count, x);
  uint32_t cells = 1;
  for (int k = 0; k < PBF_DIM; ++k) cells *= g->cells[k];
  memset(g->start, 0, (cells + 1) * sizeof *g->start);
  for (uint32_t i = 0; i < count; ++i) ++g->start[g->cell_of[i] = cell_at(g, x[i])];
  uint32_t end = 0;
  for (uint32_t c = 0; c < cells; ++c) end = g->start[c] += end;
  g->start[cells] = count;
  for (uint32_t i = count; i-- > 0;) g->list[--g->start[g->cell_of[i]]] = i;
}

/* Walks over the particles j != i nearer than h to particle i, at positions x. */
typedef struct neighbor {
  uint32_t j;
  pbf_vec x_ij; /* of the nearest images */
  pbf_real r2;
  pbf_vec image; /* x_ij less x_i - x_j */
  /* where the walk stands */
  uint32_t i, next, end;
  int block;
  uint32_t base[PBF_DIM];
} neighbor;

static inline neighbor neighbors_of(const grid *g, uint32_t i) {
  neighbor n = {.i = i};
  uint32_t cell = g->cell_of[i];
  for (int k = 0; k < PBF_DIM; ++k) {
    n.base[k] = (cell % g->cells[k] + g->cells[k] - 1) % g->cells[k];
    cell /= g->cells[k];
  }
  return n;
}

/* The next entry of the 3 × 3 (× 3) cells around particle i; 0 at the end. */
static inline int next_cell(const grid *g, neighbor *n) {
  enum { BLOCKS = PBF_DIM == 3 ? 27 : 9 };
  while (n->next == n->end) {
    if (n->block == BLOCKS) return 0;
    uint32_t cell = 0, offset = (uint32_t)n->block++;
    for (int k = PBF_DIM - 1; k >= 0; --k) {
      uint32_t c = n->base[k] + (k == 0 ? offset % 3 : k == 1 ? offset / 3 % 3 : offset / 9);
      cell = cell * g->cells[k] + (c >= g->cells[k] ? c - g->cells[k] : c);
    }
    n->next = g->start[cell];
    n->end = g->start[cell + 1];
  }
  return 1;
}

static inline int next_neighbor(const grid *g, const pbf_vec *x, pbf_real h2, neighbor *n) {
  while (next_cell(g, n)) {
    n->j = g->list[n->next++];
    n->x_ij = pbf_sub(x[n->i], x[n->j]);
    if (g->periods.any) {
      const pbf_vec between = n->x_ij;
      n->x_ij = pbf_nearest_image(g->periods.length, between);
      n->image = pbf_sub(n->x_ij, between);
    }
    n->r2 = pbf_dot(n->x_ij, n->x_ij);
    if (n->r2 < h2 && n->j != n->i) return 1;
  }
  return 0;
}

#endif
