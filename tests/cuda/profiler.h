/* What the profiler of these tests has seen: profile_seen() of its library. */
#ifndef PBF_TESTS_CUDA_PROFILER_H
#define PBF_TESTS_CUDA_PROFILER_H

#include <stdint.h>

enum { PROFILE_NAMES = 40 };

typedef struct profile {
  uint32_t names; /* of ranges */
  char name[PROFILE_NAMES][32];
  uint64_t count[PROFILE_NAMES];
  int depth, deepest; /* now, and at most */
} profile;

typedef const profile *(*profile_seen_fn)(void);

#endif
