/* Part of launch.h: worlds of a batch, a block each, all steps of a call in one launch. Where
 * worlds are many what counts is not how soon a step ends but how little it takes: no block waits
 * for another, a particle has one thread, and all of a world that is read at random is in shared
 * memory. Lists lie in memory, where they are read in order.
 *
 * A world has the bits that small_kernel gives it. There a particle has WORLD_LANES threads, each
 * with a list and sums of its own, which are added up in pairs; here one thread goes through these
 * lists one after the other, and adds the sums up in the same order. Lists are made as there. */
#ifndef PBF_CUDA_SMALL_WORLD_H
#define PBF_CUDA_SMALL_WORLD_H

#include "cuda/small/kernel.h"

enum {
  WORLD_LANES = 8,  /* lists of a particle, of which … */
  WORLD_CHUNK = 4,  /* … so many entries lie side by side, … */
  WORLD_QUADS = 4,  /* … of two lists in 16 bytes */
  WORLD_ALWAYS = 3, /* entries of a list that are met without a look at how many there are */
  WORLD_AHEAD = 4,  /* candidates of a thread at once */
  WORLD_PAD = WORLD_AHEAD * WORLD_LANES /* what the search reads beyond the last point */
};

/* Blocks of a multiprocessor: colliders take registers. */
constexpr uint32_t world_blocks(surfaces_met surfaces) { return surfaces == NO_SURFACES ? 2 : 1; }

/* What a block is told of its world; behind it the steps, the iterations and the colliders. */
struct alignas(16) world_record {
  small_scene scene;
  general_buffers general;
  uint4 *lists;    /* entries of a chunk of two lists of a particle, by chunk, lists and particle */
  uint32_t padded; /* particles, as they are there */
};

/* How a block divides up its dynamic shared memory; of all worlds of a launch. */
struct world_layout {
  uint32_t slots;  /* particles, and the one that fills up chunks; even */
  uint32_t cells;  /* even */
  uint32_t listed; /* entries of a list that grows */

  __host__ __device__ uint32_t scratch() const { /* bytes, of what is dead before lists grow, too */
    const uint32_t lists = SMALL_THREADS * listed * (uint32_t)sizeof(uint16_t),
                   sort = cells * (uint32_t)sizeof(uint32_t) + slots * (uint32_t)sizeof(uint16_t);
    return ((lists > sort ? lists : sort) + 15) / 16 * 16;
  }
  __host__ __device__ size_t bytes() const {
    return 2 * ((size_t)slots + WORLD_PAD) * sizeof(point) + scratch() + slots * sizeof(float) +
           (cells + 2) * sizeof(uint16_t) + slots * (sizeof(uint16_t) + sizeof(uint8_t));
  }
};

/* A block's dynamic shared memory. Slots are the world's particles, by cell and id. */
struct world_tile {
  point *points[2]; /* of even and odd passes: position and lambda of a slot */
  pbf_real *totals; /* accelerated: lambda that has added up */
  uint32_t *counts; /* of a cell's particles; dead once `starts` are there */
  uint16_t *lists;  /* that grow, a thread's entries side by side */
  uint16_t *starts; /* a cell each: its first slot; one more at the end */
  uint16_t *ids;    /* a slot's particle */
  uint16_t *sorted; /* particles by cell; dead once `ids` are there */
  uint8_t *rows;    /* a slot each: entries of the longest of its lists */
};

static __device__ __forceinline__ world_tile world_tile_in(void *shared, const world_layout &l) {
  world_tile t;
  t.points[0] = static_cast<point *>(shared);
  t.points[1] = t.points[0] + l.slots + WORLD_PAD;
  t.lists = reinterpret_cast<uint16_t *>(t.points[1] + l.slots + WORLD_PAD);
  t.counts = reinterpret_cast<uint32_t *>(t.lists);
  t.sorted = reinterpret_cast<uint16_t *>(t.counts + l.cells);
  t.totals = reinterpret_cast<pbf_real *>(t.lists + l.scratch() / sizeof(uint16_t));
  t.starts = reinterpret_cast<uint16_t *>(t.totals + l.slots);
  t.ids = t.starts + l.cells + 2;
  t.rows = reinterpret_cast<uint8_t *>(t.ids + l.slots);
  return t;
}

