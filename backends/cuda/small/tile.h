/* Part of search.h: a block's tile: the cells around its particles, and the particles in them, a
 * slot each, by cell and id, in shared memory. Each cell is read once a step, instead of once a
 * particle near it. */
#ifndef PBF_CUDA_SMALL_TILE_H
#define PBF_CUDA_SMALL_TILE_H

#include "cuda/small/scene.h"
#include "cuda/warp.h"

/* A block's dynamic shared memory. */
struct small_tile {
  small_position *positions; /* a slot each; the last is far from everything, and fills up chunks */
  float *lambdas;            /* a slot each */
  uint16_t *lists;           /* the threads' entries side by side */
  uint32_t *marks;           /* a bit each cell of the grid: it is in the tile */
  uint32_t *cells;           /* their numbers, ascending */
  uint16_t *before;          /* a word of marks each: cells of the tile that come before it */
  uint16_t *starts;          /* a cell of the tile each: its first slot; one more at the end */
  uint16_t *ids;             /* a slot each: the particle */
  uint16_t *ghosts;          /* slots of neighbours that other blocks own */
  uint8_t *used;             /* a slot each: it is in a list */
  small_layout layout;

  __device__ __forceinline__ uint32_t sentinel_index() const { return layout.slot_capacity; }
  __device__ __forceinline__ uint32_t index_of(uint32_t cell) const {
    uint32_t below = (1u << cell % 32) - 1;
    return before[cell / 32] + (uint32_t)__popc(marks[cell / 32] & below);
  }
};

static __device__ __forceinline__ small_tile tile_in(void *shared, const small_layout &layout) {
  small_tile t;
  size_t slots = (size_t)layout.slot_capacity + 2, words = ((size_t)layout.words + 1) / 2 * 2;
  t.layout = layout;
  t.positions = static_cast<small_position *>(shared);
  t.lambdas = reinterpret_cast<float *>(t.positions + slots);
  t.marks = reinterpret_cast<uint32_t *>(t.lambdas + slots);
  t.cells = t.marks + words;
  t.lists = reinterpret_cast<uint16_t *>(t.cells + layout.cell_capacity);
  t.before = t.lists + SMALL_THREADS * layout.list_capacity;
  t.starts = t.before + words;
  t.ids = t.starts + layout.cell_capacity + 2;
  t.ghosts = t.ids + slots;
  t.used = reinterpret_cast<uint8_t *>(t.ghosts + slots);
  return t;
}

static __device__ __forceinline__ pbf_vec position_in(const small_tile &t, uint32_t slot) {
  small_position p = t.positions[slot];
  pbf_vec x;
  for (int k = 0; k < PBF_DIM; ++k) x.c[k] = p.c[k];
  return x;
}

static __device__ __forceinline__ void set_position(const small_tile &t, uint32_t slot, pbf_vec x) {
  for (int k = 0; k < PBF_DIM; ++k) t.positions[slot].c[k] = (float)x.c[k];
}

/* ---- Cells ----------------------------------------------------------------------------------- */

/* A particle's cell: its column, and its indices across the rows. Where the domain has more columns
 * than the grid, they begin anew, and the run around a column at an end is in two pieces: turning
 * back, as in grid.h, would crowd the cells where it does, and tiles have little room. */
struct cell_place {
  uint32_t at[PBF_DIM];
};

static __device__ __forceinline__ pbf_real wrap_along(const cell_grid &g, pbf_real x) {
  pbf_real from = x - g.origin.c[0];
  return g.turn > 0 ? from - g.turn * floor(from / g.turn) : from;
}

static __device__ __forceinline__ cell_place place_in(const cell_grid &g, pbf_vec x) {
  cell_place own;
  own.at[0] = grid_column(g, wrap_along(g, x.c[0]));
  for (int k = 1; k < PBF_DIM; ++k) own.at[k] = grid_index(g, k, grid_coordinate(g, k, x.c[k]));
  return own;
}

static __device__ __forceinline__ uint32_t cell_number(const cell_grid &g, const uint32_t *at) {
  return grid_row(g, at) + at[0];
}

/* The most runs that any cell has around it. */
static __device__ __forceinline__ uint32_t most_runs(const cell_grid &g) {
  return g.turn > 0 ? 2 * PBF_ROWS : PBF_ROWS;
}

static __device__ __forceinline__ uint32_t runs_around(const cell_grid &g, const cell_place &own) {
  bool ends = own.at[0] == 0 || own.at[0] + 1 == g.cells[0];
  return g.turn > 0 && ends ? 2 * PBF_ROWS : PBF_ROWS;
}

