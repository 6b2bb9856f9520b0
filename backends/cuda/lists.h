/* Neighbour lists: 16 bits a neighbour, row and place in the row. A row's places count from the
 * lowest one that the 32 particles of a warp reach in it, so that they stay small. Lists of a warp
 * interleave in chunks of eight neighbours, 16 bytes a particle. A list that does not fit its room
 * is marked, and its particle walks the cells instead: nothing is cut. */
#ifndef PBF_CUDA_LISTS_H
#define PBF_CUDA_LISTS_H

#include "cuda/grid.h"
#include "cuda/launch.h"
#include "cuda/particles.h"
#include "cuda/sort.h"

enum {
  LIST_BLOCK = 128, /* threads that build lists */
  PBF_PLACE_BITS = 12,
  PBF_PLACES = 1 << PBF_PLACE_BITS,
  PBF_CHUNK = 8,   /* neighbours */
  PBF_WALKS = 255, /* list size that says: walk the cells */
  PBF_MOST_LISTED = 128,
  PBF_NOWHERE = PBF_ROWS << PBF_PLACE_BITS /* fills up a chunk: the particle far from everything */
};

struct neighbor_lists {
  uint4 *entries;
  uint8_t *sizes;
  uint32_t *bases; /* PBF_ROWS a warp */
  uint32_t chunks; /* room of a list */
  uint32_t nowhere;
};

static __device__ __forceinline__ uint4 *list_of(const neighbor_lists &lists, uint32_t i) {
  return lists.entries + (size_t)(i / 32) * lists.chunks * 32 + i % 32;
}

/* A thread's list while it grows, in shared memory, entries LIST_BLOCK apart. Places are kept as
 * distances from the block's first entry: what is added up is the address itself. */
struct growing_list {
  uint16_t *entries;
  uint32_t begin, next, last; /* `last`: from where on there is no room for four more */
  bool fits;

  __device__ __forceinline__ growing_list(uint16_t *block_entries, uint32_t room)
      : entries(block_entries),
        begin(threadIdx.x),
        next(threadIdx.x),
        last(threadIdx.x + (room - 4) * LIST_BLOCK),
        fits(true) {}

  __device__ __forceinline__ uint32_t size() const { return (next - begin) / LIST_BLOCK; }

  /* Adds the particles near x among start … end - 1, with OWN all but `own`; `entry` is that of
   * `start`. Four at a time, reading up to three beyond the last. Every entry is written, and only
   * those that count are not written over: no branch in which the threads of a warp part. */
  template <bool OWN>
  __device__ __forceinline__ void add_row(const point *points, uint32_t start, uint32_t end,
                                          uint32_t own, pbf_vec x, pbf_real h2, uint32_t entry) {
    for (uint32_t j = start; j < end; j += 4, entry += 4) {
      if (next > last) {
        fits = false;
        return;
      }
#pragma unroll
      for (uint32_t q = 0; q < 4; ++q) {
        pbf_vec d = pbf_sub(x, position_of(load(points, j + q)));
        entries[next] = (uint16_t)(entry + q);
        if (pbf_dot(d, d) < h2 && j + q < end && !(OWN && j + q == own)) next += LIST_BLOCK;
      }
    }
  }

  __device__ __forceinline__ uint32_t entry(uint32_t k) const {
    return k < size() ? entries[begin + k * LIST_BLOCK] : (uint32_t)PBF_NOWHERE;
  }

  __device__ __forceinline__ void write(uint4 *chunk) const {
    for (uint32_t k = 0; k < size(); k += PBF_CHUNK, chunk += 32)
      *chunk = {entry(k) | entry(k + 1) << 16, entry(k + 2) | entry(k + 3) << 16,
                entry(k + 4) | entry(k + 5) << 16, entry(k + 6) | entry(k + 7) << 16};
  }
};

/* Bytes of shared memory of a block of list_kernel. */
static inline size_t list_shared(uint32_t chunks) {
  return (size_t)chunks * PBF_CHUNK * LIST_BLOCK * sizeof(uint16_t);
}

