/* What reservoirs do between two steps. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "memory.h"
#include "new_particles.h"
#include "params.h"
#include "particles/particles.h"
#include "particles/population.h"
#include "physics/spacing.h"
#include "reservoir.h"
#include "solver/backend_call.h"
#include "solver/ids.h"
#include "solver/solver_time.h"

/* From the middle of the box and along its axes. */
static void local_of(const pbf_solver *solver, const pbf_reservoir_frame *f, const pbf_numbers *x,
                     uint32_t element, double local[3]) {
  const uint32_t n = solver->kind.dimension;
  double from[3] = {0, 0, 0};
  for (uint32_t k = 0; k < n; ++k)
    from[k] = pbf_numbers_get(x, element, k, solver->kind.precision) - f->box.position[k];
  for (uint32_t axis = 0; axis < 3; ++axis) {
    local[axis] = 0;
    for (uint32_t k = 0; k < n && axis < n; ++k) local[axis] += f->box.axes[axis][k] * from[k];
  }
}

/* Around all that matters for it: what is within a spacing. */
static pbf_backend_box box_of(const pbf_reservoir_frame *f) {
  return pbf_volume_box(&f->box, f->spacing);
}

static pbf_reservoir_frame frame_of(const pbf_solver *solver, const pbf_reservoir *r) {
  return pbf_reservoir_frame_of(r, solver->kind.dimension, pbf_derive_spacing(&solver->params));
}

/* ---- Out ------------------------------------------------------------------------------------- */

typedef struct placed_row {
  double height;
  uint32_t row;
} placed_row;

/* The highest first; of those at the same height the youngest. */
static int compare(const void *left, const void *right) {
  const placed_row *a = left, *b = right;
  if (a->height != b->height) return a->height > b->height ? -1 : 1;
  return a->row > b->row ? -1 : a->row < b->row;
}

/* Those in it that stay so far; null `rows` counts them. */
static uint32_t list_inside(pbf_solver *solver, const pbf_reservoir_frame *f, const pbf_numbers *x,
                            const pbf_row_set *out, placed_row *rows) {
  uint32_t count = 0;
  for (uint32_t i = 0; i < x->elements; ++i) {
    double local[3];
    uint32_t row;
    local_of(solver, f, x, i, local);
    if (!pbf_volume_has_local(&f->box, local) || !pbf_numbers_row(solver, x, i, &row)) continue;
    if (pbf_row_set_has(out, row)) continue;
    if (rows) rows[count] = (placed_row){local[1], row};
    ++count;
  }
  return count;
}

static pbf_status mark_highest(pbf_solver *solver, const pbf_reservoir_frame *f,
                               const pbf_numbers *x, pbf_row_set *out, uint64_t *removed) {
  const uint32_t inside = list_inside(solver, f, x, out, NULL);
  const uint64_t bytes = (uint64_t)inside * sizeof(placed_row);
  void *memory;
  if (!(inside > f->particles)) return PBF_OK;
  pbf_status status =
      pbf_memory_allocate(&solver->allocator, bytes, "what is in a reservoir", &memory);
  if (status != PBF_OK) return status;
  placed_row *rows = memory;
  (void)list_inside(solver, f, x, out, rows);
  qsort(rows, inside, sizeof *rows, compare);
  for (uint32_t i = 0; i < inside && i < inside - f->particles; ++i, ++*removed)
    pbf_row_set_add(out, rows[i].row);
  pbf_memory_free(&solver->allocator, memory, bytes);
  return PBF_OK;
}

pbf_status pbf_reservoir_mark(pbf_solver *solver, const pbf_reservoir *reservoir, pbf_row_set *out,
                              uint64_t *removed) {
  const pbf_reservoir_frame f = frame_of(solver, reservoir);
  const pbf_backend_box box = box_of(&f);
  pbf_numbers x;
  *removed = 0;
  pbf_status status = pbf_numbers_in_boxes(solver, 1, &box, &x, NULL);
  if (status == PBF_OK) status = mark_highest(solver, &f, &x, out, removed);
  pbf_numbers_free(solver, &x);
  return status;
}

/* ---- In -------------------------------------------------------------------------------------- */

/* Of a cell: how high a particle would come to lie upon those that are there, a spacing from all of
 * them, and which of these it would lie upon. */
typedef struct heap_cell {
  double height;
  uint32_t support; /* an element, or none: the bottom */
} heap_cell;

