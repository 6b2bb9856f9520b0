/* Which row each of many particles is in, where some were removed: ids ascend by row, with gaps. A
 * table of every so many ids leads to few rows that an id can be in, and as gaps are mostly spread
 * evenly among these, its place among them is mostly guessed right. */
#ifndef PBF_COMMON_ID_ROWS_H
#define PBF_COMMON_ID_ROWS_H

#include <stdint.h>

#include "common/rows.h"

enum { PBF_ID_ENTRIES = 1024, PBF_IDS_AN_ENTRY = 4 };

typedef struct pbf_id_rows {
  const uint32_t *ids; /* ascending; null: row and id are the same */
  uint32_t total;
  uint32_t shift;                     /* an entry is of 2^shift ids, from ids[0] on */
  uint32_t first[PBF_ID_ENTRIES + 1]; /* the first row with an id of the entry or a later one */
} pbf_id_rows;

/* Takes less than looking up as many ids as there are rows. */
static inline void pbf_id_rows_begin(pbf_id_rows *rows, const uint32_t *ids, uint32_t total) {
  rows->ids = ids;
  rows->total = total;
  rows->shift = 0;
  if (!ids || total == 0) return;
  const uint32_t span = ids[total - 1] - ids[0], most = total / PBF_IDS_AN_ENTRY + 1;
  while (span >> rows->shift >= PBF_ID_ENTRIES || span >> rows->shift > most) ++rows->shift;
  const uint32_t last = span >> rows->shift;
  for (uint32_t entry = 0; entry <= last; ++entry)
    rows->first[entry] = pbf_id_bound(ids, entry ? rows->first[entry - 1] : 0, total,
                                      ids[0] + (entry << rows->shift));
  rows->first[last + 1] = total;
}

/* The row of an id among rows first … end - 1 that it can only be in, or total; `guess` is one. */
static inline uint32_t pbf_id_row_near(const pbf_id_rows *rows, uint32_t first, uint32_t end,
                                       uint32_t guess, uint32_t id) {
  const uint32_t *ids = rows->ids;
  uint32_t low = first, high = end, step = 1;
  if (ids[guess] == id) return guess;
  if (ids[guess] < id) {
    for (low = guess + 1; step < end - low && ids[low + step] < id; step *= 2) low += step + 1;
    high = step < end - low ? low + step : end;
  } else {
    for (high = guess; step < high - first && ids[high - step] >= id; step *= 2) high -= step;
    low = step < high - first ? high - step + 1 : first;
  }
  const uint32_t at = pbf_id_bound(ids, low, high, id);
  return at < end && ids[at] == id ? at : rows->total;
}

/* The row of an id, or total where none has it. */
static inline uint32_t pbf_id_row(const pbf_id_rows *rows, uint32_t id) {
  const uint32_t *ids = rows->ids, total = rows->total;
  if (!ids) return id;
  if (total == 0 || id < ids[0] || id > ids[total - 1]) return total;
  const uint32_t from = id - ids[0], entry = from >> rows->shift;
  const uint32_t first = rows->first[entry], end = rows->first[entry + 1];
  const uint64_t part = from - (entry << rows->shift);
  if (first == end) return total;
  return pbf_id_row_near(rows, first, end, first + (uint32_t)(part * (end - first) >> rows->shift),
                         id);
}

#endif
