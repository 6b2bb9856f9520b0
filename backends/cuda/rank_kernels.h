/* Part of staging.h: what ranks' devices tell each other. All kernels here are run by all ranks
 * in the same order. A kernel that waits has so few blocks that all of them are on the device at
 * once. */
#ifndef PBF_CUDA_RANK_KERNELS_H
#define PBF_CUDA_RANK_KERNELS_H

#include "common/rank_shares.h"
#include "cuda/launch.h"
#include "cuda/ptx.h"
#include "cuda/ranks.h"
#include "cuda/sort.h"

enum { RANK_SHARE_THREADS = 1024, RANK_EXCHANGE_BLOCKS = 48 };

/* A kernel gives the others something, and then waits for what they give. Where ranks share a
 * device, or are staged, it is launched twice, and the host waits between. */
enum rank_phases { RANK_GIVES = 1, RANK_TAKES = 2 };

/* What a kernel knows of the others. */
struct rank_place {
  rank_control *control;
  rank_report *report;
  uint32_t rank, count, turn;
  uint64_t sequence;
  int phases;
};

/* ---- Meeting ------------------------------------------------------------------------------- */

/* Whether this device does not reach the memory of rank r: hosts wait for what that one gives, and
 * launch what takes it once it has come. */
static __device__ __forceinline__ bool is_staged(const rank_place &p, uint32_t r) {
  return p.control->staged >> r & 1;
}

/* Tells all ranks how far this one has come. The threads of a block call it, and what they have
 * written others see first. */
static __device__ __forceinline__ void tell_ranks(const rank_place &p) {
  __threadfence_system();
  for (uint32_t r = threadIdx.x; r < p.count; r += blockDim.x)
    if (r != p.rank && !is_staged(p, r))
      store_release_of_system(rank_arrivals(p.control->rooms[r]) + p.rank, p.sequence);
}

/* The same by a kernel of more blocks: the last one tells. */
static __device__ __forceinline__ void tell_ranks_at_last(const rank_place &p) {
  __shared__ bool is_last;
  __threadfence_system();
  __syncthreads();
  if (threadIdx.x == 0) is_last = atomicAdd(&p.control->arrived, 1u) == gridDim.x - 1;
  __syncthreads();
  if (!is_last) return;
  if (threadIdx.x == 0) p.control->arrived = 0;
  tell_ranks(p);
}

/* Waits until all have come as far. After a minute it gives up, and so do all that wait later. */
static __device__ __forceinline__ void await_ranks(const rank_place &p) {
  const unsigned long long patience = 60ull * 1000 * 1000 * 1000, begin = nanoseconds();
  for (uint32_t r = threadIdx.x; r < p.count; r += blockDim.x) {
    if (r == p.rank || is_staged(p, r)) continue;
    const uint64_t *arrival = rank_arrivals(p.control->rooms[p.rank]) + r;
    uint64_t seen = 0;
    while (!*static_cast<volatile uint32_t *>(&p.control->lost)) {
      seen = load_acquire_of_system(arrival);
      if (seen >= p.sequence) break;
      if (nanoseconds() - begin < patience) continue;
      p.control->lost = 1;
      p.report->lost = 1;
      __threadfence_system();
    }
  }
  __syncthreads();
}

static __global__ void meet_ranks_kernel(rank_place p) {
  if (p.phases & RANK_GIVES) tell_ranks(p);
  if (p.phases & RANK_TAKES) await_ranks(p);
}

/* ---- Shares -------------------------------------------------------------------------------- */

/* Counts its own particles in bins. A warp's are near each other. */
static __global__ void __launch_bounds__(PBF_BLOCK)
    count_bins_kernel(const uint32_t *cells, uint32_t count, uint32_t cells_a_bin, uint32_t *bins) {
  const uint32_t i = thread_index(), lane = threadIdx.x % 32;
  const uint32_t bin = i < count ? cells[i] / cells_a_bin : ~0u;
  const uint32_t alike = __match_any_sync(~0u, bin);
  if (i < count && (uint32_t)__ffs((int)alike) - 1 == lane)
    atomicAdd(&bins[bin], (uint32_t)__popc(alike));
}

