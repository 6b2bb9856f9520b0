#include "guided.h"

#include <math.h>

#include "new_particles.h"
#include "particles/values.h"
#include "solver/backend_call.h"
#include "solver/ids.h"

double pbf_guided_speed(const pbf_guided *guided) {
  const double *v = guided->velocity;
  return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

void pbf_guided_place(const pbf_guided *guided, double place[3]) {
  const double speed = pbf_guided_speed(guided);
  for (int k = 0; k < 3; ++k)
    place[k] = guided->from[k] + guided->ahead * (guided->velocity[k] / speed);
}

/* ---- Positions that are set ------------------------------------------------------------------ */

/* Those on their way that are among the rows; how many lie between the first and the last. */
static uint32_t find_among(const pbf_solver *solver, uint32_t first, uint32_t count,
                           uint32_t *begin) {
  const pbf_emission *e = solver->emission;
  uint32_t row, end = 0;
  *begin = UINT32_MAX;
  for (uint32_t i = 0; e && i < e->head.guided_count; ++i) {
    if (!pbf_ids_find(solver, e->guided[i].id, &row) || row < first || row - first >= count)
      continue;
    *begin = row < *begin ? row : *begin;
    end = row >= end ? row + 1 : end;
  }
  return end > *begin ? end - *begin : 0;
}

pbf_status pbf_guided_keep(pbf_solver *solver, uint32_t first, uint32_t count) {
  pbf_emission *e = solver->emission;
  uint32_t begin;
  const uint32_t among = find_among(solver, first, count, &begin);
  if (among == 0) return PBF_OK;
  pbf_status status = pbf_emission_reserve(solver, e, among);
  if (status != PBF_OK) return status;
  const pbf_rows rows = pbf_ids_rows(solver, begin, among);
  return pbf_backend_result(
      solver, solver->api.read(solver->backend, PBF_FIELD_POSITION, &rows, e->particles), "read");
}

void pbf_guided_move(pbf_solver *solver, uint32_t first, uint32_t count, const void *positions) {
  pbf_emission *e = solver->emission;
  const pbf_check_kind *kind = &solver->kind;
  uint32_t begin, row;
  if (find_among(solver, first, count, &begin) == 0) return;
  for (uint32_t i = 0; i < e->head.guided_count; ++i) {
    pbf_guided *g = &e->guided[i];
    if (!pbf_ids_find(solver, g->id, &row) || row < first || row - first >= count) continue;
    for (uint32_t k = 0; k < kind->dimension; ++k)
      g->from[k] +=
          pbf_value_at(positions, (uint64_t)(row - first) * kind->dimension + k, kind->precision) -
          pbf_value_at(e->particles, (uint64_t)(row - begin) * kind->dimension + k,
                       kind->precision);
  }
}
