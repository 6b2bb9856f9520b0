#include "memory.h"

#include <inttypes.h>
#include <stdatomic.h>

#include "common/fp_environment.h"
#include "error.h"
#include "os.h"

enum { ALIGNMENT = 64 };

/* ---- No more than there is ------------------------------------------------------------------ */

/* Linux gives memory that it does not have, and ends the process that writes to it. So what is
 * taken must fit into what is left beside what was taken before and is yet unwritten: a solver
 * takes all of its arrays before it clears them. One look at what the system tells for so many
 * bytes. */
enum { LOOK_EVERY = 1 << 26 };

static _Atomic size_t taken, unlooked;

static int is_left(size_t size) {
  uint64_t left, written;
  if (!pbf_os_memory(&left, &written)) return 1;
  const uint64_t ours = atomic_load_explicit(&taken, memory_order_relaxed);
  const uint64_t unwritten = ours > written ? ours - written : 0;
  return size <= left && unwritten <= left - size;
}

static int may_take(size_t size) {
  const size_t before = atomic_fetch_add_explicit(&unlooked, size, memory_order_relaxed);
  if (size < LOOK_EVERY && before < LOOK_EVERY) return 1;
  atomic_store_explicit(&unlooked, 0, memory_order_relaxed);
  return is_left(size);
}

static void *default_allocate(void *user, uint64_t size, uint64_t alignment) {
  (void)user;
  if (size > SIZE_MAX - alignment || !may_take((size_t)size)) return NULL;
  if (alignment < sizeof(void *)) alignment = sizeof(void *);
  void *memory = pbf_os_allocate((size + alignment - 1) / alignment * alignment, alignment);
  if (memory) atomic_fetch_add_explicit(&taken, (size_t)size, memory_order_relaxed);
  return memory;
}

static void default_release(void *user, void *memory, uint64_t size, uint64_t alignment) {
  (void)user, (void)alignment;
  pbf_os_release(memory);
  atomic_fetch_sub_explicit(&taken, (size_t)size, memory_order_relaxed);
}

/* ---- Through whatever allocator -------------------------------------------------------------- */

const pbf_allocator pbf_default_allocator = {sizeof(pbf_allocator), 0, NULL, default_allocate,
                                             default_release};

/* Callers' allocators are never asked for 0 bytes. */
static uint64_t at_least_one(uint64_t size) { return size ? size : 1; }

/* Memory that does not lie as it must would end the process at the first access by whole lanes. */
void *pbf_memory_ask(const pbf_allocator *allocator, uint64_t size, uint64_t alignment) {
  void *memory = allocator->allocate(allocator->user, size, alignment);
  if (alignment <= 1 || ((uintptr_t)memory & (alignment - 1)) == 0) return memory;
  allocator->release(allocator->user, memory, size, alignment);
  return NULL;
}

void *pbf_memory_try(const pbf_allocator *allocator, uint64_t size) {
  const pbf_fp_environment ours = pbf_fp_now();
  void *memory = pbf_memory_ask(allocator, at_least_one(size), ALIGNMENT);
  pbf_fp_end(ours); /* a caller's function may have left another one */
  return memory;
}

pbf_status pbf_memory_allocate(const pbf_allocator *allocator, uint64_t size, const char *purpose,
                               void **memory) {
  *memory = pbf_memory_try(allocator, size);
  if (*memory) return PBF_OK;
  return pbf_fail(PBF_ERROR_OUT_OF_MEMORY,
                  "the allocator gave no %" PRIu64 " bytes aligned to %d for %s",
                  at_least_one(size), (int)ALIGNMENT, purpose);
}

void pbf_memory_free(const pbf_allocator *allocator, void *memory, uint64_t size) {
  const pbf_fp_environment ours = pbf_fp_now();
  if (memory) allocator->release(allocator->user, memory, at_least_one(size), ALIGNMENT);
  pbf_fp_end(ours);
}
