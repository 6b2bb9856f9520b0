#include "views.h"

#include <stdatomic.h>

#include "error.h"
#include "particles.h"
#include "rank_views.h"
#include "solver/backend_call.h"
#include "solver/handles.h"
#include "structs.h"

static pbf_status check_field(uint32_t field) {
  if (field >= PBF_FIELD_POSITION && field <= PBF_FIELD_ID) return PBF_OK;
  if (field == PBF_FIELD_PRESSURE) return PBF_OK;
  if (field == PBF_FIELD_DENSITY) {
    return pbf_fail(PBF_ERROR_UNSUPPORTED,
                    "field is 4 (density), which no backend keeps; pbf_get_densities computes it");
  }
  return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                  "field is %u; it must be 1 (position), 2 (velocity), 3 (id) or 5 (pressure)",
                  field);
}

static uint32_t type_of(const pbf_solver *solver, uint32_t field) {
  return field == PBF_FIELD_ID ? PBF_TYPE_UINT32 : solver->kind.precision;
}

static uint32_t components_of(const pbf_solver *solver, uint32_t field) {
  return field == PBF_FIELD_ID || field == PBF_FIELD_PRESSURE ? 1 : solver->kind.dimension;
}

/* Null for a view that fits, else the member that doesn't. */
static const char *misfit(const pbf_solver *solver, uint32_t field, const pbf_view *view) {
  if (view->field != field) return "field";
  if (view->count != solver->count) return "count";
  if (view->element_type != type_of(solver, field)) return "element_type";
  if (view->components != components_of(solver, field)) return "components";
  if (view->device_type != PBF_DEVICE_CPU && view->device_type != PBF_DEVICE_CUDA)
    return "device_type";
  if (solver->count > 0 && !view->data) return "data";
  if (solver->count > 0 && !view->ids) return "ids";
  return NULL;
}

static pbf_status map_backend(pbf_solver *solver, uint32_t field, pbf_view *view) {
  const pbf_backend_api *api = &solver->api;
  if (field == PBF_FIELD_PRESSURE)
    return pbf_backend_result(solver, api->map_pressures(solver->backend, view), "map_pressures");
  return pbf_backend_result(solver, api->map(solver->backend, field, view), "map");
}

pbf_status pbf_view_of(pbf_solver *solver, uint32_t field, pbf_view *view) {
  pbf_status status = check_field(field);
  if (status == PBF_OK && field == PBF_FIELD_PRESSURE) status = pbf_check_pressures(solver);
  if (status != PBF_OK) return status;
  *view = (pbf_view){.struct_size = sizeof *view, .field = field};
  status = solver->ranks.count > 0 ? pbf_rank_view_of(solver, field, view)
                                   : map_backend(solver, field, view);
  if (status != PBF_OK) return status;
  const char *member = misfit(solver, field, view);
  if (member) {
    return pbf_fail(PBF_ERROR_PLUGIN, "the backend \"%s\" gave a view with a wrong '%s'",
                    solver->plugin->name, member);
  }
  view->generation = solver->generation;
  view->reserved = 0;
  return PBF_OK;
}

static pbf_status map(pbf_solver *solver, uint32_t field, pbf_view *theirs) {
  pbf_view view;
  pbf_status status = pbf_struct_check_out(&pbf_kind_view, theirs);
  if (status == PBF_OK) status = pbf_view_of(solver, field, &view);
  if (status != PBF_OK) return status;
  pbf_struct_out(&pbf_kind_view, &view, theirs, theirs->struct_size);
  ++solver->mapped[field];
  return PBF_OK;
}

pbf_status pbf_map(pbf_solver *solver, uint32_t field, pbf_view *view) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, map(solver, field, view));
}

static pbf_status unmap(_Atomic uint32_t *mapped, uint32_t field) {
  for (uint32_t now = *mapped; now > 0;)
    if (atomic_compare_exchange_weak(mapped, &now, now - 1)) return PBF_OK;
  return pbf_fail(PBF_ERROR_STATE, "field is %u, of which no view is mapped", field);
}

/* Any thread, at any time: a collector of garbage has a thread of its own. */
pbf_status pbf_unmap(pbf_solver *solver, uint32_t field) {
  pbf_status status = pbf_hold(solver);
  if (status != PBF_OK) return status;
  status = check_field(field);
  if (status == PBF_OK) status = unmap(&solver->mapped[field], field);
  pbf_let_go(solver);
  return status;
}
