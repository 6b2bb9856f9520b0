#include "memory.h"

#include <inttypes.h>

#include "error.h"
#include "os.h"

enum { ALIGNMENT = 64 };

static void *default_allocate(void *user, uint64_t size, uint64_t alignment) {
  (void)user;
  if (size > SIZE_MAX - alignment) return NULL;
  if (alignment < sizeof(void *)) alignment = sizeof(void *);
  return pbf_os_allocate((size + alignment - 1) / alignment * alignment, alignment);
}

static void default_release(void *user, void *memory, uint64_t size, uint64_t alignment) {
  (void)user, (void)size, (void)alignment;
  pbf_os_release(memory);
}

const pbf_allocator pbf_default_allocator = {sizeof(pbf_allocator), 0, NULL, default_allocate,
                                             default_release};

/* Callers' allocators are never asked for 0 bytes. */
static uint64_t at_least_one(uint64_t size) { return size ? size : 1; }

pbf_status pbf_memory_allocate(const pbf_allocator *allocator, uint64_t size, const char *purpose,
                               void **memory) {
  size = at_least_one(size);
  *memory = allocator->allocate(allocator->user, size, ALIGNMENT);
  if (*memory) return PBF_OK;
  return pbf_fail(PBF_ERROR_OUT_OF_MEMORY, "the allocator gave no %" PRIu64 " bytes for %s", size,
                  purpose);
}

void pbf_memory_free(const pbf_allocator *allocator, void *memory, uint64_t size) {
  if (memory) allocator->release(allocator->user, memory, at_least_one(size), ALIGNMENT);
}
