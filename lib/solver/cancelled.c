#include "cancelled.h"

#include <stddef.h>

#include "backend_call.h"

static uint32_t is_asked_to_end(const pbf_solver *solver) {
  return atomic_load_explicit(&solver->cancelled, memory_order_relaxed);
}

int pbf_is_cancelled(const pbf_solver *solver) {
  return (int)(solver->ranks.count ? solver->told : is_asked_to_end(solver));
}

pbf_status pbf_tell_cancelled(pbf_solver *solver) {
  const pbf_backend_api *api = &solver->api;
  solver->untold = 0;
  const pbf_backend_ranks_tell *tell = api->get_extension(PBF_BACKEND_RANKS_TELL);
  if (!tell || tell->struct_size < offsetof(pbf_backend_ranks_tell, note)) return PBF_OK;
  return pbf_backend_result(
      solver, tell->any(solver->backend, is_asked_to_end(solver), &solver->told), "any");
}