/* Sums of what comes before each of the values at `from`, and of all behind the last. */
static __device__ __forceinline__ void sum_bins(const uint32_t *const *tables, uint32_t count,
                                                uint32_t *before) {
  enum { EACH = RANK_BINS / RANK_SHARE_THREADS };
  __shared__ uint32_t of_warps[RANK_SHARE_THREADS / 32];
  const uint32_t lane = threadIdx.x % 32, warp = threadIdx.x / 32, first = threadIdx.x * EACH;
  uint32_t own[EACH], sum = 0;
  for (uint32_t k = 0; k < EACH; ++k) {
    own[k] = 0;
    for (uint32_t r = 0; r < count; ++r) own[k] += __ldcv(tables[r] + first + k);
    sum += own[k];
  }
  uint32_t up_to = sum;
  for (uint32_t step = 1; step < 32; step *= 2) {
    const uint32_t other = __shfl_up_sync(~0u, up_to, step);
    if (lane >= step) up_to += other;
  }
  __syncthreads(); /* those before have been read */
  if (lane == 31) of_warps[warp] = up_to;
  __syncthreads();
  uint32_t at = up_to - sum;
  for (uint32_t w = 0; w < warp; ++w) at += of_warps[w];
  for (uint32_t k = 0; k < EACH; ++k) {
    before[first + k] = at;
    at += own[k];
  }
  if (threadIdx.x == RANK_SHARE_THREADS - 1) before[RANK_BINS] = at;
  __syncthreads();
}

/* What the shares follow from, beside the bins. */
struct rank_cut {
  uint32_t own_first[RANKS_OF_CUDA + 1];
  uint32_t cells, cells_a_bin, capacity;
  unsigned long long reach; /* how far apart the numbers of neighbours' cells can be */
};

static __device__ inline rank_share share_between(const rank_cut &cut, uint32_t r,
                                                  const uint32_t *before) {
  rank_share s = {};
  if (cut.own_first[r] >= cut.own_first[r + 1]) return s;
  s.own_first = cut.own_first[r];
  s.own_last = cut.own_first[r + 1];
  const unsigned long long each = cut.cells_a_bin, total = cut.cells;
  const unsigned long long first = pbf_bin_of_place(before, RANK_BINS, s.own_first) * each;
  const unsigned long long last = (pbf_bin_of_place(before, RANK_BINS, s.own_last - 1) + 1) * each;
  s.bin_first = first > cut.reach ? (uint32_t)((first - cut.reach) / each) : 0;
  const unsigned long long end = (last + cut.reach + each - 1) / each,
                           bins = (total + each - 1) / each;
  s.bin_last = (uint32_t)(end < bins ? end : bins);
  s.held_first = before[s.bin_first];
  s.held_last = before[s.bin_last];
  s.cell_first = (uint32_t)(s.bin_first * each);
  s.cell_last = (uint32_t)(s.bin_last * each < total ? s.bin_last * each : total);
  return s;
}

/* Gives all ranks its bins, and leaves them empty; one block. */
static __device__ __forceinline__ void give_bins(const rank_place &p) {
  rank_control *c = p.control;
  for (uint32_t k = 0; k < p.count; ++k) {
    uint32_t *to = rank_bins(c->rooms[k], p.count, p.turn, p.rank);
    for (uint32_t b = threadIdx.x; b < RANK_BINS; b += RANK_SHARE_THREADS) to[b] = c->bins[b];
  }
  if (threadIdx.x < p.count) c->sent[threadIdx.x] = 0;
  __threadfence_system();
  __syncthreads();
  for (uint32_t b = threadIdx.x; b < RANK_BINS; b += RANK_SHARE_THREADS) c->bins[b] = 0;
  tell_ranks(p);
}

