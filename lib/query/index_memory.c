/* The memory of what is sorted for queries, given back. */
#include "index.h"
#include "memory.h"

uint64_t pbf_query_order_bytes(const pbf_query_index *index) {
  return 2 * (uint64_t)index->order_capacity * sizeof *index->order;
}

void pbf_query_index_free(pbf_solver *solver) {
  pbf_query_index *index = solver->query;
  if (!index) return;
  solver->query = NULL;
  pbf_memory_free(&solver->allocator, index->order, pbf_query_order_bytes(index));
  pbf_memory_free(&solver->allocator, index, index->bytes);
}
