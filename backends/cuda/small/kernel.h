/* The resident kernel of small scenes. */
#ifndef PBF_CUDA_SMALL_KERNEL_H
#define PBF_CUDA_SMALL_KERNEL_H

#include "cuda/small/general.h"
#include "cuda/small/search.h"
#include "physics/step.h"

/* Sums over the threads of a particle, all reals at a time; each thread gets the same bits. */
template <class Sums>
static __device__ __forceinline__ void sum_lanes(Sums *sums, uint32_t lanes) {
  for (uint32_t step = 1; step < lanes; step *= 2) {
    Sums other = *sums;
    pbf_real *values = reinterpret_cast<pbf_real *>(&other);
#pragma unroll
    for (unsigned k = 0; k < sizeof(Sums) / sizeof(pbf_real); ++k)
      values[k] = __shfl_xor_sync(~0u, values[k], (int)step);
    add_sums(sums, other);
  }
}

/* Fetch what the ghosts' owners publish in a pass, N ghosts a thread at a time; some may be the
 * same. */
template <int N, class Fetch>
static __device__ __forceinline__ void each_ghost_of(const small_tile &t, uint32_t count,
                                                     Fetch fetch) {
  for (uint32_t ghost = threadIdx.x; ghost < count; ghost += N * SMALL_THREADS) {
    uint32_t slots[N], particles[N];
#pragma unroll
    for (uint32_t k = 0; k < N; ++k) {
      uint32_t other = ghost + k * SMALL_THREADS;
      slots[k] = t.ghosts[other < count ? other : ghost];
      particles[k] = t.ids[slots[k]];
    }
    fetch(slots, particles);
  }
}

template <int N>
static __device__ __forceinline__ void fetch_lambdas_of(const small_tile &t,
                                                        const particle_exchange &exchange,
                                                        uint32_t ghosts, uint32_t pass) {
  each_ghost_of<N>(t, ghosts, [&](const uint32_t(&slots)[N], const uint32_t(&particles)[N]) {
    pbf_real lambdas[N];
    await_lambdas(exchange, particles, pass, lambdas);
#pragma unroll
    for (int k = 0; k < N; ++k) t.lambdas[slots[k]] = (float)lambdas[k];
  });
}

template <int N>
static __device__ __forceinline__ void fetch_positions_of(const small_tile &t,
                                                          const particle_exchange &exchange,
                                                          uint32_t ghosts, uint32_t pass) {
  each_ghost_of<N>(t, ghosts, [&](const uint32_t(&slots)[N], const uint32_t(&particles)[N]) {
    pbf_vec positions[N];
    await_positions(exchange, particles, pass, positions);
#pragma unroll
    for (int k = 0; k < N; ++k) set_position(t, slots[k], positions[k]);
  });
}

static __device__ __forceinline__ void fetch_lambdas(const small_tile &t,
                                                     const particle_exchange &exchange,
                                                     uint32_t ghosts, uint32_t pass) {
  if (ghosts <= SMALL_THREADS)
    fetch_lambdas_of<1>(t, exchange, ghosts, pass);
  else
    fetch_lambdas_of<2>(t, exchange, ghosts, pass);
}

static __device__ __forceinline__ void fetch_positions(const small_tile &t,
                                                       const particle_exchange &exchange,
                                                       uint32_t ghosts, uint32_t pass) {
  if (ghosts <= SMALL_THREADS)
    fetch_positions_of<1>(t, exchange, ghosts, pass);
  else
    fetch_positions_of<2>(t, exchange, ghosts, pass);
}

/* What obstacles contribute at a place: to lambda's density, and to its gradient, which the move
 * needs as well, with pbf_tangential_excess in place of lambda. */
struct obstacle_part {
  pbf_real density;
  point move;
};

template <surfaces_met SURFACES>
static __device__ __forceinline__ obstacle_part obstacles_at(const pbf_constants *c,
                                                             const step_obstacles &obstacles,
                                                             pbf_vec x) {
  const pbf_boundary boundary = boundary_at<SURFACES>(c, obstacles, x);
  obstacle_part part = {};
  pbf_vec gradient = {{0}};
  pbf_add_boundary(&boundary, &part.density, &gradient);
  part.move = point_at(gradient);
  part.move.lambda = pbf_tangential_excess(boundary.rest);
  return part;
}

