/* Part of launches.h: building the neighbour lists. */
#ifndef PBF_CUDA_SEARCH_H
#define PBF_CUDA_SEARCH_H

#include "cuda/grid.h"
#include "cuda/launch.h"
#include "cuda/lists.h"
#include "cuda/sort.h"
#include "cuda/warp.h"

enum {
  SEARCH_BLOCK = 128, /* threads */
  SEARCH_WINDOW = 32  /* candidates, a bit each */
};

/* On a multiprocessor: fewer registers than the compiler would take. */
constexpr int SEARCH_BLOCKS = resident_blocks(10, SEARCH_BLOCK);

/* Shifts in from the right whether a number is negative. */
static __device__ __forceinline__ uint32_t shift_in_sign(uint32_t bits, float of) {
  return __funnelshift_l(__float_as_uint(of), bits, 1);
}

static __device__ __forceinline__ uint32_t shift_in_sign(uint32_t bits, double of) {
  return __funnelshift_l((uint32_t)__double2hiint(of), bits, 1);
}

/* Negative where a and b are nearer than h. */
static __device__ __forceinline__ pbf_real beyond_h(pbf_vec a, pbf_vec b, pbf_real h2) {
  pbf_real error_units = -h2;
  for (int k = 0; k < PBF_DIM; ++k) error_units += (a.c[k] - b.c[k]) * (a.c[k] - b.c[k]);
  return error_units;
}

/* Which of `count` candidates are near x, at most SEARCH_WINDOW: bit 31 for the first, and so on.
 * No store and no branch depends on a single candidate. Reads up to three beyond the last. */
static __device__ __forceinline__ uint32_t near_among(const point *candidates, uint32_t count,
                                                      pbf_vec x, pbf_real h2) {
  uint32_t near = 0;
  for (int rest = (int)count; rest > 0; rest -= 4, candidates += 4) {
#pragma unroll
    for (uint32_t q = 0; q < 4; ++q)
      near = shift_in_sign(near, beyond_h(x, position_of(load(candidates, q)), h2));
  }
  uint32_t left = SEARCH_WINDOW - count;
  return near << (left & ~3u) & ~0u << left;
}

/* A thread's list while it grows, in shared memory, entries SEARCH_BLOCK apart. */
struct growing_list {
  uint16_t *entries;
  uint32_t next, end;
  bool fits;

  __device__ __forceinline__ growing_list(uint16_t *block_entries, uint32_t chunks)
      : entries(block_entries),
        next(threadIdx.x),
        end(threadIdx.x + chunks * SEARCH_BLOCK),
        fits(true) {}

  __device__ __forceinline__ uint32_t size() const { return (next - threadIdx.x) / SEARCH_BLOCK; }

  /* `last` is the entry that bit 0 stands for. */
  __device__ __forceinline__ void add(uint32_t near, uint32_t last) {
    fits = next + (uint32_t)__popc(near) * SEARCH_BLOCK <= end;
    if (!fits) return;
    while (near) {
      uint32_t bit = 31 - (uint32_t)__clz((int)near);
      near ^= 1u << bit;
      entries[next] = (uint16_t)(last - bit);
      next += SEARCH_BLOCK;
    }
  }

  /* Adds the particles near x among start … end - 1, all but `own`; `entry` is that of `start`. */
  __device__ __forceinline__ void add_row(const point *points, uint32_t start, uint32_t row_end,
                                          uint32_t own, pbf_vec x, pbf_real h2, uint32_t entry) {
    for (; start < row_end && fits; start += SEARCH_WINDOW, entry += SEARCH_WINDOW) {
      uint32_t count = min(row_end - start, (uint32_t)SEARCH_WINDOW);
      uint32_t near = near_among(points + start, count, x, h2);
      if (own - start < SEARCH_WINDOW) near &= ~(0x80000000u >> (own - start));
      add(near, entry + SEARCH_WINDOW - 1);
    }
  }

  __device__ __forceinline__ uint32_t entry(uint32_t k) const {
    return k < size() ? entries[threadIdx.x + k * SEARCH_BLOCK] : (uint32_t)PBF_NOWHERE;
  }

  /* At least a chunk: readers ask for the first one before they know the size. */
  __device__ __forceinline__ void write(uint4 *chunk) const {
    for (uint32_t k = 0; k == 0 || k < size(); k += PBF_CHUNK, chunk += 32)
      *chunk = {entry(k) | entry(k + 1) << 16, entry(k + 2) | entry(k + 3) << 16,
                entry(k + 4) | entry(k + 5) << 16, entry(k + 6) | entry(k + 7) << 16};
  }
};

/* Bytes of shared memory of a block of list_kernel. */
static inline size_t list_shared(uint32_t chunks) {
  return (size_t)chunks * PBF_CHUNK * SEARCH_BLOCK * sizeof(uint16_t);
}

static inline uint32_t list_blocks(uint32_t count) {
  return (count + SEARCH_BLOCK - 1) / SEARCH_BLOCK;
}

/* Particles start … end - 1 of a row. */
struct row_part {
  uint32_t start, end;
};

/* What a particle reaches of a row beyond the nearer face along it, which is periodic. */
static __device__ __forceinline__ row_part part_beyond(const sorted_particles &p,
                                                       const cell_grid &grid, const grid_view &view,
                                                       int row) {
  uint32_t first, last;
  if (!grid_reaches_beyond(grid, view)) return {0, 0};
  if (!grid_reach(grid, grid_view_beyond(grid, view), row, &first, &last)) return {0, 0};
  return {p.cell_start[first], p.cell_start[last + 1]};
}