static const uint32_t none = UINT32_MAX;

typedef struct heap {
  const pbf_reservoir_frame *frame;
  pbf_numbers positions, velocities; /* of particles that are there */
  heap_cell *of;
  uint32_t cells;
} heap;

static void middle_of_cell(const pbf_reservoir_frame *f, uint32_t cell, double middle[2]) {
  const uint32_t column = cell % f->cells[0], row = cell / f->cells[0];
  middle[0] = (column + 0.5) * f->cell[0] - f->box.half[0];
  middle[1] = f->cell[1] > 0 ? (row + 0.5) * f->cell[1] - f->box.half[2] : 0;
}

/* The first and the last cell along a side that are within a spacing of a place, and 1; or 0. */
static int near_cells(const pbf_reservoir_frame *f, uint32_t side, double at, uint32_t range[2]) {
  const double half = f->box.half[2 * side], cell = f->cell[side];
  range[0] = range[1] = 0;
  if (!(cell > 0)) return 1;
  const double first = floor((at - f->spacing + half) / cell);
  const double last = floor((at + f->spacing + half) / cell);
  if (last < 0 || first > f->cells[side] - 1.0) return 0;
  range[0] = first > 0 ? (uint32_t)first : 0;
  range[1] = last < f->cells[side] - 1.0 ? (uint32_t)last : f->cells[side] - 1;
  return 1;
}

static uint32_t id_of(const heap *h, uint32_t element) {
  return h->positions.ids && element != none ? h->positions.ids[element] : element;
}

/* Of equal heights that of the particle with the lower id counts, in whatever order they come. */
static int is_above(const heap *h, double height, uint32_t element, const heap_cell *top) {
  if (height != top->height) return height > top->height;
  return id_of(h, element) < id_of(h, top->support);
}

static void lay(const heap *h, const double local[3], uint32_t element) {
  const pbf_reservoir_frame *f = h->frame;
  uint32_t ranges[2][2];
  if (!near_cells(f, 0, local[0], ranges[0]) || !near_cells(f, 1, local[2], ranges[1])) return;
  for (uint32_t j = ranges[1][0]; j <= ranges[1][1]; ++j)
    for (uint32_t i = ranges[0][0]; i <= ranges[0][1]; ++i) {
      double middle[2];
      const uint32_t cell = i + j * f->cells[0];
      middle_of_cell(f, cell, middle);
      const double a = middle[0] - local[0], b = middle[1] - local[2];
      const double square = f->spacing * f->spacing - a * a - b * b;
      const double height = local[1] + sqrt(fmax(square, 0));
      if (square > 0 && is_above(h, height, element, &h->of[cell]))
        h->of[cell] = (heap_cell){height, element};
    }
}

static uint32_t lowest_of(const heap *h) {
  uint32_t lowest = 0;
  for (uint32_t i = 1; i < h->cells; ++i)
    if (h->of[i].height < h->of[lowest].height) lowest = i;
  return lowest;
}

/* Heaps up what is there; returns how many that are in the box. */
static double heap_up(pbf_solver *solver, const heap *h) {
  double inside = 0;
  for (uint32_t i = 0; i < h->positions.elements; ++i) {
    double local[3];
    local_of(solver, h->frame, &h->positions, i, local);
    inside += pbf_volume_has_local(&h->frame->box, local) != 0;
    if (local[1] < h->frame->upper + h->frame->spacing) lay(h, local, i);
  }
  return inside;
}

/* Places for as many as are missing, but none of which the middle would be above the level, and
 * what each would lie upon. */
static uint32_t write_places(const pbf_solver *solver, pbf_emission *e, const heap *h,
                             uint32_t most, uint32_t *supports) {
  const pbf_reservoir_frame *f = h->frame;
  const uint32_t n = solver->kind.dimension;
  uint32_t written = 0;
  while (written < most) {
    const uint32_t cell = lowest_of(h);
    const heap_cell top = h->of[cell];
    double middle[2], place[3];
    middle_of_cell(f, cell, middle);
    const double local[3] = {middle[0], top.height, middle[1]};
    if (!(local[1] <= f->upper)) break;
    for (uint32_t k = 0; k < n; ++k) {
      place[k] = f->box.position[k];
      for (uint32_t axis = 0; axis < n; ++axis) place[k] += local[axis] * f->box.axes[axis][k];
    }
    lay(h, local, top.support);
    if (!pbf_emission_is_inside(solver, place)) continue;
    for (uint32_t k = 0; k < n; ++k)
      pbf_emission_put(solver, e->particles, (uint64_t)written * n + k, place[k]);
    supports[written++] = top.support;
  }
  return written;
}