/* From all ranks' bins to the shares, on each alike; one block. */
static __global__ void __launch_bounds__(RANK_SHARE_THREADS)
    share_kernel(rank_place p, rank_cut cut) {
  __shared__ uint32_t before[RANK_BINS + 1];
  __shared__ uint32_t staged[RANKS_OF_CUDA];
  __shared__ const uint32_t *tables[RANKS_OF_CUDA];
  rank_control *c = p.control;
  rank_plan *plan = &c->plan;
  const uint32_t r = threadIdx.x;
  if (p.phases & RANK_GIVES) give_bins(p);
  if (!(p.phases & RANK_TAKES)) return;
  if (r < p.count) tables[r] = rank_bins(c->rooms[p.rank], p.count, p.turn, r);
  await_ranks(p);
  sum_bins(tables, p.count, before);
  rank_share share = {};
  if (r < p.count) share = share_between(cut, r, before);
  const uint32_t room = share.held_first % RANK_GROUP + share.held_last - share.held_first;
  const bool fits = !__syncthreads_or(r < p.count && room > cut.capacity);
  uint32_t at = 0, received = 0, sent = 0;
  for (uint32_t q = 0; q < p.count; ++q) {
    sum_bins(tables + q, 1, before);
    if (r >= p.count || q == r) continue;
    const uint32_t its = before[share.bin_last] - before[share.bin_first];
    if (q < p.rank) at += its;
    if (q == p.rank) sent = its;
    if (r == p.rank) p.report->plan.got[q] = its;
    received += its;
  }
  if (r < p.count) staged[r] = is_staged(p, r) ? sent : 0;
  __syncthreads();
  if (r < p.count) {
    if (is_staged(p, r)) at = 0;
    for (uint32_t q = 0; q < r && is_staged(p, r); ++q) at += staged[q];
    plan->shares[r] = p.report->plan.shares[r] = share;
    plan->inbox_first[r] = at;
    p.report->plan.sent[r] = sent;
    if (r == p.rank) plan->received = p.report->plan.received = received;
  }
  if (r == 0) plan->fits = p.report->plan.fits = fits;
  __threadfence_system();
  __syncthreads();
  if (r == 0) *static_cast<volatile unsigned long long *>(&p.report->plan.sequence) = p.sequence;
}

static inline __host__ __device__ rank_inbox_has inbox_has(const unsorted_particles &of) {
  return {of.last_pressure != nullptr, of.overlap != nullptr, of.activity != nullptr,
          of.phase != nullptr, of.acceleration != nullptr};
}

/* Where particles are put for staged ranks, and how many there is room for. */
struct rank_outbox {
  char *at;
  uint32_t capacity;
};

/* Puts each particle where a rank holds it. Cells of those that this rank does not hold get to be
 * PBF_NO_CELL. */
static __global__ void __launch_bounds__(PBF_BLOCK)
    send_particles_kernel(rank_place p, unsorted_particles from, uint32_t cells_a_bin,
                          uint32_t capacity, rank_outbox outbox, uint32_t *cells) {
  rank_control *c = p.control;
  const rank_plan *plan = &c->plan;
  const uint32_t i = thread_index(), lane = threadIdx.x % 32;
  if (!plan->fits) return;
  const bool real = i < from.count;
  const uint32_t bin = real ? cells[i] / cells_a_bin : 0;
  for (uint32_t r = 0; r < p.count; ++r) {
    const uint32_t first = plan->shares[r].bin_first, last = plan->shares[r].bin_last;
    const bool holds = real && bin - first < last - first;
    if (r == p.rank) {
      if (real && !holds) cells[i] = PBF_NO_CELL;
      continue;
    }
    const uint32_t lanes = __ballot_sync(~0u, holds);
    if (!lanes) continue;
    uint32_t slot = 0;
    if (lane == 0) slot = atomicAdd(&c->sent[r], (uint32_t)__popc(lanes));
    slot = __shfl_sync(~0u, slot, 0) + plan->inbox_first[r] +
           (uint32_t)__popc(lanes & ((1u << lane) - 1));
    if (!holds) continue;
    const bool staged = is_staged(p, r);
    const rank_inbox to = rank_inbox_in(staged ? outbox.at : c->inboxes[r],
                                        staged ? outbox.capacity : capacity, inbox_has(from));
    store(to.points, slot, load(from.points, i));
    to.velocities[slot] = from.velocities[i];
    to.ids[slot] = from.ids[i];
    if (to.last_pressure) to.last_pressure[slot] = from.last_pressure[i];
    if (to.overlap) to.overlap[slot] = from.overlap[i];
    if (to.activity) to.activity[slot] = from.activity[i];
    if (to.phase) to.phase[slot] = from.phase[i];
    if (to.acceleration) to.acceleration[slot] = from.acceleration[i];
  }
}

