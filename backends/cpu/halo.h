/* Part of sort.h and executor.h: how particles come to the rank that has them in its share, and to
 * those that need them as neighbours; and how what stages change of them follows. */
#ifndef PBF_CPU_HALO_H
#define PBF_CPU_HALO_H

#include "cpu/shares.h"

/* An array of what goes along with particles, from where it is to where it is wanted. */
typedef struct carried {
  const void *from;
  void *to;
  uint32_t element; /* bytes */
} carried;

static uint32_t larger(uint32_t a, uint32_t b) { return a > b ? a : b; }
static uint32_t smaller(uint32_t a, uint32_t b) { return a < b ? a : b; }

enum { MAX_CARRIED = 4 * PBF_DIM + 6 };

/* The bin of each particle, in the place of the order that the sort will give them. */
static uint32_t *bins_of(const solver *s) { return s->order; }

static void count_bins(solver *s) {
  uint32_t *histogram = s->ranks.histogram, *bins = bins_of(s), each = cells_a_bin(&s->grid);
  memset(histogram, 0, (RANK_BINS + 1) * sizeof *histogram);
  for (uint32_t i = 0; i < s->count; ++i) {
    bins[i] = s->cells[i] / each;
    ++histogram[bins[i]];
  }
}

/* All ranks find the same. */
static bool shares_fit(solver *s) {
  uint32_t most = 0, rank = 0;
  for (uint32_t k = 0; k < s->ranks.count; ++k) {
    const uint32_t wanted = room_wanted(s, &s->ranks.shares[k]);
    if (wanted > most) most = wanted, rank = k;
  }
  if (most <= s->local_capacity) return true;
  char text[200];
  snprintf(text, sizeof text,
           "rank %u would hold %u particles, those near its own included, and local_capacity is "
           "%u; a larger one would do, or fewer ranks",
           rank, most, s->local_capacity);
  refuse_on_ranks(s, PBF_ERROR_CAPACITY, text);
  return false;
}

static bool is_held_by(const rank_share *share, uint32_t bin) {
  bool is = false;
  for (const rank_run &run : share->held) is |= bin - run.bin_first < run.bin_last - run.bin_first;
  return is;
}

/* How many of this rank's particles each rank is to hold. */
static void count_for_ranks(const solver *s, uint32_t *counts) {
  const uint32_t *bins = bins_of(s);
  for (uint32_t k = 0; k < s->ranks.count; ++k) {
    const rank_share share = s->ranks.shares[k];
    uint32_t count = 0;
    for (uint32_t i = 0; i < s->count; ++i) count += is_held_by(&share, bins[i]);
    counts[k] = count;
  }
}

/* Those of an array that a rank is to hold, one after another; `to` may be the array itself.
 * Returns how many. */
template <class Element>
static uint32_t take_held(const solver *s, const rank_share *share, const void *from, void *to) {
  const uint32_t *bins = bins_of(s);
  const Element *source = static_cast<const Element *>(from);
  Element *sink = static_cast<Element *>(to);
  uint32_t taken = 0;
  for (uint32_t i = 0; i < s->count; ++i)
    if (is_held_by(share, bins[i])) sink[taken++] = source[i];
  return taken;
}

static uint32_t take_array(const solver *s, const rank_share *share, const carried &what,
                           void *to) {
  if (what.element == sizeof(uint8_t)) return take_held<uint8_t>(s, share, what.from, to);
  return what.element == sizeof(uint32_t) ? take_held<uint32_t>(s, share, what.from, to)
                                          : take_held<uint64_t>(s, share, what.from, to);
}

/* Array by array, those that rank k is to hold. */
static void pack_for(const solver *s, uint32_t k, const carried *what, int arrays, char *to) {
  for (int a = 0; a < arrays; ++a)
    to += (uint64_t)take_array(s, &s->ranks.shares[k], what[a], to) * what[a].element;
}

/* What a rank gets begins where any number may: the arrays of larger ones come first. */
static uint64_t aligned_for_any(uint64_t bytes) { return (bytes + 7) / 8 * 8; }

static uint64_t bytes_a_particle(const carried *what, int arrays) {
  uint64_t bytes = 0;
  for (int a = 0; a < arrays; ++a) bytes += what[a].element;
  return bytes;
}

