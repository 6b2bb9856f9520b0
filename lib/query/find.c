/* Which particles are in a volume. */
#include "check.h"
#include "error.h"
#include "particles/numbers.h"
#include "particles/row_set.h"
#include "particles/values.h"
#include "solver/handles.h"
#include "solver/ids.h"
#include "volume.h"

/* `inside` is empty. */
static pbf_status mark(pbf_solver *solver, const pbf_volume_frame *frame, pbf_row_set *inside) {
  pbf_numbers x;
  pbf_status status = pbf_numbers_find(solver, PBF_FIELD_POSITION, 0, solver->count, &x);
  for (uint32_t i = 0; i < x.elements && status == PBF_OK; ++i) {
    uint32_t row = i;
    double point[3] = {0, 0, 0};
    for (uint32_t k = 0; k < frame->dimension; ++k)
      point[k] = pbf_numbers_get(&x, i, k, solver->kind.precision);
    if (!pbf_volume_has(frame, point)) continue;
    if (!x.ids || pbf_ids_find(solver, x.ids[i], &row)) pbf_row_set_add(inside, row);
  }
  pbf_numbers_free(solver, &x);
  return status;
}

static pbf_status find(pbf_solver *solver, const pbf_volume *theirs, uint32_t capacity,
                       uint32_t *ids, uint32_t *count) {
  pbf_row_set inside;
  pbf_volume volume;
  pbf_status status = pbf_check_pointer("count", count, sizeof *count);
  if (status == PBF_OK) status = pbf_volumes_in(solver->kind, "volume", 1, theirs, &volume);
  if (status == PBF_OK && capacity > 0) status = pbf_check_pointer("ids", ids, sizeof *ids);
  if (status == PBF_OK) status = pbf_row_set_allocate(solver, &inside);
  if (status != PBF_OK) return status;
  const pbf_volume_frame frame = pbf_volume_frame_of(&volume, solver->kind.dimension);
  status = mark(solver, &frame, &inside);
  if (status == PBF_OK) {
    pbf_row_set_ids(solver, &inside, capacity, ids);
    *count = inside.count;
  }
  pbf_row_set_free(solver, &inside);
  return status;
}

pbf_status pbf_find_in_volume(pbf_solver *solver, const pbf_volume *volume, uint32_t capacity,
                              uint32_t *ids, uint32_t *count) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, find(solver, volume, capacity, ids, count));
}
