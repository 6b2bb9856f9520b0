#include "saved_state.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "checksum.h"
#include "collider.h"
#include "emission/saved.h"
#include "error.h"
#include "memory.h"
#include "params.h"
#include "particles/accelerations.h"
#include "particles/values.h"
#include "shape/registry.h"
#include "solver/colliders.h"
#include "solver/ids.h"
#include "structs.h"

static pbf_status reject(const char *what) {
  return pbf_fail(PBF_ERROR_DATA, "the saved state %s; pbf_load takes what pbf_save wrote", what);
}

/* Makes the message of a check one about the saved state. */
static pbf_status reject_by_check(pbf_status status) {
  if (status == PBF_OK || status == PBF_ERROR_OUT_OF_MEMORY) return status;
  return pbf_fail(PBF_ERROR_DATA, "the saved state holds a bad value: %.1500s", pbf_last_error());
}

/* No number among them is none. */
static int is_finite(const pbf_placement *placement) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) sum += fabs(placement->shift[k]) + fabs(placement->collider_shift[k]);
  for (int wall = 0; wall < 6; ++wall) sum += fabs(placement->wall_shift[wall]);
  return isfinite(sum);
}

static pbf_status check_kind(const pbf_solver *solver, const pbf_snapshot_header *header) {
  if (header->dimension == solver->kind.dimension && header->precision == solver->kind.precision)
    return PBF_OK;
  return pbf_fail(
      PBF_ERROR_DATA, "the saved state is %uD with numbers of %u bytes; this solver is %uD with %u",
      header->dimension, header->precision, solver->kind.dimension, solver->kind.precision);
}

static pbf_status check_header(const pbf_solver *solver, const pbf_snapshot_header *header,
                               uint64_t size) {
  if (header->version != PBF_SNAPSHOT_VERSION || header->header_size != sizeof *header)
    return reject("is of a version that this library does not know");
  if (header->size != size) return reject("is cut short or has something behind it");
  pbf_status status = check_kind(solver, header);
  if (status != PBF_OK) return status;
  if (header->collider_count > PBF_MAX_COLLIDERS || header->has_ids > 1 ||
      header->kept >> PBF_KEPT_COUNT || header->placement.places > PBF_PLACES_ALL ||
      header->placement.shifted > 1 || header->count > PBF_MAX_CAPACITY || header->phases > size ||
      header->diffuse > size || header->has_accelerations > 1 ||
      header->acceleration_count > header->has_accelerations * header->count ||
      pbf_snapshot_layout_of(header).size != size)
    return reject("contradicts itself in its sizes");
  int has_ids_rightly = header->has_ids || header->next_id == header->count;
  if (!has_ids_rightly || header->next_id < header->count || header->next_id > UINT64_C(1) << 32 ||
      header->steps_since > header->step || header->step >> 63)
    return reject("contradicts itself in its counts");
  return PBF_OK;
}

static pbf_status check_envelope(const pbf_solver *solver, const void *buffer, uint64_t size,
                                 pbf_saved_state *in) {
  uint64_t checksum;
  if (size < sizeof in->header + sizeof checksum) return reject("is cut short");
  memcpy(&in->header, buffer, sizeof in->header);
  static const char magic[] = PBF_SNAPSHOT_MAGIC;
  if (memcmp(in->header.magic, magic, sizeof in->header.magic) != 0)
    return reject("does not begin as one");
  pbf_status status = check_header(solver, &in->header, size);
  if (status != PBF_OK) return status;
  in->buffer = buffer;
  in->layout = pbf_snapshot_layout_of(&in->header);
  memcpy(&checksum, in->buffer + in->layout.checksum, sizeof checksum);
  if (pbf_checksum(buffer, in->layout.checksum) != checksum)
    return reject("is damaged: its checksum does not fit");
  status = pbf_colliders_check_count(solver, in->header.collider_count);
  if (status != PBF_OK) return status;
  if (in->header.count <= solver->capacity) return PBF_OK;
  return pbf_fail(PBF_ERROR_CAPACITY,
                  "the saved state has %u particles; desc.capacity of this solver is %u",
                  in->header.count, solver->capacity);
}

