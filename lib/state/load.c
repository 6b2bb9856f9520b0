/* pbf_load: a saved state takes the place of the present one. */
#include <string.h>

#include "error.h"
#include "memory.h"
#include "particles/accelerations.h"
#include "particles/particles.h"
#include "saved_state.h"
#include "solver/backend_call.h"
#include "solver/colliders.h"
#include "solver/handles.h"
#include "solver/ids.h"
#include "solver/overlap.h"
#include "solver/previous.h"
#include "solver/rank_settings.h"
#include "solver/set_params.h"
#include "solver/solver_time.h"
#include "solver/step.h"

/* What the backend holds before the load, to be restored when it fails half-way. */
typedef struct previous_state {
  void *positions;
  void *velocities;
  uint64_t bytes;
  pbf_kept_fields kept;
} previous_state;

static void free_previous(const pbf_solver *solver, previous_state *previous) {
  pbf_memory_free(&solver->allocator, previous->positions, previous->bytes);
  pbf_memory_free(&solver->allocator, previous->velocities, previous->bytes);
  pbf_kept_free(solver, &previous->kept);
}

static pbf_status allocate_previous(const pbf_solver *solver, previous_state *previous) {
  static const char purpose[] = "the state before a load";
  const pbf_allocator *allocator = &solver->allocator;
  previous->bytes = solver->count * pbf_point_bytes(solver);
  pbf_status status =
      pbf_memory_allocate(allocator, previous->bytes, purpose, &previous->positions);
  if (status == PBF_OK)
    status = pbf_memory_allocate(allocator, previous->bytes, purpose, &previous->velocities);
  if (status == PBF_OK)
    status =
        pbf_kept_allocate(solver, pbf_kept_by(solver), solver->count, purpose, &previous->kept);
  return status;
}

static pbf_status read_previous(pbf_solver *solver, previous_state *previous) {
  *previous = (previous_state){0};
  if (solver->count == 0) return PBF_OK;
  pbf_status status = allocate_previous(solver, previous);
  if (status == PBF_OK) status = pbf_read_all(solver, PBF_FIELD_POSITION, previous->positions);
  if (status == PBF_OK) status = pbf_read_all(solver, PBF_FIELD_VELOCITY, previous->velocities);
  for (int k = 0; k < PBF_KEPT_COUNT && status == PBF_OK; ++k)
    if (previous->kept.data[k])
      status = pbf_read_all(solver, pbf_kept_field((pbf_kept)k), previous->kept.data[k]);
  return status;
}

static pbf_status replace_particles(pbf_solver *solver, uint32_t count, const uint32_t *ids,
                                    const void *positions, const void *velocities) {
  const pbf_particles particles = {.struct_size = sizeof particles,
                                   .count = count,
                                   .ids = ids,
                                   .positions = positions,
                                   .velocities = velocities};
  pbf_status status = solver->api.remove_all(solver->backend);
  if (status != PBF_OK) return pbf_backend_result(solver, status, "remove_all");
  if (count == 0) return PBF_OK;
  status = solver->api.add_particles(solver->backend, &particles);
  return pbf_backend_result(solver, status, "add_particles");
}

/* As far as a failing device lets it; its message is kept. */
static void restore_particles(pbf_solver *solver, const previous_state *previous, uint32_t *ids) {
  uint32_t count = solver->count;
  for (uint32_t row = 0; row < count; ++row) ids[row] = pbf_ids_of_row(solver, row);
  replace_particles(solver, count, ids, previous->positions, previous->velocities);
  pbf_phases_to_backend(solver, solver->phases, count, ids);
  pbf_overlap_restore(solver, &solver->overlap);
  pbf_accelerations_to_backend(solver, solver->accelerations, solver->acceleration_count, count,
                               ids);
  pbf_kept_write(solver, count, ids, &previous->kept);
}

/* `ids` is memory for the ids of `capacity` particles. */
static pbf_status roll_back(pbf_solver *solver, const previous_state *previous, uint32_t *ids,
                            pbf_status status) {
  char why[PBF_MESSAGE_SIZE];
  memcpy(why, pbf_last_error(), sizeof why);
  pbf_params_to_backend(solver, &solver->params);
  pbf_colliders_to_backend(solver, solver->collider_count, solver->colliders,
                           solver->collider_time);
  restore_particles(solver, previous, ids);
  pbf_time_to_backend(solver, pbf_solver_time(solver));
  return pbf_fail(status, "%s", why);
}