/* As count_particle, of its own particles in cells that it holds; and `pad`, from which places
 * count. */
static __global__ void __launch_bounds__(PBF_BLOCK)
    count_held_kernel(uint32_t count, uint32_t *cell_count, sort_scratch scratch, uint32_t *front,
                      uint32_t pad) {
  const uint32_t i = thread_index();
  if (i == 0) *front = pad;
  if (i >= count) return;
  const uint32_t cell = scratch.cell[i];
  if (cell != PBF_NO_CELL) scratch.arrival[i] = atomicAdd(&cell_count[cell], 1u);
}

/* ---- What stages change -------------------------------------------------------------------- */

/* Words that are exchanged of each particle: the first ones from `base` on, `stride` apart. */
struct rank_field {
  uint32_t *base;
  uint32_t words, stride;
};

/* Two that have places in common: first … last - 1. */
struct rank_run {
  uint32_t first, last;
};

static __host__ __device__ __forceinline__ rank_run common_run(const rank_share &own,
                                                               const rank_share &held) {
  return {own.own_first > held.held_first ? own.own_first : held.held_first,
          own.own_last < held.held_last ? own.own_last : held.held_last};
}

/* Where a place that is not a share's own comes in what it holds of others. */
static __host__ __device__ __forceinline__ uint32_t halo_place(const rank_share &s,
                                                               uint32_t place) {
  return place - s.held_first - (place >= s.own_last ? s.own_last - s.own_first : 0);
}

static __host__ __device__ __forceinline__ uint32_t halo_count(const rank_share &s) {
  return s.held_last - s.held_first - (s.own_last - s.own_first);
}

/* Visits the words of a run, shared out among all threads. */
template <class Visit>
static __device__ __forceinline__ void for_words(const rank_run &run, uint32_t words, Visit visit) {
  if (run.first >= run.last) return;
  const uint32_t all = (run.last - run.first) * words;
  for (uint32_t k = thread_index(); k < all; k += gridDim.x * blockDim.x)
    visit(run.first + k / words, k % words);
}

/* What is exchanged: one or two fields, and where in a rank's room they go. */
struct rank_fields {
  rank_field first, second;
  uint64_t mail;
  uint32_t held_first, pad;
};

static __device__ __forceinline__ uint32_t *word_of(const rank_field &f, const rank_fields &all,
                                                    uint32_t place, uint32_t word) {
  return f.base + (uint64_t)(place - all.held_first + all.pad) * f.stride + word;
}

/* Gives the others what they hold of this rank's particles. */
static __device__ __forceinline__ void give_fields(const rank_place &p, const rank_fields &f) {
  rank_control *c = p.control;
  const rank_share mine = c->plan.shares[p.rank];
  for (uint32_t r = 0; r < p.count; ++r) {
    if (r == p.rank) continue;
    const rank_share its = c->plan.shares[r];
    const rank_run run = common_run(mine, its);
    uint32_t *to = reinterpret_cast<uint32_t *>(c->rooms[r] + f.mail);
    for (const rank_field &field : {f.first, f.second}) {
      if (field.words)
        for_words(run, field.words, [&](uint32_t place, uint32_t word) {
          to[(uint64_t)halo_place(its, place) * field.words + word] =
              *word_of(field, f, place, word);
        });
      to += (uint64_t)halo_count(its) * field.words;
    }
  }
  tell_ranks_at_last(p);
}

