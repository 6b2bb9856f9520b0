/* Deep water: the pressure of the fluid's weight on a coarse grid (physics/coarse.h), before the
 * iterations. */
#ifndef PBF_CUDA_DEEP_H
#define PBF_CUDA_DEEP_H

#include "cuda/barrier.h"
#include "cuda/passes.h"
#include "physics/coarse.h"

/* Whether the build has it. */
constexpr bool PBF_DEEP = (PBF_BUILT & PBF_FEATURE_PRESSURE_GRID) != 0;

/* What blocks tell each other in a step; zeroed before it. Reals that are never negative are
 * ordered as their bits are. */
struct deep_control {
  grid_counter barrier;
  unsigned long long largest;              /* of the right sides */
  unsigned long long miss[3];              /* of an iteration; iterations take turns */
  uint32_t below[PBF_DIM], above[PBF_DIM]; /* nodes that are not in the open: the largest */
                                           /* distance from either end of an axis */
  uint32_t inside;                         /* so many nodes are not in the open */
  uint32_t odd;                            /* 1: the solve has ended in `before` */
};

struct deep_arrays {
  deep_control *control; /* the first of all arrays; null: not deep */
  unsigned long long *sums;
  double *rooms, *right, *inverse, *lambda, *before;
  uint32_t *inside; /* the nodes that are not in the open, in any order */
};

static inline uint64_t deep_bytes(uint32_t capacity) {
  return sizeof(deep_control) +
         pbf_coarse_limit(capacity) * (6 * sizeof(double) + sizeof(uint32_t));
}

static inline deep_arrays deep_arrays_in(void *memory, uint32_t capacity) {
  uint64_t limit = pbf_coarse_limit(capacity);
  deep_control *control = static_cast<deep_control *>(memory);
  double *first = reinterpret_cast<double *>(control + 1);
  return {control,           reinterpret_cast<unsigned long long *>(first),
          first + limit,     first + 2 * limit,
          first + 3 * limit, first + 4 * limit,
          first + 5 * limit, reinterpret_cast<uint32_t *>(first + 6 * limit)};
}

static __device__ __forceinline__ const double *deep_lambda(const deep_arrays &a) {
  return a.control->odd ? a.before : a.lambda;
}

/* Sums the particles up; sleepers pass for free of error. */
template <int FEATURES>
static __global__ void __launch_bounds__(PBF_BLOCK)
    weigh_kernel(neighborhood n, iteration_extras extras, pbf_coarse grid, deep_arrays a) {
  uint32_t i = thread_index();
  const pbf_constants *c = &n.constants;
  uint32_t own = min(i, n.particles.count - 1);
  pbf_vec x = position_of(load(n.particles.points, own)), gradient = {{0}};
  pbf_real density = c->value_scale;
  for_neighbors(n.particles, n.grid, n.lists, i, [&](uint32_t j) {
    pbf_vec x_ij = pbf_sub(x, position_of(load(n.particles.points, j)));
    density += pbf_pair_density(FEATURES, c, pbf_dot(x_ij, x_ij));
  });
  if (i >= n.particles.count) return;
  if (extras.wall_density) add_walls(c, extras.obstacles, x, &density, &gradient);
  if (extras.rest.unrest && pbf_is_asleep(extras.rest.unrest[i])) density = 1;
  double at[PBF_DIM];
  uint32_t cell = pbf_coarse_cell(&grid, x, at);
  atomicAdd(&a.sums[cell], (unsigned long long)pbf_coarse_entry(density));
}

static __global__ void __launch_bounds__(PBF_BLOCK)
    deep_cells_kernel(pbf_coarse grid, step_obstacles o, deep_arrays a) {
  uint32_t cell = thread_index();
  if (cell >= grid.nodes) return;
  a.rooms[cell] = pbf_coarse_room(&grid, o.count, o.solids, cell);
}

static __global__ void __launch_bounds__(PBF_BLOCK)
    deep_nodes_kernel(pbf_coarse grid, deep_arrays a) {
  uint32_t node = thread_index();
  if (node >= grid.nodes) return;
  double right, inverse;
  pbf_coarse_equation(&grid, reinterpret_cast<const int64_t *>(a.sums), a.rooms, node, &right,
                      &inverse);
  a.right[node] = right;
  a.inverse[node] = inverse;
  if (!(inverse > 0)) return;
  int i[PBF_DIM];
  a.inside[atomicAdd(&a.control->inside, 1u)] = node;
  pbf_coarse_place(&grid, node, i);
  for (int k = 0; k < PBF_DIM; ++k) {
    atomicMax(&a.control->above[k], (uint32_t)i[k]);
    atomicMax(&a.control->below[k], (uint32_t)(grid.n[k] + 1 - i[k]));
  }
  atomicMax(&a.control->largest, (unsigned long long)__double_as_longlong(fabs(right)));
}

