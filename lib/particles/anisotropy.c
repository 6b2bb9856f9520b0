/* Smoothed positions and anisotropies for renderers: Yu & Turk 2013, whose equations are named. On
 * the host, in float64, for all backends alike. */
#include <math.h>
#include <string.h>

#include "cells.h"
#include "compiler.h"
#include "eigen.h"
#include "check.h"
#include "error.h"
#include "memory.h"
#include "particles.h"
#include "physics/spacing.h"
#include "solver/handles.h"
#include "structs.h"
#include "text.h"

/* ---- What is asked for ---------------------------------------------------------------------- */

/* The desc with all that it leaves to the library. */
typedef struct wanted {
  pbf_anisotropy_desc desc;
  double rest_variance; /* along an axis, of the neighbours in a lattice at rest */
} wanted;

static pbf_status fail_on(const char *member, double value, const char *demand) {
  char number[PBF_NUMBER_SIZE];
  return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "anisotropy.%s is %s; it must be %s", member,
                  pbf_text_number(number, value), demand);
}

static pbf_status check_radius(const pbf_solver *solver, double radius) {
  const double spacing = pbf_derive_spacing(&solver->params);
  const double h = solver->params.smoothing_radius;
  if (radius > spacing && radius <= 4 * h) return PBF_OK;
  char number[PBF_NUMBER_SIZE];
  return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                  "anisotropy.radius is %s; it must be above the spacing, %.9g, and at most 4 h, "
                  "%.9g, or 0 for 2 h",
                  pbf_text_number(number, radius), spacing, 4 * h);
}

static pbf_status check_place(const pbf_solver *solver, const pbf_anisotropy_desc *desc) {
  const uint32_t size = pbf_element_size(solver);
  if (desc->count == 0) return PBF_OK;
  if (!desc->positions && !desc->stretches)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "anisotropy.positions and anisotropy.stretches are null; at least one is to be "
                    "written to");
  pbf_status status = PBF_OK;
  if (desc->positions) status = pbf_check_pointer("anisotropy.positions", desc->positions, size);
  if (status == PBF_OK && desc->stretches)
    status = pbf_check_pointer("anisotropy.stretches", desc->stretches, size);
  return status;
}

static pbf_status check(const pbf_solver *solver, const pbf_anisotropy_desc *desc) {
  pbf_status status = pbf_check_rows(solver, desc->first, desc->count);
  if (status == PBF_OK) status = check_radius(solver, desc->radius);
  if (status != PBF_OK) return status;
  if (!(desc->smoothing >= 0 && desc->smoothing <= 1))
    return fail_on("smoothing", desc->smoothing, "0 … 1");
  if (!(desc->max_ratio >= 1 && isfinite(desc->max_ratio)))
    return fail_on("max_ratio", desc->max_ratio, "finite and at least 1, or 0 for 4");
  if (!(desc->lone_scale > 0 && desc->lone_scale <= 1))
    return fail_on("lone_scale", desc->lone_scale, "above 0 and at most 1, or 0 for 0.5");
  return check_place(solver, desc);
}

static void fill_in(const pbf_solver *solver, pbf_anisotropy_desc *desc) {
  if (desc->radius == 0) desc->radius = 2 * solver->params.smoothing_radius;
  if (desc->max_ratio == 0) desc->max_ratio = 4;
  if (desc->lone_scale == 0) desc->lone_scale = 0.5;
  if (desc->min_neighbors == 0) desc->min_neighbors = solver->kind.dimension == 3 ? 25 : 9;
}

/* ---- Sums over neighbours -------------------------------------------------------------------- */

/* Eq. 11, `square` being the distance's over the radius'; 0 from the radius on. */
static double weight(double square) { return square < 1 ? 1 - square * sqrt(square) : 0; }

/* Of the neighbours' places from a particle's, the particle included. */
typedef struct sums {
  double weights, mean[3], products[3][3];
  uint32_t neighbors;
} sums;

