/* An allocator that counts, checks and, when told to, fails. */
#ifndef PBF_TESTS_ALLOCATOR_H
#define PBF_TESTS_ALLOCATOR_H

#include <pbf/pbf.h>

typedef struct counting {
  uint64_t live_bytes;
  uint64_t live_blocks;
  uint64_t calls;
  uint64_t failing_call; /* the call with this number gets nothing; 0: none fails */
} counting;

/* All solvers of a test share one count; tests that use it run in one thread. */
extern counting test_count;

extern const pbf_allocator test_allocator;

#endif
