#include "ids.h"

#include "memory.h"

uint32_t pbf_ids_of_row(const pbf_solver *solver, uint32_t row) {
  return solver->ids ? solver->ids[row] : row;
}

int pbf_ids_find(const pbf_solver *solver, uint32_t id, uint32_t *row) {
  uint32_t low = 0, end = solver->count;
  while (low < end) {
    uint32_t middle = low + (end - low) / 2;
    if (pbf_ids_of_row(solver, middle) < id) {
      low = middle + 1;
    } else {
      end = middle;
    }
  }
  *row = low;
  return low < solver->count && pbf_ids_of_row(solver, low) == id;
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
