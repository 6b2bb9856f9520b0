/* Part of pressure_grid_host.h: the solve of a large pressure grid with corrections from coarser
 * levels (physics/pressure_grid/coarse.h). All blocks share a level, or one block has it, to which
 * a barrier of its own costs less. */
#ifndef PBF_CUDA_PRESSURE_GRID_LEVELS_H
#define PBF_CUDA_PRESSURE_GRID_LEVELS_H

#include "cuda/pressure_grid_solve.h"
#include "physics/pressure_grid/coarse.h"

enum {
  PRESSURE_GRID_LEVELS_FROM = 40, /* cells along an axis: fewer take less time without */
  PRESSURE_GRID_ALONE = 1024      /* indices of a level that one block has, at most */
};

struct pressure_grid_levels {
  int count;  /* 0: none */
  int shared; /* so many are shared by all blocks, the first one at least */
  pbf_coarse_level of[PBF_COARSE_LEVELS];
  float *memory; /* of all of them, */
  uint64_t words;
  pbf_coarse_level finest; /* the grid: what is missing is its right side */
  uint8_t *moves;          /* of its nodes: whether corrections move lambda there */
};

/* Numbers of the levels from l on, which lie one behind the other. */
static inline __host__ __device__ uint64_t words_of_levels(const pressure_grid_levels &levels,
                                                           int l) {
  return levels.words - (uint64_t)(levels.of[l].stencil - levels.memory);
}

/* The levels of a grid in the memory for them; none where they are not worth it, or too many. One
 * block has so many of them as fit into its shared memory. */
static inline pressure_grid_levels pressure_grid_levels_in(const pressure_grid_arrays &a,
                                                           const pbf_pressure_grid &grid,
                                                           uint32_t capacity, size_t max_shared) {
  pressure_grid_levels levels = {};
  const int *n = grid.n;
  float *next = levels.memory = a.coarse;
  const uint64_t room = pressure_grid_coarse_words(capacity);
  if (pbf_most_cells(n) < PRESSURE_GRID_LEVELS_FROM) return levels;
  levels.moves = a.moves;
  for (int k = 0; k < PBF_DIM; ++k) {
    levels.finest.n[k] = grid.n[k];
    levels.finest.stride[k] = grid.corner[1u << k];
  }
  levels.finest.nodes = grid.nodes;
  levels.finest.right = a.missing;
  while (pbf_most_cells(n) > PBF_COARSEST_CELLS && levels.count < PBF_COARSE_LEVELS) {
    pbf_coarse_level *level = &levels.of[levels.count++];
    *level = pbf_coarse_level_of(n);
    levels.words += level->length * (uint64_t)PBF_COARSE_ARRAYS;
    if (levels.words > room) return {};
    level->stencil = next;
    float **const arrays[] = {&level->inverse, &level->right, &level->now, &level->before};
    next += level->length * (uint64_t)PBF_STENCIL;
    for (float **array : arrays) {
      *array = next;
      next += level->length;
    }
    n = level->n;
  }
  levels.shared = 1;
  while (levels.of[levels.shared].nodes > PRESSURE_GRID_ALONE ||
         words_of_levels(levels, levels.shared) * sizeof(float) > max_shared)
    if (++levels.shared == levels.count) return {};
  return levels;
}

/* ---- Teams of threads ------------------------------------------------------------------------ */

/* All blocks, … */
struct shared_by_all {
  pressure_grid_in_memory *lambda;
  __device__ __forceinline__ uint32_t first() const { return thread_index(); }
  __device__ __forceinline__ uint32_t stride() const { return gridDim.x * PRESSURE_GRID_THREADS; }
  __device__ __forceinline__ void meet() const { lambda->meet(false, false); }
};

/* … or one. */
struct alone {
  __device__ __forceinline__ uint32_t first() const { return threadIdx.x; }
  __device__ __forceinline__ uint32_t stride() const { return PRESSURE_GRID_THREADS; }
  __device__ __forceinline__ void meet() const { __syncthreads(); }
};