static __global__ void __launch_bounds__(PBF_BLOCK)
    deep_guess_kernel(pbf_coarse grid, int axis, int down, deep_arrays a) {
  uint32_t column = thread_index();
  if (column >= pbf_coarse_columns(&grid, axis)) return;
  pbf_coarse_guess(&grid, a.inverse, axis, down, column, a.lambda);
  pbf_coarse_guess(&grid, a.inverse, axis, down, column, a.before);
}

/* The largest of a block's values, in thread 0. */
template <uint32_t THREADS>
static __device__ __forceinline__ double block_largest(double value) {
  __shared__ double of_warp[THREADS / 32];
  for (int step = 16; step > 0; step /= 2) value = fmax(value, __shfl_xor_sync(~0u, value, step));
  __syncthreads();
  if (threadIdx.x % 32 == 0) of_warp[threadIdx.x / 32] = value;
  __syncthreads();
  if (threadIdx.x == 0)
    for (uint32_t k = 0; k < THREADS / 32; ++k) value = fmax(value, of_warp[k]);
  return value;
}

/* Each time they ask, blocks tell the largest and, after a barrier, hear it. The next time's word
 * is cleared where nobody can still be reading it: all have come past the barrier since. */
static __device__ __forceinline__ void tell_miss(deep_control *control, int time, double miss) {
  if (threadIdx.x != 0) return;
  atomicMax(&control->miss[time % 3], (unsigned long long)__double_as_longlong(miss));
  if (blockIdx.x == 0) atomicExch(&control->miss[(time + 1) % 3], 0ull);
}

static __device__ __forceinline__ double heard_miss(const deep_control *control, int time) {
  const volatile unsigned long long *miss = &control->miss[time % 3];
  return __longlong_as_double((long long)*miss);
}

/* A grid of so many indices is solved by one block, whose threads wait for each other a third as
 * long as blocks do. */
enum { DEEP_ALONE = 16384, DEEP_ALONE_THREADS = 1024 };

/* All iterations; all blocks are resident. */
template <bool ALONE>
static __global__ void __launch_bounds__(ALONE ? DEEP_ALONE_THREADS : PBF_BLOCK)
    deep_solve_kernel(pbf_coarse grid, deep_arrays a) {
  constexpr uint32_t THREADS = ALONE ? DEEP_ALONE_THREADS : PBF_BLOCK;
  deep_control *control = a.control;
  double *now = a.lambda, *before = a.before;
  uint32_t inside = control->inside;
  int longest = 1, k = 0;
  for (int axis = 0; axis < PBF_DIM; ++axis)
    longest = max(longest, (int)(control->below[axis] + control->above[axis]) - grid.n[axis]);
  pbf_coarse_solve solve =
      pbf_coarse_begin(longest, __longlong_as_double((long long)control->largest));
  for (bool over = false; k < solve.most && !over; ++k) {
    double miss = 0;
    for (uint32_t i = thread_index(); i < inside; i += gridDim.x * THREADS) {
      uint32_t node = a.inside[i];
      double residual = pbf_coarse_residual(&grid, a.rooms, now, a.right[node], node);
      miss = fmax(miss, pbf_coarse_miss(residual, now[node]));
      before[node] = pbf_coarse_next(&solve, residual, a.inverse[node], now[node], before[node]);
    }
    if (pbf_coarse_asks(k)) tell_miss(control, k / 4, block_largest<THREADS>(miss));
    if (ALONE)
      __syncthreads();
    else
      grid_barrier(&control->barrier, k + 1);
    over = pbf_coarse_asks(k) && !(heard_miss(control, k / 4) > solve.enough);
    pbf_coarse_go_on(&solve, k);
    double *other = now;
    now = before;
    before = other;
  }
  if (thread_index() == 0) control->odd = k % 2;
}

/* What the grid adds to the moves. */
static __global__ void __launch_bounds__(PBF_BLOCK)
    carry_kernel(sorted_particles p, pbf_coarse grid, deep_arrays a, pbf_real inv_time_step) {
  uint32_t i = thread_index();
  if (i >= p.count || (p.unrest && pbf_is_asleep(p.unrest[i]))) return;
  point own = load(p.points, i);
  pbf_vec x = position_of(own);
  double at[PBF_DIM];
  uint32_t cell = pbf_coarse_cell(&grid, x, at);
  pbf_vec u = pbf_coarse_move(&grid, deep_lambda(a), cell, at);
  for (int k = 0; k < PBF_DIM; ++k) own.c[k] += u.c[k];
  store(p.points, i, own);
  p.velocities[i] = pbf_add_scaled(p.velocities[i], inv_time_step, u);
}

/* What reading pressures asks of the grid of the last step. */
struct deep_pressure {
  pbf_coarse grid;
  deep_arrays arrays; /* without control: there is none */
  double scale;       /* of lambda */
};

static __device__ __forceinline__ pbf_real deep_pressure_at(const deep_pressure &d, pbf_vec x) {
  if (!PBF_DEEP || !d.arrays.control) return 0;
  double at[PBF_DIM];
  uint32_t cell = pbf_coarse_cell(&d.grid, x, at);
  return (pbf_real)(-d.scale * pbf_coarse_lambda(&d.grid, deep_lambda(d.arrays), cell, at));
}

#endif
