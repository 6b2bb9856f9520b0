/* Part of solver.h's: the shapes of the colliders on the device, each once, one behind the other:
 * a pbf_shape and its values. */
#ifndef PBF_CUDA_SHAPES_H
#define PBF_CUDA_SHAPES_H

#include "cuda/memory.h"
#include "cuda/status.h"
#include "physics/surfaces/obstacles.h"

/* Which of them there are, and where. */
struct device_shapes {
  unsigned char *memory; /* null: there are none */
  uint32_t count;
  uint64_t bytes, ids[PBF_FEW_COLLIDERS], places[PBF_FEW_COLLIDERS];
};

static inline uint64_t shape_values_bytes(const pbf_shape *shape) {
  return (uint64_t)shape->nodes[0] * shape->nodes[1] * shape->nodes[2] * sizeof(float);
}

/* Its number; `count` where it is none of them. */
static inline uint32_t number_of_shape(const device_shapes &of, uint64_t id) {
  uint32_t k = 0;
  while (k < of.count && of.ids[k] != id) ++k;
  return k;
}

/* Those of these colliders, no memory yet. */
static inline device_shapes shapes_of(uint32_t count, const pbf_collider *colliders) {
  device_shapes of = {};
  for (uint32_t c = 0; c < count; ++c) {
    const pbf_shape *shape = colliders[c].geometry;
    if (!shape || number_of_shape(of, shape->id) < of.count) continue;
    of.places[of.count] = of.bytes;
    of.ids[of.count++] = shape->id;
    of.bytes += (sizeof(pbf_shape) + shape_values_bytes(shape) + 255) / 256 * 256;
  }
  return of;
}

static inline bool are_same_shapes(const device_shapes &a, const device_shapes &b) {
  return a.count == b.count && memcmp(a.ids, b.ids, a.count * sizeof *a.ids) == 0;
}

static inline pbf_status upload_shape(unsigned char *to, const pbf_shape *shape) {
  pbf_shape there = *shape;
  there.values = reinterpret_cast<const float *>(to + sizeof there);
  if (pbf_status status =
          pbf_cuda_check(cudaMemcpy(to + sizeof there, shape->values, shape_values_bytes(shape),
                                    cudaMemcpyHostToDevice),
                         "cudaMemcpy of a shape's distances"))
    return status;
  return pbf_cuda_check(cudaMemcpy(to, &there, sizeof there, cudaMemcpyHostToDevice),
                        "cudaMemcpy of a shape");
}

/* Those of these colliders, with memory: what `now` has where that is the same. */
static inline pbf_status take_shapes(pbf_cuda_memory *memory, const device_shapes &now,
                                     uint32_t count, const pbf_collider *colliders,
                                     device_shapes *next) {
  void *room = nullptr;
  *next = shapes_of(count, colliders);
  if (are_same_shapes(now, *next)) {
    *next = now;
    return PBF_OK;
  }
  if (!next->count) return PBF_OK;
  if (pbf_status status = pbf_cuda_take(memory, "shapes", next->bytes, &room)) return status;
  next->memory = static_cast<unsigned char *>(room);
  /* It is zeroed in the solver's stream, which the copies are not in. */
  pbf_status status = pbf_cuda_check(cudaStreamSynchronize(memory->stream), "shapes");
  for (uint32_t c = 0; c < count && !status; ++c)
    if (colliders[c].geometry)
      status = upload_shape(
          next->memory + next->places[number_of_shape(*next, colliders[c].geometry->id)],
          colliders[c].geometry);
  if (status) pbf_cuda_free(memory, room);
  return status;
}

static inline const pbf_shape *shape_on_device(const device_shapes &of, uint64_t id) {
  const uint32_t k = number_of_shape(of, id);
  return k < of.count ? reinterpret_cast<const pbf_shape *>(of.memory + of.places[k]) : nullptr;
}

#endif
