/* Part of executor.h: how the pressure grid's solve is launched. */
#ifndef PBF_CUDA_PRESSURE_GRID_HOST_H
#define PBF_CUDA_PRESSURE_GRID_HOST_H

#include "cuda/pressure_grid_levels.h"
#include "cuda/rank_questions.h"
#include "cuda/solver.h"

static inline size_t pressure_grid_shared(const pbf_pressure_grid &grid, uint32_t blocks) {
  uint32_t reach = pressure_grid_reach(grid);
  return 2 * sizeof(double) *
         pressure_grid_length(pressure_grid_part_size(grid.nodes, blocks, reach), reach);
}

/* What a block can have, less what the kernels have of themselves. */
static inline size_t pressure_grid_max_shared(const solver *s) { return s->block_shared - 2048; }

/* Of a cluster, with room for two attributes. */
static inline cudaLaunchConfig_t pressure_grid_config(const solver *s, uint32_t blocks,
                                                      size_t shared,
                                                      cudaLaunchAttribute *attributes) {
  cudaLaunchConfig_t config = {};
  config.gridDim = dim3(blocks);
  config.blockDim = dim3(PRESSURE_GRID_THREADS);
  config.dynamicSmemBytes = shared;
  config.stream = s->stream;
  config.attrs = attributes;
  if (s->launches_early) attributes[config.numAttrs++] = early_launch();
  if (blocks == 1) return config;
  attributes[config.numAttrs].id = cudaLaunchAttributeClusterDimension;
  attributes[config.numAttrs++].val.clusterDim = {blocks, 1, 1};
  return config;
}

template <class... Parameters>
static inline pbf_status allow_shared(const solver *s, void (*kernel)(Parameters...)) {
  return pbf_cuda_check(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize,
                                             (int)pressure_grid_max_shared(s)),
                        "cudaFuncSetAttribute");
}

/* Lets the solve have its shared memory, and finds out how large a cluster can be. */
static inline pbf_status allow_pressure_grid(solver *s) {
  auto kernel = pressure_grid_solve_kernel<pressure_grid_in_cluster>;
  auto levels_kernel = pressure_grid_levels_kernel<pressure_grid_levels_in_cluster>;
  int clusters = 0;
  if (pbf_status status = allow_shared(s, kernel)) return status;
  if (pbf_status status = allow_shared(s, levels_kernel)) return status;
  if (pbf_status status = allow_shared(s, pressure_grid_levels_kernel<pressure_grid_in_memory>))
    return status;
  s->pressure_grid_cluster = 1;
  if (pbf_status status =
          pbf_cuda_check(cudaDeviceGetAttribute(&clusters, cudaDevAttrClusterLaunch, s->device),
                         "cudaDeviceGetAttribute"))
    return status;
  if (!clusters) return PBF_OK;
  if (pbf_status status = pbf_cuda_check(
          cudaFuncSetAttribute(kernel, cudaFuncAttributeNonPortableClusterSizeAllowed, 1),
          "cudaFuncSetAttribute"))
    return status;
  if (pbf_status status = pbf_cuda_check(
          cudaFuncSetAttribute(levels_kernel, cudaFuncAttributeNonPortableClusterSizeAllowed, 1),
          "cudaFuncSetAttribute"))
    return status;
  for (uint32_t blocks = 16; blocks > 1 && s->pressure_grid_cluster == 1; blocks /= 2) {
    cudaLaunchAttribute attributes[2];
    cudaLaunchConfig_t config =
        pressure_grid_config(s, blocks, pressure_grid_max_shared(s), attributes);
    if (cudaOccupancyMaxActiveClusters(&clusters, kernel, &config) != cudaSuccess)
      cudaGetLastError(); /* not so many */
    else if (clusters > 0)
      s->pressure_grid_cluster = blocks;
  }
  return PBF_OK;
}