/* Where the search looks. */
static __device__ __forceinline__ pbf_vec position_in(const world_tile &t, uint32_t slot) {
  return position_of(load(t.points[0], slot));
}

/* ---- Sort ------------------------------------------------------------------------------------ */

/* From the cells' counts, their first slots. */
static __device__ __forceinline__ void number_slots(const world_tile &t, uint32_t cells) {
  __shared__ uint32_t sums[32];
  const uint32_t lane = threadIdx.x % 32, warp = threadIdx.x / 32;
  const uint32_t size = (cells + blockDim.x - 1) / blockDim.x;
  const uint32_t first = min(threadIdx.x * size, cells), end = min(first + size, cells);
  uint32_t sum = 0;
  for (uint32_t k = first; k < end; ++k) sum += t.counts[k];
  uint32_t before = sum;
  for (uint32_t step = 1; step < 32; step *= 2) {
    const uint32_t other = __shfl_up_sync(~0u, before, step);
    if (lane >= step) before += other;
  }
  if (lane == 31) sums[warp] = before;
  __syncthreads();
  before -= sum;
  for (uint32_t k = 0; k < warp; ++k) before += sums[k];
  for (uint32_t k = first; k < end; ++k) {
    t.starts[k] = (uint16_t)before;
    before += t.counts[k];
  }
  if (threadIdx.x + 1 == blockDim.x) t.starts[cells] = (uint16_t)before;
  __syncthreads();
}

/* Predicts the particles, and sorts them into slots. False when a cell has too many. */
template <surfaces_met SURFACES>
static __device__ __forceinline__ bool fill_world(const world_tile &t, const small_scene &scene,
                                                  const cell_grid &grid, const pbf_forces &forces,
                                                  const step_obstacles &obstacles) {
  const uint32_t n = scene.count;
  for (uint32_t k = threadIdx.x; k < grid.count; k += blockDim.x) t.counts[k] = 0;
  __syncthreads();
  bool crowded = false;
  for (uint32_t i = threadIdx.x; i < n; i += blockDim.x) {
    const pbf_vec x = position_of(load(scene.points, i));
    pbf_vec y = pbf_predict(&forces, x, scene.velocities[i]);
    if (scene.collide_after_prediction) y = resolve_collisions<SURFACES>(obstacles, 1, x, y);
    const uint32_t cell = cell_number(grid, place_in(grid, y).at);
    const uint32_t place = atomicAdd(t.counts + cell, 1u);
    crowded |= place >= SMALL_CELL_CAPACITY;
    point own = point_at(y);
    own.lambda = __uint_as_float(cell | place << 16);
    store(t.points[1], i, own);
  }
  if (__syncthreads_or(crowded)) return false;
  number_slots(t, grid.count);
  for (uint32_t i = threadIdx.x; i < n; i += blockDim.x) {
    const uint32_t word = __float_as_uint((float)t.points[1][i].lambda);
    t.sorted[t.starts[word & 0xffff] + (word >> 16)] = (uint16_t)i;
  }
  __syncthreads();
  for (uint32_t i = threadIdx.x; i < n; i += blockDim.x) {
    point own = load(t.points[1], i);
    const uint32_t cell = __float_as_uint((float)own.lambda) & 0xffff;
    const uint32_t start = t.starts[cell], end = t.starts[cell + 1];
    uint32_t slot = start;
    for (uint32_t k = start; k < end; ++k) slot += t.sorted[k] < i;
    own.lambda = 0;
    t.ids[slot] = (uint16_t)i;
    store(t.points[0], slot, own);
  }
  __syncthreads();
  return true;
}

/* ---- Lists ----------------------------------------------------------------------------------- */

/* search_tile by slots that are in the order of all cells. */
static __device__ __forceinline__ void search_world(const world_tile &t, const cell_grid &grid,
                                                    const small_search &s, uint32_t own, bool real,
                                                    small_list *list) {
  const auto slots_in = [&](uint32_t cell, uint32_t cells) {
    return t.starts[cell] | (uint32_t)t.starts[cell + cells] << 16;
  };
  search_runs<WORLD_AHEAD>(t, grid, s, own, real, slots_in, list);
}

