/* Small scenes: all steps of a call in one launch. A step of 30,000 particles is a matter of
 * latency: a launch takes longer than its work. Here a particle stays with the same few threads of
 * a resident grid, which keep its neighbours in shared memory, and the stages are parted by
 * barriers: one between the filling of the cells and the search, two an iteration; the last move
 * of a step runs on into the next prediction. The particles are in the order of their ids, so that
 * the order of every sum is a matter of cells and ids, as everywhere.
 *
 * Cells and lists have room for what fluids do. When one overflows, all blocks learn of it at the
 * next barrier, and do this step over by general_step, which has no limits and takes its time. */
#ifndef PBF_CUDA_SMALL_H
#define PBF_CUDA_SMALL_H

#include "cuda/barrier.h"
#include "cuda/lists.h"
#include "cuda/sums.h"

enum {
  SMALL_MOST_PARTICLES = 65535, /* cells and lists hold 16-bit numbers of particles */
  SMALL_STEPS = 64,             /* a launch */
  SMALL_THREADS = 1024,         /* of a block, at most */
  SMALL_CELL_ROOM = PBF_DIM == 3 ? 32 : 16,
  SMALL_LIST_ROOM = PBF_DIM == 3 ? 128 : 64, /* at most */
  SMALL_ITERATIONS = 256,
  SMALL_CELLS_AROUND = PBF_DIM == 3 ? 27 : 9
};

/* What differs from step to step. */
struct small_step {
  pbf_walls walls;
  cell_grid grid;
};

/* What differs from iteration to iteration of an accelerated solve. */
struct small_iteration {
  pbf_real weight, scorr_k;
};

/* What a launch is told of its steps, in one copy. */
struct small_upload {
  small_step steps[SMALL_STEPS];
  small_iteration iterations[SMALL_ITERATIONS];
};

struct small_scene {
  point *points;
  pbf_vec *velocities;
  uint32_t count, steps, iterations;
  uint32_t lanes;     /* threads of a particle, a power of two up to 16 */
  uint32_t list_room; /* neighbours */
  pbf_constants constants;
  pbf_forces forces;
  pbf_real inv_time_step;
  int wall_density, accelerated;
  int collide_after_prediction, collide_in_iteration, collide_after_solve;
  const small_step *table; /* a step each */
  const small_iteration *iteration_table;
  const pbf_solid *solids; /* solid_count a step */
  int solid_count;
};

struct small_room {
  point *points[2];     /* predicted, then moved to and fro */
  uint32_t *cell_count; /* 0 between steps */
  uint16_t *cell_list;  /* SMALL_CELL_ROOM each */
  grid_control *control;
};

/* For general_step. Sorted particles carry their number in the order of ids in place of the id. */
struct general_room {
  sorted_particles sorted;
  uint32_t *numbers;
  sort_scratch scratch;
  pbf_real *before; /* accelerated: lambda an iteration earlier; else null */
};

/* A particle's neighbours in shared memory, which its threads take in turns. */
struct small_list {
  uint16_t *entries;     /* `stride` apart */
  uint32_t stride, size; /* both the same in all threads of the particle */
  uint32_t lane, lanes;

  __device__ __forceinline__ uint16_t &at(uint32_t k) const { return entries[k * stride]; }

  /* Sorts `particle` into the entries from `first` on, of which there are `size` so far. */
  __device__ __forceinline__ void insert(uint32_t first, uint32_t count, uint32_t particle) const {
    uint32_t k = first + count;
    for (; k > first && at(k - 1) > particle; --k) at(k) = at(k - 1);
    at(k) = (uint16_t)particle;
  }

  /* Calls use(neighbour) for this thread's share; two loads are under way at a time. */
  template <class Use>
  __device__ __forceinline__ void gather(const point *points, Use use) const {
    for (uint32_t k = lane; k < size; k += 2 * lanes) {
      bool two = k + lanes < size;
      point a = load(points, at(k)), b = load(points, at(two ? k + lanes : k));
      use(a);
      if (two) use(b);
    }
  }
};

