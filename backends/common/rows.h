/* Where a particle stands in the order of adding (pbf_backend.h, pbf_rows). */
#ifndef PBF_COMMON_ROWS_H
#define PBF_COMMON_ROWS_H

#include <pbf/pbf_backend.h>

#include "physics/features.h"

/* The first of ascending ids[low … high - 1] that is at least `id`, or high. */
PBF_FN uint32_t pbf_id_bound(const uint32_t *ids, uint32_t low, uint32_t high, uint32_t id) {
  while (low < high) {
    const uint32_t middle = low + (high - low) / 2;
    if (ids[middle] < id)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/* Position of `id` in ascending ids[0 … count - 1], or count where it is not among them. */
PBF_FN uint32_t pbf_find_id(const uint32_t *ids, uint32_t count, uint32_t id) {
  const uint32_t at = pbf_id_bound(ids, 0, count, id);
  return at < count && ids[at] == id ? at : count;
}

static inline uint32_t pbf_row_of(const pbf_rows *rows, uint32_t id) {
  return rows->ids ? pbf_find_id(rows->ids, rows->total, id) : id;
}

#endif
