#include "numbers.h"

#include "memory.h"
#include "particles.h"
#include "views.h"

static int is_vector(uint32_t field) {
  return field == PBF_FIELD_POSITION || field == PBF_FIELD_VELOCITY;
}

pbf_status pbf_numbers_copy(pbf_solver *solver, uint32_t field, uint32_t first, uint32_t count,
                            pbf_numbers *numbers) {
  const uint64_t size = pbf_element_size(solver);
  const uint64_t point = is_vector(field) ? pbf_point_bytes(solver) : size;
  *numbers = (pbf_numbers){.component_stride = (int64_t)size,
                           .particle_stride = (int64_t)point,
                           .elements = count,
                           .bytes = count * point};
  pbf_status status = pbf_memory_allocate(&solver->allocator, numbers->bytes,
                                          "a copy of what is read", &numbers->copy);
  numbers->data = numbers->copy;
  if (status != PBF_OK || count == 0) return status;
  return pbf_read_rows(solver, field, first, count, numbers->copy);
}

pbf_status pbf_numbers_find(pbf_solver *solver, uint32_t field, uint32_t first, uint32_t count,
                            pbf_numbers *numbers) {
  pbf_view view;
  *numbers = (pbf_numbers){0};
  if (solver->ranks.count > 0) /* where there are no views */
    return pbf_numbers_copy(solver, field, first, count, numbers);
  pbf_status status = pbf_view_of(solver, field, &view);
  if (status != PBF_OK) return status;
  if (view.device_type != PBF_DEVICE_CPU)
    return pbf_numbers_copy(solver, field, first, count, numbers);
  *numbers = (pbf_numbers){.data = view.data,
                           .particle_stride = view.particle_stride,
                           .component_stride = view.component_stride,
                           .elements = view.count,
                           .ids = view.ids};
  return PBF_OK;
}

void pbf_numbers_free(const pbf_solver *solver, const pbf_numbers *numbers) {
  pbf_memory_free(&solver->allocator, numbers->copy, numbers->bytes);
}
