/* What a solver that is one of some ranks (pbf/ranks.h) knows of the others, and how it asks them.
 * A failure is kept: nothing after it communicates, and the call fails when it ends. */
#ifndef PBF_CPU_RANKS_H
#define PBF_CPU_RANKS_H

#include <stdio.h>
#include <string.h>

#include <pbf/ranks.h>

#include "common/fp_environment.h"
#include "common/number.h"
#include "common/rank_call.h"
#include "common/system.h"
#include "cpu/worker.h"

static inline bool has_ranks(const solver *s) {
  return (PBF_BUILT & PBF_FEATURE_RANKS) && s->ranks.count > 0;
}

/* Particles of the scene. */
static inline uint32_t particles_of_all(const solver *s) {
  return has_ranks(s) ? s->ranks.total : s->count;
}

/* ---- Time ---------------------------------------------------------------------------------- */

/* By what a processor has worked for the calling thread: what others do on the same one is no work
 * of this rank's. */
static inline void note_work(solver *s) {
  const double now = pbf_thread_seconds();
  s->ranks.busy += now - s->ranks.since;
  s->ranks.since = now;
}

/* ---- Failures ------------------------------------------------------------------------------ */

/* Of this call: nothing has changed. */
static inline void refuse_on_ranks(solver *s, pbf_status status, const char *sentence) {
  if (s->ranks.failed) return;
  s->ranks.failed = status;
  snprintf(s->ranks.reason, sizeof s->ranks.reason, "%s", sentence);
}

/* Of the others: what they hold is out of reach, for good. */
static inline void note_communication(solver *s, pbf_status status) {
  (void)pbf_fp_begin();
  s->ranks.since = pbf_thread_seconds();
  if (status == PBF_OK) return;
  refuse_on_ranks(s, status, s->ranks.link.reason(s->ranks.link.user));
  s->ranks.lost = true;
}

/* Begins a call that needs all. */
static inline bool begin_on_ranks(solver *s) {
  s->ranks.since = pbf_thread_seconds();
  if (!s->ranks.lost) s->ranks.failed = PBF_OK;
  return !s->ranks.lost;
}

/* What the call returns. */
static inline pbf_status end_on_ranks(solver *s) {
  if (!s->ranks.failed) return PBF_OK;
  char text[sizeof s->ranks.reason + 96];
  snprintf(text, sizeof text, "%s%s", s->ranks.reason,
           s->ranks.told ? "; nothing but pbf_destroy is possible since" : "");
  s->host->set_error(text);
  const pbf_status status = s->ranks.told ? PBF_ERROR_STATE : s->ranks.failed;
  s->ranks.told = s->ranks.lost;
  return status;
}

/* ---- Questions ----------------------------------------------------------------------------- */

static inline bool gather_on_ranks(solver *s, const void *mine, void *all, uint64_t bytes) {
  if (s->ranks.failed) return false;
  note_work(s);
  note_communication(s, s->ranks.link.all_gather(s->ranks.link.user, mine, all, bytes));
  return !s->ranks.failed;
}

static inline bool sum_on_ranks(solver *s, uint32_t *values, uint64_t count) {
  if (s->ranks.failed) return false;
  note_work(s);
  note_communication(s, s->ranks.link.sum(s->ranks.link.user, values, count));
  return !s->ranks.failed;
}

/* Messages are added up before. */
static inline void add_message(rank_messages *m, uint32_t rank, const void *data, uint64_t bytes) {
  if (bytes) m->list[m->count++] = {rank, 0, bytes, const_cast<void *>(data)};
}

static inline bool exchange_on_ranks(solver *s) {
  ranks_state *r = &s->ranks;
  if (r->failed) return false;
  note_work(s);
  for (uint32_t k = 0; k < r->sends.count; ++k) r->bytes_sent += r->sends.list[k].bytes;
  note_communication(s, r->link.exchange(r->link.user, r->sends.count, r->sends.list,
                                         r->receives.count, r->receives.list));
  return !r->failed;
}

