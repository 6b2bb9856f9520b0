/* Spray, foam and bubbles in the caller's layout. */
#include <string.h>

#include "diffuse.h"
#include "error.h"
#include "solver/handles.h"
#include "structs.h"

/* The read with all that it leaves to the library. */
static void fill_in(const pbf_solver *solver, pbf_diffuse_read *read) {
  if (read->element_type == 0) read->element_type = solver->kind.precision;
  if (read->components == 0) read->components = solver->kind.dimension;
}

/* The longest element that is asked for. */
static uint64_t longest(const pbf_diffuse_read *read) {
  uint64_t bytes = 0;
  if (read->kinds) bytes = sizeof *read->kinds;
  if (read->ages || read->lives) bytes = bytes > read->element_type ? bytes : read->element_type;
  if (read->ids && bytes < sizeof *read->ids) bytes = sizeof *read->ids;
  const uint64_t point = (uint64_t)read->components * read->element_type;
  return (read->positions || read->velocities) && point > bytes ? point : bytes;
}

static pbf_status check_layout(const pbf_solver *solver, const pbf_diffuse_read *read) {
  const uint32_t dimension = solver->kind.dimension;
  if (read->reserved != 0)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "read.reserved is %u; it must be 0",
                    read->reserved);
  if (read->element_type != PBF_TYPE_FLOAT32 && read->element_type != PBF_TYPE_FLOAT64)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "read.element_type is %u; it must be PBF_TYPE_FLOAT32, PBF_TYPE_FLOAT64 or 0",
                    read->element_type);
  if (read->components < dimension || read->components > 3)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "read.components is %u; in %uD it must be %s3, or 0 for as many as dimensions",
                    read->components, dimension, dimension == 2 ? "2 or " : "");
  const uint64_t most = UINT64_C(1) << 32;
  if (read->stride != 0 && (read->stride < longest(read) || read->stride > most))
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "read.stride is %.0f bytes; it must be at least %.0f, that of the longest that "
                    "is asked for, and at most 2^32, or 0",
                    (double)read->stride, (double)longest(read));
  return PBF_OK;
}

static pbf_status check_range(const pbf_solver *solver, const pbf_diffuse_read *read) {
  const uint32_t there = solver->diffuse ? solver->diffuse->head.count : 0;
  if (read->first > there || read->count > there - read->first)
    return pbf_fail(PBF_ERROR_NOT_FOUND,
                    "read.first is %u and read.count %u; there are %u diffuse particles",
                    read->first, read->count, there);
  if (read->count > 0 && longest(read) == 0)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "read.positions, velocities, ages, lives, kinds and ids are null; at least one "
                    "is to be written to");
  return PBF_OK;
}

static void put(void *array, uint64_t at, uint32_t type, double number) {
  const float single = (float)number;
  char *to = (char *)array + at;
  if (type == PBF_TYPE_FLOAT32)
    memcpy(to, &single, sizeof single);
  else
    memcpy(to, &number, sizeof number);
}

static void put_vector(const pbf_diffuse_read *read, void *array, uint32_t i, const double *v) {
  const uint64_t size = read->element_type, stride = read->components * size;
  const uint64_t at = i * (read->stride ? read->stride : stride);
  for (uint32_t c = 0; array && c < read->components; ++c)
    put(array, at + c * size, read->element_type, v[c]);
}

static void put_number(const pbf_diffuse_read *read, void *array, uint32_t i, double number) {
  if (array)
    put(array, i * (read->stride ? read->stride : read->element_type), read->element_type, number);
}

static void put_bytes(const pbf_diffuse_read *read, void *array, uint32_t i, const void *value,
                      uint64_t size) {
  if (array) memcpy((char *)array + i * (read->stride ? read->stride : size), value, size);
}

static void write_out(const pbf_diffuse *d, const pbf_diffuse_read *read) {
  for (uint32_t i = 0; i < read->count; ++i) {
    const pbf_diffuse_particle *p = pbf_diffuse_at(d, read->first + i);
    put_vector(read, read->positions, i, p->position);
    put_vector(read, read->velocities, i, p->velocity);
    put_number(read, read->ages, i, d->head.time - p->born);
    put_number(read, read->lives, i, p->dies - d->head.time);
    put_bytes(read, read->kinds, i, &p->kind, sizeof p->kind);
    put_bytes(read, read->ids, i, &p->id, sizeof p->id);
  }
}

static pbf_status read_as(const pbf_solver *solver, const pbf_diffuse_read *theirs) {
  pbf_diffuse_read read;
  if (!theirs) return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "read is null; it says what goes where");
  pbf_status status = pbf_struct_in(&pbf_kind_diffuse_read, theirs, &read);
  if (status != PBF_OK) return status;
  fill_in(solver, &read);
  status = check_layout(solver, &read);
  if (status == PBF_OK) status = check_range(solver, &read);
  if (status == PBF_OK && read.count > 0) write_out(solver->diffuse, &read);
  return status;
}

pbf_status pbf_read_diffuse(pbf_solver *solver, const pbf_diffuse_read *read) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, read_as(solver, read));
}