template <class Team, class Visit>
static __device__ __forceinline__ void each_index(const Team &team, const pbf_coarse_level &level,
                                                  Visit visit) {
  for (uint32_t node = team.first(); node < level.nodes; node += team.stride()) visit(node);
}

/* Nodes that have an equation, and where they are along each axis. */
template <class Team, class Visit>
static __device__ __forceinline__ void each_place(const Team &team, const pbf_coarse_level &level,
                                                  Visit visit) {
  each_index(team, level, [&](uint32_t node) {
    int at[PBF_DIM];
    if (level.inverse[node] > 0 && pbf_coarse_place(&level, node, at)) visit(node, at);
  });
}

/* ---- Levels --------------------------------------------------------------------------------- */

/* The row of a node of the grid, or of a level that is not the first; false where there is none. */
static __device__ __forceinline__ bool row_of(const pbf_pressure_grid &grid,
                                              const pressure_grid_arrays &a,
                                              const pressure_grid_levels &levels, int finer,
                                              uint32_t node, pbf_coarse_row *row) {
  if (finer >= 0) {
    *row = pbf_row_of_level(&levels.of[finer], node);
    return true;
  }
  if (!levels.moves[node]) return false;
  *row = pbf_row_of_grid(&grid, a.free_volumes, a.inverse, levels.moves, node);
  return true;
}

/* The stencils of level l from the one before: a lane for each of the finer nodes around a node. */
static __device__ __forceinline__ void find_stencils(const pbf_pressure_grid &grid,
                                                     const pressure_grid_arrays &a,
                                                     const pressure_grid_levels &levels, int l) {
  constexpr uint32_t LANES = PBF_DIM == 3 ? 32 : 16, NODES = 32 / LANES;
  const pbf_coarse_level &level = levels.of[l], &finer = l > 0 ? levels.of[l - 1] : levels.finest;
  const uint32_t lane = threadIdx.x % LANES, in_warp = threadIdx.x % 32 / LANES;
  const uint32_t warps = gridDim.x * PRESSURE_GRID_THREADS / 32;
  for (uint32_t base = thread_index() / 32 * NODES; base < level.nodes; base += warps * NODES) {
    const uint32_t node = base + in_warp;
    int at[PBF_DIM];
    const bool has = pbf_coarse_place(&level, node, at);
    pbf_coarse_row row = {};
    if (has && lane < PBF_AROUND) {
      const pbf_finer_node around = pbf_finer_node_of(at, (int)lane, finer.n);
      uint32_t index = 0;
      for (int k = 0; k < PBF_DIM; ++k) index += (uint32_t)around.at[k] * finer.stride[k];
      if (around.weight > 0 && row_of(grid, a, levels, l - 1, index, &row))
        row = pbf_galerkin_part(at, &around, finer.n, row);
    }
#pragma unroll
    for (uint32_t k = 0; k < PBF_STENCIL; ++k) {
      float sum = row.of[PBF_AROUND / 2 + k];
#pragma unroll
      for (uint32_t step = LANES / 2; step > 0; step /= 2) sum += __shfl_xor_sync(~0u, sum, step);
      if (has && lane == 0) level.stencil[k * (uint64_t)level.length + node] = sum;
    }
  }
}

template <class Team>
static __device__ __noinline__ void find_inverses(const Team &team, const pbf_coarse_level &level) {
  each_index(team, level, [&](uint32_t node) {
    int at[PBF_DIM];
    if (pbf_coarse_place(&level, node, at)) level.inverse[node] = pbf_coarse_inverse(&level, node);
  });
}

/* Once lambda is smooth: which of its nodes move, and all levels. */
static __device__ __forceinline__ void find_levels(const shared_by_all &all,
                                                   const pbf_pressure_grid &grid,
                                                   const pressure_grid_arrays &a,
                                                   const pressure_grid_levels &levels,
                                                   const double *now) {
  for (uint64_t k = all.first(); k < levels.words; k += all.stride()) levels.memory[k] = 0;
  for (uint32_t node = all.first(); node < grid.nodes; node += all.stride()) {
    levels.moves[node] = a.inverse[node] > 0 && now[node] < 0;
    levels.finest.right[node] = 0;
  }
  all.meet();
#pragma unroll 1
  for (int l = 0; l < levels.count; ++l) {
    find_stencils(grid, a, levels, l);
    all.meet();
    find_inverses(all, levels.of[l]);
  }
  all.meet();
}