/* Blocks of the cluster that solves a grid; 0 where it has no room for it. */
static inline uint32_t pressure_grid_blocks(const solver *s, const pbf_pressure_grid &grid) {
  const uint32_t blocks = s->pressure_grid_cluster;
  return pressure_grid_shared(grid, blocks) <= pressure_grid_max_shared(s) ? blocks : 0;
}

/* Indices of a grid up to which corrections in a cluster are faster than in all blocks. */
enum { PRESSURE_GRID_IN_CLUSTER = 24576 };

/* Where a grid is solved, and with which levels. */
struct pressure_grid_way {
  uint32_t blocks; /* of a cluster; 0: all that are resident */
  size_t shared;
  pressure_grid_levels levels;
};

/* Torn nodes have their neighbours anywhere: a cluster does not solve them, nor are there levels.
 */
static inline pressure_grid_way way_of_solve(const solver *s, const pbf_pressure_grid &grid,
                                             const pressure_grid_arrays &arrays) {
  const size_t most = pressure_grid_max_shared(s);
  pressure_grid_way way = {};
  if (s->pressure_grid_is_torn) return way;
  if (!pressure_grid_has_levels(grid) || grid.nodes <= PRESSURE_GRID_IN_CLUSTER)
    way.blocks = pressure_grid_blocks(s, grid);
  if (way.blocks) way.shared = pressure_grid_shared(grid, way.blocks);
  way.levels = pressure_grid_levels_in(arrays, grid, s->scene_capacity, most - way.shared);
  if (way.levels.count) way.shared += bytes_in_block(way.levels, way.levels.shared);
  return way;
}

static inline pbf_status launch_pressure_grid_solve(solver *s, const pbf_pressure_grid &grid,
                                                    const pressure_grid_arrays &arrays) {
  const pressure_grid_way way = way_of_solve(s, grid, arrays);
  const uint32_t resident =
      min((grid.nodes + PRESSURE_GRID_THREADS - 1) / PRESSURE_GRID_THREADS, s->multiprocessors);
  static const char name[] = "launch of the pressure grid";
  if (way.blocks == 0) {
    if (way.levels.count)
      return pbf_cuda_check(
          launch_cooperative(s->stream, pressure_grid_levels_kernel<pressure_grid_in_memory>,
                             resident, PRESSURE_GRID_THREADS, way.shared, grid, arrays, way.levels),
          name);
    return pbf_cuda_check(
        launch_cooperative(s->stream, pressure_grid_solve_kernel<pressure_grid_in_memory>, resident,
                           PRESSURE_GRID_THREADS, 0, grid, arrays),
        name);
  }
  cudaLaunchAttribute attributes[2];
  cudaLaunchConfig_t config = pressure_grid_config(s, way.blocks, way.shared, attributes);
  if (way.levels.count)
    return pbf_cuda_check(
        cudaLaunchKernelEx(&config, pressure_grid_levels_kernel<pressure_grid_levels_in_cluster>,
                           grid, arrays, way.levels),
        name);
  return pbf_cuda_check(
      cudaLaunchKernelEx(&config, pressure_grid_solve_kernel<pressure_grid_in_cluster>, grid,
                         arrays),
      name);
}

/* Indices of cells and nodes that a kernel over all of them has threads for. */
static inline uint32_t pressure_grid_indices(const solver *s) {
  return s->pressure_grid_is_torn ? (uint32_t)pbf_pressure_grid_max_nodes(s->scene_capacity)
                                  : s->pressure_grid.nodes;
}

/* Before the particles are summed up, in sums that lie elsewhere on ranks. */
static inline pbf_status clear_pressure_grid(solver *s, const pressure_grid_arrays &arrays,
                                             const pressure_grid_arrays &own) {
  unsigned long long *sums = own.sums;
  const uint64_t bytes = 2 * pressure_grid_indices(s) * sizeof *sums;
  const bool apart = sums != arrays.sums;
  if (own.cell_moves)
    if (pbf_status status = pbf_cuda_check(
            cudaMemsetAsync(own.cell_moves, 0,
                            PBF_DIM * pressure_grid_indices(s) * sizeof *own.cell_moves, s->stream),
            "cudaMemsetAsync"))
      return status;
  if (apart)
    if (pbf_status status =
            pbf_cuda_check(cudaMemsetAsync(sums, 0, bytes, s->stream), "cudaMemsetAsync"))
      return status;
  return pbf_cuda_check(
      cudaMemsetAsync(arrays.control, 0, sizeof *arrays.control + (apart ? 0 : bytes), s->stream),
      "cudaMemsetAsync");
}

