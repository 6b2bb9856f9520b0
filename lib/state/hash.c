/* Hash of the state: step (8 bytes), count (4 bytes), ids, positions, velocities, and what comes
 * and goes, and phases, where there are any. */
#include "emission/saved.h"
#include "check.h"
#include "fnv.h"
#include "memory.h"
#include "particles/particles.h"
#include "particles/phases.h"
#include "solver/handles.h"
#include "solver/ids.h"

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "the hash is over little-endian bytes");

static pbf_status add_field(pbf_solver *solver, uint32_t field, void *scratch, uint64_t bytes,
                            uint64_t *hash) {
  pbf_status status = pbf_read_all(solver, field, scratch);
  if (status == PBF_OK) *hash = pbf_fnv(*hash, scratch, bytes);
  return status;
}

static pbf_status add_particles(pbf_solver *solver, uint64_t *hash) {
  void *scratch;
  uint64_t bytes = solver->count * pbf_point_bytes(solver);
  if (solver->count == 0) return PBF_OK;
  pbf_status status = pbf_memory_allocate(&solver->allocator, bytes, "a copy to hash", &scratch);
  if (status != PBF_OK) return status;
  status = add_field(solver, PBF_FIELD_POSITION, scratch, bytes, hash);
  if (status == PBF_OK) status = add_field(solver, PBF_FIELD_VELOCITY, scratch, bytes, hash);
  pbf_memory_free(&solver->allocator, scratch, bytes);
  return status;
}

static pbf_status add_emission(pbf_solver *solver, uint64_t *hash) {
  const uint64_t bytes = pbf_emission_saved_size(solver);
  void *scratch;
  if (bytes == 0) return PBF_OK;
  pbf_status status = pbf_memory_allocate(&solver->allocator, bytes, "emitters to hash", &scratch);
  if (status != PBF_OK) return status;
  pbf_emission_put_clean(solver, scratch);
  *hash = pbf_fnv(*hash, scratch, bytes);
  pbf_memory_free(&solver->allocator, scratch, bytes);
  return PBF_OK;
}

static pbf_status add_phases(const pbf_solver *solver, uint64_t *hash) {
  const uint64_t bytes = pbf_phases_saved_size(solver);
  void *scratch;
  if (bytes == 0) return PBF_OK;
  pbf_status status = pbf_memory_allocate(&solver->allocator, bytes, "phases to hash", &scratch);
  if (status != PBF_OK) return status;
  pbf_phases_save(solver, scratch);
  *hash = pbf_fnv(*hash, scratch, bytes);
  pbf_memory_free(&solver->allocator, scratch, bytes);
  return PBF_OK;
}

static pbf_status hash_state(pbf_solver *solver, uint64_t *theirs) {
  pbf_status status = pbf_check_pointer("hash", theirs, sizeof *theirs);
  if (status != PBF_OK) return status;
  uint64_t hash = pbf_fnv(PBF_FNV_START, &solver->step, sizeof solver->step);
  hash = pbf_fnv(hash, &solver->count, sizeof solver->count);
  for (uint32_t row = 0; row < solver->count; ++row) {
    uint32_t id = pbf_ids_of_row(solver, row);
    hash = pbf_fnv(hash, &id, sizeof id);
  }
  status = add_particles(solver, &hash);
  if (status == PBF_OK) status = add_emission(solver, &hash);
  if (status == PBF_OK) status = add_phases(solver, &hash);
  if (status == PBF_OK) *theirs = hash;
  return status;
}

pbf_status pbf_hash(pbf_solver *solver, uint64_t *hash) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, hash_state(solver, hash));
}
