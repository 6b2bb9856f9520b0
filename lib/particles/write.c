/* Writing fields from the caller's own layout. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "check.h"
#include "device_rows.h"
#include "error.h"
#include "memory.h"
#include "particles.h"
#include "solver/handles.h"
#include "solver/ids.h"
#include "structs.h"
#include "text.h"
#include "values.h"

/* A writing, in which zeros have given way to what they stand for. */
typedef struct writing {
  pbf_solver *solver;
  pbf_write_desc desc;
  uint32_t size; /* bytes of a number */
  int is_device;
} writing;

static pbf_status fail_on(const char *member, uint32_t value, const char *demand) {
  return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "write.%s is %u; it must be %s", member, value,
                  demand);
}

static pbf_status check_numbers(const writing *w) {
  const pbf_write_desc *desc = &w->desc;
  const uint32_t type = desc->element_type, dimension = w->solver->kind.dimension;
  if (desc->field != PBF_FIELD_POSITION && desc->field != PBF_FIELD_VELOCITY)
    return fail_on("field", desc->field, "1 (position) or 2 (velocity)");
  if (type != 0 && type != PBF_TYPE_FLOAT32 && type != PBF_TYPE_FLOAT64)
    return fail_on("element_type", type, "4 (float32), 8 (float64) or 0");
  if (desc->components != 0 && (desc->components < dimension || desc->components > 4))
    return fail_on("components", desc->components, dimension == 2 ? "2 … 4 or 0" : "3, 4 or 0");
  return pbf_check_rows(w->solver, desc->first, desc->count);
}

static void fill_in(writing *w) {
  pbf_write_desc *desc = &w->desc;
  if (!desc->element_type) desc->element_type = w->solver->kind.precision;
  if (!desc->components) desc->components = w->solver->kind.dimension;
  w->size = desc->element_type == PBF_TYPE_FLOAT64 ? 8 : 4;
  if (!desc->stride) desc->stride = (uint64_t)desc->components * w->size;
}

static pbf_status check_place(const writing *w) {
  const pbf_write_desc *desc = &w->desc;
  const uint64_t least = (uint64_t)desc->components * w->size;
  if (desc->count == 0) return PBF_OK;
  return pbf_values_check_layout("write", desc->data, desc->stride, least, w->size);
}

/* ---- Numbers as the solver has them, without gaps -------------------------------------------- */

static double number_at(const char *row, uint32_t k, uint32_t size) {
  float single;
  double number;
  if (size == sizeof number) return memcpy(&number, row + k * sizeof number, sizeof number), number;
  memcpy(&single, row + k * sizeof single, sizeof single);
  return (double)single;
}

static void gather(const writing *w, const char *from, uint64_t stride, void *to) {
  const uint32_t dimension = w->solver->kind.dimension;
  const int is_single = w->solver->kind.precision == PBF_FLOAT32;
  for (uint32_t row = 0; row < w->desc.count; ++row)
    for (uint32_t k = 0; k < dimension; ++k) {
      const double x = number_at(from + row * stride, k, w->size);
      const uint64_t place = (uint64_t)row * dimension + k;
      if (is_single)
        ((float *)to)[place] = (float)x;
      else
        ((double *)to)[place] = x;
    }
}

/* What float64 holds and float32 does not: once gathered it would be told of as infinite. */
static pbf_status check_range(const writing *w, const char *from, uint64_t stride) {
  const uint32_t dimension = w->solver->kind.dimension;
  char number[PBF_NUMBER_SIZE];
  if (w->solver->kind.precision != PBF_FLOAT32 || w->size == sizeof(float)) return PBF_OK;
  for (uint32_t row = 0; row < w->desc.count; ++row)
    for (uint32_t k = 0; k < dimension; ++k) {
      const double given = number_at(from + row * stride, k, w->size);
      if (!isfinite(given) || isfinite((float)given)) continue;
      return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                      "%s[%u][%u] is %s; it must be a number that float32 holds, at most 3.4e38 in "
                      "size",
                      w->desc.field == PBF_FIELD_POSITION ? "positions" : "velocities",
                      w->desc.first + row, k, pbf_text_number(number, given));
    }
  return PBF_OK;
}

