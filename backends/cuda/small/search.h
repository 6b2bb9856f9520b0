/* Part of kernel.h: the lists of small scenes: a particle's candidates are dealt out to its threads
 * in turn, and each keeps those that are near in a list of its own. */
#ifndef PBF_CUDA_SMALL_SEARCH_H
#define PBF_CUDA_SMALL_SEARCH_H

#include "cuda/small/tile.h"

/* A thread's list in shared memory: slots, or particles where the block reads from memory. While
 * it grows, entries are written in any case, and written over if they do not count. */
struct small_list {
  uint16_t *entries; /* SMALL_THREADS apart */
  uint32_t size;     /* more than `most` if there was no room */
  uint32_t max_size; /* that it may have; four more have room */

  __device__ __forceinline__ uint16_t &at(uint32_t k) const { return entries[k * SMALL_THREADS]; }

  /* Entries k … k + 3. */
  __device__ __forceinline__ void chunk(uint32_t k, uint32_t (&some)[SMALL_CHUNK]) const {
#pragma unroll
    for (uint32_t q = 0; q < SMALL_CHUNK; ++q) some[q] = at(k + q);
  }
  __device__ __forceinline__ void fill_up(uint32_t entry) const {
    if (size > max_size) return;
#pragma unroll
    for (uint32_t q = 0; q < SMALL_CHUNK; ++q) at(size + q) = (uint16_t)entry;
  }

  /* Evens out the lists of a particle's threads; those of a warp call it together. */
  __device__ __forceinline__ void balance(uint32_t lane, uint32_t lanes) {
    for (uint32_t step = 1; step < lanes; step *= 2) {
      uint32_t other = __shfl_xor_sync(~0u, size, (int)step);
      uint32_t share = (size + other + (lane & step ? 0 : 1)) / 2;
      uint16_t *to = entries + ((int)(lane ^ step) - (int)lane);
      for (; size > share; ++other) to[other * SMALL_THREADS] = at(--size);
      size = share;
      __syncwarp();
    }
  }
};

/* What a thread looks for. */
struct small_search {
  cell_place place;
  pbf_vec x;
  uint32_t own; /* particle */
  uint32_t lane, lanes;
  pbf_real h2;

  /* Of two particles the same bits whichever asks, wherever it is compiled into: blocks rely on
   * that a neighbour's neighbour is oneself. */
  __device__ __forceinline__ bool is_near(pbf_vec other) const {
    pbf_vec d = pbf_sub(x, other);
    float sum = __fmul_rn((float)d.c[0], (float)d.c[0]);
    for (int k = 1; k < PBF_DIM; ++k) sum = __fmaf_rn((float)d.c[k], (float)d.c[k], sum);
    return sum < h2;
  }
};

/* Those of a warp call it together, with `real` for those that have a particle. */
static __device__ __forceinline__ uint32_t own_slot(const small_tile &t, const cell_grid &grid,
                                                    const small_search &s, bool real) {
  uint32_t found = 0;
  if (real) {
    const uint32_t index = t.index_of(cell_number(grid, s.place.at)), end = t.starts[index + 1];
    for (uint32_t slot = t.starts[index] + s.lane; slot < end; slot += s.lanes)
      if (t.ids[slot] == s.own) found = slot;
  }
  for (uint32_t step = 1; step < s.lanes; step *= 2)
    found = max(found, __shfl_xor_sync(~0u, found, (int)step));
  return found;
}

/* Lists what is near in the cells around a place, AHEAD candidates at a time; slots_in(cell, cells)
 * has the first slot of a run of cells, and above 16 bits its end. Each thread finds some runs for
 * all threads of its particle: to find a run takes longer than to look at its candidates. Those of
 * a warp call it together, with `real` for those that have a particle. */