/* The cells of run 0 … runs_around - 1 around `own`, one after the other; false when there are
 * none. The second pieces come after all rows. */
static __device__ __forceinline__ bool run_around(const cell_grid &g, const cell_place &own,
                                                  uint32_t run, uint32_t *first, uint32_t *cells) {
  uint32_t at[PBF_DIM], row = run % PBF_ROWS;
  at[0] = max(own.at[0], 1u) - 1;
  *cells = min(own.at[0] + 2, g.cells[0]) - at[0];
  if (run >= PBF_ROWS) {
    at[0] = own.at[0] == 0 ? g.cells[0] - 1 : 0;
    *cells = 1;
  }
  for (int k = 1; k < PBF_DIM; ++k) {
    at[k] = own.at[k] + row % 3 - 1;
    row /= 3;
    if (at[k] >= g.cells[k]) return false;
  }
  *first = cell_number(g, at);
  return true;
}

/* ---- Building the tile ----------------------------------------------------------------------- */

/* Sum of the values of the block's threads before this one; *total: of all. */
static __device__ __forceinline__ uint32_t scan_block(uint32_t value, uint32_t *total) {
  __shared__ uint32_t sums[SMALL_THREADS / 32];
  uint32_t lane = threadIdx.x % 32, warp = threadIdx.x / 32, end = value, before = 0;
  for (uint32_t step = 1; step < 32; step *= 2) {
    uint32_t other = __shfl_up_sync(~0u, end, step);
    if (lane >= step) end += other;
  }
  __syncthreads(); /* the sums of the last time have been read */
  if (lane == 31) sums[warp] = end;
  __syncthreads();
  *total = 0;
#pragma unroll
  for (uint32_t k = 0; k < SMALL_THREADS / 32; ++k) {
    if (k == warp) before = *total;
    *total += sums[k];
  }
  return before + end - value;
}

/* The words of marks that a block has set, one after the other. */
struct marked_words {
  uint32_t first, last; /* none if first > last */
};

static __device__ __forceinline__ void clear_marks(const small_tile &t, marked_words words) {
  for (uint32_t k = words.first + threadIdx.x; k <= words.last; k += SMALL_THREADS) t.marks[k] = 0;
}

static __device__ __forceinline__ void mark(uint32_t *word, uint32_t bits) {
  if ((*word & bits) != bits) atomicOr(word, bits);
}

/* Marks the cells around a particle, a run each of its threads at a time. */
static __device__ __forceinline__ marked_words mark_around(const small_tile &t,
                                                           const cell_grid &grid,
                                                           const cell_place &place, uint32_t lane,
                                                           uint32_t lanes) {
  marked_words words = {~0u, 0};
  for (uint32_t run = lane, runs = runs_around(grid, place); run < runs; run += lanes) {
    uint32_t first, cells;
    if (!run_around(grid, place, run, &first, &cells)) continue;
    unsigned long long bits = ((1ull << cells) - 1) << first % 32;
    mark(t.marks + first / 32, (uint32_t)bits);
    if (bits >> 32) mark(t.marks + first / 32 + 1, (uint32_t)(bits >> 32));
    words.first = min(words.first, first / 32);
    words.last = max(words.last, (first + cells - 1) / 32);
  }
  return words;
}

/* Adds to the block's words, which are in shared memory. A warp calls it together. */
static __device__ __forceinline__ void add_words(marked_words *all, marked_words words) {
  words.first = min_of_lanes(~0u, words.first);
  words.last = max_of_lanes(~0u, words.last);
  if (threadIdx.x % 32) return;
  atomicMin(&all->first, words.first);
  atomicMax(&all->last, words.last);
}

/* Numbers the marked cells; returns how many there are, more than there is room for or not. */
static __device__ __forceinline__ uint32_t number_cells(const small_tile &t, marked_words words) {
  uint32_t size = (words.last - words.first + SMALL_THREADS) / SMALL_THREADS;
  uint32_t first = words.first + threadIdx.x * size, end = min(first + size, words.last + 1);
  uint32_t sum = 0, count;
  for (uint32_t k = first; k < end; ++k) sum += (uint32_t)__popc(t.marks[k]);
  uint32_t next = scan_block(sum, &count);
  if (count > t.layout.cell_capacity) return count;
  for (uint32_t k = first; sum && k < end; ++k) {
    t.before[k] = (uint16_t)next;
    for (uint32_t bits = t.marks[k]; bits; bits &= bits - 1)
      t.cells[next++] = k * 32 + (uint32_t)__ffs((int)bits) - 1;
  }
  return count;
}

static __device__ __forceinline__ void sort_two(uint32_t *a, uint32_t *b) {
  uint32_t low = min(*a, *b);
  *b = max(*a, *b);
  *a = low;
}

