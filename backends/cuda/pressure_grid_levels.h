/* Part of pressure_grid_host.h: the solve of a pressure grid with corrections from coarser levels
 * (physics/pressure_grid/coarse.h), by a cluster or by all blocks. They share a level, or one block
 * has it, to which a barrier of its own costs less. */
#ifndef PBF_CUDA_PRESSURE_GRID_LEVELS_H
#define PBF_CUDA_PRESSURE_GRID_LEVELS_H

#include "cuda/pressure_grid_solve.h"
#include "physics/pressure_grid/coarse.h"

/* Indices of a level that one block has, at most. */
enum { PRESSURE_GRID_ALONE = 1024 };

/* Fewer cells along an axis are solved as fast without. */
static inline bool pressure_grid_has_levels(const pbf_pressure_grid &grid) {
  return pbf_most_cells(grid.n) >= (PBF_DIM == 3 ? 24 : 20);
}

/* Of the iterations of a level, or of the grid. */
struct pressure_grid_weights {
  int count;
  double step, of[PBF_COARSEST_ITERATIONS];
};

static inline pressure_grid_weights pressure_grid_weights_of(pbf_pressure_grid_solve solve,
                                                             int iterations) {
  pressure_grid_weights weights = {iterations, solve.step, {}};
  pbf_find_weights(solve, iterations, weights.of);
  return weights;
}

struct pressure_grid_levels {
  int count;  /* 0: none */
  int shared; /* so many are shared by all blocks */
  pbf_coarse_level of[PBF_COARSE_LEVELS];
  float *memory; /* of all of them, */
  uint64_t words;
  pbf_coarse_level finest; /* the grid: what is missing is its right side */
  uint8_t *moves;          /* of its nodes: whether corrections move lambda there */
  pressure_grid_weights of_grid, smoothing, coarsest;
};

/* Numbers of the levels from l on, which lie one behind the other. */
static inline __host__ __device__ uint64_t words_of_levels(const pressure_grid_levels &levels,
                                                           int l) {
  return levels.words - (uint64_t)(levels.of[l].stencil - levels.memory);
}

/* What a block keeps of the levels from l on, with a list of nodes for each. */
static inline size_t bytes_in_block(const pressure_grid_levels &levels, int l) {
  size_t bytes = words_of_levels(levels, l) * sizeof(float);
  for (; l < levels.count; ++l) bytes += levels.of[l].nodes * sizeof(uint16_t);
  return bytes;
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
  if (!pressure_grid_has_levels(grid)) return levels;
  levels.moves = a.moves;
  levels.of_grid = pressure_grid_weights_of(pbf_finest_smoothing(), PBF_SMOOTHINGS);
  levels.smoothing = pressure_grid_weights_of(pbf_coarse_smoothing(), PBF_SMOOTHINGS);
  levels.coarsest = pressure_grid_weights_of(pbf_coarsest_solve(), PBF_COARSEST_ITERATIONS);
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
  while (levels.of[levels.shared].nodes > PRESSURE_GRID_ALONE ||
         bytes_in_block(levels, levels.shared) > max_shared)
    if (++levels.shared == levels.count) return {};
  return levels;
}

/* ---- Teams of threads ------------------------------------------------------------------------ */

