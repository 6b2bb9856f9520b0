/* Spray, foam and bubbles in a saved state: sizes, head, desc, and particles from the oldest on. */
#include <math.h>
#include <string.h>

#include "diffuse.h"
#include "error.h"
#include "structs.h"

/* Structs have the sizes of the build that has written them. */
typedef struct stored_head {
  pbf_diffuse_head head;
  uint32_t desc_size, particle_size;
} stored_head;

static uint64_t size_of(const stored_head *stored) {
  return sizeof *stored + stored->desc_size +
         (uint64_t)stored->head.count * sizeof(pbf_diffuse_particle);
}

static stored_head head_of(const pbf_diffuse *d) {
  return (stored_head){d->head, sizeof(pbf_diffuse_desc), sizeof(pbf_diffuse_particle)};
}

uint64_t pbf_diffuse_saved_size(const pbf_solver *solver) {
  if (!solver->diffuse) return 0;
  const stored_head stored = head_of(solver->diffuse);
  return size_of(&stored);
}

static unsigned char *put(unsigned char *at, const void *data, uint64_t size) {
  memcpy(at, data, size);
  return at + size;
}

void pbf_diffuse_save(const pbf_solver *solver, void *buffer) {
  const pbf_diffuse *d = solver->diffuse;
  const stored_head stored = head_of(d);
  unsigned char *at = put(buffer, &stored, sizeof stored);
  at = put(at, &d->desc, sizeof d->desc);
  for (uint32_t n = 0; n < d->head.count; ++n)
    at = put(at, pbf_diffuse_at(d, n), sizeof(pbf_diffuse_particle));
}

/* ---- Reading --------------------------------------------------------------------------------- */

static pbf_status reject(const char *what) {
  return pbf_fail(PBF_ERROR_DATA, "the saved state %s; pbf_load takes what pbf_save wrote", what);
}

static pbf_status check_head(const stored_head *stored, uint64_t size) {
  const pbf_diffuse_head *head = &stored->head;
  if (stored->particle_size != sizeof(pbf_diffuse_particle) || stored->desc_size > size ||
      stored->desc_size < sizeof(uint32_t) || head->count > PBF_MAX_DIFFUSE ||
      head->reserved != 0 || head->next_id < head->count || head->next_id >> 63 ||
      size_of(stored) != size)
    return reject("contradicts itself in its diffuse particles");
  if (!isfinite(head->time) || !(head->due >= 0 && head->due < 1))
    return reject("has diffuse particles of no time");
  return PBF_OK;
}

static pbf_status read_desc(const pbf_solver *solver, const stored_head *stored,
                            const unsigned char *at, pbf_diffuse_desc *desc) {
  pbf_status status = pbf_struct_in_stored(&pbf_kind_diffuse_desc, at, stored->desc_size, desc);
  if (status == PBF_OK) status = pbf_diffuse_check(desc, solver->kind);
  if (status == PBF_OK && stored->head.count > desc->capacity)
    status = reject("has more diffuse particles than their capacity");
  return status;
}

static int is_sound(const pbf_diffuse_particle *p) {
  int is_finite = isfinite(p->born) && isfinite(p->dies);
  for (int k = 0; k < 3; ++k) is_finite &= isfinite(p->position[k]) && isfinite(p->velocity[k]);
  return is_finite && p->kind <= PBF_DIFFUSE_BUBBLE && p->reserved == 0;
}

static pbf_status read_particles(const stored_head *stored, const unsigned char *at,
                                 pbf_diffuse *d) {
  uint64_t next = 0;
  if (stored->head.count > 0)
    memcpy(d->particles, at, (uint64_t)stored->head.count * sizeof *d->particles);
  for (uint32_t n = 0; n < stored->head.count; ++n) {
    const pbf_diffuse_particle *p = &d->particles[n];
    if (!is_sound(p) || p->id < next || p->id >= stored->head.next_id)
      return reject("contradicts itself in its diffuse particles");
    next = p->id + 1;
  }
  return PBF_OK;
}

pbf_status pbf_diffuse_restore(const pbf_solver *solver, const void *buffer, uint64_t size,
                               pbf_diffuse **diffuse) {
  const unsigned char *at = (const unsigned char *)buffer + sizeof(stored_head);
  stored_head stored;
  pbf_diffuse_desc desc;
  pbf_diffuse *d = NULL;
  *diffuse = NULL;
  if (size == 0) return PBF_OK;
  if (size < sizeof stored) return reject("is cut short in its diffuse particles");
  memcpy(&stored, buffer, sizeof stored);
  pbf_status status = check_head(&stored, size);
  if (status == PBF_OK) status = read_desc(solver, &stored, at, &desc);
  if (status == PBF_OK) status = pbf_diffuse_allocate(solver, &desc, &d);
  if (status != PBF_OK) return status;
  d->work = &pbf_diffuse_in_steps;
  d->head = stored.head;
  status = read_particles(&stored, at + stored.desc_size, d);
  if (status == PBF_OK)
    *diffuse = d;
  else
    pbf_diffuse_free(solver, d);
  return status;
}
