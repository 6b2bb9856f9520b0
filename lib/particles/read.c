/* Reading fields into the caller's own layout. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "error.h"
#include "compiler.h"
#include "device_rows.h"
#include "memory.h"
#include "numbers.h"
#include "particles.h"
#include "solver/handles.h"
#include "solver/ids.h"
#include "structs.h"
#include "text.h"
#include "values.h"
#include "views.h"

/* ---- What is asked for ---------------------------------------------------------------------- */

static int is_vector(uint32_t field) {
  return field == PBF_FIELD_POSITION || field == PBF_FIELD_VELOCITY;
}

static uint32_t type_of(const pbf_solver *solver, const pbf_read_desc *read) {
  if (read->element_type) return read->element_type;
  return read->field == PBF_FIELD_ID ? (uint32_t)PBF_TYPE_UINT32 : solver->kind.precision;
}

static uint32_t components_of(const pbf_solver *solver, const pbf_read_desc *read) {
  if (read->components) return read->components;
  return is_vector(read->field) ? solver->kind.dimension : 1;
}

static uint32_t bytes_of(uint32_t type) { return type == PBF_TYPE_FLOAT64 ? 8 : 4; }

static pbf_status fail_on(const char *member, uint32_t value, const char *demand) {
  return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "read.%s is %u; it must be %s", member, value,
                  demand);
}

static pbf_status check_type(const pbf_read_desc *read) {
  const uint32_t type = read->element_type;
  if (type == 0) return PBF_OK;
  if (read->field == PBF_FIELD_ID)
    return type == PBF_TYPE_UINT32 ? PBF_OK
                                   : fail_on("element_type", type, "12 (uint32) or 0 for ids");
  return type == PBF_TYPE_FLOAT32 || type == PBF_TYPE_FLOAT64
             ? PBF_OK
             : fail_on("element_type", type, "4 (float32), 8 (float64) or 0");
}

static pbf_status check_components(const pbf_solver *solver, const pbf_read_desc *read) {
  const uint32_t components = read->components,
                 own = is_vector(read->field) ? solver->kind.dimension : 1;
  if (components == 0 || components == own) return PBF_OK;
  if (!is_vector(read->field))
    return fail_on("components", components, "1 or 0: the field is a number");
  if (components < own || components > 4)
    return fail_on("components", components, own == 2 ? "2 … 4 or 0" : "3, 4 or 0");
  return PBF_OK;
}

static pbf_status check_w(const pbf_solver *solver, const pbf_read_desc *read) {
  if (read->w > PBF_W_PRESSURE) return fail_on("w", read->w, "0 … 3 (PBF_W_…)");
  if (read->components != 4) return PBF_OK;
  if (read->w == PBF_W_PRESSURE) return pbf_check_pressures(solver);
  char number[PBF_NUMBER_SIZE];
  if (read->w != PBF_W_CONSTANT || isfinite(read->w_value)) return PBF_OK;
  return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "read.w_value is %s; it must be finite",
                  pbf_text_number(number, read->w_value));
}

static pbf_status check_order(const pbf_solver *solver, const pbf_read_desc *read) {
  if (read->order > PBF_ORDER_STORED) return fail_on("order", read->order, "0 or 1 (PBF_ORDER_…)");
  if (read->order == PBF_ORDER_ADDED || (read->first == 0 && read->count == solver->count))
    return PBF_OK;
  return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                  "read.first is %u and read.count %u; in the order in which they are stored all "
                  "particles are read, 0 and %u",
                  read->first, read->count, solver->count);
}

static pbf_status check_behind(const pbf_solver *solver, const pbf_read_desc *read) {
  char number[PBF_NUMBER_SIZE];
  if (!(read->behind >= 0 && read->behind <= 1))
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "read.behind is %s; it must be 0 … 1",
                    pbf_text_number(number, read->behind));
  if (read->behind == 0) return PBF_OK;
  if (read->field != PBF_FIELD_POSITION)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "read.behind is %.9g; it must be 0 but for positions, which alone are kept",
                    read->behind);
  if (solver->previous) return PBF_OK;
  return pbf_fail(PBF_ERROR_STATE,
                  "read.behind is %.9g; positions before a step are kept after "
                  "pbf_keep_previous(solver, 1)",
                  read->behind);
}

