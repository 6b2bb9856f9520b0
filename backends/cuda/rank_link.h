/* Part of hold.h: how ranks agree on what they do, and how their devices come to see each other's
 * memory, or a mirror of it. */
#ifndef PBF_CUDA_RANK_LINK_H
#define PBF_CUDA_RANK_LINK_H

#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "common/digest.h"
#include "common/number.h"
#include "common/rank_call.h"
#include "cuda/arrays.h"
#include "cuda/staging.h"

/* ---- Agreement ----------------------------------------------------------------------------- */

/* A call, and whether this rank's memory has come to lie elsewhere. */
struct rank_call_and_memory : rank_call {
  uint64_t changed;
};

static inline rank_call_and_memory own_call(const solver *s, const char *call,
                                            const void *arguments, uint64_t bytes) {
  const uint32_t room[2] = {s->scene_capacity, s->capacity}, kind[2] = {PBF_DIM, sizeof(pbf_real)};
  uint64_t hash = digest(DIGEST_OF_NOTHING, kind, sizeof kind);
  hash = digest(hash, s->ranks.portions, s->ranks.count * sizeof(double));
  return {rank_call_of(s, call, arguments, bytes, room, hash, s->colliders), s->ranks.changed};
}

/* ---- Each other's memory ------------------------------------------------------------------- */

/* Where a rank's memory is. */
struct rank_address {
  uint64_t host, process;
  int32_t device; /* as this process counts them */
  uint32_t has_handles, host_staged;
  cudaUUID_t device_name;
  char *room, *inbox;
  cudaIpcMemHandle_t room_handle, inbox_handle;
};

/* Another process has another one. */
static inline uint64_t process_token() {
  static const char here = 0;
  char space[64] = "";
  if (readlink("/proc/self/ns/pid", space, sizeof space - 1) < 0) space[0] = 0;
  const uint64_t parts[2] = {(uint64_t)getpid(), reinterpret_cast<uint64_t>(&here)};
  return digest(digest(DIGEST_OF_NOTHING, parts, sizeof parts), space, sizeof space);
}

static inline uint64_t host_token() {
  char text[64] = "";
  if (FILE *file = fopen("/proc/sys/kernel/random/boot_id", "r")) {
    if (!fgets(text, sizeof text, file)) text[0] = 0;
    fclose(file);
  }
  return digest(DIGEST_OF_NOTHING, text, sizeof text);
}

/* Without handles it serves ranks of this process. */
static inline rank_address address_of(solver *s) {
  rank_address a = {};
  a.host = host_token();
  a.process = process_token();
  a.device = s->device;
  a.host_staged = s->ranks.link.host_staged;
  cudaDeviceProp properties;
  if (cudaGetDeviceProperties(&properties, s->device) == cudaSuccess)
    a.device_name = properties.uuid;
  a.room = s->ranks.room;
  a.inbox = static_cast<char *>(s->list_storage);
  a.has_handles = cudaIpcGetMemHandle(&a.room_handle, a.room) == cudaSuccess &&
                  cudaIpcGetMemHandle(&a.inbox_handle, a.inbox) == cudaSuccess;
  cudaGetLastError();
  return a;
}

static inline void close_handles(solver *s) {
  for (auto &kind : s->ranks.opened)
    for (char *&address : kind) {
      if (address && cudaIpcCloseMemHandle(address) != cudaSuccess) cudaGetLastError();
      address = nullptr;
    }
}

/* Of another process, by handles. */
static inline bool open_handles(solver *s, uint32_t r, const rank_address &other, char *seen[2]) {
  const cudaIpcMemHandle_t handles[2] = {other.room_handle, other.inbox_handle};
  for (int k = 0; k < 2 && other.has_handles; ++k) {
    void *at = nullptr;
    if (cudaIpcOpenMemHandle(&at, handles[k], cudaIpcMemLazyEnablePeerAccess) != cudaSuccess) {
      cudaGetLastError();
      return false;
    }
    seen[k] = s->ranks.opened[k][r] = static_cast<char *>(at);
  }
  return other.has_handles;
}

static inline bool enable_peer(int mine, int other) {
  int can = 0;
  if (cudaDeviceCanAccessPeer(&can, mine, other) != cudaSuccess || !can) return false;
  const cudaError_t error = cudaDeviceEnablePeerAccess(other, 0);
  cudaGetLastError();
  return error == cudaSuccess || error == cudaErrorPeerAccessAlreadyEnabled;
}

/* Whether this device reaches the other's memory. */
static inline bool see_memory(solver *s, uint32_t r, const rank_address &mine,
                              const rank_address &other, char *seen[2]) {
  if (other.host != mine.host || other.host_staged || mine.host_staged) return false;
  if (other.process != mine.process) return open_handles(s, r, other, seen);
  seen[0] = other.room;
  seen[1] = other.inbox;
  return other.device == mine.device || enable_peer(mine.device, other.device);
}

