/* Part of halo.h: which particles each rank has in a step: an equal part of those in the order of
 * the sort, or one by how fast it has been. Sums over pairs are found for whole groups of them, so
 * a share begins with a group: then every group, and with it every bit, is that of a solver without
 * ranks. All ranks know all shares from one histogram of cells. */
#ifndef PBF_CPU_SHARES_H
#define PBF_CPU_SHARES_H

#include "common/rank_shares.h"
#include "cpu/ranks.h"

/* Cells are counted in bins, runs of their numbers. */
enum { RANK_BINS = 4096 };

static inline uint32_t cells_a_bin(const grid *g) { return (g->total + RANK_BINS - 1) / RANK_BINS; }

/* How far apart the numbers of cells of neighbours can be, unless one is beyond a face of the axis
 * of the last digit; all of them where the numbering wraps. */
static inline uint64_t cells_in_reach(const grid *g) {
  if (grid_is_wrapped(g)) return g->total;
  uint64_t rows = 0;
  for (int k = 1; k < PBF_DIM; ++k) {
    const bool across = k + 1 < PBF_DIM && g->up[k] && g->cells[k] > 1;
    rows += (uint64_t)g->stride[k] * (across ? g->cells[k] - 1 : 1);
  }
  return rows * g->cells[0] + (g->up[0] && g->cells[0] > g->reach ? g->cells[0] - 1 : g->reach);
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

static inline rank_run run_of_bins(const uint32_t *before, uint64_t first, uint64_t last) {
  return {before[first], before[last], (uint32_t)first, (uint32_t)last};
}

/* What is held, from the first bin in reach to the last. Beyond the faces of the axis of the last
 * digit what is in reach is at the other end of the numbering. */
static inline void hold_neighbors(const solver *s, rank_share *share) {
  const grid *g = &s->grid;
  const uint32_t *before = s->ranks.histogram, each = cells_a_bin(g);
  const uint64_t reach = cells_in_reach(g), total = g->total, bins = (total + each - 1) / each;
  const uint64_t own = (uint64_t)pbf_bin_of_place(before, RANK_BINS, share->own_first) * each;
  const uint64_t own_end =
      ((uint64_t)pbf_bin_of_place(before, RANK_BINS, share->own_last - 1) + 1) * each;
  const uint64_t end = (own_end + reach + each - 1) / each;
  const bool periodic = g->up[PBF_DIM - 1] != 0, all = periodic && reach >= total;
  uint64_t first = own > reach ? (own - reach) / each : 0, last = end < bins ? end : bins;
  uint64_t low_end = 0,
           high = bins; /* runs beyond the faces are before the one and from the other */
  if (periodic && own < reach && !all) high = (own + total - reach) / each;
  if (periodic && own_end + reach > total && !all)
    low_end = (own_end + reach - total + each - 1) / each;
  if (all || (high < bins && high <= last) || (low_end && low_end >= first))
    first = 0, last = bins, low_end = 0, high = bins;
  share->held[0] = low_end ? run_of_bins(before, 0, low_end) : run_of_bins(before, first, last);
  share->held[1] = low_end ? run_of_bins(before, first, last) : run_of_bins(before, high, bins);
  share->cell_first = share->held[0].bin_first * each;
  const uint64_t cells = (low_end || high < bins ? bins : last) * each;
  share->cell_last = (uint32_t)(cells < total ? cells : total);
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

static inline uint32_t places_in(const rank_run *run) { return run->last - run->first; }

static inline uint32_t held_by(const rank_share *share) {
  return places_in(&share->held[0]) + places_in(&share->held[1]);
}

/* Where a place that is held is among all that are. */
static inline uint32_t among_held(const rank_share *share, uint32_t place) {
  const rank_run *runs = share->held;
  if (place <= runs[0].last) return place - runs[0].first;
  return places_in(&runs[0]) + place - runs[1].first;
}

/* Places before the first one that is held, so that groups begin where they do without ranks. */
static inline uint32_t pad_of(const solver *s, const rank_share *share) {
  const uint32_t width = s->kernels->width;
  return (width - among_held(share, share->own_first) % width) % width;
}

static inline uint32_t room_wanted(const solver *s, const rank_share *share) {
  return pad_of(s, share) + held_by(share);
}

/* Where a place in the order of all is in this rank's. */
static inline uint32_t local_place(const solver *s, uint32_t place) {
  return among_held(&s->ranks.shares[s->ranks.rank], place) + s->ranks.pad;
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
