#include "elsewhere.h"

#include "memory.h"
#include "physics/depenetration.h"
#include "solver/backend_call.h"
#include "solver/ids.h"
#include "solver/overlap.h"
#include "solver/solver_time.h"
#include "values.h"

static inline double way2_of(pbf_check_kind kind, const pbf_set_rows *rows, uint32_t row) {
  double way2 = 0;
  for (uint32_t k = 0; k < kind.dimension; ++k) {
    const uint64_t at = (uint64_t)row * kind.dimension + k;
    const double way = pbf_value_at(rows->positions, at, kind.precision) -
                       pbf_value_at(rows->before, at, kind.precision) - rows->shift[k];
    way2 += way * way;
  }
  return way2;
}

static double most_pushed2(const pbf_solver *solver) {
  const double speed = pbf_max_depenetration_speed_of(&solver->params, (int)solver->kind.dimension);
  const double way = speed * pbf_part_time_step(solver);
  return way * way;
}

/* How many rows lie between the first and the last that goes elsewhere. */
static inline uint32_t find_among(pbf_check_kind kind, const pbf_set_rows *rows, double most2,
                                  uint32_t *first) {
  uint32_t end = 0;
  *first = rows->count;
  for (uint32_t row = 0; row < rows->count; ++row) {
    if (way2_of(kind, rows, row) <= most2) continue;
    if (end == 0) *first = row;
    end = row + 1;
  }
  return end > 0 ? end - *first : 0;
}

static void put_placed(const pbf_solver *solver, void *overlaps, uint32_t at) {
  if (solver->kind.precision == PBF_FLOAT64)
    ((double *)overlaps)[at] = PBF_BACKEND_OVERLAP_PLACED;
  else
    ((float *)overlaps)[at] = (float)PBF_BACKEND_OVERLAP_PLACED;
}

static pbf_status tell(pbf_solver *solver, const pbf_set_rows *rows, uint32_t first, uint32_t count,
                       void *overlaps) {
  const double most2 = most_pushed2(solver);
  const pbf_rows among = pbf_ids_rows(solver, rows->first + first, count);
  const pbf_backend_api *api = &solver->api;
  pbf_status status = api->read(solver->backend, PBF_BACKEND_FIELD_OVERLAP, &among, overlaps);
  if (status != PBF_OK) return pbf_backend_result(solver, status, "read");
  for (uint32_t i = 0; i < count; ++i)
    if (way2_of(solver->kind, rows, first + i) > most2) put_placed(solver, overlaps, i);
  status = api->write(solver->backend, PBF_BACKEND_FIELD_OVERLAP, &among, overlaps);
  return pbf_backend_result(solver, status, "write");
}

pbf_status pbf_elsewhere_note(pbf_solver *solver, const pbf_set_rows *rows) {
  uint32_t first;
  const double most2 = most_pushed2(solver);
  const uint32_t count = PBF_OF_KIND(solver->kind, find_among, rows, most2, &first);
  if (count == 0 || !pbf_overlap_can_be_found(solver)) return PBF_OK;
  const uint64_t bytes = (uint64_t)count * pbf_element_size(solver);
  void *overlaps;
  pbf_status status = pbf_memory_allocate(&solver->allocator, bytes, "what overlaps", &overlaps);
  if (status != PBF_OK) return status;
  status = pbf_overlap_expect(solver);
  if (status == PBF_OK) status = tell(solver, rows, first, count, overlaps);
  pbf_memory_free(&solver->allocator, overlaps, bytes);
  return status;
}
