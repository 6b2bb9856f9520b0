/* Part of diagnostics.h: calls of a solver that is one of some ranks: joining, refusals, what comes
 * in, which all are given whole, and what goes out, which all get whole. */
#ifndef PBF_CPU_CALLS_ON_RANKS_H
#define PBF_CPU_CALLS_ON_RANKS_H

#include "common/rank_shares.h"
#include "common/id_rows.h"
#include "cpu/arrays.h"
#include "cpu/halo.h"

/* ---- Life ---------------------------------------------------------------------------------- */

/* Bytes that a rank may tell all others at once. */
static uint64_t largest_gathered(void) {
  const uint64_t sizes[] = {sizeof(rank_call), sizeof(rank_summary), sizeof(pbf_params),
                            sizeof(pbf_stats), DEPTHS_AT_ONCE * sizeof(uint64_t)};
  uint64_t largest = 0;
  for (uint64_t size : sizes) largest = size > largest ? size : largest;
  return largest;
}

/* One array holds what there is of each rank. 0 when there is no memory. */
static int take_rank_tables(solver *s) {
  ranks_state *r = &s->ranks;
  const uint64_t n = r->count, messages = n * (MAX_CARRIED + HELD_RUNS * PBF_DEVIATOR_DIM);
  const uint64_t sizes[] = {n * largest_gathered(),
                            messages * sizeof(pbf_rank_message),
                            messages * sizeof(pbf_rank_message),
                            n * sizeof(double),
                            n * sizeof(rank_share),
                            (RANK_BINS + 1) * sizeof(uint32_t),
                            (n + 1) * n * sizeof(uint32_t)};
  char *at[sizeof sizes / sizeof sizes[0]];
  uint64_t bytes = 0;
  for (uint64_t size : sizes) bytes += (size + PBF_ALIGNMENT - 1) / PBF_ALIGNMENT * PBF_ALIGNMENT;
  char *next = static_cast<char *>(pbf_memory_take(&s->memory, "of ranks", bytes, 1));
  r->ids = take_indices(s, "held id", padded(s->local_capacity));
  if (!next || !r->ids) return 0;
  for (uint64_t k = 0; k < sizeof sizes / sizeof sizes[0]; ++k) {
    at[k] = next;
    next += (sizes[k] + PBF_ALIGNMENT - 1) / PBF_ALIGNMENT * PBF_ALIGNMENT;
  }
  r->gathered = at[0];
  r->sends.list = reinterpret_cast<pbf_rank_message *>(at[1]);
  r->receives.list = reinterpret_cast<pbf_rank_message *>(at[2]);
  r->portions = reinterpret_cast<double *>(at[3]);
  r->shares = reinterpret_cast<rank_share *>(at[4]);
  r->histogram = reinterpret_cast<uint32_t *>(at[5]);
  r->counts = reinterpret_cast<uint32_t *>(at[6]);
  return 1;
}

/* Once the tables have been cleared. */
static void begin_portions(solver *s) {
  ranks_state *r = &s->ranks;
  for (uint32_t k = 0; k < r->count; ++k)
    r->portions[k] = r->shares_are_fixed ? r->link.shares[k] : 1 / (double)r->count;
  r->link.shares = NULL;
}

static void describe_ranks(solver *s, const pbf_ranks *ranks) {
  if (!ranks) return;
  s->ranks.link = *ranks;
  s->ranks.count = ranks->count;
  s->ranks.rank = ranks->rank;
  s->ranks.particles = DIGEST_OF_NOTHING;
  s->ranks.shares_are_fixed = ranks->shares != NULL;
  if (ranks->local_capacity) s->local_capacity = ranks->local_capacity;
}

static bool agree_on_step(solver *s, const pbf_step_times *times, uint32_t steps) {
  const double arguments[4] = {times->time, (double)times->before, times->time_step, (double)steps};
  return agree_on_call(s, "pbf_step", arguments, sizeof arguments);
}

/* ---- In ------------------------------------------------------------------------------------ */

static uint64_t row_bytes_of(uint32_t which) {
  if (which == PBF_FIELD_POSITION || which == PBF_FIELD_VELOCITY ||
      which == PBF_BACKEND_FIELD_ACCELERATION)
    return PBF_DIM * sizeof(pbf_real);
  if (which == PBF_BACKEND_FIELD_REST) return 2 * sizeof(pbf_real);
  return which == PBF_BACKEND_FIELD_PHASE ? sizeof(uint8_t) : sizeof(pbf_real);
}

