/* Part of rank_link.h: ranks that do not reach each other's memory, as devices of two hosts. Each
 * device writes into a mirror of the other's room, in its host's memory, and between the two
 * launches of a kernel by which ranks meet (hold.h) hosts exchange what has changed there by the
 * functions of pbf/ranks.h. So kernels are the same for ranks that are staged and those that are
 * not. */
#ifndef PBF_CUDA_STAGING_H
#define PBF_CUDA_STAGING_H

#include "cuda/launch.h"
#include "cuda/rank_kernels.h"
#include "cuda/rank_questions.h"

/* ---- Memory -------------------------------------------------------------------------------- */

static inline void free_staged(char **memory) {
  if (*memory && cudaFreeHost(*memory) != cudaSuccess) cudaGetLastError();
  *memory = nullptr;
}

static inline void free_staging(rank_staging *g) {
  free_staged(&g->memory);
  free_staged(&g->outbox);
  free_staged(&g->inbox);
  g->outbox_bytes = g->inbox_bytes = 0;
}

/* Of the host, where the device sees it, at *seen. */
static inline bool take_staged(uint64_t bytes, char **memory, char **seen) {
  void *at = nullptr, *there = nullptr;
  free_staged(memory);
  if (cudaHostAlloc(&at, bytes, cudaHostAllocMapped) != cudaSuccess) {
    cudaGetLastError();
    return false;
  }
  *memory = static_cast<char *>(at);
  if (cudaHostGetDevicePointer(&there, at, 0) != cudaSuccess) {
    cudaGetLastError();
    return false;
  }
  *seen = static_cast<char *>(there);
  return true;
}

/* A mirror of the room of each rank that is staged, where `rooms` says it is, and one of its own,
 * for messages. */
static inline bool take_mirrors(solver *s, uint64_t staged, uint64_t room_bytes, char **rooms) {
  rank_staging *g = &s->ranks.staging;
  uint64_t count = 1;
  char *seen = nullptr;
  free_staged(&g->memory);
  for (uint32_t k = 0; k < s->ranks.count; ++k) {
    g->with[k] = staged >> k & 1;
    count += g->with[k];
  }
  if (!staged) return true;
  room_bytes = (room_bytes + 255) / 256 * 256;
  if (!take_staged(count * room_bytes, &g->memory, &seen)) return false;
  memset(g->memory, 0, count * room_bytes); /* notes are empty */
  g->mirrors[s->ranks.rank] = g->memory;
  for (uint32_t k = 0, at = 1; k < s->ranks.count; ++k) {
    if (!g->with[k]) continue;
    g->mirrors[k] = g->memory + at * room_bytes;
    rooms[k] = seen + at * room_bytes;
    ++at;
  }
  return true;
}

/* ---- Ranges of rooms ----------------------------------------------------------------------- */

struct rank_range {
  uint64_t at, bytes;
};

enum { RANK_RANGES = 2, RANK_MESSAGES = RANKS_OF_CUDA * RANK_INBOX_FIELDS };

struct rank_messages {
  uint32_t count;
  pbf_rank_message list[RANK_MESSAGES];

  void add(uint32_t rank, char *data, uint64_t bytes) {
    if (bytes) list[count++] = {rank, 0, bytes, data};
  }
};

static inline bool exchange_messages(solver *s, const rank_messages &sends,
                                     const rank_messages &receives) {
  const pbf_ranks &link = s->ranks.link;
  if (s->ranks.failed) return false;
  return note_communication(
      s, link.exchange(link.user, sends.count, sends.list, receives.count, receives.list));
}

static inline bool copy_staged(solver *s, void *to, const void *from, uint64_t bytes,
                               cudaMemcpyKind kind) {
  if (!bytes || pbf_cuda_check(cudaMemcpyAsync(to, from, bytes, kind, s->stream),
                               "cudaMemcpyAsync") == PBF_OK)
    return true;
  lose_ranks(s, PBF_ERROR_DEVICE, "a copy between a rank's device and its host has failed");
  return false;
}

/* What each has written for another comes to its room. ranges(from, to, list) fills in how much of
 * the room of rank `to` rank `from` has written, in up to RANK_RANGES ranges, others being empty.
 */