static pbf_status write_to_backend(pbf_solver *solver, const pbf_saved_state *in) {
  pbf_status status = pbf_colliders_to_backend(solver, in->header.collider_count, in->colliders,
                                               in->header.collider_time);
  if (status == PBF_OK)
    status = replace_particles(solver, in->header.count, in->ids, in->positions, in->velocities);
  if (status == PBF_OK)
    status = pbf_phases_to_backend(solver, in->phases, in->header.count, in->ids);
  if (status == PBF_OK && (in->accelerations || pbf_has_accelerations(solver)))
    status = pbf_accelerations_to_backend(solver, in->accelerations, in->header.acceleration_count,
                                          in->header.count, in->ids);
  if (status == PBF_OK) status = pbf_overlap_restore(solver, &in->header.overlap);
  if (status == PBF_OK) status = pbf_kept_write(solver, in->header.count, in->ids, &in->kept);
  if (status == PBF_OK) status = pbf_time_to_backend(solver, in->time);
  return status;
}

static pbf_status replace_state(pbf_solver *solver, pbf_saved_state *in) {
  previous_state previous;
  pbf_status status = read_previous(solver, &previous);
  if (status == PBF_OK) status = pbf_params_to_backend(solver, &in->params);
  if (status == PBF_OK) {
    status = write_to_backend(solver, in);
    if (status != PBF_OK) status = roll_back(solver, &previous, in->ids, status);
  }
  free_previous(solver, &previous);
  return status;
}

static void commit(pbf_solver *solver, pbf_saved_state *in) {
  solver->params = in->params;
  solver->count = in->header.count;
  solver->next_id = in->header.next_id;
  solver->step = in->header.step;
  solver->steps_since = in->header.steps_since;
  solver->time_base = in->header.time_base;
  solver->overlap = in->header.overlap;
  if (!solver->api.set_overlap) solver->overlap.end = 0;
  solver->placement = in->header.placement;
  solver->planned = in->header.planned;
  solver->step_length_checked = 0;
  pbf_previous_forget(solver);
  pbf_accelerations_free(solver);
  solver->accelerations = in->accelerations;
  solver->acceleration_count = in->header.acceleration_count;
  in->accelerations = NULL;
  ++solver->generation;
  pbf_colliders_replace(solver, in->header.collider_count, in->colliders, in->header.collider_time);
  in->colliders = NULL;
  pbf_emission_free(solver, solver->emission);
  solver->emission = in->emission;
  in->emission = NULL;
  pbf_diffuse_free(solver, solver->diffuse);
  solver->diffuse = in->diffuse;
  in->diffuse = NULL;
  pbf_phases_free(solver, solver->phases);
  solver->phases = in->phases;
  in->phases = NULL;
  uint32_t *old_ids = solver->ids;
  solver->ids = in->header.has_ids ? in->ids : NULL;
  in->ids = in->header.has_ids ? old_ids : in->ids;
  if (!in->header.has_ids) pbf_memory_free(&solver->allocator, old_ids, pbf_ids_bytes(solver));
}

/* By its checksum, with which a state ends. */
static void note_state(pbf_solver *solver, const void *buffer, uint64_t size) {
  const char *end = (const char *)buffer + size;
  pbf_rank_settings_note(solver, "pbf_load", end - sizeof(uint64_t), sizeof(uint64_t));
}

static pbf_status load(pbf_solver *solver, const void *buffer, uint64_t size) {
  pbf_saved_state in;
  pbf_status status = pbf_check_unmapped(solver);
  if (status != PBF_OK) return status;
  if (!buffer) return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "buffer is null");
  status = pbf_saved_state_read(solver, buffer, size, &in);
  if (status != PBF_OK) return status;
  status = replace_state(solver, &in);
  if (status == PBF_OK) commit(solver, &in);
  if (status == PBF_OK) note_state(solver, buffer, size);
  pbf_saved_state_free(solver, &in);
  return status;
}

pbf_status pbf_load(pbf_solver *solver, const void *buffer, uint64_t size) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, load(solver, buffer, size));
}