/* The constants of iteration k. For a wall's density the scene's serve: its tables, looked up in a
 * copy, would be in local memory. */
static __device__ __forceinline__ pbf_constants constants_at(const small_scene &scene, uint32_t k) {
  pbf_constants c = scene.constants;
  if (!PBF_CHEBYSHEV || !scene.accelerated) return c;
  c.weight = scene.iteration_table[k].weight;
  c.scorr_k = scene.iteration_table[k].scorr_k;
  return c;
}

/* Sums over the threads of a particle; every one of them gets the same bits. */
static __device__ __forceinline__ pbf_real sum_lanes(pbf_real value, uint32_t lanes) {
  for (uint32_t step = 1; step < lanes; step *= 2) value += __shfl_xor_sync(~0u, value, (int)step);
  return value;
}
static __device__ __forceinline__ pbf_vec sum_lanes(pbf_vec value, uint32_t lanes) {
  for (int k = 0; k < PBF_DIM; ++k) value.c[k] = sum_lanes(value.c[k], lanes);
  return value;
}

/* A particle's cell by its indices, those across the rows folded. */
struct cell_place {
  uint32_t at[PBF_DIM];
};

static __device__ __forceinline__ bool is_folded(const cell_grid &g, int k) {
  return k > 0 && g.cells[k] <= (uint32_t)g.last.c[k];
}

static __device__ __forceinline__ cell_place place_in(const cell_grid &g, pbf_vec x) {
  cell_place own;
  for (int k = 0; k < PBF_DIM; ++k) {
    own.at[k] = grid_index(g, k, grid_coordinate(g, k, x.c[k]));
    if (is_folded(g, k)) own.at[k] %= g.cells[k];
  }
  return own;
}

static __device__ __forceinline__ uint32_t cell_number(const cell_grid &g, const uint32_t *at) {
  uint32_t number = 0;
  for (int k = PBF_DIM - 1; k >= 0; --k) number = number * g.cells[k] + at[k];
  return number;
}

/* Cell `around` of the block of cells about `own`; false when it is outside. Without a division:
 * these took a third of the search. */
static __device__ __forceinline__ bool cell_around(const cell_grid &g, const cell_place &own,
                                                   uint32_t around, uint32_t *neighbor) {
  uint32_t at[PBF_DIM];
  for (int k = 0; k < PBF_DIM; ++k) {
    at[k] = own.at[k] + around % 3 - 1;
    around /= 3;
    if (at[k] < g.cells[k]) continue;
    if (!is_folded(g, k)) return false;
    at[k] = at[k] == g.cells[k] ? 0 : g.cells[k] - 1;
  }
  *neighbor = cell_number(g, at);
  return true;
}

/* Which of the particles that a cell lists are near x; *row is where it lists them. */
static __device__ __forceinline__ uint32_t near_in_cell(const small_room &room, uint32_t cell,
                                                        const point *points, pbf_vec x,
                                                        uint32_t own, pbf_real h2,
                                                        const uint16_t **row) {
  *row = room.cell_list + (size_t)cell * SMALL_CELL_ROOM;
  const uint2 *fours = reinterpret_cast<const uint2 *>(*row);
  uint2 four = fours[0]; /* in flight together with the count */
  uint32_t count = min(room.cell_count[cell], (uint32_t)SMALL_CELL_ROOM), near = 0;
  for (uint32_t k = 0; k < count; k += 4) {
    const uint32_t particles[4] = {four.x & 0xffff, four.x >> 16, four.y & 0xffff, four.y >> 16};
    point candidates[4];
#pragma unroll
    for (uint32_t q = 0; q < 4; ++q)
      candidates[q] = load(points, k + q < count ? particles[q] : own);
    if (k + 4 < count) four = fours[k / 4 + 1];
#pragma unroll
    for (uint32_t q = 0; q < 4; ++q) {
      pbf_vec d = pbf_sub(x, position_of(candidates[q]));
      if (k + q < count && pbf_dot(d, d) < h2 && particles[q] != own) near |= 1u << (k + q);
    }
  }
  return near;
}

