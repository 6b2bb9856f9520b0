#include "numbers.h"

#include "memory.h"
#include "particles.h"
#include "views.h"

static int is_vector(uint32_t field) {
  return field == PBF_FIELD_POSITION || field == PBF_FIELD_VELOCITY;
}

static uint64_t point_bytes(const pbf_solver *solver, uint32_t field) {
  return is_vector(field) ? pbf_point_bytes(solver) : pbf_element_size(solver);
}

static pbf_status copy_to(pbf_solver *solver, uint32_t field, uint32_t first, uint32_t count,
                          void *memory, pbf_numbers *numbers) {
  *numbers = (pbf_numbers){.data = memory,
                           .component_stride = (int64_t)pbf_element_size(solver),
                           .particle_stride = (int64_t)point_bytes(solver, field),
                           .elements = count};
  return count > 0 ? pbf_read_rows(solver, field, first, count, memory) : PBF_OK;
}

pbf_status pbf_numbers_copy(pbf_solver *solver, uint32_t field, uint32_t first, uint32_t count,
                            pbf_numbers *numbers) {
  const uint64_t bytes = count * point_bytes(solver, field);
  void *memory;
  *numbers = (pbf_numbers){0};
  pbf_status status =
      pbf_memory_allocate(&solver->allocator, bytes, "a copy of what is read", &memory);
  if (status != PBF_OK) return status;
  status = copy_to(solver, field, first, count, memory, numbers);
  numbers->copy = memory;
  numbers->bytes = bytes;
  return status;
}

/* *copies: the view is no use. Ranks have none. */
static pbf_status view_of(pbf_solver *solver, uint32_t field, pbf_view *view, int *copies) {
  *copies = 1;
  if (solver->ranks.count > 0) return PBF_OK;
  const pbf_status status = pbf_view_of(solver, field, view);
  if (status == PBF_OK) *copies = view->device_type != PBF_DEVICE_CPU;
  return status;
}

pbf_status pbf_numbers_need_copies(pbf_solver *solver, int *copies) {
  pbf_view view;
  return view_of(solver, PBF_FIELD_POSITION, &view, copies);
}

pbf_status pbf_numbers_find_in(pbf_solver *solver, uint32_t field, uint32_t first, uint32_t count,
                               void *memory, pbf_numbers *numbers) {
  pbf_view view;
  int copies;
  *numbers = (pbf_numbers){0};
  const pbf_status status = view_of(solver, field, &view, &copies);
  if (status != PBF_OK) return status;
  if (copies && memory) return copy_to(solver, field, first, count, memory, numbers);
  if (copies) return pbf_numbers_copy(solver, field, first, count, numbers);
  *numbers = (pbf_numbers){.data = view.data,
                           .particle_stride = view.particle_stride,
                           .component_stride = view.component_stride,
                           .elements = view.count,
                           .ids = view.ids};
  return PBF_OK;
}

pbf_status pbf_numbers_find(pbf_solver *solver, uint32_t field, uint32_t first, uint32_t count,
                            pbf_numbers *numbers) {
  return pbf_numbers_find_in(solver, field, first, count, NULL, numbers);
}

void pbf_numbers_free(const pbf_solver *solver, const pbf_numbers *numbers) {
  pbf_memory_free(&solver->allocator, numbers->copy, numbers->bytes);
}
