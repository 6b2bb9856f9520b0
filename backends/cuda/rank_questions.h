/* Part of staging.h: what ranks ask each other by the functions of pbf/ranks.h. A failure is
 * kept: nothing after it communicates, and the call fails when it ends. */
#ifndef PBF_CUDA_RANK_QUESTIONS_H
#define PBF_CUDA_RANK_QUESTIONS_H

#include <stdio.h>

#include "common/fp_environment.h"
#include "cuda/solver.h"

/* ---- Failures ------------------------------------------------------------------------------ */

/* Of this call: nothing has changed. */
static inline void refuse_on_ranks(solver *s, pbf_status status, const char *sentence) {
  if (s->ranks.failed) return;
  s->ranks.failed = status;
  snprintf(s->ranks.reason, sizeof s->ranks.reason, "%s", sentence);
}

/* Of the others, or of a device while others wait for it: there is no way on. */
static inline void lose_ranks(solver *s, pbf_status status, const char *sentence) {
  refuse_on_ranks(s, status, sentence);
  s->ranks.lost = true;
}

static inline bool begin_on_ranks(solver *s) {
  if (!s->ranks.lost) s->ranks.failed = PBF_OK;
  return !s->ranks.lost;
}

/* What the call returns. */
static inline pbf_status end_on_ranks(solver *s) {
  rank_state *r = &s->ranks;
  if (!r->failed) return PBF_OK;
  char text[sizeof r->reason + 96];
  snprintf(text, sizeof text, "%s%s", r->reason,
           r->told ? "; nothing but pbf_destroy is possible since" : "");
  s->host->set_error(text);
  const pbf_status status = r->told ? PBF_ERROR_STATE : r->failed;
  r->told = r->lost;
  return status;
}

/* ---- Questions ----------------------------------------------------------------------------- */

static inline bool note_communication(solver *s, pbf_status status) {
  (void)pbf_fp_begin();
  if (status != PBF_OK) lose_ranks(s, status, s->ranks.link.reason(s->ranks.link.user));
  return !s->ranks.failed;
}

static inline bool gather_on_ranks(solver *s, const void *mine, void *all, uint64_t bytes) {
  if (s->ranks.failed) return false;
  return note_communication(s, s->ranks.link.all_gather(s->ranks.link.user, mine, all, bytes));
}

/* Whether it is so on all; false when that is not to be learnt. */
static inline bool on_all_ranks(solver *s, bool yes) {
  const uint32_t mine = yes;
  uint32_t all[RANKS_OF_CUDA];
  if (!gather_on_ranks(s, &mine, all, sizeof mine)) return false;
  for (uint32_t k = 0; k < s->ranks.count; ++k) yes = yes && all[k];
  return yes;
}

#endif