static void note_written(solver *s, uint32_t which, const pbf_rows *rows, const void *in) {
  const uint32_t what[3] = {which, rows->first, rows->count};
  s->ranks.particles = digest(s->ranks.particles, what, sizeof what);
  s->ranks.particles = digest(s->ranks.particles, in, rows->count * row_bytes_of(which));
}

static void note_removed(solver *s, uint32_t count, const uint32_t *ids) {
  s->ranks.particles = digest(s->ranks.particles, ids, (uint64_t)count * sizeof *ids);
  s->ranks.total -= count;
}

/* ---- Out ----------------------------------------------------------------------------------- */

/* Rows that this rank knows: their numbers, and then what they hold. Returns how many. */
static uint32_t pack_rows(const pbf_rows *rows, const uint32_t *ids, uint32_t count,
                          const char *out, uint64_t row_bytes, char *to) {
  uint32_t known = 0;
  pbf_id_rows all;
  pbf_id_rows_begin(&all, rows->ids, rows->total);
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t row = pbf_id_row(&all, ids[i]) - rows->first;
    if (row >= rows->count) continue;
    if (to) {
      memcpy(to, &row, sizeof row);
      memcpy(to + sizeof row, out + row * row_bytes, row_bytes);
      to += sizeof row + row_bytes;
    }
    ++known;
  }
  return known;
}

static void unpack_rows(const char *from, uint32_t count, char *out, uint64_t row_bytes) {
  for (uint32_t k = 0; k < count; ++k, from += sizeof(uint32_t) + row_bytes) {
    uint32_t row;
    memcpy(&row, from, sizeof row);
    memcpy(out + row * row_bytes, from + sizeof row, row_bytes);
  }
}

/* All ranks get the rows that each has put into `out`: those of particles ids[0 … count - 1]. */
static void share_rows(solver *s, const pbf_rows *rows, const uint32_t *ids, uint32_t count,
                       void *out, uint64_t row_bytes) {
  ranks_state *r = &s->ranks;
  const uint64_t each = sizeof(uint32_t) + row_bytes;
  char *to = static_cast<char *>(out);
  const uint32_t known = r->failed ? 0 : pack_rows(rows, ids, count, to, row_bytes, NULL);
  uint32_t *counts = r->counts, most = 0;
  if (!gather_on_ranks(s, &known, counts, sizeof known)) return;
  for (uint32_t k = 0; k < r->count; ++k) most = larger(most, counts[k]);
  if (!on_all_ranks(s, keep_bytes(s, "sent to ranks", &r->sent, most * each)))
    refuse_on_ranks(s, PBF_ERROR_OUT_OF_MEMORY, "a rank has no memory for the others' rows");
  char *buffer = static_cast<char *>(r->sent.data);
  for (uint32_t k = 0; k < r->count && !r->failed; ++k) {
    r->sends.count = r->receives.count = 0;
    if (k == r->rank) pack_rows(rows, ids, count, to, row_bytes, buffer);
    for (uint32_t other = 0; other < r->count; ++other)
      if (k == r->rank && other != k) add_message(&r->sends, other, buffer, counts[k] * each);
    if (k != r->rank) add_message(&r->receives, k, buffer, counts[k] * each);
    if (exchange_on_ranks(s) && k != r->rank) unpack_rows(buffer, counts[k], to, row_bytes);
  }
}

/* A number that goes from rank to rank, and from the last one to all, as `add` makes it more: in
 * the order of all particles, which no number of ranks changes. */
template <class Add>
static void pass_along(solver *s, pbf_stats *sums, const Add &add) {
  ranks_state *r = &s->ranks;
  for (uint32_t k = 0; k < r->count; ++k) {
    r->sends.count = r->receives.count = 0;
    if (k == r->rank) add();
    if (k + 1 == r->count) break;
    if (k == r->rank) add_message(&r->sends, k + 1, sums, sizeof *sums);
    if (k + 1 == r->rank) add_message(&r->receives, k, sums, sizeof *sums);
    exchange_on_ranks(s);
  }
  pbf_stats *all = static_cast<pbf_stats *>(r->gathered);
  if (gather_on_ranks(s, sums, all, sizeof *sums)) *sums = all[r->count - 1];
}

#endif