/* Whether another rank has the device of rank r, by the name that it has everywhere. */
static inline bool shares_device(const rank_address *all, uint32_t count, uint32_t r) {
  for (uint32_t k = 0; k < count; ++k)
    if (k != r && memcmp(&all[k].device_name, &all[r].device_name, sizeof all->device_name) == 0)
      return true;
  return false;
}

/* A bit for each rank that this one does not reach, or that does not reach it; and whether there
 * are such ranks anywhere. */
static inline bool agree_on_staged(solver *s, uint64_t reached, uint64_t *staged) {
  rank_state *r = &s->ranks;
  uint64_t all[RANKS_OF_CUDA];
  *staged = 0;
  r->staging.any = false;
  if (!gather_on_ranks(s, &reached, all, sizeof reached)) return false;
  for (uint32_t a = 0; a < r->count; ++a)
    for (uint32_t b = 0; b < r->count; ++b) {
      if (all[a] >> b & all[b] >> a & 1) continue;
      r->staging.any = true;
      if (a == r->rank) *staged |= UINT64_C(1) << b;
    }
  return true;
}

/* Has each see where the others' rooms are. All ranks call it. */
static inline bool connect_ranks(solver *s) {
  rank_state *r = &s->ranks;
  rank_address all[RANKS_OF_CUDA], mine = address_of(s);
  char *seen[2][RANKS_OF_CUDA] = {};
  uint64_t reached = 0, staged = 0;
  bool fine = cudaStreamSynchronize(s->stream) == cudaSuccess; /* what is new is empty by now */
  close_handles(s);
  if (!gather_on_ranks(s, &mine, all, sizeof mine)) return false;
  for (uint32_t k = 0; k < r->count; ++k) {
    char *its[2] = {mine.room, mine.inbox};
    if (k == r->rank || see_memory(s, k, mine, all[k], its)) reached |= UINT64_C(1) << k;
    r->one_by_one = r->one_by_one || shares_device(all, r->count, k);
    seen[0][k] = its[0];
    seen[1][k] = its[1];
  }
  if (!agree_on_staged(s, reached, &staged)) return false;
  fine = fine && take_mirrors(s, staged, rank_room_bytes(r), seen[0]);
  if (!on_all_ranks(s, fine)) {
    refuse_on_ranks(s, PBF_ERROR_OUT_OF_MEMORY,
                    "the host of a rank has no memory for what it exchanges with others");
    return false;
  }
  r->changed = false;
  for (uint32_t k = 0; k < r->count; ++k)
    if (staged >> k & 1) seen[1][k] = nullptr;
  if (pbf_cuda_check(
          cudaMemcpyAsync(r->control->rooms, seen, sizeof seen, cudaMemcpyHostToDevice, s->stream),
          "cudaMemcpyAsync") != PBF_OK ||
      pbf_cuda_check(cudaMemcpyAsync(&r->control->staged, &staged, sizeof staged,
                                     cudaMemcpyHostToDevice, s->stream),
                     "cudaMemcpyAsync") != PBF_OK)
    lose_ranks(s, PBF_ERROR_DEVICE, "a copy to the device of a rank has failed");
  return !r->failed;
}

/* Begins a call that all ranks make alike; false where they do not, or one does not come. */
static inline bool agree_on_call(solver *s, const char *call, const void *arguments,
                                 uint64_t bytes) {
  rank_call_and_memory mine = own_call(s, call, arguments, bytes), all[RANKS_OF_CUDA];
  bool changed = false;
  if (!begin_on_ranks(s) || !gather_on_ranks(s, &mine, all, sizeof mine)) return false;
  for (uint32_t k = 0; k < s->ranks.count; ++k) {
    changed = changed || all[k].changed;
    const char *part = differing_part(all[0], all[k], "dimension, precision or shares");
    if (!part) continue;
    char text[160];
    snprintf(text, sizeof text, "ranks 0 and %u differ in %s", k, part);
    if (!strcmp(part, "the call"))
      snprintf(text, sizeof text, "ranks 0 and %u differ in the call: %s and %s", k, all[0].call,
               all[k].call);
    refuse_on_ranks(s, PBF_ERROR_INVALID_ARGUMENT, text);
    return false;
  }
  return !changed || connect_ranks(s);
}

static inline bool agree_on_step(solver *s, const pbf_step_times &times, uint32_t steps) {
  const double arguments[4] = {times.time, (double)times.before, times.time_step, (double)steps};
  return agree_on_call(s, "pbf_step", arguments, sizeof arguments);
}

/* ---- Memory -------------------------------------------------------------------------------- */

static inline pbf_status take_room(solver *s, uint32_t halo, uint64_t indices, uint64_t numbers) {
  rank_state *r = &s->ranks;
  void *room = nullptr;
  const uint32_t notes = s->activity ? s->capacity : 0;
  const uint64_t bytes = rank_notes_begin(r->count, halo, indices, numbers) + notes;
  if (pbf_status status = pbf_cuda_take(&s->memory, "exchanged with ranks", bytes, &room))
    return status;
  pbf_cuda_free(&s->memory, r->room);
  r->room = static_cast<char *>(room);
  r->halo_room = halo;
  r->index_room = indices;
  r->number_room = numbers;
  r->note_room = notes;
  r->changed = true;
  return PBF_OK;
}