/* What lies upon fluid moves with it: particles at rest would have to fall by a spacing before
 * others find room, and so limit what comes in to a layer in sqrt(2 spacing / g). */
static void write_velocities(const pbf_solver *solver, pbf_emission *e, const heap *h,
                             uint32_t count, const uint32_t *supports) {
  char *velocities = (char *)e->particles + count * pbf_point_bytes(solver);
  const uint32_t n = solver->kind.dimension;
  memset(velocities, 0, count * pbf_point_bytes(solver));
  for (uint32_t i = 0; i < count; ++i)
    for (uint32_t k = 0; k < n && supports[i] != none; ++k)
      pbf_emission_put(solver, velocities, (uint64_t)i * n + k,
                       pbf_numbers_get(&h->velocities, supports[i], k, solver->kind.precision));
}

static uint32_t room_in(const pbf_solver *solver) {
  const uint64_t ids = (UINT64_C(1) << 32) - solver->next_id;
  const uint32_t places = solver->capacity - solver->count;
  return ids < places ? (uint32_t)ids : places;
}

static pbf_status add(pbf_solver *solver, pbf_emission *e, pbf_reservoir *r, const heap *h,
                      uint32_t missing, uint32_t *supports) {
  pbf_status status = pbf_emission_reserve(solver, e, missing);
  if (status != PBF_OK) return status;
  const uint32_t count = write_places(solver, e, h, missing, supports);
  if (count == 0) return PBF_OK;
  write_velocities(solver, e, h, count, supports);
  const void *velocities = (char *)e->particles + count * pbf_point_bytes(solver);
  status = pbf_population_append(solver, count, e->particles, velocities, 0, r->phase);
  if (status != PBF_OK) return status;
  r->added += count;
  e->head.in_out.emitted += count;
  return PBF_OK;
}

static pbf_status add_missing(pbf_solver *solver, pbf_emission *e, pbf_reservoir *r,
                              const heap *h) {
  void *supports;
  const double missing = fmin(h->frame->particles - heap_up(solver, h), room_in(solver));
  if (!(missing >= 1)) return PBF_OK;
  const uint64_t bytes = (uint64_t)missing * sizeof(uint32_t);
  pbf_status status =
      pbf_memory_allocate(&solver->allocator, bytes, "what comes into a reservoir", &supports);
  if (status != PBF_OK) return status;
  status = add(solver, e, r, h, (uint32_t)missing, supports);
  pbf_memory_free(&solver->allocator, supports, bytes);
  return status;
}

/* From where to where the domain is along the box's own y axis, from its middle. */
static void find_reach(const pbf_solver *solver, const pbf_volume_frame *box, double reach[2]) {
  const uint32_t n = solver->kind.dimension;
  const pbf_box domain = pbf_params_box(&solver->params, n, pbf_solver_time(solver));
  reach[0] = INFINITY;
  reach[1] = -INFINITY;
  for (uint32_t corner = 0; corner < 1u << n; ++corner) {
    double at = 0;
    for (uint32_t k = 0; k < n; ++k)
      at += ((corner >> k & 1 ? domain.upper[k] : domain.lower[k]) - box->position[k]) *
            box->axes[1][k];
    reach[0] = fmin(reach[0], at);
    reach[1] = fmax(reach[1], at);
  }
}

/* Where the lowest may be: whole spacings above the box's side, so far as that is below the domain,
 * where there is none: a domain may have been made smaller since. *upper ends with the domain. */
static double lowest_place(const pbf_solver *solver, const pbf_reservoir_frame *f, double *upper) {
  const double lowest = f->lower + 0.5 * f->spacing;
  double reach[2];
  find_reach(solver, &f->box, reach);
  *upper = fmin(f->upper, reach[1]);
  return lowest + f->spacing * floor(fmax(reach[0] - lowest, 0) / f->spacing);
}

