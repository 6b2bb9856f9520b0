#include "inside.h"

#include "error.h"
#include "memory.h"
#include "solver/backend_call.h"
#include "solver/ids.h"

/* Memory for what is found, one after the other: positions, velocities, ids. */
static pbf_status take_room(pbf_solver *solver, uint32_t room, pbf_backend_found *found,
                            pbf_numbers *positions) {
  const uint64_t vectors = room * pbf_point_bytes(solver);
  void *memory;
  pbf_numbers_free(solver, positions);
  *positions = (pbf_numbers){0};
  const uint64_t bytes = 2 * vectors + room * sizeof *found->ids;
  pbf_status status =
      pbf_memory_allocate(&solver->allocator, bytes, "particles that are looked for", &memory);
  if (status != PBF_OK) return status;
  *positions = (pbf_numbers){.data = memory,
                             .component_stride = (int64_t)pbf_element_size(solver),
                             .particle_stride = (int64_t)pbf_point_bytes(solver),
                             .copy = memory,
                             .bytes = bytes};
  *found = (pbf_backend_found){.struct_size = sizeof *found, .room = room};
  found->positions = memory;
  found->velocities = (char *)memory + vectors;
  found->ids = (uint32_t *)(void *)((char *)memory + 2 * vectors);
  return PBF_OK;
}

/* With room for as many as are mostly found; where it is too little, once more. */
static pbf_status find(pbf_solver *solver, uint32_t count, const pbf_backend_box *boxes,
                       pbf_numbers *positions, pbf_numbers *velocities) {
  const uint32_t usual = 1024;
  pbf_backend_found found = {.count = solver->count < usual ? solver->count : usual};
  pbf_status status;
  do {
    status = take_room(solver, found.count, &found, positions);
    if (status != PBF_OK) return status;
    status = solver->api.find_in_boxes(solver->backend, count, boxes, &found);
  } while (status == PBF_OK && found.count > found.room && found.count <= solver->count);
  if (status != PBF_OK) return pbf_backend_result(solver, status, "find_in_boxes");
  if (found.count > solver->count)
    return pbf_fail(PBF_ERROR_PLUGIN, "the backend \"%s\" found %u particles of %u",
                    solver->plugin->name, found.count, solver->count);
  positions->elements = found.count;
  positions->ids = found.ids;
  if (!velocities) return PBF_OK;
  *velocities = *positions;
  velocities->data = found.velocities;
  velocities->copy = NULL;
  return PBF_OK;
}

pbf_status pbf_numbers_in_boxes(pbf_solver *solver, uint32_t count, const pbf_backend_box *boxes,
                                pbf_numbers *positions, pbf_numbers *velocities) {
  *positions = (pbf_numbers){0};
  if (velocities) *velocities = (pbf_numbers){0};
  if (count == 0 || solver->count == 0) return PBF_OK;
  if (solver->api.find_in_boxes && solver->ranks.count == 0)
    return find(solver, count, boxes, positions, velocities);
  pbf_status status = pbf_numbers_find(solver, PBF_FIELD_POSITION, 0, solver->count, positions);
  if (status == PBF_OK && velocities)
    status = pbf_numbers_find(solver, PBF_FIELD_VELOCITY, 0, solver->count, velocities);
  return status;
}

int pbf_numbers_row(const pbf_solver *solver, const pbf_numbers *numbers, uint32_t element,
                    uint32_t *row) {
  *row = element;
  return !numbers->ids || pbf_ids_find(solver, numbers->ids[element], row);
}

pbf_status pbf_row_set_add_inside(pbf_solver *solver, uint32_t count, const pbf_backend_box *boxes,
                                  pbf_has_point_fn has, const void *what, pbf_row_set *set) {
  pbf_numbers x;
  pbf_status status = pbf_numbers_in_boxes(solver, count, boxes, &x, NULL);
  for (uint32_t i = 0; i < x.elements && status == PBF_OK; ++i) {
    double point[3] = {0, 0, 0};
    uint32_t row;
    for (uint32_t k = 0; k < solver->kind.dimension; ++k)
      point[k] = pbf_numbers_get(&x, i, k, solver->kind.precision);
    if (has(what, point) && pbf_numbers_row(solver, &x, i, &row)) pbf_row_set_add(set, row);
  }
  pbf_numbers_free(solver, &x);
  return status;
}