static pbf_status write_gathered(const writing *w, const char *from, uint64_t stride) {
  const pbf_write_desc *desc = &w->desc;
  pbf_status status = check_range(w, from, stride);
  if (status != PBF_OK) return status;
  const pbf_allocator *allocator = &w->solver->allocator;
  const uint64_t bytes = desc->count * pbf_point_bytes(w->solver);
  void *memory;
  status = pbf_memory_allocate(allocator, bytes, "a copy of what is written", &memory);
  if (status != PBF_OK) return status;
  gather(w, from, stride, memory);
  status = pbf_write_field(w->solver, desc->field, desc->first, desc->count, memory);
  pbf_memory_free(allocator, memory, bytes);
  return status;
}

static pbf_status write_from_host(const writing *w) {
  const pbf_write_desc *desc = &w->desc;
  if (w->size == pbf_element_size(w->solver) && desc->stride == pbf_point_bytes(w->solver))
    return pbf_write_field(w->solver, desc->field, desc->first, desc->count, desc->data);
  return write_gathered(w, desc->data, desc->stride);
}

/* ---- From a device --------------------------------------------------------------------------- */

static pbf_status write_positions_from_device(const writing *w, const pbf_device_rows *rows) {
  const pbf_allocator *allocator = &w->solver->allocator;
  const uint64_t stride = (uint64_t)w->desc.components * w->size, bytes = w->desc.count * stride;
  void *memory;
  pbf_status status = pbf_memory_allocate(allocator, bytes, "a copy of what is written", &memory);
  if (status != PBF_OK) return status;
  status = pbf_device_rows_fetch(w->solver, rows, memory);
  if (status == PBF_OK) status = write_gathered(w, memory, stride);
  pbf_memory_free(allocator, memory, bytes);
  return status;
}

static pbf_status write_from_device(const writing *w) {
  const pbf_write_desc *desc = &w->desc;
  const pbf_rows rows = pbf_ids_rows(w->solver, desc->first, desc->count);
  const pbf_device_rows from = {.struct_size = sizeof from,
                                .field = desc->field,
                                .rows = &rows,
                                .element_type = desc->element_type,
                                .components = desc->components,
                                .stride = desc->stride,
                                .data = (void *)(uintptr_t)desc->data,
                                .stream = desc->stream,
                                .most = pbf_check_most,
                                .name = "write.data"};
  pbf_status status = pbf_check_unmapped(w->solver);
  if (status != PBF_OK) return status;
  if (desc->field == PBF_FIELD_POSITION) return write_positions_from_device(w, &from);
  status = pbf_device_rows_write(w->solver, &from);
  if (status == PBF_OK) ++w->solver->generation;
  return status;
}

static pbf_status write_as(pbf_solver *solver, const pbf_write_desc *theirs) {
  writing w = {.solver = solver};
  if (!theirs) return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "write is null; it says what to write");
  pbf_status status = pbf_struct_in(&pbf_kind_write_desc, theirs, &w.desc);
  if (status == PBF_OK) status = check_numbers(&w);
  if (status == PBF_OK)
    status = pbf_device_rows_check(solver, "write", w.desc.device_type, w.desc.reserved,
                                   w.desc.stream, &w.is_device);
  if (status != PBF_OK) return status;
  fill_in(&w);
  status = check_place(&w);
  if (status != PBF_OK || w.desc.count == 0) return status;
  return w.is_device ? write_from_device(&w) : write_from_host(&w);
}

pbf_status pbf_write(pbf_solver *solver, const pbf_write_desc *write) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, write_as(solver, write));
}