/* The same in two calls, between which the rank works. */
static inline bool begin_exchange_on_ranks(solver *s) {
  ranks_state *r = &s->ranks;
  if (r->failed) return false;
  note_work(s);
  for (uint32_t k = 0; k < r->sends.count; ++k) r->bytes_sent += r->sends.list[k].bytes;
  note_communication(s, r->link.begin_exchange(r->link.user, r->sends.count, r->sends.list,
                                               r->receives.count, r->receives.list));
  return !r->failed;
}

static inline bool end_exchange_on_ranks(solver *s) {
  if (s->ranks.failed) return false;
  note_work(s);
  note_communication(s, s->ranks.link.end_exchange(s->ranks.link.user));
  return !s->ranks.failed;
}

/* Whether it is so on all; false when that is not to be learnt. */
static inline bool on_all_ranks(solver *s, bool yes) {
  const uint32_t mine = yes;
  uint32_t *all = static_cast<uint32_t *>(s->ranks.gathered);
  if (!gather_on_ranks(s, &mine, all, sizeof mine)) return false;
  for (uint32_t k = 0; k < s->ranks.count; ++k) yes = yes && all[k];
  return yes;
}

static inline int64_t sum_of_ranks(solver *s, int64_t value) {
  int64_t *all = static_cast<int64_t *>(s->ranks.gathered), sum = 0;
  if (!gather_on_ranks(s, &value, all, sizeof value)) return value;
  for (uint32_t k = 0; k < s->ranks.count; ++k) sum += all[k];
  return sum;
}

/* Of what solids meet, that ranks tell each other: loads.h. */
enum { DEPTHS_AT_ONCE = 64 };

/* Numbers of 64 bits come as three pieces each: of the lower two, those of all ranks have a sum of
 * 32 bits; what the upper one carries over is beyond the number. */
enum { PIECES = 3, PIECE_BITS = 20 };
static_assert(((UINT64_C(1) << PIECE_BITS) - 1) * PBF_MAX_RANKS <= UINT32_MAX, "pieces");

static inline void cut_number(int64_t number, uint32_t pieces[PIECES]) {
  const uint64_t bits = (uint64_t)number;
  for (int k = 0; k < PIECES; ++k)
    pieces[k] = (uint32_t)(bits >> PIECE_BITS * k) &
                (k + 1 < PIECES ? (UINT32_C(1) << PIECE_BITS) - 1 : UINT32_MAX);
}

static inline int64_t number_of_pieces(const uint32_t pieces[PIECES]) {
  uint64_t bits = 0;
  for (int k = 0; k < PIECES; ++k) bits += (uint64_t)pieces[k] << PIECE_BITS * k;
  return (int64_t)bits;
}

/* numbers[k] = its sum over all ranks, exactly, by way of `room` words. */
static inline bool sum_numbers_on_ranks(solver *s, int64_t *numbers, uint64_t count,
                                        uint32_t *words, uint64_t room) {
  for (uint64_t some; count > 0; count -= some, numbers += some) {
    some = count < room / PIECES ? count : room / PIECES;
    for (uint64_t k = 0; k < some; ++k) cut_number(numbers[k], words + PIECES * k);
    if (!sum_on_ranks(s, words, PIECES * some)) return false;
    for (uint64_t k = 0; k < some; ++k) numbers[k] = number_of_pieces(words + PIECES * k);
  }
  return true;
}

static inline double max_of_ranks(solver *s, double value) {
  double *all = static_cast<double *>(s->ranks.gathered), largest = value;
  if (!gather_on_ranks(s, &value, all, sizeof value)) return value;
  for (uint32_t k = 0; k < s->ranks.count; ++k) largest = all[k] > largest ? all[k] : largest;
  return largest;
}

