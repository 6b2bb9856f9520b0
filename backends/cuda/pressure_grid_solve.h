/* Part of solver.h: the solve of the pressure grid, by blocks that each have a run of its nodes. Up
 * to as many as fit there, lambda is in the shared memory of one block or of a cluster, and blocks
 * hand on what their neighbours need: an iteration waits for shared memory alone. Larger grids are
 * in memory, and their blocks meet at a barrier of all. */
#ifndef PBF_CUDA_PRESSURE_GRID_SOLVE_H
#define PBF_CUDA_PRESSURE_GRID_SOLVE_H

#include <cooperative_groups.h>

#include "cuda/pressure_grid.h"

enum { PRESSURE_GRID_THREADS = 512 };

/* A block's nodes first … end - 1, in `size` indices: all have the same. Nodes that are farther
 * apart than `reach` have no cell in common. */
struct pressure_grid_part {
  uint32_t first, end, size, reach;
};

static inline __host__ __device__ uint32_t pressure_grid_reach(const pbf_pressure_grid &grid) {
  return grid.corner[PBF_CORNERS - 1];
}

/* So that a block's neighbours alone need its nodes. */
static inline __host__ __device__ uint32_t pressure_grid_part_size(uint32_t nodes, uint32_t blocks,
                                                                   uint32_t reach) {
  uint32_t size = (nodes + blocks - 1) / blocks;
  return size > reach ? size : reach;
}

/* Nodes at filled cells, as they are the only ones that may not be in the open. */
static __device__ __forceinline__ pressure_grid_part
pressure_grid_part_of(const pbf_pressure_grid &grid, const pbf_pressure_grid_extent &filled) {
  constexpr int axis = PBF_DIM - 1;
  uint32_t stride = grid.corner[1u << axis], reach = pressure_grid_reach(grid);
  uint32_t low = (uint32_t)grid.n[axis] + 1 - filled.below[axis], high = filled.above[axis] + 1;
  uint32_t first = low * stride + reach - stride, end = (high + 1) * stride;
  uint32_t size = pressure_grid_part_size(end - first, gridDim.x, reach);
  first += blockIdx.x * size;
  return {first, max(first, min(first + size, end)), size, reach};
}

/* Lists the block's nodes that are not in the open; returns how many. */
static __device__ __forceinline__ uint32_t list_inside(const pressure_grid_arrays &a,
                                                       const pressure_grid_part &part) {
  __shared__ uint32_t listed;
  uint32_t lane = threadIdx.x % 32;
  if (threadIdx.x == 0) listed = 0;
  __syncthreads();
  for (uint32_t base = part.first + threadIdx.x - lane; base < part.end;
       base += PRESSURE_GRID_THREADS) {
    uint32_t node = base + lane, before = 0;
    bool inside = node < part.end && a.inverse[node] > 0;
    uint32_t warp = __ballot_sync(~0u, inside);
    if (lane == 0) before = atomicAdd(&listed, (uint32_t)__popc(warp));
    before = __shfl_sync(~0u, before, 0) + (uint32_t)__popc(warp & ((1u << lane) - 1));
    if (inside) a.inside[part.first + before] = node;
  }
  __syncthreads();
  return listed;
}

/* The equation of a node. */
struct pressure_grid_equation {
  uint32_t node;
  double right, inverse, surface, around[PBF_CORNERS];
};

static __device__ __forceinline__ pressure_grid_equation equation_of(const pbf_pressure_grid &grid,
                                                                     const pressure_grid_arrays &a,
                                                                     uint32_t node) {
  pressure_grid_equation e;
  e.node = node;
  e.right = a.right[node];
  e.inverse = a.inverse[node];
  pbf_pressure_grid_around(&grid, a.free_volumes, node, e.around);
  e.surface = pbf_pressure_grid_surface_of(e.around, e.inverse);
  return e;
}

/* ---- Lambda in memory, for any number of blocks --------------------------------------------- */

struct pressure_grid_in_memory {
  static constexpr bool TORN = true;  /* whether there may be torn nodes */
  static constexpr uint32_t KEPT = 1; /* nodes of a thread with equations in registers */
  grid_counter *barrier;
  uint32_t meetings, misses;

  __device__ __forceinline__ pressure_grid_in_memory(const pressure_grid_arrays &a,
                                                     const pressure_grid_part &)
      : barrier(&a.control->barrier), meetings(0), misses(0) {}
  __device__ __forceinline__ uint32_t low() const { return 0; }
  __device__ __forceinline__ void begin(const pbf_pressure_grid &, const pressure_grid_arrays &a,
                                        double **now, double **before) const {
    *now = a.lambda;
    *before = a.before;
  }
  __device__ __forceinline__ void hand_on(double *, uint32_t, double) const {}
  __device__ __forceinline__ float *memory_behind() const {
    extern __shared__ double lambdas[];
    return reinterpret_cast<float *>(lambdas);
  }