static int is_size(double number) { return isfinite(number) && number >= 0; }

static int is_overlap_sound(const pbf_snapshot_header *header) {
  const pbf_overlap_state *o = &header->overlap;
  int has_found = o->found.struct_size != 0;
  return o->moved <= 1 && o->reserved == 0 && is_size(o->end) && is_size(o->time_step) &&
         is_size(o->error) && is_size(o->most) && is_size(o->left) && is_size(o->reference) &&
         isfinite(o->since) && is_size(o->rate) &&
         (header->kept >> PBF_KEPT_OVERLAP & 1) == (o->end > 0) &&
         (!has_found ||
          (o->found.struct_size == sizeof o->found && o->found.walls <= 1 &&
           isfinite(o->found.part) && o->found.part <= 1 && is_size(o->found.before) &&
           is_size(o->found.now) && is_size(o->found.reference) && is_size(o->found.least)));
}

static pbf_status read_params(const pbf_solver *solver, pbf_saved_state *in) {
  pbf_status status = pbf_struct_in_stored(&pbf_kind_params, in->buffer + in->layout.params,
                                           in->header.params_size, &in->params);
  if (status != PBF_OK) return status;
  if ((in->header.kept >> PBF_KEPT_REST & 1) != (in->params.sleep_speed > 0))
    return reject("contradicts itself in what sleeps");
  if ((in->header.kept >> PBF_KEPT_LAST_PRESSURE & 1) && in->params.solver != PBF_SOLVER_CHEBYSHEV)
    return reject("contradicts itself in its pressures");
  if (!is_overlap_sound(&in->header)) return reject("contradicts itself in what overlaps");
  in->time = in->header.time_base + (double)in->header.steps_since * in->params.time_step;
  if (!isfinite(in->time) || !isfinite(in->header.collider_time) ||
      !is_finite(&in->header.placement))
    return reject("has a time that is not finite");
  return pbf_params_check(&in->params, solver->kind, in->time);
}

/* What is stored in place of a geometry is its hash. */
static pbf_status find_geometry(pbf_saved_state *in, uint32_t i) {
  pbf_collider *collider = &in->colliders[i];
  const uint64_t hash = (uint64_t)(uintptr_t)collider->geometry;
  collider->geometry = hash ? pbf_shape_hold_by_hash(hash) : NULL;
  if (hash && !collider->geometry) {
    return pbf_fail(PBF_ERROR_DATA,
                    "colliders[%u].geometry is the shape with the hash %016" PRIx64
                    ", which no shape that lives has; it has to be made before pbf_load",
                    i, hash);
  }
  in->collider_holds = i + 1;
  return PBF_OK;
}

static void read_marks(const pbf_solver *solver, pbf_saved_state *in) {
  const uint32_t count = in->header.collider_count;
  const uint64_t bytes = (uint64_t)pbf_collider_words(count) * sizeof(uint64_t);
  const unsigned char *stored = in->buffer + in->layout.marks;
  if (bytes == 0) return;
  memcpy(pbf_colliders_marked(solver, count, in->colliders, PBF_COLLIDERS_PLACED), stored, bytes);
  memcpy(pbf_colliders_marked(solver, count, in->colliders, PBF_COLLIDERS_SHIFTED), stored + bytes,
         bytes);
}