/* All blocks, … */
template <class Lambda>
struct shared_by_all {
  Lambda *lambda;
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

/* The nodes of a level that have an equation: all of them, … */
struct nodes_of_level {
  const pbf_coarse_level &level;
  __device__ __forceinline__ uint32_t count() const { return level.nodes; }
  __device__ __forceinline__ uint32_t operator[](uint32_t k) const { return k; }
  __device__ __forceinline__ bool has(uint32_t node) const { return level.inverse[node] > 0; }
};

/* … or those that are listed. */
struct listed_nodes {
  const pbf_coarse_level &level;
  const uint16_t *list;
  uint32_t listed;
  __device__ __forceinline__ uint32_t count() const { return listed; }
  __device__ __forceinline__ uint32_t operator[](uint32_t k) const { return list[k]; }
  __device__ __forceinline__ bool has(uint32_t) const { return true; }
};

template <class Team, class Nodes, class Visit>
static __device__ __forceinline__ void each_node(const Team &team, const Nodes &nodes,
                                                 Visit visit) {
  for (uint32_t k = team.first(); k < nodes.count(); k += team.stride())
    if (nodes.has(nodes[k])) visit(nodes[k]);
}

/* With where they are along each axis. */
template <class Team, class Nodes, class Visit>
static __device__ __forceinline__ void each_place(const Team &team, const Nodes &nodes,
                                                  Visit visit) {
  each_node(team, nodes, [&](uint32_t node) {
    int at[PBF_DIM];
    if (pbf_coarse_place(&nodes.level, node, at)) visit(node, at);
  });
}

/* ---- Levels --------------------------------------------------------------------------------- */

static __device__ __forceinline__ const pbf_coarse_level &level_before(
    const pressure_grid_levels &levels, int l) {
  return l > 0 ? levels.of[l - 1] : levels.finest;
}

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
  const pbf_coarse_level &level = levels.of[l], &finer = level_before(levels, l);
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
  for (uint32_t node = team.first(); node < level.nodes; node += team.stride()) {
    int at[PBF_DIM];
    if (pbf_coarse_place(&level, node, at)) level.inverse[node] = pbf_coarse_inverse(&level, node);
  }
}

/* Once lambda is smooth: which of its nodes move, and all levels. */
template <class Team, class Iterations>
static __device__ __forceinline__ void find_levels(const Team &all, const Iterations &iterations,
                                                   const pressure_grid_levels &levels) {
  const pbf_pressure_grid &grid = iterations.grid;
  const pressure_grid_arrays &a = iterations.a;
  for (uint64_t k = all.first(); k < levels.words; k += all.stride()) levels.memory[k] = 0;
  for (uint32_t node = all.first(); node < grid.nodes; node += all.stride()) {
    levels.moves[node] = 0;
    levels.finest.right[node] = 0;
  }
  all.meet();
  iterations.each([&](const pressure_grid_equation &e) {
    levels.moves[e.node] = iterations.now[e.node - iterations.lambda.low()] < 0;
  });
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

/* An even number of iterations ends in `now`. A thread that has one node keeps its equation. */
template <class Team, class Nodes>
static __device__ __forceinline__ void smooth_level(const Team &team, const Nodes &nodes,
                                                    const pressure_grid_weights &weights) {
  const pbf_coarse_level &level = nodes.level;
  const bool one = nodes.count() <= team.stride();
  const uint32_t mine = one && team.first() < nodes.count() ? nodes[team.first()] : 0;
  pbf_coarse_equation kept = {};
  const float step = (float)weights.step;
  float *now = level.now, *before = level.before;
  if (one && team.first() < nodes.count() && nodes.has(mine))
    kept = pbf_coarse_equation_of(&level, mine);
#pragma unroll 1
  for (int k = 0; k < weights.count; ++k) {
    const float weight = (float)weights.of[k];
    if (kept.inverse > 0)
      before[mine] = pbf_coarse_next(&level, &kept, step, weight, now, before, mine);
    if (!one)
      each_node(team, nodes, [&](uint32_t node) {
        const pbf_coarse_equation e = pbf_coarse_equation_of(&level, node);
        before[node] = pbf_coarse_next(&level, &e, step, weight, now, before, node);
      });
    team.meet();
    float *other = now;
    now = before;
    before = other;
  }
}

/* What is missing on a level, from the one before. */
template <class Team, class Nodes>
static __device__ __noinline__ void descend(const Team &team, const pbf_coarse_level &finer,
                                            const Nodes &nodes) {
  each_place(team, nodes, [&](uint32_t node, const int *at) {
    nodes.level.right[node] = pbf_restricted(at, finer.n, finer.stride,
                                             [&](uint32_t other) { return finer.right[other]; });
  });
  team.meet();
}

/* A level's correction, from that of the next one. */
template <class Team, class Nodes>
static __device__ __forceinline__ void ascend(const Team &team, const pbf_coarse_level &coarser,
                                              const Nodes &nodes,
                                              const pressure_grid_weights &smoothing) {
  const pbf_coarse_level &level = nodes.level;
  each_place(team, nodes, [&](uint32_t node, const int *at) {
    level.now[node] = level.before[node] = pbf_interpolated(&coarser, at, coarser.now);
  });
  team.meet();
  smooth_level(team, nodes, smoothing);
}

/* The levels that one block has, in its shared memory, and their nodes that have an equation. */
struct levels_of_block {
  int first, count;
  pbf_coarse_level of[PBF_COARSE_LEVELS];
  uint32_t listed[PBF_COARSE_LEVELS];
  uint16_t *list[PBF_COARSE_LEVELS];

  __device__ __forceinline__ listed_nodes nodes_of(int l) const {
    return {of[l], list[l], listed[l]};
  }
};

/* Copies them there, once they are found. */
static __device__ __forceinline__ void keep_levels(const pressure_grid_levels &levels,
                                                   float *level_memory, levels_of_block *kept) {
  const float *from = levels.of[levels.shared].stencil;
  const uint64_t words = words_of_levels(levels, levels.shared);
  uint16_t *list = reinterpret_cast<uint16_t *>(level_memory + words);
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
      kept->list[l] = list;
      kept->listed[l] = 0;
      list += level->nodes;
    }
  }
  __syncthreads();
  for (int l = kept->first; l < kept->count; ++l)
    for (uint32_t node = threadIdx.x; node < kept->of[l].nodes; node += PRESSURE_GRID_THREADS)
      if (kept->of[l].inverse[node] > 0)
        kept->list[l][atomicAdd(&kept->listed[l], 1u)] = (uint16_t)node;
  __syncthreads();
}