/* Batcher's network for eight. */
static __device__ __forceinline__ void sort_eight(uint32_t (&v)[8]) {
  const int pairs[19][2] = {{0, 1}, {2, 3}, {4, 5}, {6, 7}, {0, 2}, {1, 3}, {4, 6},
                            {5, 7}, {1, 2}, {5, 6}, {0, 4}, {1, 5}, {2, 6}, {3, 7},
                            {2, 4}, {3, 5}, {1, 2}, {3, 4}, {5, 6}};
#pragma unroll
  for (int k = 0; k < 19; ++k) sort_two(&v[pairs[k][0]], &v[pairs[k][1]]);
}

/* Sorts a particle into the `count` that are there. */
static __device__ __forceinline__ void insert(uint16_t *sorted, uint32_t count, uint16_t particle) {
  for (; count > 0 && sorted[count - 1] > particle; --count) sorted[count] = sorted[count - 1];
  sorted[count] = particle;
}

/* Writes the particles that a cell lists, ascending; `head` has the first eight. */
static __device__ __forceinline__ void put_sorted(const uint16_t *list, uint32_t count, uint4 head,
                                                  uint16_t *to) {
  const uint32_t words[4] = {head.x, head.y, head.z, head.w};
  uint32_t some[8];
#pragma unroll
  for (uint32_t k = 0; k < 8; ++k)
    some[k] = k < count ? (k % 2 ? words[k / 2] >> 16 : words[k / 2] & 0xffff) : ~0u;
  sort_eight(some);
#pragma unroll
  for (uint32_t k = 0; k < 8; ++k)
    if (k < count) to[k] = (uint16_t)some[k];
  for (uint32_t k = 8; k < count; ++k) insert(to, k, list[k]);
}

/* Gives slots to the particles in the tile's cells; returns how many, more than there is room for
 * or not. */
static __device__ __forceinline__ uint32_t fill_slots(const small_tile &t,
                                                      const small_buffers &buffers, uint32_t shift,
                                                      uint32_t cell_count) {
  uint32_t slots = 0;
  for (uint32_t first = 0; first < cell_count; first += SMALL_THREADS) {
    uint32_t k = first + threadIdx.x, count = 0, total;
    uint4 head = {0, 0, 0, 0};
    const uint16_t *list = buffers.cell_list;
    if (k < cell_count) {
      list += (size_t)t.cells[k] * SMALL_CELL_CAPACITY;
      head = *reinterpret_cast<const uint4 *>(list); /* in flight together with the count */
      count = listed_in(buffers, t.cells[k], shift);
    }
    uint32_t start = slots + scan_block(count, &total);
    slots += total;
    if (slots > t.layout.slot_capacity) return slots;
    if (k >= cell_count) continue;
    t.starts[k] = (uint16_t)start;
    put_sorted(list, count, head, t.ids + start);
  }
  if (threadIdx.x == 0) t.starts[cell_count] = (uint16_t)slots;
  return slots;
}

/* Loads the predicted positions, four at a time under way. */
static __device__ __forceinline__ void load_slots(const small_tile &t, const ulonglong2 *predicted,
                                                  uint32_t slots) {
  for (uint32_t first = threadIdx.x; first < slots; first += 4 * SMALL_THREADS) {
    pbf_vec x[4];
#pragma unroll
    for (uint32_t q = 0; q < 4; ++q)
      x[q] = ready_position(predicted, t.ids[min(first + q * SMALL_THREADS, slots - 1)]);
#pragma unroll
    for (uint32_t q = 0; q < 4; ++q) {
      uint32_t slot = first + q * SMALL_THREADS;
      if (slot >= slots) break;
      set_position(t, slot, x[q]);
      t.used[slot] = 0;
    }
  }
}

/* Lists the used slots that others own as ghosts; *count was 0. */
static __device__ __forceinline__ void list_ghosts(const small_tile &t, uint32_t slots,
                                                   uint32_t *count) {
  uint32_t lane = threadIdx.x % 32;
  for (uint32_t first = 0; first < slots; first += SMALL_THREADS) {
    uint32_t slot = first + threadIdx.x, ghost = 0;
    bool used = slot < slots && t.used[slot];
    uint32_t all = __ballot_sync(~0u, used);
    if (lane == 0 && all) ghost = atomicAdd(count, (uint32_t)__popc(all));
    ghost = __shfl_sync(~0u, ghost, 0) + (uint32_t)__popc(all & ((1u << lane) - 1));
    if (used) t.ghosts[ghost] = (uint16_t)slot;
  }
}

#endif