static pbf_status check_place(const pbf_solver *solver, const pbf_read_desc *read) {
  const uint32_t size = bytes_of(type_of(solver, read));
  const uint64_t least = (uint64_t)components_of(solver, read) * size;
  if (read->count == 0) return PBF_OK;
  return pbf_values_check_layout("read", read->data, read->stride, least, size);
}

static pbf_status check_device(const pbf_solver *solver, const pbf_read_desc *read) {
  int is_device;
  const pbf_status status = pbf_device_rows_check(solver, "read", read->device_type, read->reserved,
                                                  read->stream, &is_device);
  if (status != PBF_OK || !is_device || read->behind == 0) return status;
  return pbf_fail(
      PBF_ERROR_UNSUPPORTED,
      "read.behind is %.9g; positions before a step are in host memory, and read.device_type "
      "is 2 (PBF_DEVICE_CUDA)",
      read->behind);
}

static pbf_status check(const pbf_solver *solver, const pbf_read_desc *read) {
  if (read->field < PBF_FIELD_POSITION || read->field > PBF_FIELD_PRESSURE)
    return fail_on("field", read->field, "1 … 5 (PBF_FIELD_…)");
  pbf_status status = pbf_check_rows(solver, read->first, read->count);
  if (status == PBF_OK) status = check_type(read);
  if (status == PBF_OK) status = check_components(solver, read);
  if (status == PBF_OK) status = check_w(solver, read);
  if (status == PBF_OK) status = check_order(solver, read);
  if (status == PBF_OK) status = check_behind(solver, read);
  if (status == PBF_OK) status = check_device(solver, read);
  if (status == PBF_OK) status = check_place(solver, read);
  if (status == PBF_OK && read->field == PBF_FIELD_PRESSURE) status = pbf_check_pressures(solver);
  return status;
}

/* ---- Where numbers come from ----------------------------------------------------------------- */

/* What a reading is made from. Elements are particles in the order in which they lie: of a host's
 * memory all, by the backend's ids; else the rows that are asked for. */
typedef struct reading {
  pbf_solver *solver;
  const pbf_read_desc *desc;
  uint32_t type, components, elements;
  uint64_t stride;
  const uint32_t *ids; /* of elements; null: they are rows first, first + 1, … */
  uint32_t *rows;      /* of ids from first_id on; null: to be looked up */
  uint32_t first_id, ids_end;
  pbf_numbers field, velocity; /* by element */
  pbf_numbers scalar;          /* for w, by row from first on */
} reading;

/* A table of rows instead of a search for each, unless ids lie too far apart. */
static pbf_status find_rows(reading *r) {
  const pbf_solver *solver = r->solver;
  void *memory;
  if (!r->ids || !solver->ids) return PBF_OK;
  const uint32_t first = solver->ids[0];
  const uint64_t span = (uint64_t)solver->ids[solver->count - 1] - first + 1;
  if (span > 16 * (uint64_t)solver->count) return PBF_OK;
  pbf_status status =
      pbf_memory_allocate(&solver->allocator, span * sizeof *r->rows, "a table of rows", &memory);
  if (status != PBF_OK) return status;
  r->rows = memory;
  r->first_id = first;
  r->ids_end = (uint32_t)span;
  for (uint32_t row = 0; row < solver->count; ++row) r->rows[solver->ids[row] - first] = row;
  return PBF_OK;
}

/* Position or velocity. */
static pbf_status find_vectors(reading *r, uint32_t field, pbf_numbers *numbers) {
  pbf_status status = pbf_numbers_find(r->solver, field, r->desc->first, r->desc->count, numbers);
  r->ids = numbers->ids;
  r->elements = numbers->elements;
  return status;
}

static pbf_status copy_rows(const reading *r, uint32_t field, pbf_numbers *numbers) {
  return pbf_numbers_copy(r->solver, field, r->desc->first, r->desc->count, numbers);
}

static pbf_status find_all(reading *r) {
  const pbf_read_desc *desc = r->desc;
  pbf_status status = is_vector(desc->field) ? find_vectors(r, desc->field, &r->field)
                                             : copy_rows(r, desc->field, &r->field);
  if (status != PBF_OK || r->components != 4) return status;
  if (desc->w == PBF_W_SPEED) return find_vectors(r, PBF_FIELD_VELOCITY, &r->velocity);
  if (desc->w == PBF_W_CONSTANT) return PBF_OK;
  return copy_rows(r, desc->w == PBF_W_DENSITY ? PBF_FIELD_DENSITY : PBF_FIELD_PRESSURE,
                   &r->scalar);
}