  /* Whether a thread of any block misses; asked, or the answer is no. */
  __device__ __forceinline__ bool meet(bool asked, bool misses_here) {
    uint32_t before = misses;
    misses = grid_barrier(barrier, ++meetings, asked && misses_here);
    return misses != before;
  }

  __device__ __forceinline__ void end(const pressure_grid_arrays &a, const double *now,
                                      uint32_t) const {
    if (thread_index() == 0) a.control->odd = now == a.before;
  }
};

/* ---- In the shared memory of a cluster, or of one block ------------------------------------- */

#if !defined(__CUDA_ARCH__) || __CUDA_ARCH__ >= 900
template <class Value>
static __device__ __forceinline__ Value *in_block(Value *shared, uint32_t block) {
  return cooperative_groups::this_cluster().map_shared_rank(shared, block);
}
static __device__ __forceinline__ void meet_cluster() { cooperative_groups::this_cluster().sync(); }
#else /* a block is always alone */
template <class Value>
static __device__ __forceinline__ Value *in_block(Value *shared, uint32_t) {
  return shared;
}
static __device__ __forceinline__ void meet_cluster() {}
#endif

/* Nodes that a block keeps: its own, and so many more on each side as its neighbours hand on. */
static inline __host__ __device__ uint32_t pressure_grid_length(uint32_t size, uint32_t reach) {
  return size + 2 * reach;
}

struct pressure_grid_in_cluster {
  static constexpr bool TORN = false;
  static constexpr uint32_t KEPT = 3;
  pressure_grid_part part;
  uint32_t *misses; /* in shared memory: two that take turns */
  uint32_t asked_so_far;

  __device__ __forceinline__ pressure_grid_in_cluster(const pressure_grid_arrays &,
                                                      const pressure_grid_part &part)
      : part(part), asked_so_far(0) {
    __shared__ uint32_t shared_misses[2];
    misses = shared_misses;
  }
  __device__ __forceinline__ uint32_t low() const { return part.first - part.reach; }
  __device__ __forceinline__ void begin(const pbf_pressure_grid &grid,
                                        const pressure_grid_arrays &a, double **now,
                                        double **before) const {
    extern __shared__ double lambdas[];
    uint32_t length = pressure_grid_length(part.size, part.reach);
    *now = lambdas;
    *before = lambdas + length;
    for (uint32_t k = threadIdx.x; k < length; k += PRESSURE_GRID_THREADS) {
      double value = low() + k < grid.nodes ? a.lambda[low() + k] : 0;
      (*now)[k] = (*before)[k] = value;
    }
    if (threadIdx.x < 2) misses[threadIdx.x] = 0;
    if (gridDim.x == 1)
      __syncthreads();
    else
      meet_cluster();
  }

  /* Shared memory that lambda leaves. */
  __device__ __forceinline__ float *memory_behind() const {
    extern __shared__ double lambdas[];
    return reinterpret_cast<float *>(lambdas + 2 * pressure_grid_length(part.size, part.reach));
  }

  /* Lambda of the node at `at` of `lambda`, to the blocks that read it. */
  __device__ __forceinline__ void hand_on(double *lambda, uint32_t at, double value) const {
    if (at < 2 * part.reach && blockIdx.x > 0)
      in_block(lambda, blockIdx.x - 1)[at + part.size] = value;
    if (at >= part.size && blockIdx.x + 1 < gridDim.x)
      in_block(lambda, blockIdx.x + 1)[at - part.size] = value;
  }

  __device__ __forceinline__ bool meet(bool asked, bool misses_here) {
    if (gridDim.x == 1) return __syncthreads_or(asked && misses_here);
    uint32_t turn = asked_so_far % 2;
    if (asked) {
      bool any = __syncthreads_or(misses_here);
      if (any && threadIdx.x < gridDim.x) *in_block(misses + turn, threadIdx.x) = 1;
      if (threadIdx.x == 0) misses[1 - turn] = 0; /* long read, and not written before the next */
      ++asked_so_far;
    }
    meet_cluster();
    return asked && misses[turn];
  }

  __device__ __forceinline__ void end(const pressure_grid_arrays &a, const double *now,
                                      uint32_t count) const {
    for (uint32_t k = threadIdx.x; k < count; k += PRESSURE_GRID_THREADS) {
      uint32_t node = a.inside[part.first + k];
      a.lambda[node] = now[node - low()];
    }
  }
};

