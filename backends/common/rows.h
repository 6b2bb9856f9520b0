/* Where a particle stands in the order of adding (pbf_backend.h, pbf_rows). */
#ifndef PBF_COMMON_ROWS_H
#define PBF_COMMON_ROWS_H

#include <pbf/pbf_backend.h>

#include "physics/features.h"

/* Position of `id` in ascending ids[0 … count - 1], or count where it is not among them. */
PBF_FN uint32_t pbf_find_id(const uint32_t *ids, uint32_t count, uint32_t id) {
  uint32_t low = 0, high = count;
  while (low < high) {
    uint32_t middle = low + (high - low) / 2;
    if (ids[middle] < id)
      low = middle + 1;
    else
      high = middle;
  }
  return low < count && ids[low] == id ? low : count;
}

static inline uint32_t pbf_row_of(const pbf_rows *rows, uint32_t id) {
  return rows->ids ? pbf_find_id(rows->ids, rows->total, id) : id;
}

#endif
