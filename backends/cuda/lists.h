/* Neighbour lists: 16 bits a neighbour, row and place in the row. A row's places count from the
 * lowest one that the 32 particles of a warp reach in it, so that they stay small. Lists of a warp
 * interleave in chunks of eight neighbours, 16 bytes a particle. A list that does not fit its room
 * is marked, and its particle walks the cells instead: nothing is cut. */
#ifndef PBF_CUDA_LISTS_H
#define PBF_CUDA_LISTS_H

#include "cuda/grid.h"
#include "cuda/launch.h"
#include "cuda/particles.h"

enum {
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

/* Collects neighbours, two a word, and writes full chunks. */
struct list_writer {
  uint4 *chunk, *end;
  uint32_t word = 0, size = 0;
  uint4 words = {0, 0, 0, 0};
  bool fits = true;

  __device__ __forceinline__ void add(uint32_t entry) {
    word = __byte_perm(word, entry, 0x5432); /* the older one low */
    if (++size % 2) return;
    words = {words.y, words.z, words.w, word};
    if (size % PBF_CHUNK) return;
    if (chunk < end)
      *chunk = words;
    else
      fits = false;
    chunk += 32;
  }
};

/* Which of the particles first … first + count - 1, at most 32, are near x. Four at a time, reading
 * up to three beyond the last. */
static __device__ __forceinline__ uint32_t near_mask(const point *points, uint32_t first,
                                                     uint32_t count, pbf_vec x, pbf_real h2) {
  uint32_t mask = 0;
  for (uint32_t k = 0; k < count; k += 4) {
    uint32_t four = 0;
#pragma unroll
    for (uint32_t q = 0; q < 4; ++q) {
      pbf_vec d = pbf_sub(x, position_of(load(points, first + k + q)));
      if (pbf_dot(d, d) < h2) four |= 1u << q;
    }
    mask |= four << k;
  }
  return count < 32 ? mask & ((1u << count) - 1) : mask;
}

static __global__ void __launch_bounds__(PBF_BLOCK)
    list_kernel(sorted_particles p, cell_grid grid, pbf_real h2, neighbor_lists lists) {
  __shared__ uint32_t starts[PBF_ROWS][PBF_BLOCK], ends[PBF_ROWS][PBF_BLOCK];
  uint32_t i = thread_index(), lane = threadIdx.x % 32;
  if (i - lane >= p.count) return;
  bool real = i < p.count;
  pbf_vec x = position_of(load(p.points, real ? i : p.count - 1));
  grid_view view = grid_look(grid, x);
  /* All rows' bounds first: independent loads. */
#pragma unroll
  for (int row = 0; row < PBF_ROWS; ++row) {
    uint32_t first, last;
    bool some = real && grid_reach(grid, view, row, &first, &last);
    starts[row][threadIdx.x] = some ? p.cell_start[first] : 0;
    ends[row][threadIdx.x] = some ? p.cell_start[last + 1] : 0;
  }
  list_writer list;
  list.chunk = list_of(lists, i);
  list.end = list.chunk + (size_t)lists.chunks * 32;
  for (int row = 0; row < PBF_ROWS; ++row) {
    uint32_t start = starts[row][threadIdx.x], end = ends[row][threadIdx.x];
    uint32_t base = __reduce_min_sync(~0u, start < end ? start : ~0u);
    if (lane == 0) lists.bases[i / 32 * PBF_ROWS + row] = base;
    if (start < end && end - base > PBF_PLACES) list.fits = false;
    for (; start < end; start += 32) {
      uint32_t mask = near_mask(p.points, start, min(end - start, 32u), x, h2);
      if (i - start < 32) mask &= ~(1u << (i - start));
      uint32_t entry = ((uint32_t)row << PBF_PLACE_BITS) + start - base - 1;
      while (mask) {
        list.add(entry + (uint32_t)__ffs((int)mask));
        mask &= mask - 1;
      }
    }
    __syncwarp();
  }
  if (!real) return;
  uint32_t size = list.size;
  while (list.size % PBF_CHUNK) list.add(PBF_NOWHERE);
  lists.sizes[i] = list.fits && size < PBF_WALKS ? (uint8_t)size : (uint8_t)PBF_WALKS;
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