/* ---- Corrections ---------------------------------------------------------------------------- */

/* An even number of iterations ends in `now`. */
template <class Team>
static __device__ __noinline__ void smooth_level(const Team &team, const pbf_coarse_level &level,
                                                 pbf_pressure_grid_solve solve, int iterations) {
  float *now = level.now, *before = level.before;
  for (int k = 0; k < iterations; ++k) {
    each_index(team, level, [&](uint32_t node) {
      if (level.inverse[node] > 0)
        before[node] = pbf_coarse_next(&level, &solve, now, before, node);
    });
    team.meet();
    pbf_pressure_grid_solve_go_on(&solve, k);
    float *other = now;
    now = before;
    before = other;
  }
}

/* What is missing on a level, from the one before. */
template <class Team>
static __device__ __noinline__ void descend(const Team &team, const pbf_coarse_level &finer,
                                            const pbf_coarse_level &level) {
  each_place(team, level, [&](uint32_t node, const int *at) {
    level.right[node] = pbf_restricted(at, finer.n, finer.stride,
                                       [&](uint32_t other) { return finer.right[other]; });
  });
  team.meet();
}

/* A level's correction, from that of the next one. */
template <class Team>
static __device__ __forceinline__ void ascend(const Team &team, const pbf_coarse_level &coarser,
                                              const pbf_coarse_level &level) {
  each_place(team, level, [&](uint32_t node, const int *at) {
    level.now[node] = level.before[node] = pbf_interpolated(&coarser, at, coarser.now);
  });
  team.meet();
  smooth_level(team, level, pbf_coarse_smoothing(), PBF_SMOOTHINGS);
}

/* The levels that one block has, in its shared memory. */
struct levels_of_block {
  int first, count;
  pbf_coarse_level of[PBF_COARSE_LEVELS];
};

/* Copies them there, once they are found. */
static __device__ __forceinline__ void keep_levels(const pressure_grid_levels &levels,
                                                   levels_of_block *kept) {
  extern __shared__ float level_memory[];
  const float *from = levels.of[levels.shared].stencil;
  const uint64_t words = words_of_levels(levels, levels.shared);
  for (uint64_t k = threadIdx.x; k < words; k += PRESSURE_GRID_THREADS) level_memory[k] = from[k];
  if (threadIdx.x == 0) {
    kept->first = levels.shared;
    kept->count = levels.count;
    for (int l = levels.shared; l < levels.count; ++l) {
      pbf_coarse_level *level = &kept->of[l];
      *level = levels.of[l];
      for (float **array :
           {&level->stencil, &level->inverse, &level->right, &level->now, &level->before})
        *array = level_memory + (*array - from);
    }
  }
  __syncthreads();
}

/* Of the level `finer`, which all share, the correction by those of the block; into `now` of the
 * first of these, as all have it. */
static __device__ __forceinline__ void correct_alone(const pbf_coarse_level &finer,
                                                     const levels_of_block &kept, float *now) {
  const alone team;
  const int last = kept.count - 1;
  const pbf_coarse_level &first = kept.of[kept.first], &coarsest = kept.of[last];
  descend(team, finer, first);
  for (int l = kept.first + 1; l <= last; ++l) descend(team, kept.of[l - 1], kept.of[l]);
  each_index(team, coarsest,
             [&](uint32_t node) { coarsest.now[node] = coarsest.before[node] = 0; });
  team.meet();
  smooth_level(team, coarsest, pbf_coarsest_solve(), PBF_COARSEST_ITERATIONS);
  for (int l = last - 1; l >= kept.first; --l) ascend(team, kept.of[l + 1], kept.of[l]);
  each_index(team, first, [&](uint32_t node) { now[node] = first.now[node]; });
}

