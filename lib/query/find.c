/* Which particles are in a volume. */
#include "check.h"
#include "particles/inside.h"
#include "solver/handles.h"
#include "volume.h"

static int has_point(const void *what, const double point[3]) {
  return pbf_volume_has(what, point);
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
  const pbf_backend_box box = pbf_volume_box(&frame, 0);
  status = pbf_row_set_add_inside(solver, 1, &box, has_point, &frame, &inside);
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
