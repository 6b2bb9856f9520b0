/* Part of halo.h: which particles each rank has in a step: an equal part of those in the order of
 * the sort, or one by how fast it has been. Sums over pairs are found for whole groups of them, so
 * a share begins with a group: then every group, and with it every bit, is that of a solver without
 * ranks. All ranks know all shares from one histogram of cells. */
#ifndef PBF_CPU_SHARES_H
#define PBF_CPU_SHARES_H

#include "cpu/ranks.h"

/* Cells are counted in bins, runs of their numbers. */
enum { RANK_BINS = 4096 };

static inline uint32_t cells_a_bin(const grid *g) { return (g->total + RANK_BINS - 1) / RANK_BINS; }

/* How far apart the numbers of cells of neighbours can be; all of them where the numbering wraps.
 */
static inline uint64_t cells_in_reach(const grid *g) {
  if (grid_is_wrapped(g)) return g->total;
  uint64_t rows = 0;
  for (int k = 1; k < PBF_DIM; ++k) rows += g->stride[k];
  return rows * g->cells[0] + g->reach;
}

/* histogram[b] gets the number of particles in the bins before b. */
static inline void sum_up(uint32_t *histogram) {
  uint32_t before = 0;
  for (uint32_t b = 0; b <= RANK_BINS; ++b) {
    const uint32_t count = histogram[b];
    histogram[b] = before;
    before += count;
  }
}

static inline uint32_t bin_of_place(const uint32_t *before, uint32_t place) {
  uint32_t low = 0, high = RANK_BINS;
  while (low + 1 < high) {
    const uint32_t middle = low + (high - low) / 2;
    if (before[middle] <= place)
      low = middle;
    else
      high = middle;
  }
  return low;
}

/* Where the share of rank k begins. */
static inline uint32_t share_begin(const solver *s, uint32_t k) {
  const uint32_t total = s->ranks.total, width = s->kernels->width;
  double before = 0, all = 0;
  if (k == s->ranks.count) return total;
  for (uint32_t j = 0; j < s->ranks.count; ++j) {
    if (j < k) before += s->ranks.portions[j];
    all += s->ranks.portions[j];
  }
  const uint32_t place = (uint32_t)(total * (before / all));
  return place / width * width;
}

/* What is held, from the first bin in reach to the last. */
static inline void hold_neighbors(const solver *s, rank_share *share) {
  const uint32_t *before = s->ranks.histogram, each = cells_a_bin(&s->grid);
  const uint64_t reach = cells_in_reach(&s->grid), total = s->grid.total;
  const uint64_t first = (uint64_t)bin_of_place(before, share->own_first) * each;
  const uint64_t last = ((uint64_t)bin_of_place(before, share->own_last - 1) + 1) * each;
  share->bin_first = first > reach ? (uint32_t)((first - reach) / each) : 0;
  const uint64_t end = (last + reach + each - 1) / each, bins = (total + each - 1) / each;
  share->bin_last = (uint32_t)(end < bins ? end : bins);
  share->held_first = before[share->bin_first];
  share->held_last = before[share->bin_last];
  share->cell_first = share->bin_first * each;
  share->cell_last =
      (uint32_t)((uint64_t)share->bin_last * each < total ? (uint64_t)share->bin_last * each
                                                          : total);
}

/* A rank without particles of its own holds none. */
static inline void find_shares(solver *s) {
  for (uint32_t k = 0; k < s->ranks.count; ++k) {
    rank_share share = {};
    share.own_first = share_begin(s, k);
    share.own_last = share_begin(s, k + 1);
    if (share.own_first < share.own_last)
      hold_neighbors(s, &share);
    else
      share = {};
    s->ranks.shares[k] = share;
  }
}

/* Places before the first one that is held, so that groups begin where they do without ranks. */
static inline uint32_t pad_of(const solver *s, const rank_share *share) {
  return share->held_first % s->kernels->width;
}

static inline uint32_t room_wanted(const solver *s, const rank_share *share) {
  return pad_of(s, share) + share->held_last - share->held_first;
}

/* Where a place in the order of all is in this rank's. */
static inline uint32_t local_place(const solver *s, uint32_t place) {
  return place - s->ranks.shares[s->ranks.rank].held_first + s->ranks.pad;
}

/* ---- How large they are -------------------------------------------------------------------- */

/* What ranks tell each other at the start of a sort. */
struct rank_summary {
  box around;     /* its particles */
  double seconds; /* that it has worked in the last step, … */
  uint32_t own;   /* … at so many particles; 0: not yet */
};

/* Slowly, for times are uncertain, to where all would need as long. Where space is cut changes no
 * bit. */
static inline void balance(solver *s, const rank_summary *summaries) {
  const double part = 0.1, least = 0.05 / s->ranks.count;
  const double fair = 1.0 / s->ranks.count, room = 0.8 * s->local_capacity / s->ranks.total;
  const double most = room > fair ? room : fair; /* of which some is for neighbours */
  double all = 0;
  if (s->ranks.shares_are_fixed) return;
  for (uint32_t k = 0; k < s->ranks.count; ++k)
    if (!summaries[k].own || !(summaries[k].seconds > 0)) return;
  for (uint32_t k = 0; k < s->ranks.count; ++k) all += summaries[k].own / summaries[k].seconds;
  for (uint32_t k = 0; k < s->ranks.count; ++k) {
    const double wanted = summaries[k].own / summaries[k].seconds / all;
    double *portion = &s->ranks.portions[k];
    *portion += part * (wanted - *portion);
    if (*portion < least) *portion = least;
    if (*portion > most) *portion = most;
  }
}

#endif