/* The correction of the first level, once its right side has been found. */
static __device__ __forceinline__ void correct(const shared_by_all &all,
                                               const pressure_grid_levels &levels,
                                               const levels_of_block &kept) {
  const int shared = levels.shared;
  for (int l = 1; l < shared; ++l) descend(all, levels.of[l - 1], levels.of[l]);
  if (blockIdx.x == 0) correct_alone(levels.of[shared - 1], kept, levels.of[shared].now);
  all.meet();
  for (int l = shared - 1; l >= 0; --l) ascend(all, levels.of[l + 1], levels.of[l]);
}

/* ---- The solve ------------------------------------------------------------------------------ */

using levels_iterations = pressure_grid_iterations<pressure_grid_in_memory>;

/* Iterations of the grid before and after a correction; whether nothing is missing any more. */
static __device__ __forceinline__ bool smooth_grid(levels_iterations *iterations, double enough) {
  pbf_pressure_grid_solve solve = pbf_finest_smoothing(enough);
  bool over = false;
#pragma unroll 1
  for (int k = 0; k < PBF_SMOOTHINGS; ++k) over = iterations->iterate(&solve, k);
  return over;
}

/* What is missing at nodes that move, and on the first level. */
static __device__ __forceinline__ void find_missing(const shared_by_all &all,
                                                    levels_iterations *iterations,
                                                    const pressure_grid_levels &levels,
                                                    double largest) {
  const double *now = iterations->now;
  iterations->each([&](const pressure_grid_equation &e) {
    double missing = 0;
    if (levels.moves[e.node] && now[e.node] < 0)
      missing =
          pbf_pressure_grid_residual(&iterations->grid, e.around, now, e.right, e.inverse, e.node);
    levels.finest.right[e.node] = (float)(missing / largest);
  });
  all.meet();
  descend(all, levels.finest, levels.of[0]);
}

static __device__ __forceinline__ void add_correction(const shared_by_all &all,
                                                      levels_iterations *iterations,
                                                      const pressure_grid_levels &levels,
                                                      double largest) {
  iterations->each([&](const pressure_grid_equation &e) {
    int at[PBF_DIM];
    pbf_pressure_grid_place(&iterations->grid, e.node, at);
    const double change =
        levels.moves[e.node] ? largest * pbf_interpolated(&levels.of[0], at, levels.of[0].now) : 0;
    const double lambda = pbf_lesser(iterations->now[e.node] + change, 0);
    iterations->before[e.node] = iterations->now[e.node] = lambda;
  });
  all.meet();
}

static __global__ void __launch_bounds__(PRESSURE_GRID_THREADS, 1)
    pressure_grid_levels_kernel(const __grid_constant__ pbf_pressure_grid grid,
                                const __grid_constant__ pressure_grid_arrays a,
                                const __grid_constant__ pressure_grid_levels levels) {
  __shared__ levels_of_block kept;
  const double largest = __longlong_as_double((long long)a.control->largest);
  const int longest = pbf_pressure_grid_source_scale_of(&grid, &a.control->extent).longest;
  const pbf_pressure_grid_solve solve = pbf_pressure_grid_solve_begin(longest, largest);
  if (solve.max_iterations == 0) return;
  levels_iterations iterations(grid, a);
  const shared_by_all all = {&iterations.lambda};
  double enough = solve.enough;
  for (int k = 0; !smooth_grid(&iterations, enough) && k < PBF_MAX_CORRECTIONS; ++k) {
    if (k == 0) {
      find_levels(all, grid, a, levels, iterations.now);
      if (blockIdx.x == 0) keep_levels(levels, &kept);
      enough = PBF_CORRECTED_ENOUGH * solve.enough;
    }
    find_missing(all, &iterations, levels, largest);
    correct(all, levels, kept);
    add_correction(all, &iterations, levels, largest);
  }
  iterations.lambda.end(a, iterations.now, iterations.count);
}

#endif