template <class Ranges>
static inline void carry_given(solver *s, Ranges ranges) {
  const rank_state *r = &s->ranks;
  const rank_staging &g = r->staging;
  rank_messages sends = {}, receives = {};
  for (uint32_t k = 0; k < r->count; ++k) {
    rank_range out[RANK_RANGES] = {}, in[RANK_RANGES] = {};
    if (!g.with[k]) continue;
    ranges(r->rank, k, out);
    ranges(k, r->rank, in);
    for (const rank_range &range : out) sends.add(k, g.mirrors[k] + range.at, range.bytes);
    for (const rank_range &range : in) receives.add(k, g.mirrors[r->rank] + range.at, range.bytes);
  }
  if (!exchange_messages(s, sends, receives)) return;
  for (uint32_t k = 0; k < receives.count; ++k) {
    const char *data = static_cast<const char *>(receives.list[k].data);
    if (!copy_staged(s, r->room + (data - g.mirrors[r->rank]), data, receives.list[k].bytes,
                     cudaMemcpyHostToDevice))
      return;
  }
}

/* The same ranges of all ranks' rooms, which each shows the others: they come to the mirrors. */
static inline void carry_shown(solver *s, const rank_range (&ranges)[RANK_RANGES]) {
  const rank_state *r = &s->ranks;
  const rank_staging &g = r->staging;
  rank_messages sends = {}, receives = {};
  for (const rank_range &range : ranges)
    if (g.memory && !copy_staged(s, g.mirrors[r->rank] + range.at, r->room + range.at, range.bytes,
                                 cudaMemcpyDeviceToHost))
      return;
  if (pbf_cuda_check(cudaStreamSynchronize(s->stream), "cudaStreamSynchronize") != PBF_OK) {
    lose_ranks(s, PBF_ERROR_DEVICE, "the device of a rank has failed");
    return;
  }
  for (uint32_t k = 0; k < r->count; ++k)
    for (const rank_range &range : ranges) {
      if (!g.with[k]) continue;
      sends.add(k, g.mirrors[r->rank] + range.at, range.bytes);
      receives.add(k, g.mirrors[k] + range.at, range.bytes);
    }
  exchange_messages(s, sends, receives);
}

static __global__ void add_notes_kernel(uint8_t *to, const uint8_t *from, uint32_t count) {
  const uint32_t i = thread_index();
  if (i < count && from[i]) to[i] = 1;
}

/* Notes (rank_notes) at `notes` of the rooms: several ranks may note the same particle, so what
 * comes is added to what there is. It comes to the sender's mirror, at `free`, which no other
 * meeting uses now. */
static inline void carry_notes(solver *s, uint64_t notes, uint64_t free) {
  const rank_state *r = &s->ranks;
  const rank_staging &g = r->staging;
  const rank_share &mine = r->shares[r->rank];
  rank_messages sends = {}, receives = {};
  for (uint32_t k = 0; k < r->count; ++k) {
    const rank_share &its = r->shares[k];
    const rank_run out = common_run(its, mine), in = common_run(mine, its);
    if (!g.with[k]) continue;
    if (out.first < out.last)
      sends.add(k, g.mirrors[k] + notes + (out.first - its.own_first), out.last - out.first);
    if (in.first < in.last) receives.add(k, g.mirrors[k] + free, in.last - in.first);
  }
  if (!exchange_messages(s, sends, receives)) return;
  for (uint32_t k = 0; k < sends.count; ++k) memset(sends.list[k].data, 0, sends.list[k].bytes);
  for (uint32_t k = 0; k < receives.count; ++k) {
    const uint32_t count = (uint32_t)receives.list[k].bytes;
    const uint32_t place = common_run(mine, r->shares[receives.list[k].rank]).first;
    void *from = nullptr;
    if (pbf_cuda_check(cudaHostGetDevicePointer(&from, receives.list[k].data, 0),
                       "cudaHostGetDevicePointer") != PBF_OK) {
      lose_ranks(s, PBF_ERROR_DEVICE, "the device of a rank does not see its host's memory");
      return;
    }
    add_notes_kernel<<<blocks_for(count), PBF_BLOCK, 0, s->stream>>>(
        reinterpret_cast<uint8_t *>(r->room + notes) + (place - mine.own_first),
        static_cast<const uint8_t *>(from), count);
  }
}

