/* The memory of spray, foam and bubbles. */
#include "memory.h"

#include <string.h>

#include "diffuse.h"

pbf_status pbf_diffuse_allocate(const pbf_solver *solver, const pbf_diffuse_desc *desc,
                                pbf_diffuse **made) {
  const pbf_allocator *allocator = &solver->allocator;
  const uint64_t bytes = (uint64_t)desc->capacity * sizeof(pbf_diffuse_particle);
  void *diffuse, *particles;
  pbf_status status =
      pbf_memory_allocate(allocator, sizeof **made, "spray, foam and bubbles", &diffuse);
  if (status != PBF_OK) return status;
  status = pbf_memory_allocate(allocator, bytes, "spray, foam and bubbles", &particles);
  if (status != PBF_OK) {
    pbf_memory_free(allocator, diffuse, sizeof **made);
    return status;
  }
  *made = diffuse;
  memset(*made, 0, sizeof **made);
  (*made)->desc = *desc;
  (*made)->particles = particles;
  return PBF_OK;
}

uint64_t pbf_diffuse_bytes(const pbf_diffuse *diffuse) {
  return sizeof *diffuse + (uint64_t)diffuse->normal_capacity * sizeof *diffuse->normals +
         (uint64_t)diffuse->desc.capacity * sizeof *diffuse->particles;
}

void pbf_diffuse_free(const pbf_solver *solver, pbf_diffuse *diffuse) {
  const pbf_allocator *allocator = &solver->allocator;
  if (!diffuse) return;
  pbf_memory_free(allocator, diffuse->normals,
                  (uint64_t)diffuse->normal_capacity * sizeof *diffuse->normals);
  pbf_memory_free(allocator, diffuse->particles,
                  (uint64_t)diffuse->desc.capacity * sizeof *diffuse->particles);
  pbf_memory_free(allocator, diffuse, sizeof *diffuse);
}

pbf_diffuse_particle *pbf_diffuse_push(pbf_diffuse *d) {
  if (d->head.count == d->desc.capacity) {
    d->first = d->first + 1 < d->desc.capacity ? d->first + 1 : 0;
    --d->head.count;
    ++d->head.recycled;
  }
  pbf_diffuse_particle *pushed = pbf_diffuse_at(d, d->head.count++);
  *pushed = (pbf_diffuse_particle){.id = d->head.next_id++};
  return pushed;
}