static pbf_status fill(pbf_solver *solver, pbf_emission *e, pbf_reservoir *r) {
  pbf_reservoir_frame f = frame_of(solver, r);
  const uint64_t cells = (uint64_t)f.cells[0] * f.cells[1];
  void *memory;
  /* A spacing that has been made smaller since, or a saved state of a larger solver. */
  if (cells > solver->capacity || !(f.particles <= solver->capacity)) return PBF_OK;
  pbf_status status = pbf_memory_allocate(&solver->allocator, cells * sizeof(heap_cell),
                                          "the surface of a reservoir", &memory);
  if (status != PBF_OK) return status;
  const pbf_backend_box box = box_of(&f);
  heap h = {.frame = &f, .of = memory, .cells = (uint32_t)cells};
  const double lowest = lowest_place(solver, &f, &f.upper);
  for (uint32_t i = 0; i < h.cells; ++i) h.of[i] = (heap_cell){lowest, none};
  status = pbf_numbers_in_boxes(solver, 1, &box, &h.positions, &h.velocities);
  if (status == PBF_OK) status = add_missing(solver, e, r, &h);
  pbf_numbers_free(solver, &h.positions);
  pbf_numbers_free(solver, &h.velocities);
  pbf_memory_free(&solver->allocator, memory, cells * sizeof(heap_cell));
  return status;
}

/* ---- Pressure -------------------------------------------------------------------------------- */

/* Rows from the first to the last in the box, and which of them are. */
static pbf_status find_rows(pbf_solver *solver, const pbf_reservoir_frame *f, pbf_row_set *set,
                            uint32_t *first, uint32_t *last) {
  const pbf_backend_box box = box_of(f);
  pbf_numbers x;
  *first = UINT32_MAX;
  *last = 0;
  pbf_status status = pbf_numbers_in_boxes(solver, 1, &box, &x, NULL);
  for (uint32_t i = 0; status == PBF_OK && i < x.elements; ++i) {
    double local[3];
    uint32_t row;
    local_of(solver, f, &x, i, local);
    if (!pbf_volume_has_local(&f->box, local) || !pbf_numbers_row(solver, &x, i, &row)) continue;
    pbf_row_set_add(set, row);
    *first = row < *first ? row : *first;
    *last = row > *last ? row : *last;
  }
  pbf_numbers_free(solver, &x);
  return status;
}

static double number_at(const pbf_solver *solver, const void *array, uint64_t index) {
  return solver->kind.precision == PBF_FLOAT32 ? (double)((const float *)array)[index]
                                               : ((const double *)array)[index];
}

/* Velocities change before the prediction, as gravity changes them. */
static pbf_status push_rows(pbf_solver *solver, pbf_emission *e, const pbf_reservoir *r,
                            const pbf_reservoir_frame *f, const pbf_row_set *set, uint32_t first,
                            uint32_t count) {
  const pbf_rows rows = pbf_ids_rows(solver, first, count);
  const uint32_t n = solver->kind.dimension;
  const double gain = r->pressure / r->depth * pbf_part_time_step(solver);
  pbf_status status = pbf_emission_reserve(solver, e, count);
  if (status == PBF_OK)
    status = pbf_read_rows(solver, PBF_FIELD_VELOCITY, first, count, e->particles);
  if (status != PBF_OK) return status;
  for (uint32_t i = 0; i < count; ++i)
    for (uint32_t k = 0; k < n && pbf_row_set_has(set, first + i); ++k) {
      const uint64_t at = (uint64_t)i * n + k;
      pbf_emission_put(solver, e->particles, at,
                       number_at(solver, e->particles, at) - gain * f->box.axes[1][k]);
    }
  status = solver->api.write(solver->backend, PBF_FIELD_VELOCITY, &rows, e->particles);
  ++solver->generation;
  return pbf_backend_result(solver, status, "write");
}

static pbf_status push(pbf_solver *solver, pbf_emission *e, const pbf_reservoir *r) {
  const pbf_reservoir_frame f = frame_of(solver, r);
  uint32_t first, last;
  pbf_row_set set;
  if (!(r->pressure > 0) || solver->count == 0) return PBF_OK;
  pbf_status status = pbf_row_set_allocate(solver, &set);
  if (status == PBF_OK) status = find_rows(solver, &f, &set, &first, &last);
  if (status == PBF_OK && set.count > 0)
    status = push_rows(solver, e, r, &f, &set, first, last - first + 1);
  pbf_row_set_free(solver, &set);
  return status;
}

pbf_status pbf_reservoir_stage(pbf_solver *solver, pbf_emission *e, uint32_t number) {
  const uint32_t count = e->head.reservoir_count;
  if (number < count) return fill(solver, e, &e->reservoirs[number]);
  return push(solver, e, &e->reservoirs[number - count]);
}
