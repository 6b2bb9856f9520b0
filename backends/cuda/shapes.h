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
  uint32_t count, room;
  uint64_t bytes;
  uint64_t *ids;    /* which ascend, of `room` that the host has memory for, and behind them … */
  uint64_t *places; /* … where each is, and the first collider that has it */
};

static inline uint64_t *owners_of_shapes(const device_shapes &of) { return of.places + of.room; }
static inline uint64_t shape_table_bytes(uint32_t room) { return 3ull * room * sizeof(uint64_t); }

static inline uint64_t shape_values_bytes(const pbf_shape *shape) {
  return (uint64_t)shape->nodes[0] * shape->nodes[1] * shape->nodes[2] * sizeof(float);
}

/* The number of the first id that is no lower. */
static inline uint32_t lower_bound_of_shape(const device_shapes &of, uint64_t id) {
  uint32_t first = 0, count = of.count;
  while (count > 0) {
    const uint32_t half = count / 2;
    if (of.ids[first + half] < id) {
      first += half + 1;
      count -= half + 1;
    } else {
      count = half;
    }
  }
  return first;
}

/* Its number; `count` where it is none of them. */
static inline uint32_t number_of_shape(const device_shapes &of, uint64_t id) {
  const uint32_t k = lower_bound_of_shape(of, id);
  return k < of.count && of.ids[k] == id ? k : of.count;
}

static inline void free_shape_table(const pbf_allocator &allocator, const device_shapes &of) {
  if (of.ids)
    allocator.release(allocator.user, of.ids, shape_table_bytes(of.room), alignof(uint64_t));
}

/* Notes those of these colliders, no memory on the device yet. */
static inline void note_shapes(device_shapes *of, uint32_t count, const pbf_collider *colliders) {
  for (uint32_t c = 0; c < count; ++c) {
    const pbf_shape *shape = colliders[c].geometry;
    if (!shape || number_of_shape(*of, shape->id) < of->count) continue;
    const uint32_t k = lower_bound_of_shape(*of, shape->id);
    const uint32_t after = of->count++ - k;
    memmove(of->ids + k + 1, of->ids + k, after * sizeof *of->ids);
    memmove(owners_of_shapes(*of) + k + 1, owners_of_shapes(*of) + k, after * sizeof *of->ids);
    of->ids[k] = shape->id;
    owners_of_shapes(*of)[k] = c;
  }
  for (uint32_t k = 0; k < of->count; ++k) {
    of->places[k] = of->bytes;
    of->bytes += (sizeof(pbf_shape) +
                  shape_values_bytes(colliders[owners_of_shapes(*of)[k]].geometry) + 255) /
                 256 * 256;
  }
}

static inline bool are_same_shapes(const device_shapes &a, const device_shapes &b) {
  return a.count == b.count && (!a.count || memcmp(a.ids, b.ids, a.count * sizeof *a.ids) == 0);
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

/* Memory on the device for them, and they in it. */
static inline pbf_status upload_shapes(pbf_cuda_memory *memory, device_shapes *of,
                                       const pbf_collider *colliders) {
  void *room = nullptr;
  if (pbf_status status = pbf_cuda_take(memory, "shapes", of->bytes, &room)) return status;
  of->memory = static_cast<unsigned char *>(room);
  /* It is zeroed in the solver's stream, which the copies are not in. */
  pbf_status status = pbf_cuda_check(cudaStreamSynchronize(memory->stream), "shapes");
  for (uint32_t k = 0; k < of->count && !status; ++k)
    status = upload_shape(of->memory + of->places[k], colliders[owners_of_shapes(*of)[k]].geometry);
  if (status) pbf_cuda_free(memory, room);
  return status;
}

/* Those of these colliders, with memory: what `now` has where that is the same. */
static inline pbf_status take_shapes(const pbf_allocator &allocator, pbf_cuda_memory *memory,
                                     const device_shapes &now, uint32_t count,
                                     const pbf_collider *colliders, device_shapes *next) {
  *next = {};
  for (uint32_t c = 0; c < count; ++c) next->room += colliders[c].geometry != nullptr;
  if (!next->room) return PBF_OK;
  next->ids = static_cast<uint64_t *>(
      allocator.allocate(allocator.user, shape_table_bytes(next->room), alignof(uint64_t)));
  if (!next->ids) {
    pbf_cuda_host->set_error("no host memory for the shapes of the colliders; fewer would do");
    return PBF_ERROR_OUT_OF_MEMORY;
  }
  next->places = next->ids + next->room;
  note_shapes(next, count, colliders);
  const bool same = are_same_shapes(now, *next);
  pbf_status status = same ? PBF_OK : upload_shapes(memory, next, colliders);
  if (same || status) free_shape_table(allocator, *next);
  if (same) *next = now;
  return status;
}

static inline const pbf_shape *shape_on_device(const device_shapes &of, uint64_t id) {
  const uint32_t k = number_of_shape(of, id);
  return k < of.count ? reinterpret_cast<const pbf_shape *>(of.memory + of.places[k]) : nullptr;
}

#endif