/* counts[r * ranks + k]: particles of rank r that rank k is to hold. */
static bool gather_counts(solver *s, uint32_t *counts) {
  uint32_t *mine = s->ranks.counts + s->ranks.count * s->ranks.count;
  count_for_ranks(s, mine);
  return gather_on_ranks(s, mine, counts, s->ranks.count * sizeof *mine);
}

/* Places of an owner's particles in a run that another holds; none: {0, 0}. */
static range shared_places(const rank_share *owner, const rank_run &run) {
  const uint32_t first = larger(owner->own_first, run.first);
  const uint32_t last = smaller(owner->own_last, run.last);
  return first < last ? range{first, last} : range{0, 0};
}

/* Of what others hold of this rank's own: exchange_marks. */
static uint64_t bytes_of_marks(const solver *s) {
  const ranks_state *r = &s->ranks;
  uint64_t places = 0;
  for (uint32_t k = 0; k < r->count; ++k)
    for (const rank_run &run : r->shares[k].held) {
      const range both = shared_places(&r->shares[r->rank], run);
      places += k == r->rank ? 0 : both.last - both.first;
    }
  return places * sizeof(uint32_t);
}

/* Memory for what this rank sends, and for the ends of the cells that it is to hold. */
static bool take_room_to_hold(solver *s, const uint32_t *counts, uint64_t each) {
  const ranks_state *r = &s->ranks;
  const rank_share *share = &r->shares[r->rank];
  uint64_t sent = 0;
  for (uint32_t k = 0; k < r->count; ++k)
    if (k != r->rank) sent += aligned_for_any(counts[r->rank * r->count + k] * each);
  const uint64_t marks = s->schedule.runs[PBF_STAGE_SLEEP] ? bytes_of_marks(s) : 0;
  const bool ok =
      keep_bytes(s, "sent to ranks", &s->ranks.sent, sent > marks ? sent : marks) &&
      keep_bytes(s, "cell end", &s->ranks.cell_ends,
                 ((uint64_t)share->cell_last - share->cell_first + 1) * sizeof(uint32_t));
  if (on_all_ranks(s, ok)) return true;
  refuse_on_ranks(s, PBF_ERROR_OUT_OF_MEMORY,
                  "a rank has no memory for the particles near its own; more ranks would do");
  return false;
}

/* What this rank is to hold comes array by array: its own particles, in their place, … */
static uint32_t keep_held(const solver *s, const carried *what, int arrays) {
  uint32_t kept = 0;
  for (int a = 0; a < arrays; ++a)
    kept = take_array(s, &s->ranks.shares[s->ranks.rank], what[a], what[a].to);
  return kept;
}

/* … and then those that other ranks had, in the order of the ranks. */
static void receive_from(solver *s, uint32_t r, uint32_t count, uint32_t at, const carried *what,
                         int arrays) {
  for (int a = 0; a < arrays; ++a) {
    const uint64_t size = what[a].element;
    add_message(&s->ranks.receives, r, static_cast<char *>(what[a].to) + at * size, count * size);
  }
}

static bool send_and_receive(solver *s, const uint32_t *counts, const carried *what, int arrays) {
  ranks_state *r = &s->ranks;
  char *packed = static_cast<char *>(r->sent.data);
  r->sends.count = r->receives.count = 0;
  for (uint32_t k = 0; k < r->count; ++k) {
    const uint64_t count = counts[r->rank * r->count + k];
    const char *array = packed;
    if (k == r->rank) continue;
    pack_for(s, k, what, arrays, packed);
    packed += aligned_for_any(count * bytes_a_particle(what, arrays));
    for (int a = 0; a < arrays; ++a) {
      add_message(&r->sends, k, array, count * what[a].element);
      array += count * what[a].element;
    }
  }
  uint32_t at = keep_held(s, what, arrays);
  for (uint32_t k = 0; k < r->count; ++k) {
    if (k == r->rank) continue;
    const uint32_t count = counts[k * r->count + r->rank];
    receive_from(s, k, count, at, what, arrays);
    at += count;
  }
  return exchange_on_ranks(s);
}