/* What some lanes reach of a row between `lowest` and `highest` may be too far from the base that
 * all have in common: beyond a periodic face. They get one more of the warp's bases, and the code
 * that stands for it, until there are no more. All lanes call it. */
static __device__ __forceinline__ void take_far_rows(const neighbor_lists &lists, uint32_t i,
                                                     uint32_t lowest, uint32_t highest,
                                                     uint32_t *far_rows, uint32_t *base,
                                                     uint32_t *code) {
  for (; *far_rows < PBF_FAR_ROWS; ++*far_rows) {
    const bool is_far = lowest < highest && highest - *base > PBF_PLACES;
    if (!__any_sync(~0u, is_far)) return;
    const uint32_t far_base = min_of_lanes(~0u, is_far ? lowest : ~0u);
    if (threadIdx.x % 32 == 0) lists.far_bases[i / 32 * PBF_FAR_ROWS + *far_rows] = far_base;
    if (is_far) *base = far_base;
    if (is_far) *code = PBF_ROWS + 1 + *far_rows;
  }
}

/* Which particles get a list. The sleeping boundary (physics/sleep.h) is known once the awake have
 * theirs; a warp's lists have their bases in common, so that it gets them together. */
enum searchers { SEARCH_ALL, SEARCH_AWAKE, SEARCH_SLEEPING_BOUNDARY };

/* PERIODIC: some axis is. */
template <searchers WHICH, bool PERIODIC>
static __global__ void __launch_bounds__(SEARCH_BLOCK, SEARCH_BLOCKS)
    list_kernel(sorted_particles p, cell_grid grid, pbf_real h2, neighbor_lists lists) {
  extern __shared__ uint16_t growing[];
  uint32_t i = own_index(p), lane = threadIdx.x % 32;
  if (i - lane >= p.count) return;
  bool real = i < p.count;
  growing_list list(growing, lists.chunks * PBF_CHUNK);
  pbf_real activity = WHICH != SEARCH_ALL && real ? p.activity[i] : (pbf_real)PBF_ASLEEP;
  bool looks = real && (WHICH == SEARCH_ALL || !pbf_is_asleep(activity));
  if (WHICH == SEARCH_SLEEPING_BOUNDARY) {
    if (!__any_sync(~0u, activity == pbf_sleeping_boundary())) return;
    looks = !pbf_is_inactive(activity);
  }
  /* The other lists are empty. */
  if (WHICH == SEARCH_AWAKE && !__any_sync(~0u, looks)) {
    if (real) list.write(list_of(lists, i));
    if (real) lists.sizes[i] = 0;
    return;
  }
  pbf_vec x = position_of(load(p.points, real ? i : p.count - 1));
  grid_view view = grid_look(grid, x);
  /* A row's bounds are asked for while the row before is looked through. */
  auto bounds = [&](int row, uint32_t *start, uint32_t *end) {
    uint32_t first, last;
    bool some = looks && grid_reach(grid, view, row, &first, &last);
    *start = some ? p.cell_start[first] : 0;
    *end = some ? p.cell_start[last + 1] : 0;
  };
  uint32_t next_start, next_end;
  bounds(0, &next_start, &next_end);
  uint32_t far_rows = 0;
#pragma unroll 1
  for (int row = 0; row < PBF_ROWS; ++row) {
    uint32_t start = next_start, end = next_end;
    if (row + 1 < PBF_ROWS) bounds(row + 1, &next_start, &next_end);
    uint32_t lowest = start < end ? start : ~0u, highest = start < end ? end : 0;
    if (PERIODIC && grid.period.c[0] > 0) {
      const row_part beyond = looks ? part_beyond(p, grid, view, row) : row_part{0, 0};
      if (beyond.start < beyond.end) lowest = min(lowest, beyond.start);
      if (beyond.start < beyond.end) highest = max(highest, beyond.end);
      __syncwarp();
    }
    uint32_t base = min_of_lanes(~0u, lowest), code = (uint32_t)row;
    if (lane == 0) lists.bases[i / 32 * PBF_ROWS + row] = base;
    if (PERIODIC) take_far_rows(lists, i, lowest, highest, &far_rows, &base, &code);
    if (start < end && end - base > PBF_PLACES) list.fits = false;
    const pbf_vec from = PERIODIC ? grid_image(grid, view, row, x) : x;
    list.add_row(p.points, start, end, i, from, h2, (code << PBF_PLACE_BITS) + start - base);
    if (PERIODIC && grid.period.c[0] > 0 && looks) {
      const row_part beyond = part_beyond(p, grid, view, row);
      pbf_vec seen = from;
      seen.c[0] += 2 * view.along < grid.period.c[0] ? grid.period.c[0] : -grid.period.c[0];
      if (beyond.start < beyond.end && beyond.end - base > PBF_PLACES) list.fits = false;
      list.add_row(p.points, beyond.start, beyond.end, i, seen, h2,
                   (code << PBF_PLACE_BITS) + beyond.start - base);
    }
    __syncwarp();
  }
  if (PERIODIC && lane >= far_rows && lane < PBF_FAR_ROWS)
    lists.far_bases[i / 32 * PBF_FAR_ROWS + lane] = 0;
  if (!real) return;
  lists.sizes[i] = list.fits ? (uint8_t)list.size() : (uint8_t)PBF_WALKS;
  list.write(list_of(lists, i));
}

#endif