/* Fills the list with the neighbours in the cells around `place`, cell by cell and sorted within
 * each; false when there is no room. All threads of a warp call it together. */
static __device__ __forceinline__ bool search(const small_room &room, const cell_grid &grid,
                                              const cell_place &place, const point *points,
                                              pbf_vec x, uint32_t own, bool real, pbf_real h2,
                                              uint32_t list_room, small_list *list) {
  list->size = 0;
  for (uint32_t first = 0; first < SMALL_CELLS_AROUND; first += list->lanes) {
    uint32_t around = first + list->lane, neighbor, near = 0;
    const uint16_t *row = nullptr;
    if (real && around < SMALL_CELLS_AROUND && cell_around(grid, place, around, &neighbor))
      near = near_in_cell(room, neighbor, points, x, own, h2, &row);
    /* The threads' cells come one after the other. */
    uint32_t count = (uint32_t)__popc(near), end = count;
    for (uint32_t step = 1; step < list->lanes; step *= 2) {
      uint32_t before = __shfl_up_sync(~0u, end, step, (int)list->lanes);
      if (list->lane >= step) end += before;
    }
    uint32_t next = list->size + end - count;
    list->size += __shfl_sync(~0u, end, (int)list->lanes - 1, (int)list->lanes);
    for (uint32_t k = 0; near && list->size <= list_room; near &= near - 1, ++k)
      list->insert(next, k, row[__ffs((int)near) - 1]);
  }
  __syncwarp();
  if (list->size <= list_room) return true;
  list->size = 0;
  return false;
}

