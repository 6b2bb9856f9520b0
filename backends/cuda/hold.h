/* Part of launches.h: how particles come to the rank that has them in its share, and to those that
 * need them as neighbours, sorted; and how what stages change of them follows. */
#ifndef PBF_CUDA_HOLD_H
#define PBF_CUDA_HOLD_H

#include "cuda/rank_link.h"

static inline rank_place rank_place_of(const solver *s) {
  const rank_state *r = &s->ranks;
  return {r->control,  r->device_report,       r->rank, r->count, r->turn,
          r->sequence, RANK_GIVES | RANK_TAKES};
}

/* Launches a kernel by which all ranks meet, by launch(place). No kernel may wait for another
 * rank's where that can't be launched before it has ended: where they share a device, and where a
 * kernel is launched for the first time, for which CUDA may wait for a device. Then hosts wait. So
 * do those of staged ranks, and carry(place) exchanges what the kernel has given. */
template <class Launch, class Carry>
static inline void meet_ranks(solver *s, Launch launch, Carry carry) {
  s->ranks.sequence += 1;
  s->ranks.turn = (uint32_t)(s->ranks.sequence % 2);
  rank_place place = rank_place_of(s);
  if (!s->ranks.careful && !s->ranks.staging.any) return launch(place);
  place.phases = RANK_GIVES;
  launch(place);
  if (!on_all_ranks(s, cudaStreamSynchronize(s->stream) == cudaSuccess))
    lose_ranks(s, PBF_ERROR_DEVICE, "the device of a rank has failed");
  if (s->ranks.staging.any && !s->ranks.failed) carry(place);
  place.phases = RANK_TAKES;
  if (!s->ranks.failed) launch(place);
}

/* Steps after what may have other kernels launched: some are not launched in every step. */
enum { STEPS_OF_NEW = 6 };

/* ---- Which particles ----------------------------------------------------------------------- */

/* How far apart the numbers of cells of neighbours can be; all of them where the numbering wraps.
 * Along a periodic axis neighbours are at both ends, too: along the last one that is all. */
static inline uint64_t cells_in_reach(const cell_grid &g) {
  uint64_t rows = 0;
  if (g.row_mask != ~0u || g.turn > 0) return g.count;
  for (int k = 1; k < PBF_DIM; ++k)
    rows += (uint64_t)g.stride[k] * (g.period.c[k] > 0 ? g.cells[k] - 1 : 1);
  return rows * g.cells[0] + (g.period.c[0] > 0 ? g.cells[0] - 1 : g.columns_in_reach);
}

static inline rank_cut rank_cut_of(const solver *s, const cell_grid &grid) {
  const rank_state *r = &s->ranks;
  rank_cut cut = {};
  double before = 0, all = 0;
  for (uint32_t k = 0; k < r->count; ++k) all += r->portions[k];
  for (uint32_t k = 0; k < r->count; ++k) {
    cut.own_first[k] = (uint32_t)(r->total * (before / all)) / RANK_GROUP * RANK_GROUP;
    before += r->portions[k];
  }
  cut.own_first[r->count] = r->total;
  cut.cells = grid.count;
  cut.cells_a_bin = (grid.count + RANK_BINS - 1) / RANK_BINS;
  cut.capacity = s->capacity;
  cut.reach = cells_in_reach(grid);
  return cut;
}