static pbf_status read_colliders(const pbf_solver *solver, pbf_saved_state *in) {
  char label[32];
  read_marks(solver, in);
  for (uint32_t i = 0; i < in->header.collider_count; ++i) {
    const unsigned char *stored =
        in->buffer + in->layout.colliders + (uint64_t)i * in->header.collider_size;
    pbf_status status = pbf_struct_in_stored(&pbf_kind_collider, stored, in->header.collider_size,
                                             &in->colliders[i]);
    if (status == PBF_OK) status = find_geometry(in, i);
    snprintf(label, sizeof label, "colliders[%u]", i);
    if (status == PBF_OK)
      status = pbf_collider_check_moving(&in->colliders[i], label, solver->kind);
    if (status != PBF_OK) return status;
  }
  return PBF_OK;
}

static pbf_status read_ids(pbf_saved_state *in) {
  uint32_t count = in->header.count;
  if (!in->header.has_ids) {
    for (uint32_t row = 0; row < count; ++row) in->ids[row] = row;
    return PBF_OK;
  }
  if (count > 0) memcpy(in->ids, in->buffer + in->layout.ids, (uint64_t)count * sizeof *in->ids);
  for (uint32_t row = 1; row < count; ++row) {
    if (in->ids[row] <= in->ids[row - 1]) return reject("has ids that do not ascend");
  }
  if (count > 0 && in->ids[count - 1] >= in->header.next_id)
    return reject("has ids that were never given");
  return PBF_OK;
}

static pbf_status read_particles(const pbf_solver *solver, pbf_saved_state *in) {
  uint64_t bytes = pbf_snapshot_field_bytes(&in->header);
  if (bytes == 0) return PBF_OK;
  memcpy(in->positions, in->buffer + in->layout.positions, bytes);
  memcpy(in->velocities, in->buffer + in->layout.velocities, bytes);
  /* Not asked to be inside the domain: a change of parameters may have left them outside. */
  pbf_status status =
      pbf_values_check_finite(solver, "positions", in->positions, in->header.count, 0);
  if (status == PBF_OK)
    status = pbf_values_check_finite(solver, "velocities", in->velocities, in->header.count, 0);
  for (int k = 0; k < PBF_KEPT_COUNT && status == PBF_OK; ++k) {
    if (!in->kept.data[k]) continue;
    uint64_t numbers = in->header.count * (uint64_t)pbf_kept_components((pbf_kept)k);
    memcpy(in->kept.data[k], in->buffer + in->layout.kept[k], in->kept.bytes[k]);
    status = pbf_values_check_numbers(solver, "kept", in->kept.data[k], numbers);
  }
  return status;
}

static pbf_status read_accelerations(const pbf_solver *solver, pbf_saved_state *in) {
  const uint64_t bytes = pbf_snapshot_acceleration_bytes(&in->header);
  if (in->accelerations && !solver->api.set_accelerations)
    return pbf_fail(PBF_ERROR_DATA,
                    "the saved state has accelerations of particles, and the backend \"%s\" none",
                    solver->plugin->name);
  if (bytes == 0) return PBF_OK;
  memcpy(in->accelerations, in->buffer + in->layout.accelerations, bytes);
  return pbf_values_check_finite(solver, "accelerations", in->accelerations,
                                 in->header.acceleration_count, 0);
}

static pbf_status allocate_section(const pbf_solver *solver, uint64_t size, void *pointer) {
  void *memory;
  if (size == 0) return PBF_OK;
  pbf_status status = pbf_memory_allocate(&solver->allocator, size, "loading a state", &memory);
  if (status == PBF_OK) memcpy(pointer, &memory, sizeof memory);
  return status;
}

static pbf_status allocate(const pbf_solver *solver, pbf_saved_state *in) {
  uint64_t bytes = pbf_snapshot_field_bytes(&in->header);
  uint64_t colliders = pbf_colliders_bytes(solver, in->header.collider_count);
  pbf_status status = allocate_section(solver, colliders, &in->colliders);
  if (status == PBF_OK) status = allocate_section(solver, pbf_ids_bytes(solver), &in->ids);
  if (status == PBF_OK) status = allocate_section(solver, bytes, &in->positions);
  if (status == PBF_OK) status = allocate_section(solver, bytes, &in->velocities);
  if (status == PBF_OK && in->header.has_accelerations)
    status = allocate_section(solver, pbf_accelerations_bytes(solver), &in->accelerations);
  if (status != PBF_OK) return status;
  return pbf_kept_allocate(solver, in->header.kept, in->header.count, "loading a state", &in->kept);
}