/* An iteration of the torn nodes, where there are some: lambda is in memory then. What another
 * thread reads in it is `now`. Whether one misses. */
static __device__ __forceinline__ bool relax_torn(const pbf_pressure_grid &grid,
                                                  const pressure_grid_arrays &a,
                                                  const pbf_pressure_grid_solve &solve,
                                                  const double *now, double *before) {
  const pbf_pressure_grid_topology *t = &a.topology;
  const uint32_t count = pbf_pressure_grid_torn_count(t);
  bool misses = false;
  for (uint32_t k = thread_index(); k < count; k += gridDim.x * PRESSURE_GRID_THREADS) {
    const double miss = pbf_pressure_grid_relax_torn(&grid, t, &solve, a.free_volumes, now, k);
    pbf_pressure_grid_end_torn(t, now, before, k);
    misses = misses || miss > solve.enough;
  }
  return misses;
}

/* ---- The iterations ------------------------------------------------------------------------- */

/* A block's nodes, and lambda there. */
template <class Lambda>
struct pressure_grid_iterations {
  const pbf_pressure_grid &grid;
  const pressure_grid_arrays &a;
  const pressure_grid_part part;
  const uint32_t count;
  Lambda lambda;
  double *now, *before;
  pressure_grid_equation kept[Lambda::KEPT];

  __device__ __forceinline__ pressure_grid_iterations(const pbf_pressure_grid &grid,
                                                      const pressure_grid_arrays &a)
      : grid(grid),
        a(a),
        part(pressure_grid_part_of(grid, a.control->extent)),
        count(list_inside(a, part)),
        lambda(a, part) {
    lambda.begin(grid, a, &now, &before);
#pragma unroll
    for (uint32_t q = 0; q < Lambda::KEPT; ++q) {
      uint32_t k = threadIdx.x + q * PRESSURE_GRID_THREADS;
      if (k < count) kept[q] = equation_of(grid, a, a.inside[part.first + k]);
    }
  }

  /* Calls visit(equation) for the thread's nodes. */
  template <class Visit>
  __device__ __forceinline__ void each(Visit visit) const {
#pragma unroll
    for (uint32_t q = 0; q < Lambda::KEPT; ++q)
      if (threadIdx.x + q * PRESSURE_GRID_THREADS < count) visit(kept[q]);
    for (uint32_t i = threadIdx.x + Lambda::KEPT * PRESSURE_GRID_THREADS; i < count;
         i += PRESSURE_GRID_THREADS)
      visit(equation_of(grid, a, a.inside[part.first + i]));
  }

  /* Iteration k; whether it has asked, and nothing was missing before. */
  __device__ __forceinline__ bool iterate(const pbf_pressure_grid_solve &solve, int k) {
    bool misses = false;
    each([&](const pressure_grid_equation &e) {
      uint32_t at = e.node - lambda.low();
      double residual = pbf_pressure_grid_residual(&grid, e.around, now, e.right, e.surface, at);
      double next = pbf_pressure_grid_next(&solve, residual, e.inverse, now[at], before[at]);
      misses = misses || pbf_pressure_grid_miss(residual, now[at]) > solve.enough;
      before[at] = next;
      lambda.hand_on(before, at, next);
    });
    if (Lambda::TORN) misses = relax_torn(grid, a, solve, now, before) || misses;
    const bool asks = pbf_pressure_grid_asks(k), over = !lambda.meet(asks, misses) && asks;
    double *other = now;
    now = before;
    before = other;
    return over;
  }
};

template <class Lambda>
static __global__ void __launch_bounds__(PRESSURE_GRID_THREADS)
    pressure_grid_solve_kernel(const __grid_constant__ pbf_pressure_grid grid,
                               const __grid_constant__ pressure_grid_arrays a) {
  await_launches_before();
  const pressure_grid_control *control = a.control;
  pbf_pressure_grid_solve solve = pbf_pressure_grid_solve_begin(
      pbf_pressure_grid_source_scale_of(&grid, &control->extent).longest,
      __longlong_as_double((long long)control->largest));
  if (solve.max_iterations == 0) return;
  pressure_grid_iterations<Lambda> iterations(grid, a);
  bool over = false;
  for (int k = 0; k < solve.max_iterations && !over; ++k) {
    pbf_pressure_grid_solve later = solve; /* found while others are waited for */
    pbf_pressure_grid_solve_go_on(&later, k);
    over = iterations.iterate(solve, k);
    solve = later;
  }
  iterations.lambda.end(a, iterations.now, iterations.count);
}

#endif
