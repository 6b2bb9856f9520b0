/* Host memory of a solver: every array is in one table, so that the plan and the release can't
 * forget one. */
#ifndef PBF_COMMON_MEMORY_H
#define PBF_COMMON_MEMORY_H

#include <stdint.h>
#include <string.h>

#include <pbf/pbf_backend.h>

#include "physics/scene_arrays.h"

typedef struct pbf_array {
  const char *name;
  void *data;
  uint64_t bytes;
} pbf_array;

/* All that a scene may have at once, on ranks, too; no more than some are of one backend. A plan
 * has fewer entries: the last arrays are in its bytes alone. */
enum { PBF_LASTING_ARRAYS = 48, PBF_MEMORY_ARRAYS = PBF_LASTING_ARRAYS + PBF_SCENE_ARRAYS };

typedef struct pbf_memory {
  pbf_allocator allocator;
  pbf_array arrays[PBF_MEMORY_ARRAYS];
  uint32_t count;
} pbf_memory;

enum { PBF_ALIGNMENT = 64 };

static inline void pbf_memory_free(pbf_memory *memory, void *data) {
  if (!data) return;
  for (uint32_t k = 0; k < memory->count; ++k)
    if (memory->arrays[k].data == data) {
      const uint64_t bytes = memory->arrays[k].bytes;
      memory->arrays[k] = memory->arrays[--memory->count];
      memory->allocator.release(memory->allocator.user, data, bytes, PBF_ALIGNMENT);
      return;
    }
}

static inline void pbf_memory_free_all(pbf_memory *memory) {
  while (memory->count) pbf_memory_free(memory, memory->arrays[memory->count - 1].data);
}

/* Null when there is no memory, or no place left in the table. `name` must outlive the array. */
static inline void *pbf_memory_take(pbf_memory *memory, const char *name, uint64_t count,
                                    uint64_t element) {
  if (memory->count == PBF_MEMORY_ARRAYS || (count && element > UINT64_MAX / count)) return NULL;
  uint64_t bytes = count * element;
  if (bytes < PBF_ALIGNMENT) bytes = PBF_ALIGNMENT;
  void *data = memory->allocator.allocate(memory->allocator.user, bytes, PBF_ALIGNMENT);
  if (data) memory->arrays[memory->count++] = (pbf_array){name, data, bytes};
  return data;
}

/* Takes or releases an array, as `wanted` says: `count` elements that begin as 0, with *array
 * behind the first `front` of them. Returns false when there is no memory. */
template <class Element>
static inline bool pbf_memory_keep(pbf_memory *memory, bool wanted, const char *name,
                                   uint64_t count, uint64_t front, Element **array) {
  if (wanted == (*array != NULL)) return true;
  if (!wanted) {
    pbf_memory_free(memory, *array - front);
    *array = NULL;
    return true;
  }
  Element *base = (Element *)pbf_memory_take(memory, name, count, sizeof(Element));
  if (!base) return false;
  memset(base, 0, count * sizeof(Element));
  *array = base + front;
  return true;
}

/* The same of what has arrays behind it: so many bytes. */
template <class Header>
static inline bool pbf_memory_keep_bytes(pbf_memory *memory, bool wanted, const char *name,
                                         uint64_t bytes, Header **header) {
  char *block = (char *)*header;
  const bool kept = pbf_memory_keep(memory, wanted, name, bytes, 0, &block);
  *header = (Header *)block;
  return kept;
}

/* Adds the arrays to the plan; sums up its bytes. */
static inline void pbf_memory_plan(const pbf_memory *memory, uint32_t capacity, pbf_plan *plan) {
  for (uint32_t k = 0; k < memory->count; ++k) {
    const uint64_t bytes = memory->arrays[k].bytes;
    plan->bytes += bytes;
    plan->bytes_per_particle += (double)bytes / capacity;
    if (plan->array_count == PBF_MAX_ARRAYS) continue;
    pbf_plan_array *entry = &plan->arrays[plan->array_count++];
    strncpy(entry->name, memory->arrays[k].name, sizeof entry->name - 1);
    entry->bytes = bytes;
    entry->bytes_per_particle = (double)bytes / capacity;
  }
}

#endif