static __device__ __forceinline__ void add_obstacles(const obstacle_part &part,
                                                     lambda_sums<pbf_real> *sums) {
  sums->density += part.density;
  sums->gradient = lanes_of(pbf_add_scaled(vec_of(sums->gradient), 1, position_of(part.move)));
}

/* The move's part of it. */
static __device__ __forceinline__ void correct_move(pbf_real lambda, const point &obstacles,
                                                    move_sums<pbf_real> *sums) {
  sums->change = lanes_of(
      pbf_corrected_beside(vec_of(sums->change), lambda, obstacles.lambda, position_of(obstacles)));
}

/* What the threads of a block tell each other. */
struct small_board {
  uint32_t ghosts;
  uint32_t outcome; /* of a barrier: how often blocks have failed */
  marked_words marked;
};

/* A thread's share of the work. */
struct small_thread {
  uint32_t i, lane, lanes; /* particle; which of its threads, of how many */
  bool real, leads, works; /* has a particle, is its first thread, is in a warp that has some */
};

static __device__ __forceinline__ small_thread thread_of(const small_scene &scene) {
  uint32_t mine = threadIdx.x / scene.lanes, place = blockIdx.x * scene.own + mine;
  small_thread thread;
  thread.lane = threadIdx.x % scene.lanes;
  thread.lanes = scene.lanes;
  thread.real = mine < scene.own && place < scene.count;
  thread.leads = thread.real && thread.lane == 0;
  thread.works = threadIdx.x / 32 * 32 < scene.own * scene.lanes;
  thread.i = thread.real ? scene.owners[place] : 0;
  return thread;
}

/* Enters the particles into their cells, and numbers the cells of the tile; returns how many. The
 * barrier in between is number `turn`; until all blocks are there, a block does what it does
 * meanwhile. */
template <class Meanwhile>
static __device__ __forceinline__ uint32_t
fill_cells(const small_tile &tile, const small_buffers &buffers, const cell_grid &grid,
           const small_thread &thread, const small_search &look, uint32_t cell, uint32_t shift,
           uint32_t pass, uint32_t turn, small_board *board, Meanwhile meanwhile) {
  bool crowded = false;
  uint32_t place = 0;
  if (threadIdx.x == 0) {
    board->ghosts = 0;
    board->marked = {~0u, 0};
  }
  if (thread.leads) {
    publish_position(buffers.exchange, thread.i, look.x, pass);
    place = atomicAdd(buffers.cell_count + cell, 1u << shift) >> shift & 0xffff;
  }
  __syncthreads();
  /* While the atomic is under way. */
  if (thread.works) {
    marked_words words = {~0u, 0};
    if (thread.real) words = mark_around(tile, grid, look.place, thread.lane, thread.lanes);
    add_words(&board->marked, words);
  }
  if (thread.leads) {
    crowded = place >= SMALL_CELL_CAPACITY;
    if (!crowded)
      buffers.cell_list[(size_t)cell * SMALL_CELL_CAPACITY + place] = (uint16_t)thread.i;
  }
  crowded = __syncthreads_or(crowded);
  if (threadIdx.x == 0) arrive(&buffers.control->filled, crowded);
  uint32_t cells = number_cells(tile, board->marked);
  meanwhile();
  if (threadIdx.x == 0) board->outcome = await_all(&buffers.control->filled, turn);
  __syncthreads();
  return cells;
}

/* Lists the neighbours, and the block's ghosts. */
static __device__ __forceinline__ void find_neighbors(
    const small_tile &tile, const small_buffers &buffers, const cell_grid &grid,
    const small_thread &thread, const small_search &look, uint32_t shift,
    const ulonglong2 *predicted, uint32_t cells, small_board *board, small_neighbors *near) {
  uint32_t slots =
      cells <= tile.layout.cell_capacity ? fill_slots(tile, buffers, shift, cells) : ~0u;
  near->in_memory = slots > tile.layout.slot_capacity;
  __syncthreads();
  if (near->in_memory) {
    if (thread.real)
      near->list.size = search_memory(buffers, shift, predicted, grid, look, near->list);
  } else {
    load_slots(tile, predicted, slots);
    __syncthreads();
    if (thread.works) {
      near->slot = own_slot(tile, grid, look, thread.real);
      search_tile(tile, grid, look, near->slot, thread.real, &near->list);
    }
  }
  bool all_fit = !__syncthreads_or(near->list.size > near->list.max_size);
  if (threadIdx.x == 0) arrive_relaxed(&buffers.control->searched, !all_fit);
  if (!all_fit) near->list.size = 0;
  if (thread.works) near->list.balance(thread.lane, thread.lanes);
  near->keep();
  if (near->in_memory) return;
  if (thread.leads) tile.used[near->slot] = 0;
  __syncthreads();
  list_ghosts(tile, all_fit ? slots : 0, &board->ghosts);
  __syncthreads();
}

