/* What each rank says is its share: together all particles, each once, as all ranks read them. */
#ifndef PBF_TESTS_SHARES_H
#define PBF_TESTS_SHARES_H

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "thread_ranks.h"

/* How many ranks have each id below MAX_SHARED_IDS. */
enum { MAX_SHARED_IDS = 8192 };
typedef struct shared_ids {
  atomic_uint owners[MAX_SHARED_IDS];
} shared_ids;

static inline void expect_own(pbf_solver *s, uint32_t field, uint64_t row_bytes, const void *all,
                              const uint32_t *all_ids, uint32_t total, shared_ids *seen) {
  uint32_t count = 0, row = 0;
  EXPECT_OK(pbf_get_share(s, field, 0, &count, NULL, NULL));
  uint32_t *ids = calloc(count + 1, sizeof *ids);
  char *values = calloc(count + 1, row_bytes);
  if (!EXPECT(ids && values)) return;
  EXPECT_OK(pbf_get_share(s, field, count, &count, ids, values));
  for (uint32_t k = 0; k < count; ++k) {
    EXPECT(k == 0 || ids[k] > ids[k - 1]);
    while (row < total && all_ids[row] != ids[k]) ++row;
    if (!EXPECT(row < total)) break;
    EXPECT(memcmp(values + k * row_bytes, (const char *)all + row * row_bytes, row_bytes) == 0);
    if (seen) atomic_fetch_add(&seen->owners[ids[k] % MAX_SHARED_IDS], 1);
  }
  if (count)
    EXPECT_FAILS(pbf_get_share(s, field, count - 1, &count, ids, values),
                 PBF_ERROR_INVALID_ARGUMENT, "the share has");
  free(ids);
  free(values);
}

/* All ranks call it with the same `seen`. */
static inline void expect_share(pbf_solver *s, uint32_t dimension, uint32_t precision,
                                shared_ids *seen) {
  const uint64_t row_bytes = (uint64_t)dimension * precision;
  uint32_t total = 0, count = 0;
  float value;
  EXPECT_OK(pbf_get_count(s, &total));
  uint32_t *ids = calloc(total, sizeof *ids);
  void *rows = calloc(total, row_bytes);
  if (!EXPECT(ids && rows)) return;
  EXPECT_OK(pbf_get_ids(s, 0, total, ids));
  EXPECT_OK(pbf_get_positions(s, 0, total, rows));
  expect_own(s, PBF_FIELD_POSITION, row_bytes, rows, ids, total, seen);
  EXPECT_OK(pbf_get_velocities(s, 0, total, rows));
  expect_own(s, PBF_FIELD_VELOCITY, row_bytes, rows, ids, total, NULL);
  EXPECT_FAILS(pbf_get_share(s, PBF_FIELD_DENSITY, total, &count, ids, rows),
               PBF_ERROR_INVALID_ARGUMENT, "PBF_FIELD_POSITION or PBF_FIELD_VELOCITY");
  EXPECT_FAILS(pbf_get_share(s, PBF_FIELD_POSITION, total, &count, NULL, &value),
               PBF_ERROR_INVALID_ARGUMENT, "ids is null");
  EXPECT_FAILS(pbf_get_share(s, PBF_FIELD_POSITION, total, NULL, ids, rows),
               PBF_ERROR_INVALID_ARGUMENT, "count");
  free(ids);
  free(rows);
}

/* Whether so many ids have one owner, and no other has any. */
static inline int each_is_in_one(shared_ids *seen, uint64_t count) {
  uint64_t once = 0, more = 0;
  for (uint32_t k = 0; k < MAX_SHARED_IDS; ++k) {
    const unsigned owners = atomic_load(&seen->owners[k]);
    once += owners == 1;
    more += owners > 1;
  }
  return once == count && !more;
}

#endif
