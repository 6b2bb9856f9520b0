/* pbf_save: the state in one buffer, laid out as snapshot.h says. */
#include <inttypes.h>
#include <string.h>

#include "diffuse/diffuse.h"
#include "emission/saved.h"
#include "check.h"
#include "checksum.h"
#include "error.h"
#include "memory.h"
#include "particles/accelerations.h"
#include "particles/particles.h"
#include "particles/phases.h"
#include "shape/registry.h"
#include "snapshot.h"
#include "solver/colliders.h"
#include "solver/handles.h"

static pbf_snapshot_header header_of(const pbf_solver *solver) {
  pbf_snapshot_header header = {
      .magic = PBF_SNAPSHOT_MAGIC,
      .version = PBF_SNAPSHOT_VERSION,
      .header_size = sizeof header,
      .dimension = solver->kind.dimension,
      .precision = solver->kind.precision,
      .params_size = sizeof(pbf_params),
      .collider_size = sizeof(pbf_collider),
      .collider_count = solver->collider_count,
      .count = solver->count,
      .has_ids = solver->ids != NULL,
      .kept = pbf_kept_by(solver),
      .planned = solver->planned,
      .emission = (uint32_t)pbf_emission_saved_size(solver),
      .phases = pbf_phases_saved_size(solver),
      .diffuse = pbf_diffuse_saved_size(solver),
      .has_accelerations = (uint32_t)pbf_has_accelerations(solver),
      .acceleration_count = solver->acceleration_count,
      .next_id = solver->next_id,
      .step = solver->step,
      .steps_since = solver->steps_since,
      .time_base = solver->time_base,
      .collider_time = solver->collider_time,
      .overlap = solver->overlap,
      .placement = solver->placement,
  };
  header.size = pbf_snapshot_layout_of(&header).size;
  return header;
}

static void put(void *buffer, uint64_t offset, const void *data, uint64_t size) {
  if (size) memcpy((unsigned char *)buffer + offset, data, size);
}

/* By way of aligned memory where the caller's buffer is not; else `scratch` is null. */
static pbf_status read_field(pbf_solver *solver, uint32_t field, void *scratch, void *buffer,
                             uint64_t offset, uint64_t bytes) {
  if (!scratch) return pbf_read_all(solver, field, (unsigned char *)buffer + offset);
  pbf_status status = pbf_read_all(solver, field, scratch);
  if (status == PBF_OK) put(buffer, offset, scratch, bytes);
  return status;
}

static pbf_status write_particles(pbf_solver *solver, const pbf_snapshot_header *header,
                                  const pbf_snapshot_layout *layout, void *buffer) {
  const int is_aligned = (uintptr_t)buffer % pbf_element_size(solver) == 0;
  void *scratch = NULL;
  uint64_t bytes = pbf_snapshot_field_bytes(header), scratch_bytes = bytes, kept[PBF_KEPT_COUNT];
  if (solver->count == 0) return PBF_OK;
  for (int k = 0; k < PBF_KEPT_COUNT; ++k) {
    kept[k] = pbf_snapshot_kept_bytes(header, (pbf_kept)k);
    scratch_bytes = kept[k] > scratch_bytes ? kept[k] : scratch_bytes;
  }
  pbf_status status = PBF_OK;
  if (!is_aligned)
    status = pbf_memory_allocate(&solver->allocator, scratch_bytes, "a copy to save", &scratch);
  if (status != PBF_OK) return status;
  status = read_field(solver, PBF_FIELD_POSITION, scratch, buffer, layout->positions, bytes);
  if (status == PBF_OK)
    status = read_field(solver, PBF_FIELD_VELOCITY, scratch, buffer, layout->velocities, bytes);
  for (int k = 0; k < PBF_KEPT_COUNT; ++k)
    if (status == PBF_OK && kept[k] > 0)
      status = read_field(solver, pbf_kept_field((pbf_kept)k), scratch, buffer, layout->kept[k],
                          kept[k]);
  pbf_memory_free(&solver->allocator, scratch, scratch_bytes);
  return status;
}

/* Pointers mean nothing to another process: a geometry is named by its hash. */
static void put_colliders(const pbf_solver *solver, uint64_t offset, void *buffer) {
  for (uint32_t i = 0; i < solver->collider_count; ++i) {
    pbf_collider collider = solver->colliders[i];
    if (collider.geometry)
      collider.geometry = (pbf_shape *)(uintptr_t)pbf_shape_hash(collider.geometry);
    put(buffer, offset + (uint64_t)i * sizeof collider, &collider, sizeof collider);
  }
}

static void put_marks(const pbf_solver *solver, uint64_t offset, void *buffer) {
  const pbf_collider_set placed = pbf_colliders_set(solver, 0, PBF_COLLIDERS_PLACED);
  const pbf_collider_set shifted = pbf_colliders_set(solver, 0, PBF_COLLIDERS_SHIFTED);
  const uint64_t bytes = placed.words * sizeof *placed.more;
  put(buffer, offset, placed.more, bytes);
  put(buffer, offset + bytes, shifted.more, bytes);
}

/* All but the arrays of particles, of which each may leave a gap before the next section. */
static void clear(const pbf_snapshot_layout *layout, unsigned char *buffer) {
  const uint64_t word = sizeof(uint64_t);
  memset(buffer, 0, layout->positions);
  memset(buffer + layout->velocities - word, 0, word);
  for (int k = 0; k < PBF_KEPT_COUNT; ++k) memset(buffer + layout->kept[k] - word, 0, word);
  memset(buffer + layout->emission - word, 0, layout->size - layout->emission + word);
}

static pbf_status write_state(pbf_solver *solver, const pbf_snapshot_header *header, void *buffer) {
  pbf_snapshot_layout layout = pbf_snapshot_layout_of(header);
  clear(&layout, buffer);
  put(buffer, 0, header, sizeof *header);
  put(buffer, layout.params, &solver->params, sizeof solver->params);
  put_colliders(solver, layout.colliders, buffer);
  put_marks(solver, layout.marks, buffer);
  if (header->has_ids)
    put(buffer, layout.ids, solver->ids, (uint64_t)solver->count * sizeof *solver->ids);
  if (header->emission > 0) pbf_emission_save(solver, (unsigned char *)buffer + layout.emission);
  if (header->phases > 0) pbf_phases_save(solver, (unsigned char *)buffer + layout.phases);
  if (header->diffuse > 0) pbf_diffuse_save(solver, (unsigned char *)buffer + layout.diffuse);
  put(buffer, layout.accelerations, solver->accelerations, pbf_snapshot_acceleration_bytes(header));
  pbf_status status = write_particles(solver, header, &layout, buffer);
  uint64_t checksum = pbf_checksum(buffer, layout.checksum);
  put(buffer, layout.checksum, &checksum, sizeof checksum);
  return status;
}

static pbf_status save(pbf_solver *solver, void *buffer, uint64_t *size) {
  pbf_status status = pbf_check_pointer("size", size, sizeof *size);
  if (status != PBF_OK) return status;
  pbf_snapshot_header header = header_of(solver);
  if (buffer && *size < header.size) {
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "*size is %" PRIu64 "; the state needs %" PRIu64,
                    *size, header.size);
  }
  status = buffer ? write_state(solver, &header, buffer) : PBF_OK;
  if (status == PBF_OK) *size = header.size;
  return status;
}

pbf_status pbf_save(pbf_solver *solver, void *buffer, uint64_t *size) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, save(solver, buffer, size));
}
