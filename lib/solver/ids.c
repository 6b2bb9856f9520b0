#include "ids.h"

#include "common/rows.h"
#include "memory.h"

uint32_t pbf_ids_of_row(const pbf_solver *solver, uint32_t row) {
  return solver->ids ? solver->ids[row] : row;
}

int pbf_ids_find(const pbf_solver *solver, uint32_t id, uint32_t *row) {
  const uint32_t count = solver->count;
  if (solver->ids)
    *row = pbf_id_bound(solver->ids, 0, count, id);
  else
    *row = id < count ? id : count;
  return *row < count && pbf_ids_of_row(solver, *row) == id;
}

pbf_status pbf_ids_store(pbf_solver *solver) {
  void *memory;
  if (solver->ids) return PBF_OK;
  pbf_status status =
      pbf_memory_allocate(&solver->allocator, pbf_ids_bytes(solver), "the particles' ids", &memory);
  if (status != PBF_OK) return status;
  uint32_t *ids = memory;
  for (uint32_t row = 0; row < solver->count; ++row) ids[row] = row;
  solver->ids = ids;
  return PBF_OK;
}

pbf_rows pbf_ids_rows(const pbf_solver *solver, uint32_t first, uint32_t count) {
  return (pbf_rows){
      .struct_size = sizeof(pbf_rows),
      .first = first,
      .count = count,
      .total = solver->count,
      .ids = solver->ids,
  };
}
