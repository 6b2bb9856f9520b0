/* Neighbour lists: 16 bits a neighbour, row and place in the row. A row's places count from the
 * lowest one that the 32 particles of a warp reach in it, so that they stay small; with periodic
 * axes some of them can reach a row at the domain's other end, which then counts as one more. Lists
 * of a warp interleave in chunks of eight neighbours, 16 bytes a particle. A list that does not fit
 * its room is marked, and its particle walks the cells instead: nothing is cut. */
#ifndef PBF_CUDA_LISTS_H
#define PBF_CUDA_LISTS_H

#include "cuda/grid.h"
#include "cuda/launch.h"
#include "cuda/particles.h"
#include "cuda/ptx.h"
#include "physics/constants.h"

enum {
  PBF_PLACE_BITS = 12,
  PBF_PLACES = 1 << PBF_PLACE_BITS,
  PBF_CHUNK = 8,   /* neighbours */
  PBF_WALKS = 255, /* list size that says: walk the cells */
  PBF_MAX_LISTED = 128,
  PBF_NOWHERE = PBF_ROWS << PBF_PLACE_BITS, /* fills up a chunk: the particle far from everything */
  PBF_ROW_CODES = 1 << (16 - PBF_PLACE_BITS),
  PBF_FAR_ROWS = PBF_ROW_CODES - PBF_ROWS - 1, /* by the codes after that of the particle */
  PBF_GATHERS = sizeof(pbf_real) == sizeof(float) ? 4 : 2 /* neighbours loaded at once */
};

struct neighbor_lists {
  uint4 *entries;
  uint8_t *sizes;
  uint32_t *bases;     /* PBF_ROWS a warp */
  uint32_t *far_bases; /* PBF_FAR_ROWS a warp where an axis is periodic, else null */
  uint32_t chunks;     /* room of a list */
  uint32_t sentinel_index;
};

static __device__ __forceinline__ uint4 *list_of(const neighbor_lists &lists, uint32_t i) {
  return lists.entries + (size_t)(i / 32) * lists.chunks * 32 + i % 32;
}

/* Calls visit(j) for all particles in the cells around particle i's; of `of` threads that share
 * them, each for its own. */
template <class Visit>
static __device__ __forceinline__ void walk_cells(const sorted_particles &p, const cell_grid &grid,
                                                  uint32_t i, Visit visit, int share = 0,
                                                  int of = 1) {
  uint32_t cell = p.cells[i], first, last;
  for (int row = share; row < PBF_ROWS; row += of) {
    if (!grid_reach_of_cell(grid, cell, row, &first, &last)) continue;
    for (bool beyond = false;; beyond = true) {
      uint32_t end = p.cell_start[last + 1];
      for (uint32_t j = p.cell_start[first]; j < end; ++j)
        if (j != i) visit(j);
      if (beyond || !grid_reach_beyond(grid, cell, &first, &last)) break;
    }
  }
}

/* The warp's bases less the row's bits of an entry, so that adding the entry gives the neighbour.
 * They are found by the bits themselves, for which those of a warp are aligned. */
struct alignas(PBF_ROW_CODES * sizeof(uint32_t)) row_bases {
  uint32_t of[PBF_ROW_CODES];
};

/* The neighbour that one half of a list's word stands for; `bases` in shared memory. */
static __device__ __forceinline__ uint32_t neighbor_at(uint32_t bases, uint32_t word, bool upper) {
  enum { ROW_SHIFT = PBF_PLACE_BITS - 2 }; /* of a row's bits, to where they count bytes */
  uint32_t row = word >> ((upper ? 16 : 0) + ROW_SHIFT) & 15 << 2;
  return load_shared(bases | row) + (upper ? word >> 16 : word & 0xffff);
}

/* Calls take(bases, word, count) for the words of particle i's list, four at a time, of whose
 * neighbours `count` are left; or visit(j) for all in the cells around where it has none. The
 * threads of a warp call it with consecutive i and the same p.count. SHARES warps of a block, the
 * first ones, can share the same particles. */
template <uint32_t SHARES, class Take, class Visit>
static __device__ __forceinline__ void for_chunks(const sorted_particles &p, const cell_grid &grid,
                                                  const neighbor_lists &lists, uint32_t i,
                                                  Take take, Visit visit) {
  __shared__ row_bases shared_bases[PBF_BLOCK / 32];
  uint32_t *bases = shared_bases[threadIdx.x / 32].of;
  const uint32_t lane = threadIdx.x % 32, share = SHARES > 1 ? threadIdx.x / 32 : 0;
  if (i - lane >= p.count) return;
  if (lane <= PBF_ROWS) {
    uint32_t base = lane < PBF_ROWS ? lists.bases[i / 32 * PBF_ROWS + lane] : lists.sentinel_index;
    bases[lane] = base - (lane << PBF_PLACE_BITS);
  } else if (lists.far_bases && lane < PBF_ROW_CODES) {
    uint32_t far_row = i / 32 * PBF_FAR_ROWS + lane - PBF_ROWS - 1;
    bases[lane] = lists.far_bases[far_row] - (lane << PBF_PLACE_BITS);
  }
  __syncwarp();
  if (i >= p.count) return;
  uint32_t shared = shared_address(bases);
  const uint4 *chunk = list_of(lists, i);
  uint4 ahead = *chunk; /* there is always a first one */
  uint32_t size = lists.sizes[i], first = PBF_CHUNK * share, stride = PBF_CHUNK * SHARES;
  if (size == PBF_WALKS) return walk_cells(p, grid, i, visit, (int)share, (int)SHARES);
  chunk += 32 * share;
  if (share > 0 && first < size) ahead = *chunk;
  for (uint32_t k = first; k < size; k += stride) {
    const uint32_t word[4] = {ahead.x, ahead.y, ahead.z, ahead.w};
    chunk += 32 * SHARES;
    if (k + stride < size) ahead = *chunk;
    take(shared, word, size - k);
  }
}

