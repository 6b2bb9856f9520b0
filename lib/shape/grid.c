#include "grid.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/fp_environment.h"
#include "check.h"
#include "error.h"
#include "fnv.h"
#include "lock.h"
#include "physics/elementary.h"
#include "structs.h"
#include "text.h"

/* ---- Checks --------------------------------------------------------------------------------- */

pbf_status pbf_shape_check_size(const char *label, uint32_t dimension, const uint32_t size[3]) {
  if (dimension != 2 && dimension != 3) {
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "%s.dimension is %u; it must be 2 or 3", label,
                    dimension);
  }
  uint64_t nodes = 1;
  for (uint32_t k = 0; k < dimension; ++k) {
    if (size[k] < 3 || size[k] > PBF_MAX_SHAPE_NODES / nodes) {
      return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                      "%s.nodes[%u] is %u; it must be 3 or more, and all nodes together at most %u",
                      label, k, size[k], PBF_MAX_SHAPE_NODES);
    }
    nodes *= size[k];
  }
  return PBF_OK;
}

pbf_status pbf_shape_check_place(const char *label, uint32_t dimension, const double origin[3],
                                 double cell) {
  char number[PBF_NUMBER_SIZE];
  if (!(cell > 1e-30 && cell < 1e30)) {
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "%s.cell is %s; it must be a length between 1e-30 and 1e30", label,
                    pbf_text_number(number, cell));
  }
  for (uint32_t k = 0; k < dimension; ++k) {
    if (fabs(origin[k]) < 1e30) continue;
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "%s.origin[%u] is %s; it must be between -1e30 and 1e30", label, k,
                    pbf_text_number(number, origin[k]));
  }
  return PBF_OK;
}

pbf_status pbf_shape_fail_without_inside(const char *label) {
  return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                  "%s has no number below 0, and so no inside; it may be thinner than a cell",
                  label);
}

/* 2 or 3, as the compiler can tell, too. */
static uint32_t axes_of(const pbf_shape *s) { return s->dimension == 3 ? 3 : 2; }

/* A node, and where it is in the grid. */
typedef struct node {
  uint64_t index;
  uint32_t at[3];
} node;

static int is_on_border(const pbf_shape *s, const node *n) {
  for (uint32_t k = 0; k < axes_of(s); ++k)
    if (n->at[k] == 0 || n->at[k] == s->nodes[k] - 1) return 1;
  return 0;
}

static uint64_t stride_of(const pbf_shape *s, uint32_t axis) {
  uint64_t stride = 1;
  for (uint32_t k = 0; k < axis; ++k) stride *= s->nodes[k];
  return stride;
}

static pbf_status check_node(const pbf_shape *s, const node *n, const char *label) {
  char number[2][PBF_NUMBER_SIZE];
  const double value = (double)s->values[n->index];
  if (!isfinite(value)) {
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "%s[%" PRIu64 "] is %s; it must be finite", label,
                    n->index, pbf_text_number(number[0], value));
  }
  if (is_on_border(s, n) && !(value > 0)) {
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "%s[%" PRIu64
                    "] is %s, on the border of the grid; the solid must end within, "
                    "with a distance above 0 there",
                    label, n->index, pbf_text_number(number[0], value));
  }
  for (uint32_t k = 0; k < axes_of(s); ++k) {
    if (n->at[k] == 0) continue;
    const uint64_t before = n->index - stride_of(s, k);
    const double other = (double)s->values[before];
    if (fabs(value - other) <= pbf_shape_steepest_edge * s->cell) continue;
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "%s[%" PRIu64 "] is %s, and [%" PRIu64
                    "], a cell from it, %s; a distance "
                    "changes by no more than the way, cell",
                    label, before, pbf_text_number(number[1], other), n->index,
                    pbf_text_number(number[0], value));
  }
  return PBF_OK;
}

static int next_node(const pbf_shape *s, node *n) {
  ++n->index;
  for (uint32_t k = 0; k < 3; ++k) {
    if (++n->at[k] < s->nodes[k]) return 1;
    n->at[k] = 0;
  }
  return 0;
}

static pbf_status check_values(const pbf_shape *s, const char *label) {
  node n = {0, {0, 0, 0}};
  int any = 0;
  do {
    pbf_status status = check_node(s, &n, label);
    if (status != PBF_OK) return status;
    any |= s->values[n.index] < 0;
  } while (next_node(s, &n));
  return any ? PBF_OK : pbf_shape_fail_without_inside(label);
}

/* ---- Measures ------------------------------------------------------------------------------- */

static double part_below(double value, double cell) { return fmin(fmax(0.5 - value / cell, 0), 1); }

static void take_place(pbf_shape *s, uint32_t axis, double place) {
  s->lower[axis] = fmin(s->lower[axis], place);
  s->upper[axis] = fmax(s->upper[axis], place);
}

/* Where the surface cuts the way from a node inside to the next along each axis. */
static void measure_inside(pbf_shape *s, const node *n) {
  const double value = (double)s->values[n->index];
  double far2 = 0;
  for (uint32_t k = 0; k < axes_of(s); ++k) {
    const double place = s->origin[k] + s->cell * n->at[k];
    far2 += place * place;
    for (int side = -1; side <= 1; side += 2) {
      const uint64_t stride = stride_of(s, k);
      const double next = (double)s->values[side < 0 ? n->index - stride : n->index + stride];
      take_place(s, k, place + (next >= 0 ? side * s->cell * value / (value - next) : 0));
    }
  }
  s->bound = fmax(s->bound, sqrt(far2) + s->cell * sqrt(s->dimension));
}