/* From those of all ranks. */
static inline pbf_status add_sums_of_ranks(solver *s, const pressure_grid_arrays &arrays) {
  const rank_state &r = s->ranks;
  const pbf_pressure_grid_topology &t = arrays.topology;
  const bool torn = s->pressure_grid_is_torn;
  const rank_indices indices = {pressure_grid_indices(s),
                                torn ? t.first : PBF_NO_INDEX,
                                t.max_further,
                                t.counts + PBF_FURTHER_COMPARTMENTS,
                                t.further,
                                t.home,
                                r.index_room};
  if (torn)
    if (pbf_status status =
            pbf_cuda_check(cudaMemcpyAsync(rank_further(r.room, r.count, r.halo_room, r.index_room),
                                           t.further, s->pressure_grid.nodes * sizeof *t.further,
                                           cudaMemcpyDeviceToDevice, s->stream),
                           "cudaMemcpyAsync"))
      return status;
  const uint64_t sums = arrays.cell_moves ? RANK_SUMS : RANK_SUMS - PBF_DIM;
  const rank_range shown[RANK_RANGES] = {
      {rank_sums_begin(r.count, r.halo_room), sums * indices.count * sizeof(unsigned long long)},
      {rank_further_begin(r.count, r.halo_room, r.index_room),
       torn ? s->pressure_grid.nodes * sizeof *t.further : 0}};
  meet_ranks(
      s,
      [&](const rank_place &place) {
        add_sums_kernel<<<RANK_EXCHANGE_BLOCKS, PBF_BLOCK, 0, s->stream>>>(
            place, r.halo_room, indices, arrays.sums, arrays.cell_moves);
      },
      [&](const rank_place &) { carry_shown(s, shown); });
  return s->ranks.failed ? s->ranks.failed : pbf_cuda_check_launch("add_sums_kernel");
}

static inline pbf_status clear_topology(solver *s, const pressure_grid_arrays &arrays) {
  const pbf_pressure_grid_topology &t = arrays.topology;
  const struct {
    void *data;
    uint64_t bytes;
  } cleared[] = {{t.counts, 64},
                 {t.links, t.limit * (1 + PBF_PARTS) * sizeof *t.links},
                 {t.touched, t.limit * 2ull * sizeof *t.touched},
                 {t.corners, t.limit * (uint64_t)PBF_CORNERS * sizeof *t.corners}};
  for (const auto &array : cleared)
    if (pbf_status status = pbf_cuda_check(cudaMemsetAsync(array.data, 0, array.bytes, s->stream),
                                           "cudaMemsetAsync"))
      return status;
  return PBF_OK;
}

/* As bytes: what is padding has been zeroed with the solver, or here. */
static inline found_topology topology_wanted(const solver *s) {
  found_topology wanted;
  memset(static_cast<void *>(&wanted), 0, sizeof wanted);
  wanted.memory = s->topology_memory;
  wanted.particles = s->planned;
  wanted.solids = s->pressure_grid_solids;
  wanted.grid = s->pressure_grid;
  wanted.domain = s->pressure_grid_domain;
  return wanted;
}

/* What thin solids divide the grid into, of these colliders: none of them moves in this step where
 * they `stand`. */