/* Memory that may lose its content. */
static inline bool keep_bytes(solver *s, const char *name, rank_memory *m, uint64_t bytes) {
  if (m->bytes >= bytes) return true;
  pbf_memory_free(&s->memory, m->data);
  bytes += bytes / 8;
  m->data = pbf_memory_take(&s->memory, name, bytes, 1);
  m->bytes = m->data ? bytes : 0;
  return m->data != NULL;
}

/* ---- Agreement ----------------------------------------------------------------------------- */

/* The first parameter in which these differ, with both values; the parameters in both otherwise. */
static inline void differing_param(const pbf_params &a, const pbf_params &b, char *text,
                                   size_t size) {
  char first[PBF_NUMBER_SIZE], second[PBF_NUMBER_SIZE];
#define PBF_PARAM_INTEGER(offset, name, ...)                             \
  if (a.name != b.name) {                                                \
    snprintf(text, size, "params." #name ": %u and %u", a.name, b.name); \
    return;                                                              \
  }
#define PBF_PARAM_REAL(offset, name, ...)                                               \
  if (memcmp(&a.name, &b.name, sizeof a.name) != 0) {                                   \
    snprintf(text, size, "params." #name ": %s and %s", pbf_number_text(first, a.name), \
             pbf_number_text(second, b.name));                                          \
    return;                                                                             \
  }
#define PBF_PARAM_REALS(offset, name, count, ...)                                      \
  for (int k = 0; k < count; ++k)                                                      \
    if (memcmp(&a.name[k], &b.name[k], sizeof a.name[k]) != 0) {                       \
      snprintf(text, size, "params." #name "[%d]: %s and %s", k,                       \
               pbf_number_text(first, a.name[k]), pbf_number_text(second, b.name[k])); \
      return;                                                                          \
    }
#include "physics/params.def"
  snprintf(text, size, "the parameters");
}

static inline uint64_t kind_digest(const solver *s) {
  const uint32_t kind[4] = {PBF_DIM, sizeof(pbf_real), (uint32_t)s->isa, s->kernels->width};
  uint64_t hash = digest(DIGEST_OF_NOTHING, kind, sizeof kind);
  return s->ranks.shares_are_fixed
             ? digest(hash, s->ranks.portions, s->ranks.count * sizeof(double))
             : hash;
}

static inline void say_what_differs(solver *s, uint32_t other, const char *part,
                                    const rank_call *all) {
  char text[192], sentence[256];
  snprintf(text, sizeof text, "%s", part);
  if (!strcmp(part, "the call"))
    snprintf(text, sizeof text, "the call: %s and %s", all[0].call, all[other].call);
  pbf_params *params = static_cast<pbf_params *>(s->ranks.gathered);
  if (!strcmp(part, "the parameters") && gather_on_ranks(s, &s->params, params, sizeof *params))
    differing_param(params[0], params[other], text, sizeof text);
  snprintf(sentence, sizeof sentence, "ranks 0 and %u differ in %s", other, text);
  refuse_on_ranks(s, PBF_ERROR_INVALID_ARGUMENT, sentence);
}

/* Begins a call that all ranks make alike; false where they do not, or one does not come. */
static inline bool agree_on_call(solver *s, const char *call, const void *arguments,
                                 uint64_t bytes) {
  rank_call *all = static_cast<rank_call *>(s->ranks.gathered);
  if (!begin_on_ranks(s)) return false;
  const uint32_t room[2] = {s->capacity, s->local_capacity};
  const rank_call mine =
      rank_call_of(s, call, arguments, bytes, room, kind_digest(s), s->table.list);
  if (!gather_on_ranks(s, &mine, all, sizeof mine)) return false;
  for (uint32_t k = 1; k < s->ranks.count; ++k)
    if (const char *part =
            differing_part(all[0], all[k], "dimension, precision, instruction set or shares")) {
      say_what_differs(s, k, part, all);
      return false;
    }
  return true;
}

#endif