/* The largest change along an edge of an axis among the nodes around one. */
static double steepest_edge_around(const pbf_shape *s, const node *n, uint32_t axis) {
  uint64_t stride[3] = {1, s->nodes[0], (uint64_t)s->nodes[0] * s->nodes[1]};
  const int deep = s->dimension == 3;
  float most = 0;
  for (int k = -deep; k <= deep; ++k)
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i) {
        const int at[3] = {i, j, k};
        if (at[axis] > 0) continue;
        const int64_t away = i + (int64_t)stride[1] * j + (int64_t)stride[2] * k;
        const uint64_t index = n->index + (uint64_t)away;
        most = fmaxf(most, fabsf(s->values[index + stride[axis]] - s->values[index]));
      }
  return (double)most;
}

/* The slopes around a node are means of those along edges around it. */
static double steepness_at(const pbf_shape *s, const node *n) {
  double sum2 = 0;
  for (uint32_t k = 0; k < axes_of(s); ++k) {
    const double edge = steepest_edge_around(s, n, k);
    sum2 += edge * edge;
  }
  return sqrt(sum2) / s->cell;
}

static void measure(pbf_shape *s) {
  double below = 0, above_half = 0, below_half = 0;
  node n = {0, {0, 0, 0}};
  for (uint32_t k = 0; k < axes_of(s); ++k) s->lower[k] = INFINITY, s->upper[k] = -INFINITY;
  s->bound = 0;
  s->steepest = 1;
  do {
    const double value = (double)s->values[n.index];
    below += part_below(value, s->cell);
    above_half += part_below(value - 0.5 * s->cell, s->cell);
    below_half += part_below(value + 0.5 * s->cell, s->cell);
    if (value < 0) measure_inside(s, &n);
    if (!is_on_border(s, &n)) s->steepest = fmax(s->steepest, 1.0001 * steepness_at(s, &n));
  } while (next_node(s, &n));
  s->volume = below * pbf_whole_power(s->cell, (int)s->dimension);
  s->area = (above_half - below_half) * pbf_whole_power(s->cell, (int)s->dimension - 1);
}

static uint64_t hash_of(const pbf_shape *s) {
  uint64_t hash = pbf_fnv(PBF_FNV_START, &s->dimension, sizeof s->dimension);
  hash = pbf_fnv(hash, s->nodes, sizeof s->nodes);
  hash = pbf_fnv(hash, s->origin, sizeof s->origin);
  hash = pbf_fnv(hash, &s->cell, sizeof s->cell);
  hash = pbf_fnv(hash, s->values, pbf_shape_nodes(s->nodes) * sizeof *s->values);
  return hash ? hash : 1; /* 0 is no shape */
}

pbf_status pbf_shape_finish(pbf_live_shape *made, const char *label, pbf_shape **shape) {
  pbf_status status = check_values(&made->shape, label);
  if (status != PBF_OK) {
    free(made);
    return status;
  }
  measure(&made->shape);
  made->shape.hash = hash_of(&made->shape);
  *shape = pbf_shape_publish(made);
  return PBF_OK;
}

/* ---- From a caller's grid ------------------------------------------------------------------- */

static pbf_status check_desc(const pbf_grid_desc *grid) {
  pbf_status status = pbf_shape_check_size("grid", grid->dimension, grid->nodes);
  if (status == PBF_OK)
    status = pbf_shape_check_place("grid", grid->dimension, grid->origin, grid->cell);
  if (status != PBF_OK) return status;
  return pbf_check_pointer("grid.values", grid->values, sizeof *grid->values);
}

static pbf_status from_grid(const pbf_grid_desc *grid, pbf_shape **shape) {
  const uint32_t size[3] = {grid->nodes[0], grid->nodes[1],
                            grid->dimension == 3 ? grid->nodes[2] : 1};
  pbf_live_shape *made = pbf_shape_allocate(grid->dimension, size);
  if (!made) {
    return pbf_fail(PBF_ERROR_OUT_OF_MEMORY, "no memory for a shape of %" PRIu64 " nodes",
                    pbf_shape_nodes(size));
  }
  memcpy(made->shape.origin, grid->origin, grid->dimension * sizeof *grid->origin);
  made->shape.cell = grid->cell;
  memcpy(made->values, grid->values, pbf_shape_nodes(size) * sizeof *grid->values);
  return pbf_shape_finish(made, "grid.values", shape);
}

pbf_status pbf_shape_from_grid(const pbf_grid_desc *theirs, pbf_shape **shape) {
  pbf_grid_desc grid;
  pbf_status status = pbf_lock_check();
  if (status == PBF_OK) status = pbf_struct_in(&pbf_kind_grid_desc, theirs, &grid);
  if (status == PBF_OK && !shape) status = pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "shape is null");
  if (status != PBF_OK) return status;
  const pbf_fp_environment before = pbf_fp_begin();
  status = check_desc(&grid);
  if (status == PBF_OK) status = from_grid(&grid, shape);
  pbf_fp_end(before);
  return status;
}