static inline pbf_status find_topology(solver *s, const pressure_grid_arrays &arrays,
                                       const pbf_surface *surfaces, bool stand) {
  if (!s->pressure_grid_is_torn) return PBF_OK;
  const pbf_pressure_grid &grid = s->pressure_grid;
  const uint32_t blocks = blocks_for(grid.nodes);
  const found_topology wanted = topology_wanted(s);
  if (stand && memcmp(&s->topology, &wanted, sizeof wanted) == 0) return PBF_OK;
  s->topology.memory = nullptr;
  if (pbf_status status = clear_topology(s, arrays)) return status;
  if (s->pressure_grid_solids > 0)
    if (pbf_status status =
            pbf_cuda_check(cudaMemcpyAsync(const_cast<pbf_surface *>(arrays.topology.surfaces),
                                           surfaces, s->pressure_grid_solids * sizeof *surfaces,
                                           cudaMemcpyDeviceToDevice, s->stream),
                           "cudaMemcpyAsync"))
      return status;
  with_surfaces(s, [&](auto surfaces_of_step) {
    constexpr surfaces_met SURFACES = decltype(surfaces_of_step)::value;
    divide_cells_kernel<SURFACES><<<blocks, PBF_BLOCK, 0, s->stream>>>(grid, arrays);
    link_cells_kernel<SURFACES><<<blocks, PBF_BLOCK, 0, s->stream>>>(grid, arrays);
  });
  merge_compartments_kernel<<<blocks, PBF_BLOCK, 0, s->stream>>>(grid, arrays);
  tear_nodes_kernel<<<blocks, PBF_BLOCK, 0, s->stream>>>(grid, arrays);
  list_torn_nodes_kernel<<<blocks, PBF_BLOCK, 0, s->stream>>>(grid, arrays);
  if (pbf_status status = pbf_cuda_check_launch("list_torn_nodes_kernel")) return status;
  if (stand) s->topology = wanted;
  return PBF_OK;
}

static inline void launch_guess(solver *s, const pressure_grid_arrays &arrays) {
  const pbf_pressure_grid &grid = s->pressure_grid;
  const uint32_t columns = pbf_pressure_grid_columns(&grid);
  if (!s->collider_count && !s->pressure_grid_is_torn) {
    launch_early(s, guess_over_walls_kernel, blocks_for(32 * columns), PBF_BLOCK, 0, grid, arrays);
    return;
  }
  if (s->pressure_grid_is_torn)
    guess_torn_kernel<<<blocks_for(pressure_grid_indices(s)), PBF_BLOCK, 0, s->stream>>>(grid,
                                                                                         arrays);
  guess_kernel<<<blocks_for(columns), PBF_BLOCK, 0, s->stream>>>(grid, arrays);
}

/* The grid's equations and their solution, once the particles have been summed up. */
static inline pbf_status solve_pressure_grid(solver *s, const step_obstacles &obstacles) {
  const pbf_pressure_grid &grid = s->pressure_grid;
  pressure_grid_arrays arrays = pressure_grid_of(s);
  const uint32_t indices = pressure_grid_indices(s), torn = s->pressure_grid_is_torn ? indices : 0;
  const uint32_t blocks = blocks_for(indices), with_torn = blocks_for(grid.nodes + torn);
  with_surfaces(s, [&](auto surfaces) {
    launch_early(s, pressure_grid_cells_kernel<decltype(surfaces)::value>, blocks, PBF_BLOCK, 0,
                 grid, obstacles, arrays);
  });
  launch_early(s, pressure_grid_depths_kernel, with_torn, PBF_BLOCK, 0, grid, arrays);
  launch_early(s, pressure_grid_nodes_kernel, with_torn, PBF_BLOCK, 0, grid, arrays);
  if (s->pressure_grid_gains)
    with_surfaces(s, [&](auto surfaces) {
      launch_early(s, pressure_grid_gains_kernel<decltype(surfaces)::value>, with_torn, PBF_BLOCK,
                   0, grid, obstacles, arrays);
    });
  launch_guess(s, arrays);
  if (pbf_status status = launch_pressure_grid_solve(s, grid, arrays)) return status;
  launch_early(s, extrapolate_kernel, with_torn, PBF_BLOCK, 0, grid, arrays);
  return pbf_cuda_check_launch("extrapolate_kernel");
}