/* Calls visit(j) for the neighbours j of particle i, in sorted order, and maybe for some that are
 * farther than h. */
template <class Visit>
static __device__ __forceinline__ void for_neighbors(const sorted_particles &p,
                                                     const cell_grid &grid,
                                                     const neighbor_lists &lists, uint32_t i,
                                                     Visit visit) {
  for_chunks<1>(
      p, grid, lists, i,
      [&](uint32_t bases, const uint32_t word[4], uint32_t count) {
#pragma unroll
        for (uint32_t k = 0; k < PBF_CHUNK; k += 2) {
          if (k >= count) break;
          visit(neighbor_at(bases, word[k / 2], false));
          visit(neighbor_at(bases, word[k / 2], true));
        }
      },
      visit);
}

/* A walk through the cells meets all that are in them: right where what is farther than h adds
 * nothing. */
struct meets_all {
  __device__ __forceinline__ bool operator()(uint32_t) const { return true; }
};

/* A place that passes look up beside the points. */
struct start_point {
  point at;
};

static __device__ __forceinline__ start_point load(const start_point *starts, uint32_t i) {
  return {load(&starts->at, i)};
}

/* What is looked up, with its particle moved to an image. */
template <class Value>
static __device__ __forceinline__ Value value_moved(const Value &value, pbf_vec) {
  return value;
}
static __device__ __forceinline__ start_point value_moved(start_point start, pbf_vec by) {
  for (int k = 0; k < PBF_DIM; ++k) start.at.c[k] += by.c[k];
  return start;
}

/* Moves a point, and what is looked up with it, to the image nearest to x. */
template <class Value>
static __device__ __forceinline__ void move_near(const cell_grid &grid, pbf_vec x, point *other,
                                                 Value *value) {
  pbf_vec by = {{0}};
  for (int k = 0; k < PBF_DIM; ++k) {
    const pbf_real period = grid.period.c[k], half = (pbf_real)0.5 * period;
    const pbf_real apart = x.c[k] - other->c[k];
    if (period > 0) by.c[k] = apart > half ? period : apart < -half ? -period : 0;
    other->c[k] += by.c[k];
  }
  *value = value_moved(*value, by);
}

/* The same with visit(point, value), where `values` has one for each particle, and points are at
 * their image nearest to x: where IMAGES is false no axis may be periodic. What is far from
 * everything has i's own. A walk leaves out those that it does not meet. */
template <uint32_t SHARES = 1, bool IMAGES = true, class Value, class Visit,
          class Meets = meets_all>
static __device__ __forceinline__ void for_points_with(const sorted_particles &p,
                                                       const cell_grid &grid,
                                                       const neighbor_lists &lists, uint32_t i,
                                                       pbf_vec x, const Value *values, Visit visit,
                                                       Meets meets = {}) {
  for_chunks<SHARES>(
      p, grid, lists, i,
      [&](uint32_t bases, const uint32_t word[4], uint32_t count) {
#pragma unroll
        for (uint32_t k = 0; k < PBF_CHUNK; k += PBF_GATHERS) {
          if (k >= count) break;
          point near[PBF_GATHERS];
          Value value[PBF_GATHERS];
#pragma unroll
          for (uint32_t q = 0; q < PBF_GATHERS; ++q) {
            uint32_t j = neighbor_at(bases, word[(k + q) / 2], q % 2);
            near[q] = load(p.points, j);
            value[q] = load(values, j == lists.sentinel_index ? i : j);
          }
          if (IMAGES && grid.periodic) {
#pragma unroll
            for (uint32_t q = 0; q < PBF_GATHERS; ++q) move_near(grid, x, &near[q], &value[q]);
          }
#pragma unroll
          for (uint32_t q = 0; q < PBF_GATHERS; ++q) visit(near[q], value[q]);
        }
      },
      [&](uint32_t j) {
        if (!meets(j)) return;
        point near = load(p.points, j);
        Value value = load(values, j);
        if (IMAGES && grid.periodic) move_near(grid, x, &near, &value);
        visit(near, value);
      });
}

/* What every pass reads. */
struct neighborhood {
  sorted_particles particles;
  cell_grid grid;
  neighbor_lists lists;
  pbf_constants constants;
};

#endif