/* A thread's list goes to memory, as far as the longest of its particle's. */
static __device__ __forceinline__ void keep_list(const world_record &world, const small_list &list,
                                                 uint32_t slot, uint32_t lane, uint32_t rows,
                                                 uint32_t sentinel) {
  uint2 *to = reinterpret_cast<uint2 *>(world.lists);
  for (uint32_t first = 0, chunk = 0; chunk == 0 || first < rows; first += WORLD_CHUNK, ++chunk) {
    uint32_t e[WORLD_CHUNK];
#pragma unroll
    for (uint32_t q = 0; q < WORLD_CHUNK; ++q)
      e[q] = first + q < list.size ? list.at(first + q) : sentinel;
    const size_t quad = (size_t)(chunk * WORLD_QUADS + lane / 2) * world.padded + slot;
    to[2 * quad + lane % 2] = {e[0] | e[1] << 16, e[2] | e[3] << 16};
  }
}

/* Lists the neighbours, with WORLD_LANES threads a particle. False when a list has no room. */
static __device__ __forceinline__ bool list_world(const world_tile &t, const world_record &world,
                                                  const cell_grid &grid) {
  const small_scene &scene = world.scene;
  const uint32_t n = scene.count, lane = threadIdx.x % WORLD_LANES;
  const pbf_real h2 = scene.constants.h2;
  bool fits = true;
  for (uint32_t first = 0; first < n; first += blockDim.x / WORLD_LANES) {
    const uint32_t slot = first + threadIdx.x / WORLD_LANES;
    small_list list = {t.lists + threadIdx.x, 0, scene.layout.list_capacity - SMALL_CHUNK};
    const pbf_vec x = position_in(t, min(slot, n - 1));
    const small_search look = {place_in(grid, x), x, slot, lane, WORLD_LANES, h2};
    search_world(t, grid, look, slot, slot < n, &list);
    if (list.size > list.max_size) {
      fits = false;
      list.size = 0;
    }
    __syncwarp();
    list.balance(lane, WORLD_LANES);
    uint32_t rows = list.size;
#pragma unroll
    for (uint32_t step = 1; step < WORLD_LANES; step *= 2)
      rows = max(rows, __shfl_xor_sync(~0u, rows, (int)step));
    if (slot < n) {
      keep_list(world, list, slot, lane, rows, n);
      if (lane == 0) t.rows[slot] = (uint8_t)rows;
    }
    __syncwarp();
  }
  return !__syncthreads_or(!fits);
}

/* A particle's lists. */
struct world_lists {
  const uint4 *of; /* its first */
  uint32_t padded, rows;

  __device__ __forceinline__ uint4 quad(uint32_t pair) const { return of[(size_t)pair * padded]; }
  /* Entries 4 chunk … 4 chunk + 3 of a list. */
  __device__ __forceinline__ uint2 entries(uint32_t chunk, uint32_t lane) const {
    const uint4 *at = of + (size_t)(chunk * WORLD_QUADS + lane / 2) * padded;
    return reinterpret_cast<const uint2 *>(at)[lane % 2];
  }
};

static __device__ __forceinline__ world_lists lists_in(const world_record &world,
                                                       const world_tile &t, uint32_t slot) {
  return {world.lists + slot, world.padded, t.rows[slot]};
}

static __device__ __forceinline__ uint32_t entry_of(uint2 entries, uint32_t q) {
  const uint32_t word = q / 2 ? entries.y : entries.x;
  return q % 2 ? word >> 16 : word & 0xffff;
}

/* The sums of all lists, added up as small_kernel's threads do: in pairs, pairs of pairs, … .
 * sum(lane, entries) is that of one, of which it is given the first entries. */
