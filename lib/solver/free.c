#include "free.h"

#include "worker.h"
#include "callbacks.h"
#include "colliders.h"
#include "diffuse/diffuse.h"
#include "ids.h"
#include "memory.h"
#include "previous.h"
#include "query/index.h"
#include "emission/emission.h"
#include "particles/accelerations.h"
#include "particles/phases.h"
#include "particles/rank_views.h"
#include "snapshot_memory.h"

static void free_memory(pbf_solver *solver) {
  pbf_memory_free(&solver->allocator, solver->ids, pbf_ids_bytes(solver));
  pbf_memory_free(&solver->allocator, solver->previous, pbf_previous_bytes(solver));
  pbf_accelerations_free(solver);
  pbf_phases_free(solver, solver->phases);
  pbf_rank_views_free(solver);
  pbf_snapshots_free(solver, solver->snapshots);
  pbf_query_index_free(solver);
  pbf_emission_free(solver, solver->emission);
  pbf_diffuse_free(solver, solver->diffuse);
  pbf_memory_free(&solver->allocator, solver->colliders,
                  pbf_colliders_bytes(solver, solver->collider_count));
}

/* What a call that was left halfway has given back it may yet have led to: only which blocks are
 * out is known. */
static void free_left_memory(pbf_solver *solver) {
  pbf_colliders_let_go(solver->brought_count, solver->brought);
  pbf_snapshots_forget(solver->snapshots);
  pbf_callbacks_release_rest(solver);
}

void pbf_solver_free(pbf_solver *solver) {
  const pbf_allocator allocator = solver->callbacks.allocator;
  const pbf_ranks ranks = solver->ranks;
  pbf_worker_free(solver);
  solver->api.destroy(solver->backend);
  if (solver->colliders) pbf_colliders_let_go(solver->collider_count, solver->colliders);
  if (solver->left)
    free_left_memory(solver);
  else
    free_memory(solver);
  pbf_memory_free(&allocator, solver, sizeof *solver);
  if (ranks.release) ranks.release(ranks.user);
}
