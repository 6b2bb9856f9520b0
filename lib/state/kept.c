#include "kept.h"

#include "memory.h"
#include "solver/backend_call.h"

static const struct {
  uint32_t field, components;
} kinds_of[PBF_KEPT_COUNT] = {
    [PBF_KEPT_REST] = {PBF_BACKEND_FIELD_REST, PBF_BACKEND_REST_COMPONENTS},
    [PBF_KEPT_OVERLAP] = {PBF_BACKEND_FIELD_OVERLAP, 1},
    [PBF_KEPT_LAST_PRESSURE] = {PBF_BACKEND_FIELD_LAST_PRESSURE, 1},
};

static int has_last_pressure(const pbf_solver *solver) {
  const pbf_backend_api *api = &solver->plugin->api;
  return api->get_extension && api->get_extension(PBF_BACKEND_LAST_PRESSURE);
}

uint32_t pbf_kept_by(const pbf_solver *solver) {
  uint32_t rest = solver->params.sleep_speed > 0, overlap = solver->overlap.end > 0;
  uint32_t pressure = solver->params.solver == PBF_SOLVER_CHEBYSHEV && has_last_pressure(solver);
  return rest << PBF_KEPT_REST | overlap << PBF_KEPT_OVERLAP | pressure << PBF_KEPT_LAST_PRESSURE;
}

uint32_t pbf_kept_field(pbf_kept kept) { return kinds_of[kept].field; }

uint32_t pbf_kept_components(pbf_kept kept) { return kinds_of[kept].components; }

uint64_t pbf_kept_bytes(pbf_kept kept, uint32_t kinds, uint32_t count, uint32_t precision) {
  uint64_t numbers = (uint64_t)count * kinds_of[kept].components;
  return kinds >> kept & 1 ? numbers * precision : 0;
}

pbf_status pbf_kept_allocate(const pbf_solver *solver, uint32_t kinds, uint32_t count,
                             const char *purpose, pbf_kept_fields *fields) {
  pbf_status status = PBF_OK;
  *fields = (pbf_kept_fields){0};
  for (int k = 0; k < PBF_KEPT_COUNT && status == PBF_OK; ++k) {
    uint64_t bytes = pbf_kept_bytes((pbf_kept)k, kinds, count, pbf_element_size(solver));
    if (bytes == 0) continue;
    status = pbf_memory_allocate(&solver->allocator, bytes, purpose, &fields->data[k]);
    fields->bytes[k] = bytes;
  }
  return status;
}

void pbf_kept_free(const pbf_solver *solver, pbf_kept_fields *fields) {
  for (int k = 0; k < PBF_KEPT_COUNT; ++k)
    pbf_memory_free(&solver->allocator, fields->data[k], fields->bytes[k]);
}

pbf_status pbf_kept_write(pbf_solver *solver, uint32_t count, const uint32_t *ids,
                          const pbf_kept_fields *fields) {
  const pbf_rows rows = {sizeof rows, 0, count, count, ids};
  for (int k = 0; k < PBF_KEPT_COUNT; ++k) {
    if (!fields->data[k] || (k == PBF_KEPT_LAST_PRESSURE && !has_last_pressure(solver))) continue;
    pbf_status status =
        solver->api.write(solver->backend, kinds_of[k].field, &rows, fields->data[k]);
    if (status != PBF_OK) return pbf_backend_result(solver, status, "write");
  }
  return PBF_OK;
}