template <bool SLEEP>
static __global__ void __launch_bounds__(LIST_BLOCK)
    list_kernel(sorted_particles p, cell_grid grid, pbf_real h2, neighbor_lists lists) {
  extern __shared__ uint16_t growing[];
  __shared__ uint32_t starts[PBF_ROWS][LIST_BLOCK], ends[PBF_ROWS][LIST_BLOCK];
  uint32_t i = thread_index(), lane = threadIdx.x % 32;
  if (i - lane >= p.count) return;
  bool real = i < p.count;
  /* Who sleeps has an empty list. */
  bool looks = real && !(SLEEP && pbf_is_asleep(p.unrest[i]));
  if (SLEEP && !__any_sync(~0u, looks)) {
    if (real) lists.sizes[i] = 0;
    return;
  }
  pbf_vec x = position_of(load(p.points, real ? i : p.count - 1));
  grid_view view = grid_look(grid, x);
  /* All rows' bounds first: independent loads. */
#pragma unroll
  for (int row = 0; row < PBF_ROWS; ++row) {
    uint32_t first, last;
    bool some = looks && grid_reach(grid, view, row, &first, &last);
    starts[row][threadIdx.x] = some ? p.cell_start[first] : 0;
    ends[row][threadIdx.x] = some ? p.cell_start[last + 1] : 0;
  }
  growing_list list(growing, lists.chunks * PBF_CHUNK);
  for (int row = 0; row < PBF_ROWS; ++row) {
    uint32_t start = starts[row][threadIdx.x], end = ends[row][threadIdx.x];
    uint32_t base = __reduce_min_sync(~0u, start < end ? start : ~0u);
    if (lane == 0) lists.bases[i / 32 * PBF_ROWS + row] = base;
    if (start < end && end - base > PBF_PLACES) list.fits = false;
    uint32_t entry = ((uint32_t)row << PBF_PLACE_BITS) + start - base;
    if (row == PBF_ROWS / 2 && list.fits)
      list.add_row<true>(p.points, start, end, i, x, h2, entry);
    else if (list.fits)
      list.add_row<false>(p.points, start, end, i, x, h2, entry);
    __syncwarp();
  }
  if (!real) return;
  lists.sizes[i] = list.fits ? (uint8_t)list.size() : (uint8_t)PBF_WALKS;
  if (list.fits) list.write(list_of(lists, i));
}

/* Calls visit(j) for all particles in the cells around particle i's. */
template <class Visit>
static __device__ __forceinline__ void walk_cells(const sorted_particles &p, const cell_grid &grid,
                                                  uint32_t i, Visit visit) {
  uint32_t cell = p.cells[i], first, last;
  for (int row = 0; row < PBF_ROWS; ++row) {
    if (!grid_reach_of_cell(grid, cell, row, &first, &last)) continue;
    uint32_t end = p.cell_start[last + 1];
    for (uint32_t j = p.cell_start[first]; j < end; ++j)
      if (j != i) visit(j);
  }
}

/* Calls visit(j) for the neighbours j of particle i, in sorted order, and maybe for some that are
 * farther than h. The threads of a warp call it with consecutive i and the same `count`. */
template <class Visit>
static __device__ __forceinline__ void for_neighbors(const sorted_particles &p,
                                                     const cell_grid &grid,
                                                     const neighbor_lists &lists, uint32_t i,
                                                     Visit visit) {
  __shared__ uint32_t shared_bases[PBF_BLOCK / 32][16];
  uint32_t *bases = shared_bases[threadIdx.x / 32], lane = threadIdx.x % 32;
  if (i - lane >= p.count) return;
  if (lane < PBF_ROWS) bases[lane] = lists.bases[i / 32 * PBF_ROWS + lane];
  if (lane == PBF_ROWS) bases[lane] = lists.nowhere;
  __syncwarp();
  if (i >= p.count) return;
  uint32_t size = lists.sizes[i];
  if (size == PBF_WALKS) return walk_cells(p, grid, i, visit);
  const uint4 *chunk = list_of(lists, i);
  for (uint32_t k = 0; k < size; k += PBF_CHUNK, chunk += 32) {
    uint4 words = *chunk;
    const uint32_t word[4] = {words.x, words.y, words.z, words.w};
#pragma unroll
    for (uint32_t q = 0; q < 4; ++q) {
      if (k + 2 * q >= size) break;
      uint32_t a = word[q] & 0xffff, b = word[q] >> 16;
      visit(bases[a >> PBF_PLACE_BITS] + a % PBF_PLACES);
      visit(bases[b >> PBF_PLACE_BITS] + b % PBF_PLACES);
    }
  }
}

#endif