/* What else there is goes with them. */
static pbf_status check_phases(const pbf_solver *solver, const pbf_saved_state *in) {
  pbf_status status = pbf_phases_check_params(in->phases, &in->params);
  if (status == PBF_OK) status = pbf_phases_check_ranks(in->phases, solver);
  for (uint32_t i = 0; status == PBF_OK && in->emission && i < in->emission->head.source_count; ++i)
    if (in->emission->sources[i].emitter.phase >= pbf_phases_count(in->phases))
      status = reject("has an emitter of a phase that there is not");
  for (uint32_t i = 0; status == PBF_OK && in->emission && i < in->emission->head.reservoir_count;
       ++i)
    if (in->emission->reservoirs[i].phase >= pbf_phases_count(in->phases))
      status = reject("has a reservoir of a phase that there is not");
  return status;
}

static pbf_status read_sections(pbf_solver *solver, pbf_saved_state *in) {
  pbf_status status = read_params(solver, in);
  if (status == PBF_OK) status = read_colliders(solver, in);
  pbf_colliders_bring(solver, in->collider_holds, in->colliders);
  if (status == PBF_OK) status = read_ids(in);
  if (status == PBF_OK) status = read_particles(solver, in);
  if (status == PBF_OK) status = read_accelerations(solver, in);
  if (status == PBF_OK)
    status = pbf_emission_read(solver, in->buffer + in->layout.emission, in->header.emission,
                               in->header.next_id, &in->emission);
  if (status == PBF_OK)
    status = pbf_phases_read(solver, in->buffer + in->layout.phases, in->header.phases,
                             in->header.count, &in->phases);
  if (status == PBF_OK) status = check_phases(solver, in);
  if (status == PBF_OK)
    status = pbf_diffuse_restore(solver, in->buffer + in->layout.diffuse, in->header.diffuse,
                                 &in->diffuse);
  return reject_by_check(status);
}

pbf_status pbf_saved_state_check(const pbf_solver *solver, const void *buffer, uint64_t size) {
  pbf_saved_state in = {0};
  return check_envelope(solver, buffer, size, &in);
}

pbf_status pbf_saved_state_read(pbf_solver *solver, const void *buffer, uint64_t size,
                                pbf_saved_state *in) {
  *in = (pbf_saved_state){0};
  pbf_status status = check_envelope(solver, buffer, size, in);
  if (status != PBF_OK) return status;
  status = allocate(solver, in);
  if (status == PBF_OK) status = read_sections(solver, in);
  if (status != PBF_OK) pbf_saved_state_free(solver, in);
  return status;
}

void pbf_saved_state_free(pbf_solver *solver, pbf_saved_state *in) {
  uint64_t bytes = pbf_snapshot_field_bytes(&in->header);
  pbf_colliders_bring(solver, 0, NULL);
  if (in->colliders) pbf_colliders_let_go(in->collider_holds, in->colliders);
  pbf_memory_free(&solver->allocator, in->colliders,
                  pbf_colliders_bytes(solver, in->header.collider_count));
  pbf_memory_free(&solver->allocator, in->ids, pbf_ids_bytes(solver));
  pbf_memory_free(&solver->allocator, in->positions, bytes);
  pbf_memory_free(&solver->allocator, in->velocities, bytes);
  pbf_kept_free(solver, &in->kept);
  pbf_memory_free(&solver->allocator, in->accelerations, pbf_accelerations_bytes(solver));
  pbf_emission_free(solver, in->emission);
  pbf_phases_free(solver, in->phases);
  pbf_diffuse_free(solver, in->diffuse);
}