template <class Sums, class Sum>
static __device__ __forceinline__ Sums sum_lists(const world_lists &lists, Sum sum) {
  Sums all, half;
  uint4 next = lists.quad(0);
#pragma unroll
  for (uint32_t pair = 0; pair < WORLD_QUADS; ++pair) {
    const uint4 now = next;
    if (pair + 1 < WORLD_QUADS) next = lists.quad(pair + 1);
    Sums two = sum(2 * pair, uint2{now.x, now.y});
    add_sums(&two, sum(2 * pair + 1, uint2{now.z, now.w}));
    if (pair == 0) {
      all = two;
    } else if (pair == 1) {
      add_sums(&all, two);
    } else if (pair == 2) {
      half = two;
    } else {
      add_sums(&half, two);
      add_sums(&all, half);
    }
  }
  return all;
}

/* ---- Passes ---------------------------------------------------------------------------------- */

/* The pair's terms of a pass, of entries 0 … SMALL_KEPT - 1 as small_pairs has them. */
template <int FEATURES>
struct world_passes {
  typedef lambda_pass<fixed<FEATURES>, SCALED_SUMS> lambdas;
  typedef move_pass_of<fixed<FEATURES>, SCALED_SUMS> moves;

  static __device__ __forceinline__ lambda_sums<pbf_real> sum_lambda(const lambdas &pass,
                                                                     const world_lists &lists,
                                                                     const point *points,
                                                                     pbf_vec x) {
    return sum_lists<lambda_sums<pbf_real>>(lists, [&](uint32_t lane, uint2 entries) {
      lambda_sums<pbf_real> sums = {};
      point others[WORLD_ALWAYS];
#pragma unroll
      for (uint32_t q = 0; q < WORLD_ALWAYS; ++q) others[q] = load(points, entry_of(entries, q));
#pragma unroll
      for (uint32_t q = 0; q < WORLD_ALWAYS; ++q)
        pass.pair(&sums, {}, neighbor_between(x, position_of(others[q])));
#pragma unroll 1
      for (uint32_t row = WORLD_ALWAYS; row < lists.rows; ++row) {
        if (row % WORLD_CHUNK == 0) entries = lists.entries(row / WORLD_CHUNK, lane);
        const point other = load(points, entry_of(entries, row % WORLD_CHUNK));
        pass.pair(&sums, {}, neighbor_between(x, position_of(other)));
      }
      return sums;
    });
  }

  /* Lambda's pair gives V grad W of the first entries, and the artificial pressure, which come
   * before all lambdas. */
  static __device__ __forceinline__ lane_vector<pbf_real> gradient_of(
      const lambdas &of_lambda, const neighbor_of<pbf_real> &j, pbf_real *value) {
    pbf_real slope;
    kernel_and_slope(of_lambda.features, of_lambda.c, of_lambda.value_scale(),
                     of_lambda.slope_scale(), j.r2, value, &slope);
    lane_vector<pbf_real> gradient = j.x_ij;
    gradient.scale(slope);
    return gradient;
  }

  static __device__ __forceinline__ void add_first(const lambdas &of_lambda, const moves &of_move,
                                                   pbf_vec x, pbf_real lambda, const point &other,
                                                   move_sums<pbf_real> *sums) {
    pbf_real value;
    const auto gradient = gradient_of(of_lambda, neighbor_between(x, position_of(other)), &value);
    of_move.add_lambdas(sums, lambda + other.lambda, gradient);
  }

  /* What small_pairs adds before it knows lambda. */
  static __device__ __forceinline__ void add_artificial_pressures(
      const lambdas &of_lambda, const moves &of_move, const world_lists &lists, uint32_t lane,
      uint2 entries, const point *points, pbf_vec x, move_sums<pbf_real> *sums) {
    const uint32_t end = min(lists.rows, (uint32_t)SMALL_KEPT);
#pragma unroll 1
    for (uint32_t row = 0; row < end; ++row) {
      if (row == WORLD_CHUNK) entries = lists.entries(1, lane);
      const point other = load(points, entry_of(entries, row % WORLD_CHUNK));
      pbf_real value;
      const auto gradient = gradient_of(of_lambda, neighbor_between(x, position_of(other)), &value);
      of_move.add_artificial_pressure(sums, of_lambda.c->value_scale * value, gradient);
    }
  }

