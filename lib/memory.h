/* Host memory of a solver, always through its allocator. */
#ifndef PBF_LIB_MEMORY_H
#define PBF_LIB_MEMORY_H

#include <pbf/pbf.h>

extern const pbf_allocator pbf_default_allocator;

/* Of a caller's allocator, by its own function: null where it gives none, or none that is aligned.
 */
void *pbf_memory_ask(const pbf_allocator *allocator, uint64_t size, uint64_t alignment);

/* Null where there is none. */
void *pbf_memory_try(const pbf_allocator *allocator, uint64_t size);

/* Fails with a message that says what the memory was for. A size of 0 is allowed. */
pbf_status pbf_memory_allocate(const pbf_allocator *allocator, uint64_t size, const char *purpose,
                               void **memory);

/* Null is a no-op; `size` is the one it was allocated with. */
void pbf_memory_free(const pbf_allocator *allocator, void *memory, uint64_t size);

#endif