static PBF_ALWAYS_INLINE void add(sums *s, const double r[3], double w, uint32_t dimension) {
  s->weights += w;
  for (uint32_t k = 0; k < dimension; ++k) {
    s->mean[k] += w * r[k];
    for (uint32_t l = 0; l <= k; ++l) s->products[k][l] += w * r[k] * r[l];
  }
}

/* The covariance of eq. 9 about the weighted mean of eq. 10, which `mean` becomes. */
static void finish(sums *s, uint32_t dimension, double covariance[3][3]) {
  for (uint32_t k = 0; k < dimension; ++k) s->mean[k] /= s->weights;
  for (uint32_t k = 0; k < dimension; ++k)
    for (uint32_t l = 0; l <= k; ++l)
      covariance[k][l] = covariance[l][k] =
          s->products[k][l] / s->weights - s->mean[k] * s->mean[l];
}

/* Along x, of the lattice in which nothing is stretched: it takes the place of eq. 15's k_s, which
 * the paper sets to a number that does so for its own lengths. */
static double rest_variance(double spacing, double radius, uint32_t dimension) {
  const int reach = (int)(radius / spacing), depth = dimension == 3 ? reach : 0;
  sums s = {0};
  for (int i = -reach; i <= reach; ++i) {
    for (int j = -reach; j <= reach; ++j) {
      for (int k = -depth; k <= depth; ++k) {
        const double r[3] = {i * spacing, 0, 0};
        const double square = (double)(i * i + j * j + k * k) * (spacing * spacing);
        add(&s, r, weight(square / (radius * radius)), 1);
      }
    }
  }
  return s.products[0][0] / s.weights;
}

static PBF_ALWAYS_INLINE sums sum_up(const pbf_cells *cells, uint32_t element,
                                     const pbf_cell_run *runs, uint32_t run_count,
                                     uint32_t dimension) {
  const double *own = cells->points + (uint64_t)element * dimension;
  const double scale = 1 / (cells->radius * cells->radius);
  sums s = {.neighbors = UINT32_MAX}; /* the particle itself is none */
  for (uint32_t run = 0; run < run_count; ++run) {
    for (uint32_t other = runs[run].begin; other < runs[run].end; ++other) {
      double r[3] = {0, 0, 0}, square = 0;
      for (uint32_t k = 0; k < dimension; ++k) {
        r[k] = cells->points[(uint64_t)other * dimension + k] - own[k];
        square += r[k] * r[k];
      }
      const double w = weight(square * scale);
      if (!(w > 0)) continue;
      ++s.neighbors;
      add(&s, r, w, dimension);
    }
  }
  return s;
}

/* Loops of their own, in which the dimension is a constant. */
static sums sums_around(const pbf_cells *cells, uint32_t element, const pbf_cell_run *runs,
                        uint32_t run_count) {
  return cells->dimension == 3 ? sum_up(cells, element, runs, run_count, 3)
                               : sum_up(cells, element, runs, run_count, 2);
}

/* ---- What a particle gets -------------------------------------------------------------------- */

/* Eq. 15: the longest axis is at most max_ratio times as long as any other. */
static void stretch_of(const wanted *w, double covariance[3][3], uint32_t neighbors, uint32_t n,
                       double stretch[3][3]) {
  double vectors[3][3], longest = 0;
  pbf_eigen(covariance, vectors, n);
  for (uint32_t k = 0; k < n; ++k) longest = fmax(longest, covariance[k][k]);
  const int lone = neighbors < w->desc.min_neighbors || !(longest > 0);
  for (uint32_t i = 0; i < n; ++i) {
    for (uint32_t j = 0; j < n; ++j) {
      stretch[i][j] = lone && i == j ? w->desc.lone_scale : 0;
      for (uint32_t k = 0; k < n && !lone; ++k)
        stretch[i][j] += fmax(covariance[k][k], longest / w->desc.max_ratio) / w->rest_variance *
                         vectors[i][k] * vectors[j][k];
    }
  }
}

static void put(void *array, uint64_t index, uint32_t precision, double number) {
  if (precision == PBF_FLOAT32)
    ((float *)array)[index] = (float)number;
  else
    ((double *)array)[index] = number;
}

