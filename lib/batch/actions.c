/* Changes to worlds between steps, from arrays of all worlds. */
#include <string.h>

#include "check.h"
#include "error.h"
#include "handles.h"
#include "memory.h"
#include "worlds.h"

static pbf_status set_gravity(pbf_batch *batch, uint32_t world, void *context) {
  const double(*gravity)[3] = context;
  pbf_solver *solver = batch->worlds[world].solver;
  pbf_params params = {.struct_size = sizeof params};
  pbf_status status = pbf_get_params(solver, &params);
  if (status != PBF_OK) return status;
  memcpy(params.gravity, gravity[world], sizeof params.gravity);
  return pbf_set_params(solver, &params);
}

pbf_status pbf_batch_set_gravity(pbf_batch *batch, const uint8_t *mask, const double *gravity) {
  pbf_status status = pbf_batch_enter(batch);
  if (status != PBF_OK) return status;
  status = pbf_check_pointer("gravity", gravity, sizeof *gravity);
  if (status == PBF_OK)
    status = pbf_batch_for_worlds(batch, mask, PBF_BY_CALLER, set_gravity, (void *)gravity);
  return pbf_batch_leave(batch, status);
}

/* ---- Colliders ------------------------------------------------------------------------------ */

typedef struct collider_set {
  uint32_t count;
  const pbf_collider *colliders;
} collider_set;

static pbf_status set_colliders(pbf_batch *batch, uint32_t world, void *context) {
  const collider_set *set = context;
  return pbf_set_colliders(batch->worlds[world].solver, set->count, set->colliders);
}

pbf_status pbf_batch_set_colliders(pbf_batch *batch, const uint8_t *mask, uint32_t count,
                                   const pbf_collider *colliders) {
  pbf_status status = pbf_batch_enter(batch);
  if (status != PBF_OK) return status;
  collider_set set = {count, colliders};
  return pbf_batch_leave(batch,
                         pbf_batch_for_worlds(batch, mask, PBF_BY_CALLER, set_colliders, &set));
}

typedef struct motion {
  uint32_t count;
  const double *positions, *orientations;
  double duration;
  pbf_collider *targets; /* of one world after another */
} motion;

/* Where the colliders of a world are to go. */
static pbf_status find_targets(pbf_solver *solver, uint32_t world, const motion *m,
                               pbf_collider *targets) {
  for (uint32_t i = 0; i < m->count; ++i) {
    const uint64_t at = (uint64_t)world * m->count + i;
    targets[i].struct_size = sizeof targets[i];
    pbf_status status = pbf_get_collider(solver, i, &targets[i]);
    if (status != PBF_OK) return status;
    memcpy(targets[i].position, m->positions + 3 * at, sizeof targets[i].position);
    if (m->orientations)
      memcpy(targets[i].orientation, m->orientations + 4 * at, sizeof targets[i].orientation);
  }
  return PBF_OK;
}

static pbf_status move_colliders(pbf_batch *batch, uint32_t world, void *context) {
  const motion *m = context;
  pbf_solver *solver = batch->worlds[world].solver;
  uint32_t there = 0;
  pbf_status status = pbf_get_collider_count(solver, &there);
  if (status == PBF_OK && m->count == there) status = find_targets(solver, world, m, m->targets);
  if (status != PBF_OK) return status;
  return pbf_move_colliders(solver, m->count, m->targets, m->duration);
}

static pbf_status move_all(pbf_batch *batch, const uint8_t *mask, motion *m) {
  void *memory = NULL;
  const uint64_t bytes = (uint64_t)m->count * sizeof *m->targets;
  if (m->count > PBF_MAX_COLLIDERS)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "count is %u; it must be at most %u", m->count,
                    PBF_MAX_COLLIDERS);
  pbf_status status = PBF_OK;
  if (bytes > 0) status = pbf_memory_allocate(&batch->allocator, bytes, "targets", &memory);
  if (status != PBF_OK) return status;
  m->targets = memory;
  status = pbf_batch_for_worlds(batch, mask, PBF_BY_CALLER, move_colliders, m);
  pbf_memory_free(&batch->allocator, memory, bytes);
  return status;
}

pbf_status pbf_batch_move_colliders(pbf_batch *batch, const uint8_t *mask, uint32_t count,
                                    const double *positions, const double *orientations,
                                    double duration) {
  pbf_status status = pbf_batch_enter(batch);
  if (status != PBF_OK) return status;
  motion m = {count, positions, orientations, duration, NULL};
  if (count > 0) status = pbf_check_pointer("positions", positions, sizeof *positions);
  if (status == PBF_OK && count > 0 && orientations)
    status = pbf_check_pointer("orientations", orientations, sizeof *orientations);
  if (status == PBF_OK) status = move_all(batch, mask, &m);
  return pbf_batch_leave(batch, status);
}

/* ---- Particles ------------------------------------------------------------------------------ */

typedef struct emission {
  const uint32_t *counts;
  const uint64_t *firsts; /* particles of the worlds before */
  const char *positions, *velocities;
} emission;

static pbf_status add_particles(pbf_batch *batch, uint32_t world, void *context) {
  const emission *e = context;
  const uint64_t at = e->firsts[world] * batch->kind.dimension * batch->kind.precision;
  if (e->counts[world] == 0) return PBF_OK;
  return pbf_add_particles(batch->worlds[world].solver, e->counts[world],
                           e->positions ? e->positions + at : NULL,
                           e->velocities ? e->velocities + at : NULL, NULL);
}

static pbf_status emit(pbf_batch *batch, const uint32_t *counts, const void *positions,
                       const void *velocities) {
  void *memory;
  const uint64_t bytes = batch->world_count * sizeof(uint64_t);
  pbf_status status = pbf_check_pointer("counts", counts, sizeof *counts);
  if (status == PBF_OK)
    status = pbf_memory_allocate(&batch->allocator, bytes, "an emission", &memory);
  if (status != PBF_OK) return status;
  uint64_t *firsts = memory, before = 0;
  for (uint32_t k = 0; k < batch->world_count; ++k) {
    firsts[k] = before;
    before += counts[k];
  }
  emission e = {counts, firsts, positions, velocities};
  status = pbf_batch_for_worlds(batch, NULL, PBF_BY_THREADS, add_particles, &e);
  pbf_memory_free(&batch->allocator, memory, bytes);
  return status;
}

pbf_status pbf_batch_add_particles(pbf_batch *batch, const uint32_t *counts, const void *positions,
                                   const void *velocities) {
  pbf_status status = pbf_batch_enter(batch);
  if (status != PBF_OK) return status;
  return pbf_batch_leave(batch, emit(batch, counts, positions, velocities));
}
