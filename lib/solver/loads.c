/* What the fluid does to solids. */

#include "backend_call.h"
#include "error.h"
#include "handles.h"
#include "structs.h"

/* Their numbers to a backend: physics/loads.h. */
enum { WALLS = 6, LOADS_AT_ONCE = 64 };

static pbf_status check_found(const pbf_solver *solver) {
  if (!solver->params.loads)
    return pbf_fail(PBF_ERROR_STATE, "params.loads is 0; with 1 steps find loads");
  if (solver->api.get_loads) return PBF_OK;
  return pbf_fail(PBF_ERROR_UNSUPPORTED, "the backend \"%s\" finds no loads", solver->plugin->name);
}

/* Every struct of the array has the size of the first. */
static pbf_status check_out(uint32_t count, const pbf_collider_load *theirs) {
  pbf_status status = pbf_struct_check_out(&pbf_kind_collider_load, theirs);
  const uint32_t stride = status == PBF_OK ? pbf_struct_size(theirs) : 0;
  for (uint32_t i = 1; i < count && status == PBF_OK; ++i) {
    const uint32_t size = pbf_struct_size((const unsigned char *)theirs + (uint64_t)i * stride);
    if (size != stride)
      status =
          pbf_fail(PBF_ERROR_STRUCT_SIZE,
                   "loads[%u].struct_size is %u; it must be that of loads[0], %u", i, size, stride);
  }
  return status;
}

/* Copies the loads of some solids into a caller's array. */
static pbf_status read_some(pbf_solver *solver, uint32_t first, uint32_t count,
                            unsigned char *theirs, uint32_t stride) {
  pbf_collider_load loads[LOADS_AT_ONCE];
  pbf_status status = solver->api.get_loads(solver->backend, first, count, loads);
  status = pbf_backend_result(solver, status, "get_loads");
  for (uint32_t i = 0; i < count && status == PBF_OK; ++i)
    pbf_struct_out(&pbf_kind_collider_load, &loads[i], theirs + (uint64_t)i * stride, stride);
  return status;
}

/* Loads of all solids of a kind, `there` in number, of which the first is number `first`. */
static pbf_status get_loads(pbf_solver *solver, const char *kind, uint32_t first, uint32_t there,
                            uint32_t count, pbf_collider_load *theirs) {
  pbf_status status = check_found(solver);
  if (status != PBF_OK) return status;
  if (count != there)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "count is %u; the solver has %u %s", count, there,
                    kind);
  if (count == 0) return PBF_OK;
  status = check_out(count, theirs);
  const uint32_t stride = status == PBF_OK ? pbf_struct_size(theirs) : 0;
  for (uint32_t i = 0; i < count && status == PBF_OK; i += LOADS_AT_ONCE) {
    const uint32_t left = count - i, some = left < LOADS_AT_ONCE ? left : LOADS_AT_ONCE;
    status =
        read_some(solver, first + i, some, (unsigned char *)theirs + (uint64_t)i * stride, stride);
  }
  return status;
}

pbf_status pbf_get_collider_loads(pbf_solver *solver, uint32_t count, pbf_collider_load *loads) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver,
                   get_loads(solver, "colliders", WALLS, solver->collider_count, count, loads));
}

pbf_status pbf_get_wall_loads(pbf_solver *solver, uint32_t count, pbf_collider_load *loads) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, get_loads(solver, "walls", 0, 2 * solver->kind.dimension, count, loads));
}