/* Takes what it holds of theirs. */
static __device__ __forceinline__ void take_fields(const rank_place &p, const rank_fields &f) {
  const rank_share mine = p.control->plan.shares[p.rank];
  const uint32_t *from = reinterpret_cast<const uint32_t *>(p.control->rooms[p.rank] + f.mail);
  for (const rank_field &field : {f.first, f.second}) {
    for (rank_run run :
         {rank_run{mine.held_first, mine.own_first}, rank_run{mine.own_last, mine.held_last}})
      if (field.words)
        for_words(run, field.words, [&](uint32_t place, uint32_t word) {
          *word_of(field, f, place, word) =
              __ldcv(from + (uint64_t)halo_place(mine, place) * field.words + word);
        });
    from += (uint64_t)halo_count(mine) * field.words;
  }
}

static __global__ void __launch_bounds__(PBF_BLOCK) exchange_kernel(rank_place p, rank_fields f) {
  if (p.phases & RANK_GIVES) give_fields(p, f);
  if (!(p.phases & RANK_TAKES)) return;
  await_ranks(p);
  take_fields(p, f);
}

/* ---- Notes ----------------------------------------------------------------------------------- */

/* What is noted of others' particles that a rank holds, for their ranks to know: those that
 * something awake has made the sleeping boundary, or, unless it is null, the awakened ones. */
struct rank_notes {
  pbf_real *activity;
  uint8_t *awakened;
  uint64_t at; /* in a rank's room */
  uint32_t held_first, pad;
};

static __device__ __forceinline__ bool is_noted(const rank_notes &n, uint32_t i) {
  if (n.awakened) return n.awakened[i] != 0;
  return pbf_is_asleep(n.activity[i]) && !pbf_is_inactive(n.activity[i]);
}

static __device__ __forceinline__ void note(const rank_notes &n, uint32_t i) {
  if (n.awakened)
    n.awakened[i] = 1;
  else if (pbf_is_inactive(n.activity[i]))
    n.activity[i] = pbf_sleeping_boundary();
}

/* Several may note the same one. Those read are cleared: all exchange something else between. */
static __global__ void __launch_bounds__(PBF_BLOCK) notes_kernel(rank_place p, rank_notes n) {
  const rank_control *c = p.control;
  const rank_share mine = c->plan.shares[p.rank];
  if (p.phases & RANK_GIVES) {
    for (uint32_t r = 0; r < p.count; ++r) {
      const rank_share its = c->plan.shares[r];
      uint8_t *to = reinterpret_cast<uint8_t *>(c->rooms[r] + n.at);
      if (r != p.rank)
        for_words(common_run(its, mine), 1, [&](uint32_t place, uint32_t) {
          if (is_noted(n, place - n.held_first + n.pad)) to[place - its.own_first] = 1;
        });
    }
    tell_ranks_at_last(p);
  }
  if (!(p.phases & RANK_TAKES)) return;
  await_ranks(p);
  volatile uint8_t *here = reinterpret_cast<uint8_t *>(c->rooms[p.rank] + n.at);
  for_words({mine.own_first, mine.own_last}, 1, [&](uint32_t place, uint32_t) {
    if (!here[place - mine.own_first]) return;
    here[place - mine.own_first] = 0;
    note(n, place - n.held_first + n.pad);
  });
}

/* ---- Sums ------------------------------------------------------------------------------------ */

/* Numbers of each rank that are added up: integers, in any order. Of the rest, in runs of `period`,
 * the last one is the largest instead. */
struct rank_numbers {
  unsigned long long *first, *rest;
  uint32_t first_count, rest_count, period;
  uint64_t at, room; /* in a rank's room; of each rank's numbers */
};