static void write_one(const wanted *w, const pbf_check_kind *kind, const double *own, sums *s,
                      uint32_t place) {
  const uint32_t n = kind->dimension;
  double covariance[3][3] = {{0}}, stretch[3][3];
  finish(s, n, covariance);
  for (uint32_t k = 0; k < n && w->desc.positions; ++k) /* eq. 6 */
    put(w->desc.positions, (uint64_t)place * n + k, kind->precision,
        own[k] + w->desc.smoothing * s->mean[k]);
  if (!w->desc.stretches) return;
  stretch_of(w, covariance, s->neighbors, n, stretch);
  for (uint32_t i = 0; i < n; ++i)
    for (uint32_t j = 0; j < n; ++j)
      put(w->desc.stretches, ((uint64_t)place * n + i) * n + j, kind->precision, stretch[i][j]);
}

/* In the order of cells: those of one cell share their runs, and what they read is near. */
static void write_all(const wanted *w, const pbf_check_kind *kind, const pbf_cells *cells) {
  pbf_cell_run runs[PBF_CELL_RUNS];
  uint32_t run_count = 0, runs_of = UINT32_MAX;
  for (uint32_t element = 0; element < cells->count; ++element) {
    const uint32_t place = cells->order[element] - w->desc.first;
    if (place >= w->desc.count) continue;
    if (runs_of == UINT32_MAX || cells->keys[element] != cells->keys[runs_of]) {
      run_count = pbf_cells_around(cells, element, runs);
      runs_of = element;
    }
    sums s = sums_around(cells, element, runs, run_count);
    write_one(w, kind, cells->points + (uint64_t)element * kind->dimension, &s, place);
  }
}

/* All positions as float64: what is asked for of some depends on others. */
static pbf_status read_points(pbf_solver *solver, double *points) {
  const uint64_t numbers = (uint64_t)solver->count * solver->kind.dimension;
  pbf_status status = pbf_read_all(solver, PBF_FIELD_POSITION, points);
  if (status != PBF_OK || solver->kind.precision == PBF_FLOAT64) return status;
  for (uint64_t i = numbers; i-- > 0;) { /* from the end, where nothing is overwritten */
    float single;
    memcpy(&single, (const char *)points + i * sizeof single, sizeof single);
    points[i] = (double)single;
  }
  return PBF_OK;
}

static pbf_status get(pbf_solver *solver, const wanted *w) {
  const pbf_allocator *allocator = &solver->allocator;
  const uint64_t bytes = (uint64_t)solver->count * solver->kind.dimension * sizeof(double);
  pbf_cells cells;
  void *points;
  pbf_status status = pbf_memory_allocate(allocator, bytes, "positions for anisotropies", &points);
  if (status != PBF_OK) return status;
  status = read_points(solver, points);
  if (status == PBF_OK)
    status = pbf_cells_build(allocator, points, solver->count, solver->kind.dimension,
                             w->desc.radius, &cells);
  pbf_memory_free(allocator, points, bytes);
  if (status != PBF_OK) return status;
  write_all(w, &solver->kind, &cells);
  pbf_cells_free(&cells);
  return PBF_OK;
}

static pbf_status get_as(pbf_solver *solver, const pbf_anisotropy_desc *theirs) {
  wanted w;
  if (!theirs)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "anisotropy is null; it says what is wanted");
  pbf_status status = pbf_struct_in(&pbf_kind_anisotropy_desc, theirs, &w.desc);
  if (status != PBF_OK) return status;
  fill_in(solver, &w.desc);
  status = check(solver, &w.desc);
  if (status != PBF_OK || w.desc.count == 0) return status;
  w.rest_variance =
      rest_variance(pbf_derive_spacing(&solver->params), w.desc.radius, solver->kind.dimension);
  return get(solver, &w);
}

pbf_status pbf_get_anisotropies(pbf_solver *solver, const pbf_anisotropy_desc *anisotropy) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, get_as(solver, anisotropy));
}