  static __device__ __forceinline__ move_sums<pbf_real> sum_moves(const lambdas &of_lambda,
                                                                  const moves &of_move,
                                                                  const world_lists &lists,
                                                                  const point *points, pbf_vec x,
                                                                  pbf_real lambda) {
    return sum_lists<move_sums<pbf_real>>(lists, [&](uint32_t lane, uint2 entries) {
      move_sums<pbf_real> sums = of_move.template begin<pbf_real>();
      if (FEATURES & PBF_FEATURE_SCORR)
        add_artificial_pressures(of_lambda, of_move, lists, lane, entries, points, x, &sums);
      point others[WORLD_ALWAYS];
#pragma unroll
      for (uint32_t q = 0; q < WORLD_ALWAYS; ++q) others[q] = load(points, entry_of(entries, q));
#pragma unroll
      for (uint32_t q = 0; q < WORLD_ALWAYS; ++q)
        add_first(of_lambda, of_move, x, lambda, others[q], &sums);
#pragma unroll 1
      for (uint32_t row = WORLD_ALWAYS; row < lists.rows; ++row) {
        if (row % WORLD_CHUNK == 0) entries = lists.entries(row / WORLD_CHUNK, lane);
        const point other = load(points, entry_of(entries, row % WORLD_CHUNK));
        if (row < SMALL_KEPT) {
          add_first(of_lambda, of_move, x, lambda, other, &sums);
        } else {
          auto j = neighbor_between(x, position_of(other));
          j.number = other.lambda;
          of_move.pair(&sums, {lambda}, j);
        }
      }
      return sums;
    });
  }
};

/* ---- Steps ----------------------------------------------------------------------------------- */

/* Lambda of all slots, beside the positions; `points` are those of this pass. What obstacles
 * contribute lies where the move will take the slot. */
template <int FEATURES, surfaces_met SURFACES>
static __device__ __forceinline__ void world_lambda(const world_tile &t, const world_record &world,
                                                    const step_obstacles &obstacles, uint32_t k,
                                                    point *points, point *moved) {
  typedef world_passes<FEATURES> passes;
  const small_scene &scene = world.scene;
  const bool accelerated = PBF_CHEBYSHEV && scene.accelerated;
  const pbf_constants now = accelerated ? constants_at(scene, k) : scene.constants;
  const typename passes::lambdas of_pairs = {&now, {}}, of_lambda = {&scene.constants, {}};
  for (uint32_t slot = threadIdx.x; slot < scene.count; slot += blockDim.x) {
    const point own = load(points, slot);
    const pbf_vec x = position_of(own);
    auto sums = passes::sum_lambda(of_pairs, lists_in(world, t, slot), points, x);
    add_sums(&sums, of_lambda.template begin<pbf_real>());
    of_lambda.end(&sums);
    if (scene.wall_density) {
      const obstacle_part part = obstacles_at<SURFACES>(&scene.constants, obstacles, x);
      add_obstacles(part, &sums);
      store(moved, slot, part.move);
    }
    pbf_real lambda = of_lambda.finish(sums, 0);
    if (accelerated) {
      pbf_real change = own.lambda, total = k == 0 ? 0 : t.totals[slot];
      pbf_accelerate(&now, sums.density, lambda, &total, &change);
      if (k + 1 == scene.iterations)
        pbf_smooth_pressure(&now, scene.last_pressure[t.ids[slot]], &total, &change);
      t.totals[slot] = total;
      lambda = change;
    }
    points[slot].lambda = lambda; /* which is not read in this pass */
  }
}

