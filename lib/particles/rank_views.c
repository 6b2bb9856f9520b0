#include "rank_views.h"

#include "memory.h"
#include "particles.h"
#include "solver/ids.h"

static pbf_status make_room(pbf_solver *solver, uint64_t bytes, pbf_rank_copy *copy) {
  if (copy->bytes >= bytes) return PBF_OK;
  pbf_memory_free(&solver->allocator, copy->data, copy->bytes);
  *copy = (pbf_rank_copy){0};
  pbf_status status =
      pbf_memory_allocate(&solver->allocator, bytes, "a view of all ranks' particles", &copy->data);
  if (status == PBF_OK) copy->bytes = bytes;
  return status;
}

static pbf_status copy_ids(pbf_solver *solver) {
  pbf_rank_copy *copy = &solver->rank_copies[PBF_FIELD_ID];
  pbf_status status = make_room(solver, (uint64_t)solver->count * sizeof(uint32_t), copy);
  uint32_t *ids = copy->data;
  for (uint32_t row = 0; status == PBF_OK && row < solver->count; ++row)
    ids[row] = pbf_ids_of_row(solver, row);
  return status;
}

/* While a view is mapped there are as many particles as there were, and a second one of the field
 * finds the same again. */
pbf_status pbf_rank_view_of(pbf_solver *solver, uint32_t field, pbf_view *view) {
  const int is_id = field == PBF_FIELD_ID, is_vector = !is_id && field != PBF_FIELD_PRESSURE;
  const uint64_t size = is_id ? sizeof(uint32_t) : pbf_element_size(solver);
  const uint64_t point = is_vector ? pbf_point_bytes(solver) : size;
  pbf_status status = copy_ids(solver);
  if (status == PBF_OK && !is_id)
    status = make_room(solver, solver->count * point, &solver->rank_copies[field]);
  if (status == PBF_OK && !is_id && solver->count > 0)
    status = pbf_read_all(solver, field, solver->rank_copies[field].data);
  if (status != PBF_OK) return status;
  view->device_type = PBF_DEVICE_CPU;
  view->element_type = is_id ? (uint32_t)PBF_TYPE_UINT32 : (uint32_t)size;
  view->components = (uint32_t)(point / size);
  view->particle_stride = (int64_t)point;
  view->component_stride = (int64_t)size;
  view->count = solver->count;
  view->ids = solver->rank_copies[PBF_FIELD_ID].data;
  view->data = solver->rank_copies[field].data;
  return PBF_OK;
}