template <uint32_t AHEAD, class Tile, class Slots>
static __device__ __forceinline__ void search_runs(const Tile &t, const cell_grid &grid,
                                                   const small_search &s, uint32_t own, bool real,
                                                   Slots slots_in, small_list *list) {
  const uint32_t runs = most_runs(grid), own_runs = real ? runs_around(grid, s.place) : 0;
  const auto slots_of = [&](uint32_t run) -> uint32_t {
    uint32_t cell, cells;
    if (run >= own_runs || !run_around(grid, s.place, run, &cell, &cells)) return 0;
    return slots_in(cell, cells);
  };
  uint32_t seen = 0;
  uint16_t *next = list->entries, *full = &list->at(list->max_size);
#pragma unroll 1
  for (uint32_t first = 0; first < runs; first += s.lanes) {
    const uint32_t mine = slots_of(first + s.lane);
#pragma unroll 1
    for (uint32_t run = 0; run < min(runs - first, s.lanes); ++run) {
      const uint32_t slots = __shfl_sync(~0u, mine, (int)run, (int)s.lanes);
      const uint32_t start = slots & 0xffff, end = slots >> 16;
      for (uint32_t slot = start + ((s.lane - seen) & (s.lanes - 1)); slot < end && next <= full;
           slot += AHEAD * s.lanes) {
        pbf_vec others[AHEAD]; /* some beyond the last slot: whatever is there */
#pragma unroll
        for (uint32_t q = 0; q < AHEAD; ++q) others[q] = position_in(t, slot + q * s.lanes);
#pragma unroll
        for (uint32_t q = 0; q < AHEAD; ++q) {
          const uint32_t candidate = slot + q * s.lanes;
          const bool counts = s.is_near(others[q]) && candidate < end && candidate != own;
          *next = (uint16_t)candidate;
          next += counts ? SMALL_THREADS : 0;
        }
      }
      seen += end - start;
    }
  }
  list->size = (uint32_t)(next - list->entries) / SMALL_THREADS;
}

static __device__ __forceinline__ void search_tile(const small_tile &t, const cell_grid &grid,
                                                   const small_search &s, uint32_t own, bool real,
                                                   small_list *list) {
  const auto slots_in = [&](uint32_t cell, uint32_t cells) {
    const uint32_t index = t.index_of(cell);
    return t.starts[index] | (uint32_t)t.starts[index + cells] << 16;
  };
  search_runs<4>(t, grid, s, own, real, slots_in, list);
  if (list->size > list->max_size) return;
  for (uint32_t k = 0; k < list->size; ++k) t.used[list->at(k)] = 1;
}

/* The same neighbours in the same order, as particles; returns the list's size. */
static __device__ __noinline__ uint32_t search_memory(const small_buffers &buffers, uint32_t shift,
                                                      const ulonglong2 *predicted,
                                                      const cell_grid &grid, const small_search s,
                                                      small_list list) {
  uint16_t sorted[SMALL_CELL_CAPACITY];
  uint32_t seen = 0;
  for (uint32_t run = 0, runs = runs_around(grid, s.place); run < runs; ++run) {
    uint32_t cell, cells;
    if (!run_around(grid, s.place, run, &cell, &cells)) continue;
    for (uint32_t end = cell + cells; cell < end; ++cell) {
      const uint16_t *particles = buffers.cell_list + (size_t)cell * SMALL_CELL_CAPACITY;
      uint32_t count = listed_in(buffers, cell, shift);
      for (uint32_t k = 0; k < count; ++k) insert(sorted, k, particles[k]);
      for (uint32_t k = 0; k < count; ++k, ++seen) {
        uint32_t particle = sorted[k];
        if ((seen & (s.lanes - 1)) != s.lane || particle == s.own || list.size > list.max_size)
          continue;
        if (s.is_near(ready_position(predicted, particle)))
          list.at(list.size++) = (uint16_t)particle;
      }
    }
  }
  return list.size;
}

/* ---- Neighbours in a pass -------------------------------------------------------------------- */

/* Where a thread finds what it needs of its neighbours; the first SMALL_KEPT are in registers. */
struct small_neighbors {
  const small_tile &tile;
  const particle_exchange &exchange;
  small_list list;
  uint32_t slot;  /* the particle's own */
  bool in_memory; /* the same in all threads of the block */
  uint32_t kept[SMALL_KEPT / 2];

  __device__ __forceinline__ void keep() {
    uint32_t sentinel = in_memory ? (uint32_t)SMALL_NO_PARTICLE : tile.sentinel_index();
    list.fill_up(sentinel);
#pragma unroll
    for (uint32_t k = 0; k < SMALL_KEPT / 2; ++k) {
      uint32_t low = 2 * k < list.size ? list.at(2 * k) : sentinel;
      uint32_t high = 2 * k + 1 < list.size ? list.at(2 * k + 1) : sentinel;
      kept[k] = low | high << 16;
    }
  }

  /* Entries k … k + 3 of those. */
  __device__ __forceinline__ void kept_chunk(uint32_t k, uint32_t (&some)[SMALL_CHUNK]) const {
#pragma unroll
    for (uint32_t q = 0; q < SMALL_CHUNK; ++q)
      some[q] = q % 2 ? kept[(k + q) / 2] >> 16 : kept[(k + q) / 2] & 0xffff;
  }