/* Of the level `finer`, which all share, the correction by those of the block; into `now` of the
 * first of these, as all have it. */
static __device__ __forceinline__ void correct_alone(const pressure_grid_levels &levels,
                                                     const pbf_coarse_level &finer,
                                                     const levels_of_block &kept, float *now) {
  const alone team;
  const int last = kept.count - 1;
  const pbf_coarse_level &coarsest = kept.of[last];
  const listed_nodes first = kept.nodes_of(kept.first);
  descend(team, finer, first);
  for (int l = kept.first + 1; l <= last; ++l) descend(team, kept.of[l - 1], kept.nodes_of(l));
  each_node(team, kept.nodes_of(last),
            [&](uint32_t node) { coarsest.now[node] = coarsest.before[node] = 0; });
  team.meet();
  smooth_level(team, kept.nodes_of(last), levels.coarsest);
  for (int l = last - 1; l >= kept.first; --l)
    ascend(team, kept.of[l + 1], kept.nodes_of(l), levels.smoothing);
  each_node(team, first, [&](uint32_t node) { now[node] = first.level.now[node]; });
}

/* The correction of the first level, once it is known what the grid misses. */
template <class Team>
static __device__ __forceinline__ void correct(const Team &all, const pressure_grid_levels &levels,
                                               const levels_of_block &kept) {
  const int shared = levels.shared;
  for (int l = 0; l < shared; ++l)
    descend(all, level_before(levels, l), nodes_of_level{levels.of[l]});
  if (blockIdx.x == 0)
    correct_alone(levels, level_before(levels, shared), kept, levels.of[shared].now);
  all.meet();
  for (int l = shared - 1; l >= 0; --l)
    ascend(all, levels.of[l + 1], nodes_of_level{levels.of[l]}, levels.smoothing);
}

