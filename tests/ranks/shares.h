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

typedef struct own_rows {
  uint32_t count, *ids;
  char *values;
} own_rows;

static inline own_rows read_own(pbf_solver *s, uint32_t field, uint64_t row_bytes) {
  own_rows own = {0, NULL, NULL};
  EXPECT_OK(pbf_get_share(s, field, 0, &own.count, NULL, NULL));
  own.ids = calloc(own.count + 1, sizeof *own.ids);
  own.values = calloc(own.count + 1, row_bytes);
  EXPECT(own.ids && own.values);
  EXPECT_OK(pbf_get_share(s, field, own.count, &own.count, own.ids, own.values));
  return own;
}

/* Frees them, too. */
static inline void expect_own(own_rows own, uint64_t row_bytes, const void *all,
                              const uint32_t *all_ids, uint32_t total, shared_ids *seen) {
  uint32_t row = 0;
  for (uint32_t k = 0; k < own.count; ++k) {
    EXPECT(k == 0 || own.ids[k] > own.ids[k - 1]);
    while (row < total && all_ids[row] != own.ids[k]) ++row;
    if (!EXPECT(row < total)) break;
    EXPECT(memcmp(own.values + k * row_bytes, (const char *)all + row * row_bytes, row_bytes) == 0);
    if (seen) atomic_fetch_add(&seen->owners[own.ids[k] % MAX_SHARED_IDS], 1);
  }
  free(own.ids);
  free(own.values);
}

static inline void refuse_share(pbf_solver *s, uint32_t total, uint32_t *ids, void *rows) {
  uint32_t count = 0;
  EXPECT_OK(pbf_get_share(s, PBF_FIELD_POSITION, 0, &count, NULL, NULL));
  if (count)
    EXPECT_FAILS(pbf_get_share(s, PBF_FIELD_POSITION, count - 1, &count, ids, rows),
                 PBF_ERROR_INVALID_ARGUMENT, "the share has");
  EXPECT_FAILS(pbf_get_share(s, PBF_FIELD_DENSITY, total, &count, ids, rows),
               PBF_ERROR_INVALID_ARGUMENT, "PBF_FIELD_POSITION or PBF_FIELD_VELOCITY");
  EXPECT_FAILS(pbf_get_share(s, PBF_FIELD_POSITION, total, &count, NULL, rows),
               PBF_ERROR_INVALID_ARGUMENT, "ids is null");
  EXPECT_FAILS(pbf_get_share(s, PBF_FIELD_POSITION, total, NULL, ids, rows),
               PBF_ERROR_INVALID_ARGUMENT, "count");
}

/* All ranks call it with the same `seen`, before they read anything else: a device has its share
 * elsewhere then. */
static inline void expect_share(pbf_solver *s, uint32_t dimension, uint32_t precision,
                                shared_ids *seen) {
  const uint64_t row_bytes = (uint64_t)dimension * precision;
  uint32_t total = 0;
  const own_rows x = read_own(s, PBF_FIELD_POSITION, row_bytes);
  const own_rows v = read_own(s, PBF_FIELD_VELOCITY, row_bytes);
  EXPECT_OK(pbf_get_count(s, &total));
  uint32_t *ids = calloc(total, sizeof *ids);
  void *rows = calloc(total, row_bytes);
  if (!EXPECT(ids && rows)) return;
  EXPECT_OK(pbf_get_ids(s, 0, total, ids));
  EXPECT_OK(pbf_get_positions(s, 0, total, rows));
  expect_own(x, row_bytes, rows, ids, total, seen);
  EXPECT_OK(pbf_get_velocities(s, 0, total, rows));
  expect_own(v, row_bytes, rows, ids, total, NULL);
  refuse_share(s, total, ids, rows);
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