  __device__ __forceinline__ void positions(const uint32_t (&entries)[SMALL_CHUNK], uint32_t pass,
                                            pbf_vec (&x)[SMALL_CHUNK]) const {
    if (in_memory) {
      uint32_t particles[SMALL_CHUNK];
      for (int q = 0; q < SMALL_CHUNK; ++q)
        particles[q] = entries[entries[q] == SMALL_NO_PARTICLE ? 0 : q];
      await_positions(exchange, particles, pass, x);
#pragma unroll
      for (int q = 0; q < SMALL_CHUNK; ++q)
        if (entries[q] == SMALL_NO_PARTICLE) x[q] = position_in(tile, tile.sentinel_index());
      return;
    }
#pragma unroll
    for (int q = 0; q < SMALL_CHUNK; ++q) x[q] = position_in(tile, entries[q]);
  }

  __device__ __forceinline__ void lambdas(const uint32_t (&entries)[SMALL_CHUNK], uint32_t pass,
                                          pbf_real (&values)[SMALL_CHUNK]) const {
    if (in_memory) {
      uint32_t particles[SMALL_CHUNK];
      for (int q = 0; q < SMALL_CHUNK; ++q)
        particles[q] = entries[entries[q] == SMALL_NO_PARTICLE ? 0 : q];
      await_lambdas(exchange, particles, pass, values);
      return; /* what fills up a chunk has no slope */
    }
#pragma unroll
    for (int q = 0; q < SMALL_CHUNK; ++q) values[q] = tile.lambdas[entries[q]];
  }
};

/* The pairs of a thread, from an iteration's lambda to its move: what the move needs of the first
 * SMALL_KEPT, but for the other's lambda, stays in registers. */
template <int FEATURES>
struct small_pairs {
  typedef lambda_pass<fixed<FEATURES>, SCALED_SUMS> lambdas;
  typedef move_pass_of<fixed<FEATURES>, SCALED_SUMS> moves;
  lane_vector<pbf_real> gradients[SMALL_KEPT]; /* V grad W, but for its scale */
  move_sums<pbf_real> change;

  /* Adds the neighbours to the sums of lambda, and what is known of it to the change. */
  __device__ __forceinline__ void meet(const lambdas &of_lambda, const moves &of_move,
                                       const small_neighbors &n, pbf_vec x, uint32_t pass,
                                       lambda_sums<pbf_real> *sums) {
    uint32_t entries[SMALL_CHUNK];
    pbf_vec others[SMALL_CHUNK];
#pragma unroll
    for (uint32_t k = 0; k < SMALL_KEPT; k += SMALL_CHUNK) {
      if (k >= n.list.size) break;
      n.kept_chunk(k, entries);
      n.positions(entries, pass, others);
#pragma unroll
      for (uint32_t q = 0; q < SMALL_CHUNK; ++q) {
        const auto j = neighbor_between(x, others[q]);
        const auto w = of_lambda.pair(sums, {}, j);
        gradients[k + q] = j.x_ij;
        gradients[k + q].scale(w.slope);
        of_move.add_artificial_pressure(&change, of_lambda.c->value_scale * w.value,
                                        gradients[k + q]);
      }
    }
    for (uint32_t k = SMALL_KEPT; k < n.list.size; k += SMALL_CHUNK) {
      n.list.chunk(k, entries);
      n.positions(entries, pass, others);
#pragma unroll
      for (uint32_t q = 0; q < SMALL_CHUNK; ++q)
        of_lambda.pair(sums, {}, neighbor_between(x, others[q]));
    }
  }

  /* Adds the rest to the change. */
  __device__ __forceinline__ void move(const moves &of_move, const small_neighbors &n, pbf_vec x,
                                       pbf_real lambda, uint32_t pass) {
    uint32_t entries[SMALL_CHUNK];
    pbf_vec others[SMALL_CHUNK];
    pbf_real lambdas[SMALL_CHUNK];
#pragma unroll
    for (uint32_t k = 0; k < SMALL_KEPT; k += SMALL_CHUNK) {
      if (k >= n.list.size) break;
      n.kept_chunk(k, entries);
      n.lambdas(entries, pass, lambdas);
#pragma unroll
      for (uint32_t q = 0; q < SMALL_CHUNK; ++q)
        of_move.add_lambdas(&change, lambda + lambdas[q], gradients[k + q]);
    }
    for (uint32_t k = SMALL_KEPT; k < n.list.size; k += SMALL_CHUNK) {
      n.list.chunk(k, entries);
      n.positions(entries, pass, others);
      n.lambdas(entries, pass, lambdas);
#pragma unroll
      for (uint32_t q = 0; q < SMALL_CHUNK; ++q) {
        auto j = neighbor_between(x, others[q]);
        j.number = lambdas[q];
        of_move.pair(&change, {lambda}, j);
      }
    }
  }
};

#endif