/* Moves all slots to `moved`, the last time into the state. */
template <int FEATURES, surfaces_met SURFACES>
static __device__ __forceinline__ void world_move(const world_tile &t, const world_record &world,
                                                  const step_obstacles &obstacles,
                                                  const pbf_forces &forces, uint32_t k,
                                                  const point *points, point *moved) {
  typedef world_passes<FEATURES> passes;
  const small_scene &scene = world.scene;
  const sorted_particles &kept = world.general.sorted;
  const bool accelerated = PBF_CHEBYSHEV && scene.accelerated, last = k + 1 == scene.iterations;
  const pbf_constants now = accelerated ? constants_at(scene, k) : scene.constants;
  const typename passes::lambdas of_lambda = {&now, {}};
  const typename passes::moves of_pairs = {&now, {}}, of_move = {&scene.constants, {}};
  const move_finish end = {false, /* what walls have to do with it comes before */
                           scene.collide_in_iteration + (last && scene.collide_after_solve),
                           scene.inv_time_step};
  for (uint32_t slot = threadIdx.x; slot < scene.count; slot += blockDim.x) {
    const point own = load(points, slot);
    const pbf_vec x = position_of(own);
    const uint32_t i = t.ids[slot];
    auto sums =
        passes::sum_moves(of_lambda, of_pairs, lists_in(world, t, slot), points, x, own.lambda);
    of_pairs.end(&sums);
    if (scene.wall_density) correct_move(own.lambda, load(moved, slot), &sums);
    pbf_vec predicted = x, v;
    if (k == 0) {
      const pbf_vec from = position_of(load(scene.points, i)), was = scene.velocities[i];
      v = pbf_predicted_velocity(&forces, from, was, pbf_predict(&forces, from, was), x);
      if (SURFACES) store(kept.points, slot, own);
    } else {
      v = kept.velocities[slot];
      if (SURFACES) predicted = position_of(load(kept.points, slot));
    }
    point to = point_at(finish_move<SURFACES>(of_move, obstacles, end, own.lambda, false, i,
                                              predicted, x, sums, &v));
    if (last) {
      to.lambda = accelerated ? t.totals[slot] : 0;
      if (accelerated) scene.last_pressure[i] = pbf_pressure_to_keep(&scene.constants, to.lambda);
      store(scene.points, i, to);
      scene.velocities[i] = v;
    } else {
      to.lambda = own.lambda;
      store(moved, slot, to);
      kept.velocities[slot] = v;
    }
  }
}

static __device__ __forceinline__ void copy_words(void *to, const void *from, uint32_t bytes) {
  for (uint32_t k = threadIdx.x; k < bytes / 4; k += blockDim.x)
    static_cast<uint32_t *>(to)[k] = static_cast<const uint32_t *>(from)[k];
}

/* Each block has a record, which lie `stride` bytes apart. */
template <int FEATURES, surfaces_met SURFACES>
static __global__ void __launch_bounds__(SMALL_THREADS, world_blocks(SURFACES))
    world_kernel(const char *records, uint32_t stride, world_layout layout) {
  extern __shared__ uint4 dynamic[];
  __shared__ uint4 room[(sizeof(world_record) + 15) / 16];
  __shared__ small_step now;
  const world_record &world = *reinterpret_cast<const world_record *>(room);
  const small_scene &scene = world.scene;
  const world_tile tile = world_tile_in(dynamic, layout);
  copy_words(room, records + (size_t)blockIdx.x * stride, sizeof(world_record));
  __syncthreads();
  if (threadIdx.x < 2) {
    point nowhere = {};
    for (int k = 0; k < PBF_DIM; ++k) nowhere.c[k] = (pbf_real)1e18;
    store(tile.points[threadIdx.x], scene.count, nowhere);
  }
  for (uint32_t step = 0; step < scene.steps; ++step) {
    copy_words(&now, scene.table + step, sizeof now);
    __syncthreads();
    const step_obstacles obstacles = {now.domain, SURFACES ? scene.surface_count : 0,
                                      scene.surfaces + step * scene.surface_count};
    const pbf_forces forces = forces_at(scene, now);
    if (!fill_world<SURFACES>(tile, scene, now.grid, forces, obstacles) ||
        !list_world(tile, world, now.grid)) {
      block_team team;
      general_step<FEATURES, SURFACES>(scene, world.general, step, &team);
      continue;
    }
    for (uint32_t k = 0; k < scene.iterations; ++k) {
      point *points = tile.points[k % 2], *moved = tile.points[(k + 1) % 2];
      world_lambda<FEATURES, SURFACES>(tile, world, obstacles, k, points, moved);
      __syncthreads();
      world_move<FEATURES, SURFACES>(tile, world, obstacles, forces, k, points, moved);
      __syncthreads();
    }
  }
}

#endif