/* All ranks get the sums, each in place of its own numbers. A thread gives and takes the same ones.
 */
static __global__ void __launch_bounds__(PBF_BLOCK)
    add_numbers_kernel(rank_place p, rank_numbers n) {
  const uint32_t begin = thread_index(), each = gridDim.x * blockDim.x,
                 count = n.first_count + n.rest_count;
  auto number = [&](uint32_t k) {
    return k < n.first_count ? n.first + k : n.rest + (k - n.first_count);
  };
  auto in_room = [&](uint32_t of, uint32_t from) {
    return reinterpret_cast<unsigned long long *>(p.control->rooms[of] + n.at) + from * n.room;
  };
  if (p.phases & RANK_GIVES) {
    for (uint32_t r = 0; r < p.count; ++r)
      for (uint32_t k = begin; k < count; k += each) in_room(r, p.rank)[k] = *number(k);
    tell_ranks_at_last(p);
  }
  if (!(p.phases & RANK_TAKES)) return;
  await_ranks(p);
  for (uint32_t k = begin; k < count; k += each) {
    const bool largest = k >= n.first_count && (k - n.first_count + 1) % n.period == 0;
    unsigned long long all = 0;
    for (uint32_t r = 0; r < p.count; ++r) {
      const unsigned long long its = __ldcv(in_room(p.rank, r) + k);
      all = largest ? max(all, its) : all + its;
    }
    *number(k) = all;
  }
}

/* ---- A pressure grid ------------------------------------------------------------------------- */

/* Indices of a pressure grid: those of cells, and from `first` on of further compartments, of which
 * `taken`, and at most `most`, have a cell. `further` is where those of each cell begin here,
 * `home` the cells that they are of. */
struct rank_indices {
  uint32_t count, first, most;
  const uint32_t *taken, *further, *home;
  uint64_t room; /* indices that there is room for */
};

/* The index that rank r has in place of this one; n.count: none. */
static __device__ __forceinline__ uint32_t index_on(const rank_place &p, uint32_t halo,
                                                    const rank_indices &n, uint32_t r,
                                                    uint32_t index) {
  if (index < n.first || r == p.rank) return index;
  if (index - n.first >= min(*n.taken, n.most)) return n.count;
  const uint32_t cell = n.home[index - n.first];
  const uint32_t *its = rank_further(p.control->rooms[r], p.count, halo, n.room);
  return min(__ldcv(its + cell) + (index - n.further[cell]), n.count);
}

/* Adds up what all ranks' particles make of the cells: integers, in any order. Sums
 * of all indices come before their places, and before their moves, unless these are null. */
static __global__ void __launch_bounds__(PBF_BLOCK)
    add_sums_kernel(rank_place p, uint32_t halo, rank_indices n, unsigned long long *sums,
                    unsigned long long *moves) {
  if (p.phases & RANK_GIVES) tell_ranks(p); /* each block: which comes first is not known */
  if (!(p.phases & RANK_TAKES)) return;
  await_ranks(p);
  for (uint32_t k = thread_index(); k < n.count; k += gridDim.x * blockDim.x) {
    unsigned long long sum = 0, place = 0, move[PBF_DIM] = {0};
    for (uint32_t r = 0; r < p.count; ++r) {
      const unsigned long long *its = rank_sums(p.control->rooms[r], p.count, halo);
      const uint32_t at = index_on(p, halo, n, r, k);
      if (at == n.count) continue;
      sum += __ldcv(its + at);
      place += __ldcv(its + n.count + at);
      for (uint64_t axis = 0; axis < PBF_DIM && moves; ++axis)
        move[axis] += __ldcv(its + 2ull * n.count + (uint64_t)PBF_DIM * at + axis);
    }
    sums[k] = sum;
    sums[n.count + k] = place;
    for (uint64_t axis = 0; axis < PBF_DIM && moves; ++axis)
      moves[(uint64_t)PBF_DIM * k + axis] = move[axis];
  }
}

#endif
