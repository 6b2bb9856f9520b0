/* Part of backend.cu: particles by where they are, of which only those go to the host that are
 * found. */
#ifndef PBF_CUDA_FIND_IN_BOXES_H
#define PBF_CUDA_FIND_IN_BOXES_H

#include "cuda/population.h"

/* As many as go with a kernel's arguments. */
constexpr uint32_t BOXES_A_LAUNCH = 32;

struct some_boxes {
  uint32_t count;
  pbf_backend_box boxes[BOXES_A_LAUNCH];
};

static __device__ inline bool is_in_box(const pbf_backend_box &box, pbf_vec x) {
  bool inside = true;
  for (int k = 0; k < PBF_DIM; ++k)
    inside &= (double)x.c[k] >= box.lower[k] && (double)x.c[k] <= box.upper[k];
  return inside;
}

/* 1 for those in any of these boxes or, where these are `more`, found before; 0 after the last, for
 * the scan. */
static __global__ void mark_found_kernel(const point *points, uint32_t count, some_boxes some,
                                         bool more, uint32_t *found) {
  const uint32_t i = thread_index();
  if (i > count) return;
  bool inside = more && found[i];
  for (uint32_t b = 0; b < some.count && i < count && !inside; ++b)
    inside = is_in_box(some.boxes[b], position_of(load(points, i)));
  found[i] = inside;
}

/* `place` is the exclusive scan of what mark_found_kernel wrote. */
static __global__ void take_found_kernel(const point *points, const pbf_vec *velocities,
                                         const uint32_t *ids, uint32_t count, const uint32_t *place,
                                         uint32_t room, uint32_t *to_ids, pbf_vec *to_positions,
                                         pbf_vec *to_velocities) {
  const uint32_t i = thread_index();
  if (i >= count || place[i] == place[i + 1] || place[i] >= room) return;
  to_ids[place[i]] = ids[i];
  to_positions[place[i]] = position_of(load(points, i));
  to_velocities[place[i]] = velocities[i];
}

static inline pbf_status mark_found(solver *s, uint32_t count, const pbf_backend_box *boxes,
                                    uint32_t *found) {
  const uint32_t blocks = blocks_for(s->count + 1);
  for (uint32_t first = 0; first < count; first += BOXES_A_LAUNCH) {
    some_boxes some;
    some.count = count - first < BOXES_A_LAUNCH ? count - first : BOXES_A_LAUNCH;
    for (uint32_t b = 0; b < some.count; ++b) some.boxes[b] = boxes[first + b];
    mark_found_kernel<<<blocks, PBF_BLOCK, 0, s->stream>>>(s->points, s->count, some, first > 0,
                                                           found);
  }
  return pbf_cuda_check_launch("mark_found_kernel");
}

/* What the next step sorts into is free between steps. */
static inline pbf_status take_found(solver *s, const uint32_t *place, pbf_backend_found *found) {
  const uint32_t taken = found->count < found->room ? found->count : found->room;
  pbf_vec *positions = reinterpret_cast<pbf_vec *>(s->other);
  if (!taken) return PBF_OK;
  take_found_kernel<<<blocks_for(s->count), PBF_BLOCK, 0, s->stream>>>(
      s->points, s->velocities, s->ids, s->count, place, taken, s->other_ids, positions,
      s->other_velocities);
  pbf_status status = pbf_cuda_check_launch("take_found_kernel");
  if (status == PBF_OK) status = copy_out(s, found->ids, s->other_ids, taken * sizeof *found->ids);
  if (status == PBF_OK) status = copy_out(s, found->positions, positions, taken * sizeof(pbf_vec));
  if (status == PBF_OK)
    status = copy_out(s, found->velocities, s->other_velocities, taken * sizeof(pbf_vec));
  return status;
}

static inline pbf_status population_find(solver *s, uint32_t count, const pbf_backend_box *boxes,
                                         pbf_backend_found *found) {
  uint32_t *place = static_cast<uint32_t *>(s->list_storage);
  found->count = 0;
  if (!s->count) return PBF_OK;
  pbf_status status = mark_found(s, count, boxes, place);
  if (status == PBF_OK)
    status = pbf_cuda_scan(place, s->count + 1, s->scan_scratch, s->scan_bytes, s->stream);
  if (status == PBF_OK) status = copy_out(s, &found->count, place + s->count, sizeof found->count);
  return status == PBF_OK ? take_found(s, place, found) : status;
}

#endif