/* Of this rank's groups those of which no other holds a particle. */
static range inner_groups(const solver *s) {
  const rank_share *mine = &s->ranks.shares[s->ranks.rank];
  const range own = own_groups(s);
  const uint32_t width = s->kernels->width, begin = mine->own_first, end = mine->own_last;
  uint32_t lower = begin, upper = end;
  for (uint32_t k = 0; k < s->ranks.count; ++k)
    for (const rank_run &run : s->ranks.shares[k].held) {
      if (k == s->ranks.rank || run.first >= end || run.last <= begin) continue;
      if (run.first <= begin)
        lower = larger(lower, smaller(run.last, end));
      else
        upper = smaller(upper, run.first);
    }
  const uint32_t first = smaller(own.first + (lower - begin + width - 1) / width, own.last);
  return (range){first, larger(first, own.first + (upper - begin) / width)};
}

/* From the cells of its particles on, each rank comes to hold its share and its neighbours, still
 * unsorted: s->count of them. */
static bool hold_share(solver *s, const carried *what, int arrays) {
  ranks_state *r = &s->ranks;
  count_bins(s);
  if (!sum_on_ranks(s, r->histogram, RANK_BINS)) return false;
  sum_up(r->histogram);
  find_shares(s);
  uint32_t *counts = r->counts;
  if (!shares_fit(s) || !gather_counts(s, counts) ||
      !take_room_to_hold(s, counts, bytes_a_particle(what, arrays)) ||
      !send_and_receive(s, counts, what, arrays))
    return false;
  const rank_share *share = &r->shares[r->rank];
  r->pad = pad_of(s, share);
  r->own_first = local_place(s, share->own_first);
  r->own_last = local_place(s, share->own_last);
  r->inner = inner_groups(s);
  uint32_t *ends = static_cast<uint32_t *>(r->cell_ends.data);
  ends[0] = r->pad;
  s->cell_end = ends + 1 - static_cast<ptrdiff_t>(share->cell_first);
  s->count = held_by(share);
  return true;
}

/* ---- What stages change -------------------------------------------------------------------- */

/* Of an array of reals in sorted order, to or from rank k what one owns and the other holds. */
static void add_runs(solver *s, rank_messages *messages, uint32_t k, const rank_share *owner,
                     const rank_share *holder, pbf_real *values) {
  for (const rank_run &run : holder->held) {
    const range both = shared_places(owner, run);
    add_message(messages, k, values + local_place(s, both.first),
                (both.last - both.first) * sizeof *values);
  }
}

/* Adds messages for such an array: each rank's own to those that hold them. */
static void add_array(solver *s, pbf_real *values) {
  ranks_state *r = &s->ranks;
  const rank_share *mine = &r->shares[r->rank];
  for (uint32_t k = 0; k < r->count; ++k) {
    if (k == r->rank) continue;
    add_runs(s, &r->sends, k, mine, &r->shares[k], values);
    add_runs(s, &r->receives, k, &r->shares[k], mine, values);
  }
}

/* What this rank has noted at the places of others' particles, those that have these hear of: what
 * is noted of its own by any rank is so. The memory has been taken with what is held. */
static void exchange_marks(solver *s, uint32_t *marks) {
  ranks_state *r = &s->ranks;
  const rank_share *mine = &r->shares[r->rank];
  uint32_t *heard = static_cast<uint32_t *>(r->sent.data), *next = heard;
  r->sends.count = r->receives.count = 0;
  for (uint32_t k = 0; k < r->count; ++k) {
    if (k == r->rank) continue;
    for (const rank_run &run : mine->held) {
      const range both = shared_places(&r->shares[k], run);
      add_message(&r->sends, k, marks + local_place(s, both.first),
                  (both.last - both.first) * sizeof *marks);
    }
    for (const rank_run &run : r->shares[k].held) {
      const range both = shared_places(mine, run);
      add_message(&r->receives, k, next, (both.last - both.first) * sizeof *next);
      next += both.last - both.first;
    }
  }
  if (!exchange_on_ranks(s)) return;
  next = heard;
  for (uint32_t k = 0; k < r->count; ++k)
    for (const rank_run &run : r->shares[k].held) {
      const range both = k == r->rank ? range{0, 0} : shared_places(mine, run);
      for (uint32_t i = both.first; i < both.last; ++i, ++next)
        if (*next == AWAKENED) marks[local_place(s, i)] = AWAKENED;
    }
}

static void add_field(solver *s, const field *f) {
  for (int k = 0; k < PBF_DIM; ++k) add_array(s, f->c[k]);
}

#endif
