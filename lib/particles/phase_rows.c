/* The memory of phases, and what a saved state has of them. */
#include <string.h>

#include "error.h"
#include "memory.h"
#include "phases.h"
#include "structs.h"

pbf_status pbf_phases_allocate(const pbf_solver *solver, uint32_t count, pbf_phases **phases) {
  const uint64_t bytes = pbf_phases_bytes(solver);
  void *memory;
  pbf_status status =
      pbf_memory_allocate(&solver->allocator, bytes, "the phases of particles", &memory);
  if (status != PBF_OK) return status;
  memset(memory, 0, bytes);
  *phases = memory;
  (*phases)->count = count;
  return PBF_OK;
}

void pbf_phases_free(const pbf_solver *solver, pbf_phases *phases) {
  pbf_memory_free(&solver->allocator, phases, pbf_phases_bytes(solver));
}

/* Before the phases, each of `size` bytes, and the rows. */
typedef struct stored_head {
  uint32_t count, size;
} stored_head;

static uint64_t stored_size(const stored_head *head, uint32_t particles) {
  return sizeof *head + (uint64_t)head->count * head->size + particles;
}

uint64_t pbf_phases_saved_size(const pbf_solver *solver) {
  if (!solver->phases) return 0;
  const stored_head head = {solver->phases->count, sizeof(pbf_phase)};
  return stored_size(&head, solver->count);
}

void pbf_phases_save(const pbf_solver *solver, void *buffer) {
  const pbf_phases *phases = solver->phases;
  const stored_head head = {phases->count, sizeof(pbf_phase)};
  unsigned char *at = buffer;
  memcpy(at, &head, sizeof head);
  memcpy(at + sizeof head, phases->of, head.count * sizeof *phases->of);
  if (solver->count > 0)
    memcpy(at + sizeof head + head.count * sizeof *phases->of, phases->rows, solver->count);
}

static pbf_status reject(void) {
  return pbf_fail(PBF_ERROR_DATA,
                  "the saved state contradicts itself in its phases; pbf_load takes what pbf_save "
                  "wrote");
}

static pbf_status read_phases(const pbf_solver *solver, const stored_head *head,
                              const unsigned char *at, uint32_t count, pbf_phases *phases) {
  for (uint32_t i = 0; i < head->count; ++i, at += head->size) {
    pbf_status status = pbf_struct_in_stored(&pbf_kind_phase, at, head->size, &phases->of[i]);
    if (status != PBF_OK) return status;
  }
  if (count > 0) memcpy(phases->rows, at, count);
  for (uint32_t row = 0; row < count; ++row)
    if (phases->rows[row] >= head->count) return reject();
  return pbf_phases_check(phases, solver->kind);
}

pbf_status pbf_phases_read(const pbf_solver *solver, const void *buffer, uint64_t size,
                           uint32_t count, pbf_phases **phases) {
  stored_head head;
  *phases = NULL;
  if (size == 0) return PBF_OK;
  if (size < sizeof head) return reject();
  memcpy(&head, buffer, sizeof head);
  if (head.count < 1 || head.count > PBF_MAX_PHASES || stored_size(&head, count) != size)
    return reject();
  pbf_status status = pbf_phases_allocate(solver, head.count, phases);
  if (status != PBF_OK) return status;
  return read_phases(solver, &head, (const unsigned char *)buffer + sizeof head, count, *phases);
}
