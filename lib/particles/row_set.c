#include "row_set.h"

#include <string.h>

#include "memory.h"
#include "phases.h"
#include "solver/backend_call.h"
#include "solver/ids.h"

pbf_status pbf_row_set_allocate(const pbf_solver *solver, pbf_row_set *set) {
  void *bits = NULL;
  *set = (pbf_row_set){.bytes = ((uint64_t)solver->count + 63) / 64 * 8};
  pbf_status status = pbf_memory_allocate(&solver->allocator, set->bytes, "a set of rows", &bits);
  if (status != PBF_OK) return status;
  set->bits = bits;
  memset(bits, 0, set->bytes);
  return PBF_OK;
}

void pbf_row_set_free(const pbf_solver *solver, pbf_row_set *set) {
  pbf_memory_free(&solver->allocator, set->bits, set->bytes);
}

/* The first row from `row` on that is in it or, where `in` is 0, is not; `end` where there is none.
 * Most words of a set are all of one kind. */
static uint32_t next_row(const pbf_row_set *set, uint64_t row, uint32_t end, int in) {
  const uint64_t others = in ? 0 : ~UINT64_C(0);
  while (row < end && pbf_row_set_has(set, (uint32_t)row) != in)
    row = row % 64 == 0 && set->bits[row / 64] == others ? row + 64 : row + 1;
  return row < end ? (uint32_t)row : end;
}

void pbf_row_set_ids(const pbf_solver *solver, const pbf_row_set *set, uint32_t most,
                     uint32_t *ids) {
  uint32_t row = next_row(set, 0, solver->count, 1);
  for (uint32_t found = 0; row < solver->count && found < most; ++found) {
    ids[found] = pbf_ids_of_row(solver, row);
    row = next_row(set, (uint64_t)row + 1, solver->count, 1);
  }
}

/* Rows of an array that stay, run by run; returns how many. */
static uint32_t compact(const pbf_row_set *removed, void *array, uint64_t row_bytes,
                        uint32_t count) {
  char *rows = array;
  uint32_t kept = next_row(removed, 0, count, 1);
  for (uint32_t from = kept, end; from < count; from = end) {
    from = next_row(removed, from, count, 0);
    end = next_row(removed, from, count, 1);
    memmove(rows + kept * row_bytes, rows + from * row_bytes, (end - from) * row_bytes);
    kept += end - from;
  }
  return kept;
}

static void compact_all(pbf_solver *solver, const pbf_row_set *removed) {
  const uint64_t vector = pbf_point_bytes(solver);
  solver->previous_count = compact(removed, solver->previous, vector, solver->previous_count);
  solver->acceleration_count =
      compact(removed, solver->accelerations, vector, solver->acceleration_count);
  if (solver->phases) (void)compact(removed, solver->phases->rows, 1, solver->count);
  solver->count = compact(removed, solver->ids, sizeof *solver->ids, solver->count);
  if (solver->count == 0) solver->overlap.moved = 0;
  ++solver->generation;
}

pbf_status pbf_row_set_remove(pbf_solver *solver, const pbf_row_set *set) {
  void *ids = NULL;
  const uint64_t bytes = set->count * sizeof(uint32_t);
  if (set->count == 0) return PBF_OK;
  pbf_status status = pbf_memory_allocate(&solver->allocator, bytes, "a list of ids", &ids);
  if (status == PBF_OK) status = pbf_ids_store(solver);
  if (status == PBF_OK) {
    pbf_row_set_ids(solver, set, set->count, ids);
    status = solver->api.remove_particles(solver->backend, set->count, ids);
    if (status == PBF_OK) compact_all(solver, set);
    status = pbf_backend_result(solver, status, "remove_particles");
  }
  pbf_memory_free(&solver->allocator, ids, bytes);
  return status;
}
