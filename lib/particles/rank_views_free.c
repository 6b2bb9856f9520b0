/* The memory of views on ranks, given back. */
#include "memory.h"
#include "rank_views.h"

void pbf_rank_views_free(pbf_solver *solver) {
  for (int field = 0; field < PBF_FIELD_COUNT; ++field)
    pbf_memory_free(&solver->allocator, solver->rank_copies[field].data,
                    solver->rank_copies[field].bytes);
}