/* The stages of small_kernel, and of general_step, in an order of their own. */
static const pbf_stage SMALL_STAGES[] = {PBF_STAGE_PREDICT, PBF_STAGE_NEIGHBORS, PBF_STAGE_LAMBDA,
                                         PBF_STAGE_MOVE, PBF_STAGE_VELOCITY};

/* Without EXTRAS for scenes without acceleration and wall density, without SURFACES, which are
 * EXTRAS, too, for those without colliders: these take registers.
 * The numbers of passes begin at 1: 0 is that of no pass. */
template <int FEATURES, bool EXTRAS, surfaces_met SURFACES>
static __global__ void __launch_bounds__(SMALL_THREADS, 1)
    small_kernel(const __grid_constant__ small_scene scene,
                 const __grid_constant__ small_buffers buffers,
                 const __grid_constant__ general_buffers general) {
  extern __shared__ uint4 dynamic[];
  __shared__ small_step table[SMALL_STEPS];
  __shared__ small_board board;
  const pbf_constants *c = &scene.constants;
  const bool accelerated = PBF_CHEBYSHEV && EXTRAS && scene.accelerated;
  const bool wall_density = EXTRAS && scene.wall_density;
  const small_tile tile = tile_in(dynamic, scene.layout);
  const small_thread thread = thread_of(scene);
  const uint32_t i = thread.i;
  grid_team team = {&buffers.control->general, 0};
  uint32_t searches = 0, fill_failures = 0, search_failures = 0;
  for (uint32_t k = threadIdx.x; k < scene.steps * (sizeof(small_step) / 4); k += blockDim.x)
    reinterpret_cast<uint32_t *>(table)[k] = reinterpret_cast<const uint32_t *>(scene.table)[k];
  pbf_vec x = {{0}}, v = {{0}}; /* the state, and once a step can't fail its prediction */
  if (thread.real) {
    x = position_of(load(scene.points, i));
    v = scene.velocities[i];
  }
  if (thread.leads) forget(buffers.exchange, i);
  if (threadIdx.x == 0) {
    pbf_vec sentinel_position;
    for (int k = 0; k < PBF_DIM; ++k) sentinel_position.c[k] = (pbf_real)1e18;
    set_position(tile, tile.sentinel_index(), sentinel_position);
    tile.lambdas[tile.sentinel_index()] = 0;
  }
  clear_counts(buffers, scene.cells);
  clear_marks(tile, {0, scene.layout.words - 1});
  team.meet();
  pbf_real total = 0; /* accelerated: the lambda that adds up, which the last step leaves, … */
  pbf_real last_pressure = accelerated && thread.real ? scene.last_pressure[i] : 0; /* … and this */
  for (uint32_t step = 0; step < scene.steps; ++step) {
    const cell_grid &grid = table[step].grid;
    const uint32_t shift = count_shift(step), first_pass = step * scene.iterations + 1;
    step_obstacles obstacles = {table[step].domain, SURFACES ? scene.surface_count : 0,
                                scene.surfaces + step * scene.surface_count};
    const pbf_forces forces = forces_at(scene, table[step]);
    pbf_vec y = pbf_predict(&forces, x, v);
    if (scene.collide_after_prediction) y = resolve_collisions<SURFACES>(obstacles, 1, x, y);
    const small_search look = {place_in(grid, y), y, i, thread.lane, thread.lanes, c->h2};
    const uint32_t cell = cell_number(grid, look.place.at);
    obstacle_part part = {};
    const auto meet_obstacles = [&] {
      if (thread.works && wall_density) part = obstacles_at<SURFACES>(c, obstacles, y);
    };
    const uint32_t cells = fill_cells(tile, buffers, grid, thread, look, cell, shift, first_pass,
                                      step + 1, &board, meet_obstacles);
    bool failed = board.outcome != fill_failures;
    fill_failures = board.outcome;
    small_neighbors near = {tile,
                            buffers.exchange,
                            {tile.lists + threadIdx.x, 0, scene.layout.list_capacity - SMALL_CHUNK},
                            0,
                            false,
                            {0}};
    if (!failed) {
      find_neighbors(tile, buffers, grid, thread, look, shift,
                     buffers.exchange.positions[first_pass % 2], cells, &board, &near);
      ++searches;
    }
    clear_marks(tile, board.marked);
    const uint32_t ghosts = board.ghosts;
    pbf_real change = 0;
    total = 0;
    for (uint32_t k = 0; !failed && k < scene.iterations; ++k) {
      const uint32_t pass = first_pass + k;
      bool last = k + 1 == scene.iterations;
      const pbf_constants now = accelerated ? constants_at(scene, k) : scene.constants;
      const typename small_pairs<FEATURES>::lambdas of_lambda = {c, {}};
      const typename small_pairs<FEATURES>::moves of_pairs = {&now, {}}, of_move = {c, {}};
      small_pairs<FEATURES> pairs;
      pairs.change = of_pairs.template begin<pbf_real>();
      pbf_real lambda = 0;
      if (thread.works) {
        lambda_sums<pbf_real> sums = {};
        pairs.meet(of_lambda, of_pairs, near, y, pass, &sums);
        __syncwarp();
        sum_lanes(&sums, thread.lanes);
        add_sums(&sums, of_lambda.template begin<pbf_real>()); /* once for all its threads */
        of_lambda.end(&sums);
        if (wall_density) add_obstacles(part, &sums);
        lambda = of_lambda.finish(sums, 0);
        if (accelerated) {
          pbf_accelerate(&now, sums.density, lambda, &total, &change);
          if (last) pbf_smooth_pressure(&now, last_pressure, &total, &change);
          lambda = change;
        }
      }
      if (thread.leads) {
        publish_lambda(buffers.exchange, i, lambda, pass);
        if (!near.in_memory) tile.lambdas[near.slot] = (float)lambda;
      }
      /* While the others' lambdas are under way. */
      pbf_vec predicted_velocity = v;
      if (k == 0)
        predicted_velocity = pbf_predicted_velocity(&forces, x, v, pbf_predict(&forces, x, v), y);
      if (k == 0 && threadIdx.x + 1 == SMALL_THREADS)
        board.outcome = await_all(&buffers.control->searched, searches);
      fetch_lambdas(tile, buffers.exchange, ghosts, pass);
      __syncthreads();
      if (k == 0) {
        failed = board.outcome != search_failures;
        search_failures = board.outcome;
        if (failed) break;
        /* From here the step can't fail: what it started from gives way. */
        if (thread.leads) clear_count(buffers, cell, shift);
        v = predicted_velocity;
        x = y;
      }
      if (thread.works) {
        pairs.move(of_pairs, near, y, lambda, pass);
        __syncwarp();
        sum_lanes(&pairs.change, thread.lanes);
        of_pairs.end(&pairs.change);
        if (wall_density) correct_move(lambda, part.move, &pairs.change);
        y = finish_move<SURFACES>(
            of_move, obstacles,
            {false, scene.collide_in_iteration + (last && scene.collide_after_solve),
             scene.inv_time_step},
            lambda, false, i, x, y, pairs.change, &v);
      }
      if (last) continue;
      if (thread.leads) publish_position(buffers.exchange, i, y, pass + 1);
      __syncthreads();
      if (thread.leads && !near.in_memory) set_position(tile, near.slot, y);
      meet_obstacles(); /* while the others' positions are under way */
      fetch_positions(tile, buffers.exchange, ghosts, pass + 1);
      __syncthreads();
    }
    if (failed) {
      if (thread.leads) {
        clear_count(buffers, cell, shift);
        store(scene.points, i, point_at(x));
        scene.velocities[i] = v;
        if (accelerated) scene.last_pressure[i] = last_pressure;
      }
      general_step<FEATURES, SURFACES>(scene, general, step, &team);
      if (thread.leads) forget(buffers.exchange, i);
      if (thread.real) {
        point own = load(scene.points, i);
        x = position_of(own);
        v = scene.velocities[i];
        total = own.lambda;
        if (accelerated) last_pressure = scene.last_pressure[i];
      }
    } else {
      x = y;
      last_pressure = pbf_pressure_to_keep(c, total);
    }
  }
  if (!thread.leads) return;
  point own = point_at(x);
  own.lambda = total;
  store(scene.points, i, own);
  scene.velocities[i] = v;
  if (accelerated) scene.last_pressure[i] = last_pressure;
}

#endif