static void free_all(const reading *r) {
  pbf_numbers_free(r->solver, &r->field);
  pbf_numbers_free(r->solver, &r->velocity);
  pbf_numbers_free(r->solver, &r->scalar);
  pbf_memory_free(&r->solver->allocator, r->rows, (uint64_t)r->ids_end * sizeof *r->rows);
}

/* ---- Writing --------------------------------------------------------------------------------- */

/* What a particle's numbers are written by. Loops have a copy of it: what is written could be part
 * of anything else, and all of it would be read again for each particle. */
typedef struct writing {
  char *data;
  uint64_t stride;
  uint32_t first, count, elements;
  const uint32_t *ids, *rows; /* as in reading */
  uint32_t first_id;
  const pbf_solver *solver; /* for a search; null: ids are rows */
  pbf_numbers field, velocity, scalar, previous;
  uint32_t previous_count, dimension;
  double behind, w_value;
} writing;

static inline void put(char *at, uint32_t type, uint32_t component, double number) {
  const float single = (float)number;
  if (type == PBF_TYPE_FLOAT32)
    memcpy(at + component * sizeof single, &single, sizeof single);
  else
    memcpy(at + component * sizeof number, &number, sizeof number);
}

static inline uint32_t row_of(const writing *w, uint32_t element) {
  uint32_t row;
  if (!w->ids) return w->first + element;
  if (w->rows) return w->rows[w->ids[element] - w->first_id];
  if (!w->solver) return w->ids[element];
  return pbf_ids_find(w->solver, w->ids[element], &row) ? row : UINT32_MAX;
}

static inline double speed_of(const writing *w, uint32_t element, uint32_t precision) {
  double sum = 0;
  for (uint32_t k = 0; k < w->dimension; ++k) {
    const double v = pbf_numbers_get(&w->velocity, element, k, precision);
    sum += v * v;
  }
  return sqrt(sum);
}

static inline double w_of(const writing *w, uint32_t element, uint32_t row, uint32_t precision) {
  if (w->velocity.data) return speed_of(w, element, precision);
  if (w->scalar.data) return pbf_numbers_get(&w->scalar, row - w->first, 0, precision);
  return w->w_value;
}

/* How numbers are read and written: constants where a loop is called. */
typedef struct manner {
  uint32_t precision, type, own, components;
  int stored, blends;
} manner;

static PBF_ALWAYS_INLINE void write_one(const writing *w, manner m, uint32_t element, uint32_t row,
                                        char *at) {
  for (uint32_t k = 0; k < m.own; ++k) {
    double x = pbf_numbers_get(&w->field, element, k, m.precision);
    if (m.blends && row < w->previous_count)
      x += w->behind * (pbf_numbers_get(&w->previous, row, k, m.precision) - x);
    put(at, m.type, k, x);
  }
  for (uint32_t k = m.own; k < m.components && k < 3; ++k) put(at, m.type, k, 0);
  if (m.components == 4) put(at, m.type, 3, w_of(w, element, row, m.precision));
}

static PBF_ALWAYS_INLINE void write_all(const writing *all, manner m) {
  const writing w = *all;
  const int asks = m.blends || w.scalar.data || !m.stored;
  for (uint32_t element = 0; element < w.elements; ++element) {
    const uint32_t row = asks ? row_of(&w, element) : 0, place = row - w.first;
    if (m.stored)
      write_one(&w, m, element, row, w.data + element * w.stride);
    else if (place < w.count)
      write_one(&w, m, element, row, w.data + place * w.stride);
  }
}

static PBF_ALWAYS_INLINE void write_in_order(const writing *w, manner m) {
  if (m.stored) {
    m.stored = 1;
    write_all(w, m);
  } else {
    m.stored = 0;
    write_all(w, m);
  }
}

