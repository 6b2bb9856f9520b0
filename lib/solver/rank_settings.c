#include "rank_settings.h"

#include <stddef.h>
#include <string.h>

#include "fnv.h"

void pbf_rank_settings_note(pbf_solver *solver, const char *call, const void *data,
                            uint64_t bytes) {
  if (!solver->ranks.count || !solver->api.get_extension) return;
  const pbf_backend_ranks_tell *tell = solver->api.get_extension(PBF_BACKEND_RANKS_TELL);
  const size_t needed = offsetof(pbf_backend_ranks_tell, note) + sizeof tell->note;
  solver->rank_settings = pbf_fnv(solver->rank_settings, call, strlen(call));
  solver->rank_settings = pbf_fnv(solver->rank_settings, &bytes, sizeof bytes);
  solver->rank_settings = pbf_fnv(solver->rank_settings, data, bytes);
  if (tell && tell->struct_size >= needed) tell->note(solver->backend, solver->rank_settings);
}