/* ---- The solve ------------------------------------------------------------------------------ */

/* With registers for what corrections need beside the grid's own equations. */
struct pressure_grid_levels_in_cluster : pressure_grid_in_cluster {
  static constexpr uint32_t KEPT = 1;
  using pressure_grid_in_cluster::pressure_grid_in_cluster;
};

/* Iterations of the grid before and after a correction; whether nothing is missing any more. */
template <class Iterations>
static __device__ __forceinline__ bool smooth_grid(Iterations *iterations,
                                                   const pressure_grid_weights &weights,
                                                   double enough) {
  pbf_pressure_grid_solve solve = {0, weights.step, 0, enough, 1};
  bool over = false;
#pragma unroll 1
  for (int k = 0; k < weights.count; ++k) {
    solve.weight = weights.of[k];
    over = iterations->iterate(solve, k);
  }
  return over;
}

/* What is missing at nodes that move. */
template <class Team, class Iterations>
static __device__ __forceinline__ void find_missing(const Team &all, Iterations *iterations,
                                                    const pressure_grid_levels &levels,
                                                    double largest) {
  const double *now = iterations->now;
  iterations->each([&](const pressure_grid_equation &e) {
    const uint32_t at = e.node - iterations->lambda.low();
    double missing = 0;
    if (levels.moves[e.node] && now[at] < 0)
      missing =
          pbf_pressure_grid_residual(&iterations->grid, e.around, now, e.right, e.surface, at);
    levels.finest.right[e.node] = (float)(missing / largest);
  });
  all.meet();
}

template <class Team, class Iterations>
static __device__ __forceinline__ void add_correction(const Team &all, Iterations *iterations,
                                                      const pressure_grid_levels &levels,
                                                      double largest) {
  iterations->each([&](const pressure_grid_equation &e) {
    int at[PBF_DIM];
    pbf_pressure_grid_place(&iterations->grid, e.node, at);
    const double change =
        levels.moves[e.node] ? largest * pbf_interpolated(&levels.of[0], at, levels.of[0].now) : 0;
    const uint32_t index = e.node - iterations->lambda.low();
    const double lambda = pbf_min(iterations->now[index] + change, 0);
    for (double *of : {iterations->before, iterations->now}) {
      of[index] = lambda;
      iterations->lambda.hand_on(of, index, lambda);
    }
  });
  all.meet();
}

template <class Lambda>
static __global__ void __launch_bounds__(PRESSURE_GRID_THREADS, 1)
    pressure_grid_levels_kernel(const __grid_constant__ pbf_pressure_grid grid,
                                const __grid_constant__ pressure_grid_arrays a,
                                const __grid_constant__ pressure_grid_levels levels) {
  __shared__ levels_of_block kept;
  await_launches_before();
  const double largest = __longlong_as_double((long long)a.control->largest);
  const int longest = pbf_pressure_grid_source_scale_of(&grid, &a.control->extent).longest;
  const pbf_pressure_grid_solve solve = pbf_pressure_grid_solve_begin(longest, largest);
  if (solve.max_iterations == 0) return;
  pressure_grid_iterations<Lambda> iterations(grid, a);
  const shared_by_all<Lambda> all = {&iterations.lambda};
  double enough = solve.enough;
  for (int k = 0; !smooth_grid(&iterations, levels.of_grid, enough) && k < PBF_MAX_CORRECTIONS;
       ++k) {
    if (k == 0) {
      find_levels(all, iterations, levels);
      if (blockIdx.x == 0) keep_levels(levels, iterations.lambda.memory_behind(), &kept);
      enough = PBF_CORRECTED_ENOUGH * solve.enough;
    }
    find_missing(all, &iterations, levels, largest);
    correct(all, levels, kept);
    add_correction(all, &iterations, levels, largest);
  }
  iterations.lambda.end(a, iterations.now, iterations.count);
}

#endif