/* Where the particles are that `launch(kernel, arguments...)` is for, on ranks those of all: waits
 * for the device. */
template <class Launch>
static inline pbf_status find_fluid(solver *s, const sorted_particles &particles, Launch launch,
                                    pbf_fluid_bounds *fluid) {
  pressure_grid_control *control = pressure_grid_of(s).control;
  unsigned long long mine[2 * PBF_DIM], all[RANKS_OF_CUDA][2 * PBF_DIM];
  if (pbf_status status = pbf_cuda_check(
          cudaMemsetAsync(control->farthest, 0, sizeof mine, s->stream), "cudaMemsetAsync"))
    return status;
  launch(farthest_particles_kernel, particles, control);
  if (pbf_status status = pbf_cuda_check_launch("farthest_particles_kernel")) return status;
  if (pbf_status status = copy_out(s, mine, control->farthest, sizeof mine)) return status;
  if (has_ranks(s) && !gather_on_ranks(s, mine, all, sizeof mine)) return s->ranks.failed;
  for (uint32_t r = 0; has_ranks(s) && r < s->ranks.count; ++r)
    for (int side = 0; side < 2 * PBF_DIM; ++side) mine[side] = max(mine[side], all[r][side]);
  for (int k = 0; k < PBF_DIM; ++k) {
    fluid->lower.c[k] = (pbf_real)-real_of_ordered(mine[2 * k]);
    fluid->upper.c[k] = (pbf_real)real_of_ordered(mine[2 * k + 1]);
  }
  return PBF_OK;
}

/* The grid of the step that ends at `time`, between these walls and in the containers; where there
 * are thin solids, in fewer of the indices. Where these are not enough for all cells `find(bounds)`
 * is asked where the fluid is. */
template <class Find>
static inline pbf_status place_pressure_grid(solver *s, const pbf_domain &walls, double time,
                                             Find find) {
  const uint64_t limit = pbf_pressure_grid_limit(s->planned);
  const uint64_t fewer = pbf_pressure_grid_first_further(limit);
  pbf_fluid_bounds around;
  pbf_domain domain = walls;
  bool thin = false;
  for (uint32_t k = 0; k < s->collider_count; ++k) {
    pbf_surface surface =
        pbf_surface_at(&s->colliders[k], time - s->collider_time, s->params.time_step);
    domain = pbf_domain_within(domain, &surface);
  }
  const bool whole = pbf_pressure_grid_is_whole(&s->params, &domain, fewer);
  if (!whole)
    if (pbf_status status = find(&around)) return status;
  const pbf_fluid_bounds *fluid = whole ? nullptr : &around;
  s->pressure_grid =
      pbf_pressure_grid_between(&s->params, &domain, s->schedule.corrects_shear, limit, fluid);
  s->pressure_grid_domain = walls;
  s->pressure_grid_gains = false;
  for (uint32_t k = 0; k < s->collider_count; ++k) {
    pbf_surface surface =
        pbf_surface_at(&s->colliders[k], time - s->collider_time, s->params.time_step);
    thin = thin || pbf_surface_is_thin(&s->pressure_grid, &surface);
    s->pressure_grid_gains = s->pressure_grid_gains || surface.gains;
  }
  s->pressure_grid_is_torn =
      s->topology_memory && (thin || pbf_pressure_grid_is_periodic(&s->pressure_grid));
  s->pressure_grid_solids = s->pressure_grid_is_torn ? (int)s->collider_count : 0;
  if (s->pressure_grid_is_torn)
    s->pressure_grid =
        pbf_pressure_grid_between(&s->params, &domain, s->schedule.corrects_shear, fewer, fluid);
  pbf_pressure_grid_set_gains(&s->pressure_grid, &s->params, &domain, time);
  return PBF_OK;
}

#endif
