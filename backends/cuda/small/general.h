/* Part of kernel.h: a step of a small scene without limits, for when cells or lists have no room:
 * every stage a loop over the particles and a barrier, and no lists. */
#ifndef PBF_CUDA_SMALL_GENERAL_H
#define PBF_CUDA_SMALL_GENERAL_H

#include "cuda/small/scene.h"

/* Sorted particles carry their number in the order of ids in place of the id. */
struct general_buffers {
  sorted_particles sorted;
  point *moved[2]; /* to and fro */
  uint32_t *numbers;
  sort_scratch scratch;
  pbf_real *total; /* accelerated: lambda that has added up; else null */
};

/* The threads that do a step together, and meet at barriers: those of all blocks, … */
struct grid_team {
  grid_counter *counter;
  uint32_t turn; /* the last barrier's number */

  __device__ __forceinline__ uint32_t first() const { return thread_index(); }
  __device__ __forceinline__ uint32_t size() const { return gridDim.x * blockDim.x; }
  __device__ __forceinline__ bool has_first_block() const { return blockIdx.x == 0; }
  __device__ __forceinline__ void meet() { grid_barrier(counter, ++turn); }
};

/* … or of one. */
struct block_team {
  __device__ __forceinline__ uint32_t first() const { return threadIdx.x; }
  __device__ __forceinline__ uint32_t size() const { return blockDim.x; }
  __device__ __forceinline__ bool has_first_block() const { return true; }
  __device__ __forceinline__ void meet() { __syncthreads(); }
};

/* By the threads of one block. */
static __device__ __forceinline__ void scan_in_block(uint32_t *values, uint32_t count) {
  __shared__ uint32_t shared[SMALL_THREADS];
  uint32_t size = (count + blockDim.x - 1) / blockDim.x, sum = 0;
  uint32_t first = min(threadIdx.x * size, count), end = min(first + size, count);
  for (uint32_t k = first; k < end; ++k) sum += values[k];
  shared[threadIdx.x] = sum;
  __syncthreads();
  sum = 0;
  for (uint32_t k = 0; k < threadIdx.x; ++k) sum += shared[k];
  for (uint32_t k = first; k < end; ++k) {
    uint32_t value = values[k];
    values[k] = sum;
    sum += value;
  }
}

/* Sums of particle i at x among `points`. */
template <class Pass>
static __device__ __forceinline__ typename Pass::template sums<pbf_real> general_sums(
    const Pass &pass, const sorted_particles &p, const cell_grid &grid, const point *points,
    uint32_t i, pbf_vec x, const typename Pass::template own<pbf_real> &own) {
  auto sums = pass.template begin<pbf_real>();
  walk_cells(p, grid, i, [&](uint32_t k) {
    const point other = load(points, k);
    auto j = neighbor_between(x, position_of(other));
    j.number = other.lambda;
    pass.pair(&sums, own, j);
  });
  pass.end(&sums);
  return sums;
}

/* One step of the particles in scene.points by all threads of the team: every stage a loop over the
 * particles and a barrier, and no lists. */
template <int FEATURES, surfaces_met SURFACES, class Team>
static __device__ __noinline__ void general_step(const small_scene &scene,
                                                 const general_buffers &buffers, uint32_t step,
                                                 Team *team) {
  const pbf_constants *c = &scene.constants;
  const cell_grid grid = scene.table[step].grid;
  uint32_t first = team->first(), stride = team->size(), n = scene.count;
  const sorted_particles &p = buffers.sorted;
  step_obstacles obstacles = {scene.table[step].domain, SURFACES ? scene.surface_count : 0,
                              scene.surfaces + step * scene.surface_count};
  prediction predict = {forces_at(scene, scene.table[step]), obstacles,
                        scene.collide_after_prediction};
  unsorted_particles from = {scene.points, scene.velocities, buffers.numbers, n};
  team->meet();
  for (uint32_t k = first; k <= grid.count; k += stride) p.cell_start[k] = 0;
  for (uint32_t i = first; i < n; i += stride) buffers.numbers[i] = i;
  team->meet();
  for (uint32_t i = first; i < n; i += stride)
    count_particle<SURFACES, false>(from, predict, grid, p.cell_start, buffers.scratch, i);
  team->meet();
  if (team->has_first_block()) scan_in_block(p.cell_start, grid.count + 1);
  team->meet();
  for (uint32_t i = first; i < n; i += stride)
    scatter_particle(from, p.cell_start, buffers.scratch, i);
  team->meet();
  for (uint32_t i = first; i < n; i += stride)
    place_particle<SURFACES, false>(from, predict, buffers.scratch, p, i);
  point *points = p.points, *moved = buffers.moved[0]; /* p.points keeps the prediction */
  for (uint32_t k = 0; k < scene.iterations; ++k) {
    team->meet();
    bool last = k + 1 == scene.iterations;
    const pbf_constants now = constants_at(scene, k);
    const lambda_pass<fixed<FEATURES>, SCALED_SUMS> of_lambda = {c, {}};
    const move_pass_of<fixed<FEATURES>, SCALED_SUMS> of_pairs = {&now, {}}, of_move = {c, {}};
    for (uint32_t i = first; i < n; i += stride) {
      pbf_vec x = position_of(load(points, i));
      auto sums = general_sums(of_lambda, p, grid, points, i, x, {});
      pbf_real lambda =
          finish_lambda<SURFACES>(of_lambda, obstacles, scene.wall_density, 0, x, &sums);
      if (PBF_CHEBYSHEV && scene.accelerated) {
        pbf_real change = points[i].lambda, total = k == 0 ? 0 : buffers.total[i];
        pbf_accelerate(&now, sums.density, lambda, &total, &change);
        if (last) pbf_smooth_pressure(&now, scene.last_pressure[p.ids[i]], &total, &change);
        buffers.total[i] = total;
        lambda = change;
      }
      points[i].lambda = lambda;
    }
    team->meet();
    for (uint32_t i = first; i < n; i += stride) {
      point own = load(points, i);
      pbf_vec x = position_of(own);
      const auto sums = general_sums(of_pairs, p, grid, points, i, x, {own.lambda});
      pbf_vec predicted = position_of(load(p.points, i));
      pbf_vec v = p.velocities[i];
      x = finish_move<SURFACES>(
          of_move, obstacles,
          {scene.wall_density != 0,
           scene.collide_in_iteration + (last && scene.collide_after_solve), scene.inv_time_step},
          own.lambda, false, p.ids[i], predicted, x, sums, &v);
      p.velocities[i] = v;
      point to = point_at(x);
      to.lambda = own.lambda;
      store(moved, i, to);
      if (!last) continue;
      if (PBF_CHEBYSHEV && scene.accelerated) {
        to.lambda = buffers.total[i];
        scene.last_pressure[p.ids[i]] = pbf_pressure_to_keep(c, to.lambda);
      }
      store(scene.points, p.ids[i], to);
      scene.velocities[p.ids[i]] = v;
    }
    points = buffers.moved[k % 2];
    moved = buffers.moved[(k + 1) % 2];
  }
  team->meet();
}

#endif