static __device__ __forceinline__ void scan_by_first_block(uint32_t *values, uint32_t count) {
  __shared__ uint32_t shared[SMALL_THREADS];
  uint32_t size = (count + blockDim.x - 1) / blockDim.x, sum = 0;
  uint32_t first = min(threadIdx.x * size, count), end = min(first + size, count);
  if (blockIdx.x != 0) return;
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

/* One step of the particles in scene.points by all threads of the grid: every stage a loop over the
 * particles and a barrier, and no lists. Returns the number of the last barrier. */
template <int FEATURES>
static __device__ __noinline__ uint32_t general_step(const small_scene &scene,
                                                     const small_room &small,
                                                     const general_room &room, uint32_t step,
                                                     uint32_t turn) {
  const pbf_constants *c = &scene.constants;
  const cell_grid grid = scene.table[step].grid;
  uint32_t first = thread_index(), stride = gridDim.x * blockDim.x, n = scene.count;
  const sorted_particles &p = room.sorted;
  step_obstacles obstacles = {scene.table[step].walls, scene.solid_count,
                              scene.solids + step * scene.solid_count};
  prediction predict = {scene.forces, obstacles, scene.collide_after_prediction};
  unsorted_particles from = {scene.points, scene.velocities, room.numbers, n};
  grid_barrier(small.control, ++turn);
  if (first == 0) small.control->cells_failed = small.control->lists_failed = 0;
  for (uint32_t k = first; k <= grid.count; k += stride) p.cell_start[k] = 0;
  for (uint32_t i = first; i < n; i += stride) room.numbers[i] = i;
  grid_barrier(small.control, ++turn);
  for (uint32_t i = first; i < n; i += stride)
    count_particle<true, false>(from, predict, grid, p.cell_start, room.scratch, i);
  grid_barrier(small.control, ++turn);
  scan_by_first_block(p.cell_start, grid.count + 1);
  grid_barrier(small.control, ++turn);
  for (uint32_t i = first; i < n; i += stride)
    scatter_particle(from, p.cell_start, room.scratch, i);
  grid_barrier(small.control, ++turn);
  for (uint32_t i = first; i < n; i += stride)
    place_particle<true, false>(from, predict, room.scratch, p, i);
  grid_barrier(small.control, ++turn);
  point *points = p.points, *moved = small.points[0]; /* p.points keeps the prediction */
  for (uint32_t k = 0; k < scene.iterations; ++k) {
    bool last = k + 1 == scene.iterations;
    const pbf_constants now = constants_at(scene, k);
    for (uint32_t i = first; i < n; i += stride) {
      pbf_vec x = position_of(load(points, i));
      lambda_sums<FEATURES> sums;
      walk_cells(p, grid, i,
                 [&](uint32_t j) { sums.add(c, pbf_sub(x, position_of(load(points, j)))); });
      pbf_real lambda = sums.lambda(c, obstacles, scene.wall_density, 0, x);
      if (PBF_CHEBYSHEV && scene.accelerated) {
        pbf_real total = points[i].lambda, before = k == 0 ? 0 : room.before[i];
        pbf_accelerate(&now, lambda, &total, &before);
        room.before[i] = before;
        lambda = total;
      }
      points[i].lambda = lambda;
    }
    grid_barrier(small.control, ++turn);
    for (uint32_t i = first; i < n; i += stride) {
      point own = load(points, i);
      pbf_vec x = position_of(own);
      move_sum<FEATURES> sum;
      walk_cells(p, grid, i, [&](uint32_t j) {
        point other = load(points, j);
        sum.add(&now, pbf_sub(x, position_of(other)), own.lambda + other.lambda);
      });
      pbf_vec predicted = position_of(load(p.points, i));
      x = sum.template moved<true>(
          c, obstacles, scene.wall_density, scene.accelerated,
          scene.collide_in_iteration || (last && scene.collide_after_solve), own.lambda, predicted,
          x);
      point to = point_at(x);
      to.lambda = own.lambda;
      store(moved, i, to);
      if (!last) continue;
      store(scene.points, p.ids[i], to);
      scene.velocities[p.ids[i]] = pbf_velocity(scene.inv_time_step, p.velocities[i], predicted, x);
    }
    grid_barrier(small.control, ++turn);
    points = small.points[k % 2];
    moved = small.points[(k + 1) % 2];
  }
  return turn;
}

/* Without EXTRAS for scenes without acceleration, wall density and colliders: these take registers.
 */
template <int FEATURES, bool EXTRAS>
static __global__ void __launch_bounds__(SMALL_THREADS, 1)
    small_kernel(const __grid_constant__ small_scene scene, const __grid_constant__ small_room room,
                 const __grid_constant__ general_room general) {
  extern __shared__ uint16_t shared_entries[];
  __shared__ small_step table[SMALL_STEPS];
  const pbf_constants *c = &scene.constants;
  const bool accelerated = PBF_CHEBYSHEV && EXTRAS && scene.accelerated;
  const bool wall_density = EXTRAS && scene.wall_density;
  uint32_t lanes = scene.lanes, thread = thread_index();
  uint32_t i = thread / lanes, lane = thread % lanes, turn = 0;
  bool real = i < scene.count, leads = real && lane == 0;
  small_list list = {shared_entries + threadIdx.x / lanes, blockDim.x / lanes, 0, lane, lanes};
  for (uint32_t k = threadIdx.x; k < scene.steps * (sizeof(small_step) / 4); k += blockDim.x)
    reinterpret_cast<uint32_t *>(table)[k] = reinterpret_cast<const uint32_t *>(scene.table)[k];
  pbf_vec x = {{0}}, v = {{0}}; /* the state, and once a step can't fail its prediction */
  if (real) {
    x = position_of(load(scene.points, i));
    v = scene.velocities[i];
  }
  pbf_real total = 0; /* accelerated: lambda, which the last step leaves in the state */
  point *from = room.points[0], *to = room.points[1];
  __syncthreads();
  for (uint32_t step = 0; step < scene.steps; ++step) {
    const cell_grid &grid = table[step].grid;
    step_obstacles obstacles = {table[step].walls, EXTRAS ? scene.solid_count : 0,
                                scene.solids + step * scene.solid_count};
    pbf_vec y = pbf_predict(&scene.forces, x, v);
    if (scene.collide_after_prediction) y = resolve<EXTRAS>(obstacles, 1, x, y);
    const cell_place place = place_in(grid, y);
    const uint32_t cell = cell_number(grid, place.at);
    if (leads) {
      store(from, i, point_at(y));
      uint32_t k = atomicAdd(room.cell_count + cell, 1u);
      if (k < SMALL_CELL_ROOM)
        room.cell_list[(size_t)cell * SMALL_CELL_ROOM + k] = (uint16_t)i;
      else
        room.control->cells_failed = 1;
    }
    bool failed = grid_barrier(room.control, ++turn, true).cells_failed != 0;
    pbf_real before = 0;
    total = 0;
    if (!failed && !search(room, grid, place, from, y, i, real, c->h2, scene.list_room, &list))
      room.control->lists_failed = 1;
    for (uint32_t k = 0; !failed && k < scene.iterations; ++k) {
      bool last = k + 1 == scene.iterations;
      const pbf_constants now = accelerated ? constants_at(scene, k) : scene.constants;
      lambda_sums<FEATURES> sums;
      list.gather(from, [&](const point &other) { sums.add(c, pbf_sub(y, position_of(other))); });
      __syncwarp();
      sums.density = sum_lanes(sums.density, lanes);
      sums.slope2 = sum_lanes(sums.slope2, lanes);
      sums.gradient = sum_lanes(sums.gradient, lanes);
      pbf_real lambda = sums.lambda(c, obstacles, wall_density, 0, y);
      if (accelerated) {
        pbf_accelerate(&now, lambda, &total, &before);
        lambda = total;
      }
      if (leads) from[i].lambda = lambda;
      grid_verdict verdict = grid_barrier(room.control, ++turn, k == 0);
      failed = k == 0 && verdict.lists_failed != 0;
      if (failed) break;
      if (k == 0) { /* from here the step can't fail: what it started from gives way */
        if (leads) room.cell_count[cell] = 0;
        v = pbf_predicted_velocity(&scene.forces, x, v, y);
        x = y;
      }
      move_sum<FEATURES> sum;
      list.gather(from, [&](const point &other) {
        sum.add(&now, pbf_sub(y, position_of(other)), lambda + other.lambda);
      });
      __syncwarp();
      sum.sum = sum_lanes(sum.sum, lanes);
      y = sum.template moved<EXTRAS>(
          c, obstacles, wall_density, accelerated,
          scene.collide_in_iteration || (last && scene.collide_after_solve), lambda, x, y);
      if (!last && leads) store(to, i, point_at(y));
      /* Before the next prediction counts, all counts must have been cleared. */
      if (!last || scene.iterations == 1) grid_barrier(room.control, ++turn);
      point *kept = from;
      from = to;
      to = kept;
    }
    if (failed) {
      if (leads) {
        room.cell_count[cell] = 0;
        store(scene.points, i, point_at(x));
        scene.velocities[i] = v;
      }
      turn = general_step<FEATURES>(scene, room, general, step, turn);
      if (real) {
        point own = load(scene.points, i);
        x = position_of(own);
        v = scene.velocities[i];
        total = own.lambda;
      }
    } else {
      v = pbf_velocity(scene.inv_time_step, v, x, y);
      x = y;
    }
  }
  if (!leads) return;
  point own = point_at(x);
  own.lambda = total;
  store(scene.points, i, own);
  scene.velocities[i] = v;
}

/* Into the order of ids: a particle's place is the number of ids below its own. */
static __global__ void order_kernel(unsorted_particles from, point *points, pbf_vec *velocities,
                                    uint32_t *ids) {
  uint32_t i = thread_index(), place = 0;
  if (i >= from.count) return;
  uint32_t id = from.ids[i];
  for (uint32_t k = 0; k < from.count; ++k) place += from.ids[k] < id;
  store(points, place, load(from.points, i));
  velocities[place] = from.velocities[i];
  ids[place] = id;
}

#endif