/* ---- Particles ----------------------------------------------------------------------------- */

/* How many a plan has staged ranks get, or give. */
static inline uint32_t staged_count(const rank_state *r, const uint32_t *counts) {
  uint32_t all = 0;
  for (uint32_t k = 0; k < r->count; ++k) all += r->staging.with[k] ? counts[k] : 0;
  return all;
}

/* With a half more, so that it seldom grows. */
static inline bool keep_staged(uint64_t bytes, char **memory, uint64_t *has) {
  char *seen = nullptr;
  if (bytes <= *has) return true;
  *has = bytes + bytes / 2;
  if (take_staged(*has, memory, &seen)) return true;
  *has = 0;
  free_staged(memory);
  return false;
}

/* Room for the particles of the plan that has been read. On all ranks or on none. */
static inline bool take_outbox(solver *s, const rank_inbox_has &has, rank_outbox *outbox) {
  rank_state *r = &s->ranks;
  rank_staging *g = &r->staging;
  void *seen = nullptr;
  outbox->capacity = staged_count(r, r->report->plan.sent);
  const uint32_t got = staged_count(r, r->report->plan.got);
  bool fine = keep_staged(rank_inbox_bytes(outbox->capacity, has), &g->outbox, &g->outbox_bytes) &&
              keep_staged(rank_inbox_bytes(got, has), &g->inbox, &g->inbox_bytes);
  if (fine && g->outbox) fine = cudaHostGetDevicePointer(&seen, g->outbox, 0) == cudaSuccess;
  outbox->at = static_cast<char *>(seen);
  if (on_all_ranks(s, fine)) return true;
  refuse_on_ranks(s, PBF_ERROR_OUT_OF_MEMORY,
                  "the host of a rank has no memory for the particles that it sends to others");
  return false;
}

/* Particles that have been put into the outbox come to where their receivers get particles. */
static inline void carry_particles(solver *s, const rank_inbox_has &has,
                                   const rank_outbox &outbox) {
  const rank_state *r = &s->ranks;
  const rank_staging &g = r->staging;
  const rank_plan &plan = r->report->plan;
  const uint32_t got = staged_count(r, plan.got);
  rank_inbox_field out[RANK_INBOX_FIELDS] = {}, in[RANK_INBOX_FIELDS] = {}, to[RANK_INBOX_FIELDS];
  rank_messages sends = {}, receives = {};
  const uint32_t fields =
      rank_inbox_fields(rank_inbox_in(static_cast<char *>(s->list_storage), s->capacity, has), to);
  rank_inbox_fields(rank_inbox_in(g.outbox, outbox.capacity, has), out);
  rank_inbox_fields(rank_inbox_in(g.inbox, got, has), in);
  uint64_t sent_before = 0, got_before = 0, place = 0;
  for (uint32_t k = 0; k < r->count; ++k) {
    if (!g.with[k]) continue;
    for (uint32_t f = 0; f < fields; ++f) {
      sends.add(k, out[f].at + sent_before * out[f].bytes, plan.sent[k] * out[f].bytes);
      receives.add(k, in[f].at + got_before * in[f].bytes, plan.got[k] * in[f].bytes);
    }
    sent_before += plan.sent[k];
    got_before += plan.got[k];
  }
  if (!exchange_messages(s, sends, receives)) return;
  got_before = 0;
  for (uint32_t k = 0; k < r->count; ++k) {
    if (k == r->rank) continue;
    for (uint32_t f = 0; f < fields && g.with[k]; ++f)
      if (!copy_staged(s, to[f].at + place * to[f].bytes, in[f].at + got_before * in[f].bytes,
                       plan.got[k] * to[f].bytes, cudaMemcpyHostToDevice))
        return;
    got_before += g.with[k] ? plan.got[k] : 0;
    place += plan.got[k];
  }
}

#endif
