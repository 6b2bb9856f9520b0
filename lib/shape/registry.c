#include "registry.h"

#include <stdlib.h>
#include <string.h>

#include "error.h"
#include "lock.h"
#include "structs.h"

/* Guarded by the lock, which is held while nothing allocates. */
static pbf_live_shape *live;
static uint64_t last_id;

uint64_t pbf_shape_nodes(const uint32_t size[3]) { return (uint64_t)size[0] * size[1] * size[2]; }

pbf_live_shape *pbf_shape_allocate(uint32_t dimension, const uint32_t size[3]) {
  const uint64_t bytes = sizeof(pbf_live_shape) + pbf_shape_nodes(size) * sizeof(float);
  pbf_live_shape *made = calloc(1, bytes);
  if (!made) return NULL;
  made->shape.struct_size = sizeof made->shape;
  made->shape.dimension = dimension;
  memcpy(made->shape.nodes, size, sizeof made->shape.nodes);
  made->shape.values = made->values;
  made->bytes = bytes;
  return made;
}

pbf_shape *pbf_shape_publish(pbf_live_shape *shape) {
  pbf_lock_take(PBF_LOCK_SHAPES);
  shape->shape.id = ++last_id;
  shape->references = 1;
  shape->next = live;
  live = shape;
  pbf_lock_release(PBF_LOCK_SHAPES);
  return &shape->shape;
}

/* The pointer in the list that leads to the shape, or the list's last one. */
static pbf_live_shape **find(const pbf_shape *shape) {
  pbf_live_shape **link = &live;
  while (*link && &(*link)->shape != shape) link = &(*link)->next;
  return link;
}

pbf_status pbf_shape_hold(pbf_shape *shape, const char *label) {
  if (!shape) return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "%s is null", label);
  pbf_lock_take(PBF_LOCK_SHAPES);
  pbf_live_shape *found = *find(shape);
  if (found) ++found->references;
  pbf_lock_release(PBF_LOCK_SHAPES);
  if (found) return PBF_OK;
  return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "%s is %p, which is no shape that lives", label,
                  (void *)shape);
}

pbf_shape *pbf_shape_hold_by_hash(uint64_t hash) {
  pbf_lock_take(PBF_LOCK_SHAPES);
  pbf_live_shape *found = live;
  while (found && (uintptr_t)found->shape.hash != (uintptr_t)hash) found = found->next;
  if (found) ++found->references;
  pbf_lock_release(PBF_LOCK_SHAPES);
  return found ? &found->shape : NULL;
}

uint64_t pbf_shape_hash(const pbf_shape *shape) { return shape->hash; }

void pbf_shape_let_go(pbf_shape *shape) {
  pbf_lock_take(PBF_LOCK_SHAPES);
  pbf_live_shape **link = find(shape), *found = *link;
  const int last = found && --found->references == 0;
  if (last) *link = found->next;
  pbf_lock_release(PBF_LOCK_SHAPES);
  if (last) free(found);
}

pbf_status pbf_hold_shape(pbf_shape *shape) {
  pbf_status status = pbf_lock_check();
  return status == PBF_OK ? pbf_shape_hold(shape, "shape") : status;
}

void pbf_release_shape(pbf_shape *shape) {
  if (shape && pbf_lock_check() == PBF_OK) pbf_shape_let_go(shape);
}

static pbf_shape_info info_of(const pbf_live_shape *of) {
  const pbf_shape *shape = &of->shape;
  pbf_shape_info info = {.struct_size = sizeof info,
                         .dimension = shape->dimension,
                         .references = of->references,
                         .cell = shape->cell,
                         .volume = shape->volume,
                         .area = shape->area,
                         .bytes = of->bytes,
                         .hash = shape->hash};
  memcpy(info.nodes, shape->nodes, sizeof info.nodes);
  memcpy(info.origin, shape->origin, sizeof info.origin);
  memcpy(info.lower, shape->lower, sizeof info.lower);
  memcpy(info.upper, shape->upper, sizeof info.upper);
  return info;
}

pbf_status pbf_get_shape_info(pbf_shape *shape, pbf_shape_info *info) {
  pbf_status status = pbf_lock_check();
  if (status == PBF_OK) status = pbf_struct_check_out(&pbf_kind_shape_info, info);
  if (status == PBF_OK && !shape) status = pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "shape is null");
  if (status != PBF_OK) return status;
  pbf_lock_take(PBF_LOCK_SHAPES);
  const pbf_live_shape *found = *find(shape);
  const pbf_shape_info ours = found ? info_of(found) : (pbf_shape_info){0};
  pbf_lock_release(PBF_LOCK_SHAPES);
  if (!found) {
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "shape is %p, which is no shape that lives",
                    (void *)shape);
  }
  pbf_struct_out(&pbf_kind_shape_info, &ours, info, info->struct_size);
  return PBF_OK;
}