/* What is summed up of loads: of all solids, and then of each. */
enum {
  CHANGES_OF_ALL = offsetof(pbf_few_load_tally, sums) / sizeof(unsigned long long),
  SUMS_OF_SOLID = sizeof(pbf_load_sums) / sizeof(unsigned long long)
};
static_assert(offsetof(pbf_load_sums, depth) == (SUMS_OF_SOLID - 1) * sizeof(unsigned long long),
              "of ranks' depths the largest counts");

/* For the sums and places of a pressure grid's cells, where there can be one, for loads, for a
 * solve's error, and for what is noted of sleepers. */
static inline pbf_status keep_rank_sums(solver *s) {
  const uint64_t indices =
      s->pressure_grid_memory ? pbf_pressure_grid_max_nodes(s->scene_capacity) : 0;
  uint64_t solids = PBF_FEW_SOLIDS;
  if (are_many(s->many)) solids = PBF_WALLS + (uint64_t)s->many.table.room;
  uint64_t numbers = s->watch ? 1 : 0;
  if (s->load_tally) numbers = CHANGES_OF_ALL + solids * SUMS_OF_SOLID;
  const rank_state *r = &s->ranks;
  if (!has_ranks(s) || (indices == r->index_room && numbers == r->number_room &&
                        (s->activity != nullptr) == (r->note_room > 0)))
    return PBF_OK;
  return take_room(s, s->ranks.halo_room, indices, numbers);
}

static inline pbf_status take_cells(solver *s, uint32_t cells) {
  void *memory = nullptr;
  if (pbf_status status = pbf_cuda_take(&s->memory, "cell start",
                                        ((uint64_t)cells + 2) * sizeof(uint32_t), &memory))
    return status;
  pbf_cuda_free(&s->memory, s->ranks.cell_memory);
  s->ranks.cell_memory = static_cast<uint32_t *>(memory);
  s->ranks.cell_room = cells;
  return PBF_OK;
}

static inline pbf_status take_ranks(solver *s) {
  rank_state *r = &s->ranks;
  void *control = nullptr, *report = nullptr, *seen = nullptr;
  if (pbf_status status = pbf_cuda_take(&s->memory, "of ranks", sizeof(rank_control), &control))
    return status;
  r->control = static_cast<rank_control *>(control);
  if (pbf_status status = pbf_cuda_check(
          cudaHostAlloc(&report, sizeof(rank_report), cudaHostAllocMapped), "cudaHostAlloc"))
    return status;
  memset(report, 0, sizeof(rank_report));
  r->report = static_cast<rank_report *>(report);
  if (pbf_status status =
          pbf_cuda_check(cudaHostGetDevicePointer(&seen, report, 0), "cudaHostGetDevicePointer"))
    return status;
  r->device_report = static_cast<rank_report *>(seen);
  int least, most;
  cudaDeviceGetStreamPriorityRange(&least, &most);
  if (pbf_status status = pbf_cuda_check(
          cudaStreamCreateWithPriority(&r->edges, cudaStreamNonBlocking, most), "cudaStreamCreate"))
    return status;
  for (cudaEvent_t *event : {&r->inner_done, &r->edges_done[0], &r->edges_done[1]})
    if (pbf_status status = pbf_cuda_check(cudaEventCreateWithFlags(event, cudaEventDisableTiming),
                                           "cudaEventCreate"))
      return status;
  return take_room(s, 0, 0, 0);
}

static inline void free_ranks(solver *s) {
  for (cudaEvent_t event : {s->ranks.inner_done, s->ranks.edges_done[0], s->ranks.edges_done[1]})
    if (event) cudaEventDestroy(event);
  if (s->ranks.edges) cudaStreamDestroy(s->ranks.edges);
  close_handles(s);
  free_staging(&s->ranks.staging);
  if (s->ranks.report && cudaFreeHost(s->ranks.report) != cudaSuccess) cudaGetLastError();
}

/* Before a solver has anything else. */
static inline pbf_status describe_ranks(solver *s, const pbf_ranks *ranks) {
  rank_state *r = &s->ranks;
  s->scene_capacity = s->capacity;
  if (!ranks) return PBF_OK;
  if (ranks->count > RANKS_OF_CUDA) {
    s->host->set_error("\"cuda\" works on up to 64 ranks");
    return PBF_ERROR_UNSUPPORTED;
  }
  r->link = *ranks;
  r->count = ranks->count;
  r->rank = ranks->rank;
  r->particles = DIGEST_OF_NOTHING;
  for (uint32_t k = 0; k < r->count; ++k) r->portions[k] = ranks->shares ? ranks->shares[k] : 1;
  r->link.shares = nullptr;
  if (ranks->local_capacity) s->capacity = ranks->local_capacity;
  s->capacity = (s->capacity + RANK_GROUP - 1) / RANK_GROUP * RANK_GROUP;
  return PBF_OK;
}

#endif
