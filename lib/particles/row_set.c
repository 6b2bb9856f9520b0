#include "row_set.h"

#include <string.h>

#include "accelerations.h"
#include "memory.h"
#include "phases.h"
#include "solver/backend_call.h"
#include "solver/ids.h"
#include "solver/previous.h"

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

void pbf_row_set_ids(const pbf_solver *solver, const pbf_row_set *set, uint32_t most,
                     uint32_t *ids) {
  uint32_t found = 0;
  for (uint32_t row = 0; row < solver->count && found < most; ++row)
    if (pbf_row_set_has(set, row)) ids[found++] = pbf_ids_of_row(solver, row);
}

static void compact_previous(pbf_solver *solver, const pbf_row_set *removed) {
  uint32_t kept = 0;
  for (uint32_t row = 0; row < solver->previous_count; ++row)
    if (!pbf_row_set_has(removed, row)) pbf_previous_move(solver, row, kept++);
  solver->previous_count = kept;
}

static void compact_accelerations(pbf_solver *solver, const pbf_row_set *removed) {
  uint32_t kept = 0;
  for (uint32_t row = 0; row < solver->acceleration_count; ++row)
    if (!pbf_row_set_has(removed, row)) pbf_accelerations_move(solver, row, kept++);
  solver->acceleration_count = kept;
}

static void compact_ids(pbf_solver *solver, const pbf_row_set *removed) {
  uint32_t kept = 0;
  compact_previous(solver, removed);
  compact_accelerations(solver, removed);
  for (uint32_t row = 0; row < solver->count; ++row) {
    if (pbf_row_set_has(removed, row)) continue;
    pbf_phases_move(solver, row, kept);
    solver->ids[kept++] = solver->ids[row];
  }
  solver->count = kept;
  if (kept == 0) solver->overlap.moved = 0;
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
    if (status == PBF_OK) compact_ids(solver, set);
    status = pbf_backend_result(solver, status, "remove_particles");
  }
  pbf_memory_free(&solver->allocator, ids, bytes);
  return status;
}
