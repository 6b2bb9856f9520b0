#include "rank_settings.h"

#include <stddef.h>
#include <string.h>

#include "fnv.h"

static int is_alone(const pbf_solver *solver) {
  return !solver->ranks.count || !solver->api.get_extension;
}

void pbf_rank_settings_tell(pbf_solver *solver) {
  if (is_alone(solver)) return;
  const pbf_backend_ranks_tell *tell = solver->api.get_extension(PBF_BACKEND_RANKS_TELL);
  const size_t needed = offsetof(pbf_backend_ranks_tell, note) + sizeof tell->note;
  const uint32_t read_for[2] = {solver->snapshots != NULL, solver->previous != NULL};
  const uint64_t all = pbf_fnv(solver->rank_settings, read_for, sizeof read_for);
  if (tell && tell->struct_size >= needed) tell->note(solver->backend, all);
}

void pbf_rank_settings_note(pbf_solver *solver, const char *call, const void *data,
                            uint64_t bytes) {
  if (is_alone(solver)) return;
  solver->rank_settings = pbf_fnv(solver->rank_settings, call, strlen(call));
  solver->rank_settings = pbf_fnv(solver->rank_settings, &bytes, sizeof bytes);
  solver->rank_settings = pbf_fnv(solver->rank_settings, data, bytes);
  pbf_rank_settings_tell(solver);
}
