/* Adding particles. */
#include "population.h"

#include <inttypes.h>

#include "coincident.h"
#include "check.h"
#include "error.h"
#include "memory.h"
#include "phases.h"
#include "solver/backend_call.h"
#include "solver/handles.h"
#include "solver/overlap.h"
#include "solver/prestabilize.h"
#include "values.h"

static const uint64_t id_end = UINT64_C(1) << 32;

static pbf_status check_capacity(const pbf_solver *solver, uint32_t count) {
  if (count > solver->capacity - solver->count) {
    return pbf_fail(PBF_ERROR_CAPACITY,
                    "count is %u; the solver holds %u particles and desc.capacity is %u", count,
                    solver->count, solver->capacity);
  }
  if (count > id_end - solver->next_id) {
    return pbf_fail(PBF_ERROR_CAPACITY,
                    "count is %u; the next id would be %" PRIu64
                    " and ids end at 4294967295, so "
                    "the particles need a new solver",
                    count, solver->next_id);
  }
  return PBF_OK;
}

static pbf_status check_new(const pbf_solver *solver, uint32_t count, const void *positions,
                            const void *velocities) {
  uint32_t size = pbf_element_size(solver);
  pbf_status status = pbf_check_pointer("positions", positions, size);
  if (status == PBF_OK) status = pbf_values_check_positions(solver, positions, count, 0);
  if (status != PBF_OK || !velocities) return status;
  status = pbf_check_pointer("velocities", velocities, size);
  if (status == PBF_OK)
    status = pbf_values_check_finite(solver, "velocities", velocities, count, 0);
  return status;
}

static pbf_status add_to_backend(pbf_solver *solver, const pbf_particles *particles) {
  pbf_status status = solver->api.add_particles(solver->backend, particles);
  return pbf_backend_result(solver, status, "add_particles");
}

/* The new ids, in the unused end of the solver's own array where there is one. */
static pbf_status allocate_new_ids(const pbf_solver *solver, uint32_t count, uint32_t **ids) {
  void *memory = solver->ids ? solver->ids + solver->count : NULL;
  if (!memory) {
    pbf_status status = pbf_memory_allocate(&solver->allocator, (uint64_t)count * sizeof **ids,
                                            "the new particles' ids", &memory);
    if (status != PBF_OK) return status;
  }
  *ids = memory;
  for (uint32_t i = 0; i < count; ++i) (*ids)[i] = (uint32_t)(solver->next_id + i);
  return PBF_OK;
}

static void free_new_ids(const pbf_solver *solver, uint32_t count, uint32_t *ids) {
  if (!solver->ids) pbf_memory_free(&solver->allocator, ids, (uint64_t)count * sizeof *ids);
}

/* What comes raises the level, and so the pressure on fluid that sleeps far from it: once as many
 * have come as lie in one layer of a cube of the fluid, rounded down to a power of two. By ids,
 * which are saved. */
static int raises_level(const pbf_solver *solver, uint32_t count) {
  const uint64_t n = solver->count;
  uint64_t layer = 1;
  if (solver->kind.dimension == 3)
    while (8 * layer * layer * layer <= n * n) layer *= 2;
  else
    while (4 * layer * layer <= n) layer *= 2;
  return solver->next_id / layer != (solver->next_id + count) / layer;
}

pbf_status pbf_population_append(pbf_solver *solver, uint32_t count, const void *positions,
                                 const void *velocities, int is_placed, uint32_t phase) {
  uint32_t *ids;
  pbf_status status = allocate_new_ids(solver, count, &ids);
  if (status != PBF_OK) return status;
  pbf_distinct distinct;
  status = pbf_distinct_positions(solver, positions, count, 0, &distinct);
  const pbf_particles particles = {.struct_size = sizeof particles,
                                   .count = count,
                                   .ids = ids,
                                   .positions = distinct.positions,
                                   .velocities = velocities,
                                   .phase = phase,
                                   .wakes_all = (uint32_t)raises_level(solver, count)};
  if (status == PBF_OK) status = add_to_backend(solver, &particles);
  const int were_parted = distinct.copy != NULL;
  pbf_distinct_free(solver, &distinct);
  free_new_ids(solver, count, ids);
  if (status != PBF_OK) return status;
  pbf_note_added(solver, were_parted);
  solver->count += count;
  pbf_phases_append(solver, count, phase);
  if (is_placed)
    pbf_overlap_note_particles(solver, (uint32_t)solver->next_id,
                               (uint32_t)(solver->next_id + count - 1));
  solver->next_id += count;
  solver->step_length_checked = 0;
  ++solver->generation;
  return PBF_OK;
}

static pbf_status add(pbf_solver *solver, uint32_t count, const void *positions,
                      const void *velocities, uint32_t *first_id) {
  uint64_t first = solver->next_id;
  pbf_status status = pbf_check_unmapped(solver);
  if (status == PBF_OK && first_id)
    status = pbf_check_pointer("first_id", first_id, sizeof *first_id);
  if (status == PBF_OK) status = check_capacity(solver, count);
  if (status == PBF_OK && count > 0) {
    status = check_new(solver, count, positions, velocities);
    if (status == PBF_OK)
      status = pbf_population_append(solver, count, positions, velocities, 1, 0);
  }
  if (status == PBF_OK && first_id) *first_id = (uint32_t)first;
  return status;
}

pbf_status pbf_add_particles(pbf_solver *solver, uint32_t count, const void *positions,
                             const void *velocities, uint32_t *first_id) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, add(solver, count, positions, velocities, first_id));
}