static inline double seconds_now() {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Waits until the device has found the shares, in the meeting of this number. */
static inline bool read_plan(solver *s, uint64_t wanted) {
  rank_state *r = &s->ranks;
  const volatile unsigned long long *sequence = &r->report->plan.sequence;
  const double begin = seconds_now(), patience = 75;
  for (uint32_t k = 1; *sequence != wanted; ++k) {
    if (k % 4096) continue;
    const cudaError_t error = cudaStreamQuery(s->stream);
    if (error != cudaSuccess) cudaGetLastError(); /* "not ready" would be the next launch's, too */
    if (error != cudaSuccess && error != cudaErrorNotReady) {
      lose_ranks(s, PBF_ERROR_DEVICE, cudaGetErrorString(error));
      return false;
    }
    if (seconds_now() - begin > patience) {
      lose_ranks(s, PBF_ERROR_UNAVAILABLE, "a rank's device has not answered");
      return false;
    }
  }
  __atomic_thread_fence(__ATOMIC_ACQUIRE);
  if (r->report->lost) {
    lose_ranks(s, PBF_ERROR_UNAVAILABLE, "the device of another rank has not answered");
    return false;
  }
  memcpy(r->shares, r->report->plan.shares, sizeof r->shares);
  return true;
}

static inline void refuse_capacity(solver *s) {
  uint32_t most = 0, rank = 0;
  char text[200];
  for (uint32_t k = 0; k < s->ranks.count; ++k) {
    const rank_share &share = s->ranks.shares[k];
    const uint32_t room = share.held_first % RANK_GROUP + share.held_last - share.held_first;
    if (room > most) most = room, rank = k;
  }
  snprintf(text, sizeof text,
           "rank %u would hold %u particles, those near its own included, and local_capacity is "
           "%u; a larger one would do, or fewer ranks",
           rank, most, s->capacity);
  refuse_on_ranks(s, PBF_ERROR_CAPACITY, text);
}

/* Room for what ranks hold of others, and for the ends of their cells: as much on all ranks, all of
 * which know when it is short. Nothing is under way then that waits for another rank. */
static inline bool grow_rooms(solver *s) {
  rank_state *r = &s->ranks;
  uint32_t halo = 0, cells = 0;
  for (uint32_t k = 0; k < r->count; ++k) {
    const rank_share &share = r->shares[k];
    halo = halo_count(share) > halo ? halo_count(share) : halo;
    const uint32_t its = share.cell_last - share.cell_first;
    cells = its > cells ? its : cells;
  }
  if (halo <= r->halo_room && cells <= r->cell_room) return true;
  const cudaError_t error = cudaStreamSynchronize(s->stream);
  close_handles(s); /* before others free what they are of */
  if (!on_all_ranks(s, error == cudaSuccess)) {
    lose_ranks(s, PBF_ERROR_DEVICE, "the device of a rank has failed");
    return false;
  }
  pbf_status status = PBF_OK;
  if (cells > r->cell_room) status = take_cells(s, cells + cells / 16);
  if (status == PBF_OK && halo > r->halo_room)
    status = take_room(s, halo + halo / 8, r->index_room, r->number_room);
  if (!on_all_ranks(s, status == PBF_OK)) {
    refuse_on_ranks(s, PBF_ERROR_OUT_OF_MEMORY,
                    "a rank has no memory for the particles near its own; more ranks would do");
    return false;
  }
  return connect_ranks(s);
}

/* ---- The sort ------------------------------------------------------------------------------ */

/* Behind the inbox, in the room of the lists: cells, arrivals, ids. */
static inline sort_scratch rank_scratch_of(const solver *s, uint32_t from) {
  const uint64_t n = s->capacity;
  uint32_t *room = reinterpret_cast<uint32_t *>(
      static_cast<char *>(s->list_storage) + rank_inbox_bytes(s->capacity, inbox_has(state_of(s))));
  return {room + from, room + 2 * n + from, room + 4 * n};
}

/* Laid out as by send_particles_kernel, which is given the same of `own` on each rank. */
static inline unsorted_particles inbox_of(const solver *s, const unsorted_particles &own,
                                          uint32_t count) {
  const rank_inbox in =
      rank_inbox_in(static_cast<char *>(s->list_storage), s->capacity, inbox_has(own));
  unsorted_particles from = own;
  from.points = in.points;
  from.velocities = in.velocities;
  from.ids = in.ids;
  from.last_pressure = in.last_pressure;
  from.overlap = in.overlap;
  from.activity = in.activity;
  from.phase = in.phase;
  from.acceleration = in.acceleration;
  from.count = count;
  return from;
}

/* Of its own, others hold those at either end, in whole warps. What no other rank holds has no
 * neighbour of another rank: reach is mutual. */
static inline void note_inner(rank_state *r) {
  const rank_share &mine = r->shares[r->rank];
  uint32_t first = mine.own_first, last = mine.own_last;
  for (uint32_t k = 0; k < r->count; ++k) {
    const rank_share &its = r->shares[k];
    if (k < r->rank && its.held_last > first) first = its.held_last;
    if (k > r->rank && its.held_first < its.held_last && its.held_first < last)
      last = its.held_first;
  }
  first = (first + RANK_GROUP - 1) / RANK_GROUP * RANK_GROUP;
  if (last < mine.own_last) last = last / RANK_GROUP * RANK_GROUP;
  if (first >= last) first = last = mine.own_first;
  r->inner_first = first - mine.held_first + r->pad;
  r->inner_last = last - mine.held_first + r->pad;
}

/* Where what it holds is, from the plan. */
static inline void note_share(solver *s) {
  rank_state *r = &s->ranks;
  const rank_share &share = r->shares[r->rank];
  r->pad = share.held_first % RANK_GROUP;
  r->first = share.own_first - share.held_first + r->pad;
  r->last = share.own_last - share.held_first + r->pad;
  r->held = share.held_last - share.held_first + r->pad;
  note_inner(r);
  s->cell_start = r->cell_memory + 1 - static_cast<ptrdiff_t>(share.cell_first);
}

/* The particles that stages work on: its own. */
static inline void note_own(const solver *s, sorted_particles *p) {
  p->first = s->ranks.first;
  p->count = s->ranks.last;
  p->cell_start = s->cell_start;
}

/* Hosts of staged ranks know how many particles each gets before these are sent. */
static inline bool stage_particles(solver *s, uint64_t of_plan, const unsorted_particles &from,
                                   rank_outbox *outbox) {
  if (s->ranks.failed || !read_plan(s, of_plan)) return false;
  if (s->ranks.report->plan.fits) return take_outbox(s, inbox_has(from), outbox);
  refuse_capacity(s);
  return false;
}

/* From the cells of its particles on, each rank comes to know its share, and gets what it is to
 * hold. The state is as it was. */
static inline bool hold_share(solver *s, const unsorted_particles &from, const cell_grid &grid) {
  rank_state *r = &s->ranks;
  r->careful = r->one_by_one || r->careful_once || r->careful_steps > 0;
  if (!r->careful_once && r->careful_steps) --r->careful_steps;
  r->careful_once = false;
  const rank_cut cut = rank_cut_of(s, grid);
  const uint32_t blocks = blocks_for(from.count);
  const sort_scratch scratch = rank_scratch_of(s, 0);
  rank_outbox outbox = {};
  if (blocks)
    count_bins_kernel<<<blocks, PBF_BLOCK, 0, s->stream>>>(scratch.cell, from.count,
                                                           cut.cells_a_bin, r->control->bins);
  meet_ranks(
      s,
      [&](const rank_place &place) {
        share_kernel<<<1, RANK_SHARE_THREADS, 0, s->stream>>>(place, cut);
      },
      [&](const rank_place &place) {
        carry_given(s, [&](uint32_t from_rank, uint32_t, rank_range *list) {
          list[0] = {rank_bins_begin(r->count, place.turn, from_rank),
                     RANK_BINS * sizeof(uint32_t)};
        });
      });
  const uint64_t of_plan = r->sequence;
  if (r->staging.any && !stage_particles(s, of_plan, from, &outbox)) return false;
  if (blocks)
    send_particles_kernel<<<blocks, PBF_BLOCK, 0, s->stream>>>(
        rank_place_of(s), from, cut.cells_a_bin, s->capacity, outbox, scratch.cell);
  meet_ranks(
      s, [&](const rank_place &place) { meet_ranks_kernel<<<1, 32, 0, s->stream>>>(place); },
      [&](const rank_place &) { carry_particles(s, inbox_has(from), outbox); });
  if (r->failed) return false;
  if (cudaPeekAtLastError() != cudaSuccess) {
    lose_ranks(s, PBF_ERROR_DEVICE, cudaGetErrorString(cudaGetLastError()));
    return false;
  }
  if (!read_plan(s, of_plan)) return false;
  if (!r->report->plan.fits) {
    refuse_capacity(s);
    return false;
  }
  if (!grow_rooms(s)) return false;
  note_share(s);
  return true;
}

/* Predicts, gets what it is to hold, and counts the particles of each cell. False where ranks have
 * failed. */
template <class Predict>
static inline bool hold_and_count(solver *s, const unsorted_particles &from, const cell_grid &grid,
                                  Predict predict) {
  rank_state *r = &s->ranks;
  predict(from, static_cast<uint32_t *>(nullptr), rank_scratch_of(s, 0));
  if (!hold_share(s, from, grid)) return false;
  const rank_share &share = r->shares[r->rank];
  const uint32_t received = r->report->plan.received;
  const uint64_t cells = share.cell_last - share.cell_first;
  if (cudaMemsetAsync(r->cell_memory, 0, (cells + 2) * sizeof(uint32_t), s->stream) !=
      cudaSuccess) {
    lose_ranks(s, PBF_ERROR_DEVICE, cudaGetErrorString(cudaGetLastError()));
    return false;
  }
  const uint32_t blocks = blocks_for(from.count);
  count_held_kernel<<<blocks ? blocks : 1, PBF_BLOCK, 0, s->stream>>>(
      from.count, s->cell_start, rank_scratch_of(s, 0), r->cell_memory, r->pad);
  if (received) predict(inbox_of(s, from, received), s->cell_start, rank_scratch_of(s, from.count));
  return true;
}

/* ---- Two parts ----------------------------------------------------------------------------- */

/* What is launched in its lifetime runs beside the stream of the inner particles. */
struct on_edges {
  solver *s;
  cudaStream_t before;

  explicit on_edges(solver *of) : s(of), before(of->stream) { s->stream = s->ranks.edges; }
  ~on_edges() { s->stream = before; }
};

/* ---- What stages change -------------------------------------------------------------------- */

/* Reals of each particle that lie `stride` reals apart. */
static inline rank_field rank_field_of(void *base, uint32_t reals, uint32_t stride) {
  constexpr uint32_t words = sizeof(pbf_real) / sizeof(uint32_t);
  return {static_cast<uint32_t *>(base), reals * words, stride * words};
}

static inline rank_field lambda_field(point *points) {
  return rank_field_of(&points->lambda, 1, sizeof(point) / sizeof(pbf_real));
}

static inline rank_field place_field(point *points) {
  return rank_field_of(points, PBF_DIM, sizeof(point) / sizeof(pbf_real));
}

/* With what is beside a place. */
static inline rank_field numbered_field(point *points) {
  return rank_field_of(points, PBF_DIM + 1, sizeof(point) / sizeof(pbf_real));
}

static inline rank_field vector_field(pbf_vec *vectors) {
  return rank_field_of(vectors, PBF_DIM, sizeof(pbf_vec) / sizeof(pbf_real));
}

static inline uint64_t run_sent(const rank_state *r) {
  const rank_share &mine = r->shares[r->rank];
  uint64_t sent = 0;
  for (uint32_t k = 0; k < r->count; ++k) {
    const rank_run run = common_run(mine, r->shares[k]);
    if (k != r->rank && run.first < run.last) sent += run.last - run.first;
  }
  return sent;
}

/* Where in the room of one rank the fields of another's particles go. */
static inline void ranges_of_fields(const rank_fields &fields, const rank_share &own,
                                    const rank_share &its, rank_range *list) {
  const rank_run run = common_run(own, its);
  uint64_t at = fields.mail;
  if (run.first >= run.last) return;
  for (const rank_field &field : {fields.first, fields.second}) {
    const uint64_t bytes = field.words * sizeof(uint32_t);
    *list++ = {at + halo_place(its, run.first) * bytes, (run.last - run.first) * bytes};
    at += halo_count(its) * bytes;
  }
}

static inline pbf_status exchange_on_ranks(solver *s, const rank_field &first,
                                           const rank_field &second) {
  rank_state *r = &s->ranks;
  if (r->count == 1) return PBF_OK;
  r->bytes_sent += run_sent(r) * (first.words + second.words) * sizeof(uint32_t);
  rank_fields fields = {first, second, 0, r->shares[r->rank].held_first, r->pad};
  meet_ranks(
      s,
      [&](const rank_place &place) {
        fields.mail = rank_mail(r, place.turn);
        exchange_kernel<<<RANK_EXCHANGE_BLOCKS, PBF_BLOCK, 0, s->stream>>>(place, fields);
      },
      [&](const rank_place &) {
        carry_given(s, [&](uint32_t from, uint32_t to, rank_range *list) {
          ranges_of_fields(fields, r->shares[from], r->shares[to], list);
        });
      });
  return r->failed ? r->failed : pbf_cuda_check_launch("exchange_kernel");
}

/* Adds up what lies on each rank's device. */
static inline pbf_status add_numbers_of_ranks(solver *s, rank_numbers numbers) {
  const rank_state *r = &s->ranks;
  uint32_t blocks = blocks_for(numbers.first_count + numbers.rest_count);
  if (blocks > RANK_EXCHANGE_BLOCKS) blocks = RANK_EXCHANGE_BLOCKS;
  if (r->count == 1) return PBF_OK;
  numbers.at = rank_numbers_begin(r->count, r->halo_room, r->index_room);
  numbers.room = r->number_room;
  const uint64_t each = sizeof(unsigned long long);
  meet_ranks(
      s,
      [&](const rank_place &place) {
        add_numbers_kernel<<<blocks, PBF_BLOCK, 0, s->stream>>>(place, numbers);
      },
      [&](const rank_place &) {
        carry_given(s, [&](uint32_t from, uint32_t, rank_range *list) {
          list[0] = {numbers.at + from * numbers.room * each,
                     (numbers.first_count + (uint64_t)numbers.rest_count) * each};
        });
      });
  return r->failed ? r->failed : pbf_cuda_check_launch("add_numbers_kernel");
}

/* What has been noted of others' particles goes to these. */
static inline pbf_status exchange_notes(solver *s, pbf_real *activity, uint8_t *awakened) {
  const rank_state *r = &s->ranks;
  if (r->count == 1) return PBF_OK;
  const rank_notes notes = {activity, awakened,
                            rank_notes_begin(r->count, r->halo_room, r->index_room, r->number_room),
                            r->shares[r->rank].held_first, r->pad};
  meet_ranks(
      s,
      [&](const rank_place &place) {
        notes_kernel<<<RANK_EXCHANGE_BLOCKS, PBF_BLOCK, 0, s->stream>>>(place, notes);
      },
      [&](const rank_place &place) { carry_notes(s, notes.at, rank_mail(r, place.turn)); });
  return r->failed ? r->failed : pbf_cuda_check_launch("notes_kernel");
}

/* ---- Sleep --------------------------------------------------------------------------------- */

/* On ranks hosts wait for each other between steps: what all do not do, none may launch. `asleep`:
 * all of its own particles. */
static inline pbf_status agree_on_sleep(solver *s, bool asleep) {
  rank_state *r = &s->ranks;
  r->all_asleep = on_all_ranks(s, asleep || !s->count);
  if (r->failed) return r->failed;
  return pbf_cuda_check(
      cudaMemsetAsync(&s->tally->all, r->all_asleep, sizeof s->tally->all, s->stream),
      "cudaMemsetAsync");
}

/* After a step. */
static inline pbf_status note_sleep_of_ranks(solver *s) {
  if (pbf_status status = pbf_cuda_check(cudaStreamSynchronize(s->stream), "cudaStreamSynchronize"))
    return status;
  return agree_on_sleep(s, *static_cast<const volatile uint64_t *>(s->all_asleep) == s->epoch);
}

/* Before one, if all slept: whether they still do. */
static inline pbf_status look_for_awakened(solver *s) {
  uint32_t all = 0;
  pbf_status status = pbf_cuda_check(
      cudaMemcpyAsync(&all, &s->tally->all, sizeof all, cudaMemcpyDeviceToHost, s->stream),
      "cudaMemcpyAsync to the host");
  if (status == PBF_OK)
    status = pbf_cuda_check(cudaStreamSynchronize(s->stream), "cudaStreamSynchronize");
  return status == PBF_OK ? agree_on_sleep(s, all != 0) : status;
}

#endif