/* The usual ones in loops of their own. */
static void write_numbers(const writing *w, manner m) {
  const manner triple = {PBF_FLOAT32, PBF_TYPE_FLOAT32, 3, 3, m.stored, 0};
  const manner quad = {PBF_FLOAT32, PBF_TYPE_FLOAT32, 3, 4, m.stored, 0};
  const manner triple_between = {PBF_FLOAT32, PBF_TYPE_FLOAT32, 3, 3, m.stored, 1};
  const manner quad_between = {PBF_FLOAT32, PBF_TYPE_FLOAT32, 3, 4, m.stored, 1};
  const int singles = m.precision == PBF_FLOAT32 && m.type == PBF_TYPE_FLOAT32 && m.own == 3;
  if (singles && m.components == 3 && !m.blends)
    write_in_order(w, triple);
  else if (singles && m.components == 4 && !m.blends)
    write_in_order(w, quad);
  else if (singles && m.components == 3)
    write_in_order(w, triple_between);
  else if (singles && m.components == 4)
    write_in_order(w, quad_between);
  else
    write_all(w, m);
}

static void write_reading(const reading *r) {
  const pbf_solver *solver = r->solver;
  const pbf_read_desc *desc = r->desc;
  const writing w = {
      .data = desc->data,
      .stride = r->stride,
      .first = desc->first,
      .count = desc->count,
      .elements = r->elements,
      .ids = r->ids,
      .rows = r->rows,
      .first_id = r->first_id,
      .solver = solver->ids ? solver : NULL,
      .field = r->field,
      .velocity = r->velocity,
      .scalar = r->scalar,
      .previous = {.data = solver->previous,
                   .particle_stride = (int64_t)pbf_point_bytes(solver),
                   .component_stride = pbf_element_size(solver)},
      .previous_count = solver->previous_count,
      .dimension = solver->kind.dimension,
      .behind = desc->behind,
      .w_value = desc->w_value,
  };
  const manner m = {
      .precision = solver->kind.precision,
      .type = r->type,
      .own = is_vector(desc->field) ? solver->kind.dimension : 1,
      .components = r->components,
      .stored = desc->order == PBF_ORDER_STORED,
      .blends = desc->behind > 0,
  };
  write_numbers(&w, m);
}

static pbf_status read_numbers(reading *r) {
  pbf_status status = find_all(r);
  if (status == PBF_OK) status = find_rows(r);
  if (status == PBF_OK) write_reading(r);
  free_all(r);
  return status;
}

/* Of a host's memory in the order there; else rows. */
static pbf_status read_ids(const reading *r) {
  pbf_view view = {.device_type = PBF_DEVICE_CUDA};
  pbf_status status = PBF_OK;
  if (r->desc->order == PBF_ORDER_STORED) status = pbf_view_of(r->solver, PBF_FIELD_ID, &view);
  for (uint32_t i = 0; i < r->desc->count && status == PBF_OK; ++i) {
    const uint32_t id = view.device_type == PBF_DEVICE_CPU
                            ? view.ids[i]
                            : pbf_ids_of_row(r->solver, r->desc->first + i);
    memcpy((char *)r->desc->data + i * r->stride, &id, sizeof id);
  }
  return status;
}

static pbf_status read_to_device(const reading *r) {
  const pbf_read_desc *desc = r->desc;
  const pbf_rows rows = pbf_ids_rows(r->solver, desc->first, desc->count);
  const pbf_device_rows to = {.struct_size = sizeof to,
                              .field = desc->field,
                              .rows = &rows,
                              .element_type = r->type,
                              .components = r->components,
                              .w = desc->w,
                              .order = desc->order,
                              .stride = r->stride,
                              .data = desc->data,
                              .stream = desc->stream,
                              .w_value = desc->w_value,
                              .name = "read.data"};
  return pbf_device_rows_read(r->solver, &to);
}

static pbf_status read_as(pbf_solver *solver, const pbf_read_desc *theirs) {
  pbf_read_desc read;
  if (!theirs) return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "read is null; it says what to read");
  pbf_status status = pbf_struct_in(&pbf_kind_read_desc, theirs, &read);
  if (status == PBF_OK) status = check(solver, &read);
  if (status != PBF_OK || read.count == 0) return status;
  reading r = {.solver = solver,
               .desc = &read,
               .type = type_of(solver, &read),
               .components = components_of(solver, &read),
               .elements = read.count};
  r.stride = read.stride ? read.stride : (uint64_t)r.components * bytes_of(r.type);
  if (read.device_type == PBF_DEVICE_CUDA) return read_to_device(&r);
  return read.field == PBF_FIELD_ID ? read_ids(&r) : read_numbers(&r);
}

pbf_status pbf_read(pbf_solver *solver, const pbf_read_desc *read) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, read_as(solver, read));
}
