/* Deep water: the pressure of the fluid's weight on a coarse grid (physics/pressure_grid/grid.h),
 * before the iterations. */
#ifndef PBF_CUDA_PRESSURE_GRID_H
#define PBF_CUDA_PRESSURE_GRID_H

#include "cuda/barrier.h"
#include "cuda/kernels_solve.h"
#include "physics/pressure_grid/cell_forces.h"
#include "physics/pressure_grid/particles.h"
#include "physics/pressure_grid/solid_gains.h"
#include "physics/pressure_grid/solve.h"

/* Whether the build has it. */
constexpr bool PBF_HAS_PRESSURE_GRID = (PBF_BUILT & PBF_FEATURE_PRESSURE_GRID) != 0;

/* What a step finds out of all cells and nodes; zeroed before it, with the sums and places behind
 * it. Reals that are never negative are ordered as their bits are. */
struct pressure_grid_control {
  grid_counter barrier;
  unsigned long long largest;               /* right side */
  pbf_pressure_grid_extent extent;          /* of filled cells */
  uint32_t odd;                             /* 1: the solve has ended in `before` */
  unsigned long long farthest[2 * PBF_DIM]; /* particle, down and up each axis: ordered_bits */
};

/* Of reals of either sign, ordered as these are; 0 is less than those of any. */
static __device__ __forceinline__ unsigned long long ordered_bits(double value) {
  const unsigned long long bits = (unsigned long long)__double_as_longlong(value);
  return bits >> 63 ? ~bits : bits | 1ull << 63;
}

static inline double real_of_ordered(unsigned long long ordered) {
  const unsigned long long bits = ordered >> 63 ? ordered & ~(1ull << 63) : ~ordered;
  double value;
  memcpy(&value, &bits, sizeof value);
  return ordered ? value : -INFINITY;
}

/* Where particles are, before the grid is placed around them. */
static __global__ void __launch_bounds__(PBF_BLOCK)
    farthest_particles_kernel(sorted_particles p, pressure_grid_control *control) {
  const uint32_t i = own_index(p);
  const pbf_vec x = position_of(load(p.points, min(i, p.count - 1)));
  for (int side = 0; side < 2 * PBF_DIM; ++side) {
    double far = (side % 2 ? 1 : -1) * (double)x.c[side / 2];
    for (int step = 16; step > 0; step /= 2) far = fmax(far, __shfl_xor_sync(~0u, far, step));
    if (threadIdx.x % 32 == 0) atomicMax(&control->farthest[side], ordered_bits(far));
  }
}

struct pressure_grid_arrays {
  pressure_grid_control *control;    /* the first of all arrays; null: there is no grid */
  unsigned long long *sums, *places; /* of cells; the places lie behind the sums of the grid */
  unsigned long long *cell_moves;    /* of cells, along each axis; null: no forces like that */
  double *free_volumes;              /* of cells */
  double *depths, *right, *inverse, *lambda, *before; /* of nodes */
  uint32_t *inside; /* the nodes that are not in the open; each block has its own */
  float *missing;   /* of nodes, before a correction from the levels of the solve, … */
  float *coarse;    /* … and what these have (pressure_grid_levels.h) */
  uint8_t *moves;   /* of nodes: whether they are moved by these */
  pbf_pressure_grid_topology topology; /* of thin solids */
};

/* Numbers of all coarser levels: a level has an eighth of the nodes of the one before, in 2D a
 * quarter, and 18 or 9 numbers for each. Narrow grids need more of their few nodes. */
static inline uint64_t pressure_grid_coarse_words(uint32_t capacity) {
  return 4 * pbf_pressure_grid_max_nodes(capacity) + 65536;
}

static inline uint64_t pressure_grid_bytes(uint32_t capacity) {
  return sizeof(pressure_grid_control) + pressure_grid_coarse_words(capacity) * sizeof(float) +
         pbf_pressure_grid_max_nodes(capacity) *
             (8 * sizeof(double) + sizeof(uint32_t) + sizeof(float) + 1);
}

/* Behind the topology are the colliders that it is of, if they are few. */
static inline uint64_t topology_memory_bytes(uint32_t capacity) {
  return pbf_pressure_grid_topology_bytes(pbf_pressure_grid_max_nodes(capacity)) +
         PBF_FEW_COLLIDERS * sizeof(pbf_surface);
}

static inline pbf_surface *pressure_grid_surfaces(void *room, uint32_t capacity) {
  return reinterpret_cast<pbf_surface *>(
      static_cast<char *>(room) +
      pbf_pressure_grid_topology_bytes(pbf_pressure_grid_max_nodes(capacity)));
}

/* Where forces differ from particle to particle. */
static inline uint64_t pbf_cell_move_words(uint32_t capacity) {
  return PBF_DIM * pbf_pressure_grid_max_nodes(capacity);
}

/* What a topology has been found of, beside colliders that stand still. While it is the same, all
 * that would be found again is. */
struct found_topology {
  const void *memory; /* null: none has been found */
  uint32_t particles;
  int solids;
  pbf_pressure_grid grid;
  pbf_domain domain;
};

/* `nodes`: of the grid, or all indices where further ones are used. */
static inline pressure_grid_arrays pressure_grid_arrays_in(void *memory, uint32_t capacity,
                                                           uint32_t nodes) {
  uint64_t limit = pbf_pressure_grid_max_nodes(capacity);
  pressure_grid_arrays a;
  a.control = static_cast<pressure_grid_control *>(memory);
  a.sums = reinterpret_cast<unsigned long long *>(a.control + 1);
  a.places = a.sums + nodes;
  a.cell_moves = nullptr;
  double *next = reinterpret_cast<double *>(a.sums + limit);
  double **const arrays[] = {&a.free_volumes, &a.depths, &a.right,
                             &a.inverse,      &a.lambda, &a.before};
  for (double **array : arrays) *array = next += limit;
  a.inside = reinterpret_cast<uint32_t *>(next + limit);
  a.missing = reinterpret_cast<float *>(a.inside + limit);
  a.coarse = a.missing + limit;
  a.moves = reinterpret_cast<uint8_t *>(a.coarse + pressure_grid_coarse_words(capacity));
  a.topology = pbf_pressure_grid_topology_in(nullptr, 0, 0);
  return a;
}

static __device__ __forceinline__ double *pressure_grid_lambda(const pressure_grid_arrays &a) {
  return a.control->odd ? a.before : a.lambda;
}

/* What a kernel that is built for such surfaces sees of the topology. */
template <surfaces_met SURFACES>
static __device__ __forceinline__ auto *topology_met(const pressure_grid_arrays &a) {
  if constexpr (meets_fields<SURFACES>)
    return &a.topology;
  else
    return static_cast<const pbf_closed_topology *>(&a.topology);
}

/* The density of particles without what solids contribute. `ghosts`: what these add, or null. */
template <int FEATURES>
static __global__ void __launch_bounds__(PBF_BLOCK, PBF_BLOCKS_AT_ONCE)
    grid_density_kernel(neighborhood n, const lambda_sums<pbf_real> *ghosts, pbf_real *densities) {
  const uint32_t i = own_index(n.particles);
  const density_pass<fixed<FEATURES>> pass = {&n.constants, {}};
  const pbf_vec x = position_of(load(n.particles.points, min(i, n.particles.count - 1)));
  const no_value *nothing = nullptr;
  const pbf_real density = sums_around(pass, n, i, x, {}, nothing).density;
  if (i < n.particles.count) densities[i] = density + (ghosts ? ghosts[i].density : 0);
}

/* Sums the particles up; sleepers out of reach of the awake pass for free of error. */
template <surfaces_met SURFACES>
static __global__ void __launch_bounds__(PBF_BLOCK)
    deposit_kernel(const __grid_constant__ neighborhood n,
                   const __grid_constant__ iteration_extras extras, const pbf_real *densities,
                   const __grid_constant__ pbf_pressure_grid grid,
                   const __grid_constant__ pressure_grid_arrays a, bool torn) {
  const uint32_t i = own_index(n.particles);
  const pbf_constants *c = &n.constants;
  if (i >= n.particles.count) return;
  const pbf_vec x = position_of(load(n.particles.points, i));
  pbf_vec gradient = {{0}};
  pbf_real density = densities[i];
  if (extras.wall_density) add_boundary<SURFACES>(c, extras.obstacles, x, &density, &gradient);
  if (extras.rest.activity && pbf_is_inactive(extras.rest.activity[i])) density = c->target;
  double at[PBF_DIM];
  uint32_t cell = pbf_pressure_grid_cell(&grid, x, at);
  if (torn) cell = pbf_compartment_of(&grid, topology_met<SURFACES>(a), cell, x, at);
  if (cell == PBF_NO_INDEX) return;
  const pbf_real overlap = n.particles.overlap ? n.particles.overlap[i] : 0;
  atomicAdd(&a.sums[cell],
            (unsigned long long)pbf_pressure_grid_entry(c->target, density, overlap));
  atomicAdd(&a.places[cell], (unsigned long long)pbf_pressure_grid_place_entry(at));
  for (uint64_t k = 0; k < PBF_DIM && a.cell_moves; ++k)
    atomicAdd(&a.cell_moves[(uint64_t)PBF_DIM * cell + k],
              (unsigned long long)pbf_cell_move_entry(
                  &grid, n.particles.velocities[i].c[k],
                  n.particles.acceleration ? n.particles.acceleration[i].c[k] : 0));
}

/* ---- Thin solids: a thread a cell, or a node ------------------------------------------------ */

template <surfaces_met SURFACES>
static __global__ void __launch_bounds__(PBF_BLOCK)
    divide_cells_kernel(const __grid_constant__ pbf_pressure_grid grid,
                        const __grid_constant__ pressure_grid_arrays a) {
  uint32_t cell = thread_index();
  if (cell >= grid.nodes) return;
  int i[PBF_DIM];
  pbf_pressure_grid_place(&grid, cell, i);
  if (pbf_cell_is_inside(&grid, i)) pbf_divide_cell(&grid, topology_met<SURFACES>(a), cell, i);
}

template <surfaces_met SURFACES>
static __global__ void __launch_bounds__(PBF_BLOCK)
    link_cells_kernel(const __grid_constant__ pbf_pressure_grid grid,
                      const __grid_constant__ pressure_grid_arrays a) {
  uint32_t cell = thread_index();
  if (cell >= grid.nodes) return;
  int i[PBF_DIM];
  pbf_pressure_grid_place(&grid, cell, i);
  pbf_link_cell(&grid, topology_met<SURFACES>(a), cell, i);
}

static __global__ void __launch_bounds__(PBF_BLOCK)
    merge_compartments_kernel(const __grid_constant__ pbf_pressure_grid grid,
                              const __grid_constant__ pressure_grid_arrays a) {
  uint32_t cell = thread_index();
  if (cell < grid.nodes) pbf_merge_compartments(&grid, &a.topology, cell);
}

static __global__ void __launch_bounds__(PBF_BLOCK)
    tear_nodes_kernel(const __grid_constant__ pbf_pressure_grid grid,
                      const __grid_constant__ pressure_grid_arrays a) {
  uint32_t node = thread_index();
  if (node < grid.nodes && pbf_node_is_inside(&grid, node)) pbf_tear_node(&grid, &a.topology, node);
}

static __global__ void __launch_bounds__(PBF_BLOCK)
    list_torn_nodes_kernel(const __grid_constant__ pbf_pressure_grid grid,
                           const __grid_constant__ pressure_grid_arrays a) {
  uint32_t node = thread_index();
  if (node < grid.nodes && pbf_node_is_inside(&grid, node))
    pbf_list_torn_node(&grid, &a.topology, node);
}

/* Whether a thread has a cell, or a further compartment: `index` is that. */
static __device__ __forceinline__ bool has_compartment(const pbf_pressure_grid &grid,
                                                       const pressure_grid_arrays &a,
                                                       uint32_t index) {
  const pbf_pressure_grid_topology &t = a.topology;
  if (index < grid.nodes) return true;
  return t.is_active && index >= t.first &&
         index - t.first < pbf_pressure_grid_further_count(&t, PBF_FURTHER_COMPARTMENTS);
}

/* ---- The cells ------------------------------------------------------------------------------ */

/* The part of a cell that is free of walls and colliders. */
template <surfaces_met SURFACES>
static __device__ __forceinline__ double free_volume_of(const pbf_pressure_grid &grid,
                                                        const step_obstacles &o, uint32_t cell) {
  if constexpr (SURFACES != LISTED_SURFACES) {
    return pbf_pressure_grid_free_volume(&grid, obstacles_met<SURFACES>(o), cell);
  } else {
    int i[PBF_DIM];
    pbf_pressure_grid_place(&grid, cell, i);
    const double reach = 0.51 * grid.width * scene_behind(o)->grid.steepest;
    const auto near = obstacles_near<SURFACES>(o, pbf_cell_middle(&grid, i), reach);
    return pbf_pressure_grid_free_volume_at(&grid, near, i);
  }
}

template <surfaces_met SURFACES>
static __global__ void __launch_bounds__(PBF_BLOCK)
    pressure_grid_cells_kernel(pbf_pressure_grid grid, step_obstacles o, pressure_grid_arrays a) {
  const pbf_pressure_grid_topology *t = &a.topology;
  uint32_t cell = thread_index();
  if (!has_compartment(grid, a, cell)) return;
  double free_volume = 0;
  if (cell < grid.nodes && !pbf_cell_is_cut(t, cell))
    free_volume = free_volume_of<SURFACES>(grid, o, cell);
  if (t->is_active) free_volume = pbf_compartment_volume(t, cell, free_volume);
  a.free_volumes[cell] = free_volume;
  if (!pbf_pressure_grid_is_filled(&grid, (int64_t)a.sums[cell], free_volume)) return;
  int i[PBF_DIM];
  pbf_pressure_grid_place(&grid, pbf_compartment_cell(t, cell), i);
  for (int k = 0; k < PBF_DIM; ++k) {
    atomicMax(&a.control->extent.above[k], (uint32_t)i[k]);
    atomicMax(&a.control->extent.below[k], (uint32_t)(grid.n[k] + 1 - i[k]));
  }
}

static __device__ __forceinline__ const int64_t *pressure_grid_integers(
    const unsigned long long *sums) {
  return reinterpret_cast<const int64_t *>(sums);
}

static __device__ __forceinline__ int64_t *pressure_grid_places(const pressure_grid_arrays &a) {
  return reinterpret_cast<int64_t *>(a.places);
}

/* How far nodes are below the surface; cells' places tell then where fluid ends. */
static __global__ void __launch_bounds__(PBF_BLOCK)
    pressure_grid_depths_kernel(pbf_pressure_grid grid, pressure_grid_arrays a) {
  uint32_t node = thread_index();
  int i[PBF_DIM];
  bool outside = false;
  const uint32_t torn = pbf_pressure_grid_torn_count(&a.topology);
  if (node >= grid.nodes) { /* and of torn ones, instead of what they have as ordinary ones */
    if (node - grid.nodes < torn)
      a.depths[a.topology.torn_at[node - grid.nodes]] =
          pbf_pressure_grid_torn_depth(&grid, &a.topology, pressure_grid_integers(a.sums),
                                       pressure_grid_places(a), a.free_volumes, node - grid.nodes);
    return;
  }
  if (torn && a.topology.torn[node]) return;
  pbf_pressure_grid_place(&grid, node, i);
  for (int k = 0; k < PBF_DIM; ++k) outside = outside || i[k] == 0;
  a.depths[node] =
      outside ? -1
              : pbf_pressure_grid_node_depth(&grid, &a.topology, pressure_grid_integers(a.sums),
                                             pressure_grid_places(a), a.free_volumes, node, i);
}

/* The step's source scale, for all threads of a block. */
static __device__ __forceinline__ pbf_pressure_grid_source_scale
grid_source_scale(const pbf_pressure_grid &grid, const pressure_grid_arrays &a) {
  __shared__ pbf_pressure_grid_source_scale source_scale;
  if (threadIdx.x == 0) source_scale = pbf_pressure_grid_source_scale_of(&grid, &a.control->extent);
  __syncthreads();
  return source_scale;
}

static __global__ void __launch_bounds__(PBF_BLOCK)
    pressure_grid_nodes_kernel(pbf_pressure_grid grid, pressure_grid_arrays a) {
  uint32_t node = thread_index();
  const pbf_pressure_grid_source_scale source_scale = grid_source_scale(grid, a);
  double right = 0, inverse = 0;
  if (node < grid.nodes) {
    pbf_pressure_grid_equation(&grid, &a.topology, &source_scale, pressure_grid_integers(a.sums),
                               pressure_grid_integers(a.places), a.free_volumes, a.depths, node,
                               &right, &inverse);
    if (a.topology.is_active && a.topology.torn[node]) inverse = 0;
    if (a.cell_moves && inverse > 0)
      right += pbf_moves_at_node(&grid, source_scale.part, pressure_grid_integers(a.sums),
                                 pressure_grid_integers(a.cell_moves), a.free_volumes, node);
    a.right[node] = right;
    a.inverse[node] = inverse;
  } else if (node - grid.nodes < pbf_pressure_grid_torn_count(&a.topology)) {
    const uint32_t torn = node - grid.nodes;
    pbf_pressure_grid_torn_equation(
        &grid, &a.topology, &source_scale, pressure_grid_integers(a.sums),
        pressure_grid_integers(a.places), a.free_volumes, a.depths, torn);
    right = a.topology.right[torn];
    inverse = a.topology.inverse[torn];
    if (a.cell_moves && inverse > 0)
      a.topology.right[torn] = right += pbf_moves_at_torn_node(
          &grid, &a.topology, source_scale.part, pressure_grid_integers(a.sums),
          pressure_grid_integers(a.cell_moves), a.free_volumes, torn);
  }
  double largest = inverse > 0 ? fabs(right) : 0;
  for (int step = 16; step > 0; step /= 2)
    largest = fmax(largest, __shfl_xor_sync(~0u, largest, step));
  if (threadIdx.x % 32 == 0 && largest > 0)
    atomicMax(&a.control->largest, (unsigned long long)__double_as_longlong(largest));
}

/* b at a node, solid_gains.h. */
template <surfaces_met SURFACES>
static __device__ __forceinline__ pbf_node_gain gain_at(const pbf_pressure_grid &grid,
                                                        const step_obstacles &o, uint32_t node) {
  int i[PBF_DIM];
  pbf_pressure_grid_place(&grid, node, i);
  pbf_node_gain gain = pbf_node_gain_begin(&grid, i);
  double reach = gain.nearest;
  if constexpr (SURFACES == LISTED_SURFACES) reach *= scene_behind(o)->grid.steepest;
  const auto near = obstacles_near<SURFACES>(o, gain.x, reach);
  for (int k = 0; k < pbf_surface_count(near); ++k) pbf_node_gain_look(&near.surfaces[k], &gain);
  for (int k = 0; k < pbf_surface_count(near); ++k)
    pbf_node_gain_settle(&grid, &near.surfaces[k], &gain);
  return gain;
}

/* Where solids gain: what that adds to the right sides. */
template <surfaces_met SURFACES>
static __global__ void __launch_bounds__(PBF_BLOCK)
    pressure_grid_gains_kernel(pbf_pressure_grid grid, step_obstacles o, pressure_grid_arrays a) {
  const uint32_t index = thread_index();
  const double part = grid_source_scale(grid, a).part;
  double right = 0;
  if (index < grid.nodes) {
    if (!(a.inverse[index] > 0)) return;
    const pbf_node_gain gain = gain_at<SURFACES>(grid, o, index);
    right = a.right[index] += pbf_gain_at_node(&grid, part, a.free_volumes, &gain, index);
  } else if (index - grid.nodes < pbf_pressure_grid_torn_count(&a.topology)) {
    const uint32_t torn = index - grid.nodes;
    if (!(a.topology.inverse[torn] > 0)) return;
    const pbf_node_gain gain = gain_at<SURFACES>(grid, o, a.topology.base[torn]);
    right = a.topology.right[torn] +=
        pbf_gain_at_torn_node(&grid, &a.topology, part, a.free_volumes, &gain, torn);
  }
  atomicMax(&a.control->largest, (unsigned long long)__double_as_longlong(fabs(right)));
}

/* Nodes one above the other that are not in the open, from `floor` on; a warp looks together. */
static __device__ __forceinline__ uint32_t pressure_grid_stands(const double *inverse,
                                                                uint32_t floor, int64_t up,
                                                                uint32_t max_layers) {
  for (uint32_t base = 0; base < max_layers; base += 32) {
    uint32_t i = base + threadIdx.x % 32;
    uint32_t open = __ballot_sync(~0u, !(i < max_layers && inverse[floor + i * up] > 0));
    if (open) return base + (uint32_t)__ffs((int)open) - 1;
  }
  return max_layers;
}

/* Where the solve starts, pbf_pressure_grid_guess: without solids a warp a column, since what is
 * not above the domain's wall stands on nothing. */
static __global__ void __launch_bounds__(PBF_BLOCK)
    guess_over_walls_kernel(pbf_pressure_grid grid, pressure_grid_arrays a) {
  uint32_t column = thread_index() / 32, top = 1 + (uint32_t)grid.n[grid.axis];
  const double part = grid_source_scale(grid, a).part;
  if (column >= pbf_pressure_grid_columns(&grid)) return;
  const pbf_pressure_grid_column at = pbf_pressure_grid_column_at(&grid, column);
  bool stays = pbf_pressure_grid_down(&grid) == 0;
  uint32_t stands = stays ? 0 : pressure_grid_stands(a.inverse, at.floor, at.up, top);
  double above = 0;
  if (stands) above = pbf_pressure_grid_column_above(a.depths, at, stands, top);
  for (uint32_t i = threadIdx.x % 32; i <= top; i += 32) {
    int64_t node = i < top ? at.floor + i * at.up : at.outside;
    double lambda = i < stands ? pbf_pressure_grid_weight(&grid, part, stands - 1 - i + above) : 0;
    a.lambda[node] = a.before[node] = lambda;
  }
}

/* The same with solids: of torn nodes, … */
static __global__ void __launch_bounds__(PBF_BLOCK)
    guess_torn_kernel(const __grid_constant__ pbf_pressure_grid grid,
                      const __grid_constant__ pressure_grid_arrays a) {
  const pbf_pressure_grid_topology *t = &a.topology;
  uint32_t torn = thread_index();
  const double part = grid_source_scale(grid, a).part;
  if (torn >= pbf_pressure_grid_torn_count(t)) return;
  const double lambda =
      pbf_pressure_grid_torn_guess(&grid, t, part, a.inverse, a.free_volumes, a.depths, torn);
  a.lambda[t->torn_at[torn]] = a.before[t->torn_at[torn]] = t->before[torn] = lambda;
}

/* … and of the others: a thread a column. */
static __global__ void __launch_bounds__(PBF_BLOCK)
    guess_kernel(const __grid_constant__ pbf_pressure_grid grid,
                 const __grid_constant__ pressure_grid_arrays a) {
  uint32_t column = thread_index();
  const double part = grid_source_scale(grid, a).part;
  if (column >= pbf_pressure_grid_columns(&grid)) return;
  pbf_pressure_grid_guess(&grid, &a.topology, part, a.inverse, a.free_volumes, a.depths, column,
                          a.lambda);
  const pbf_pressure_grid_column at = pbf_pressure_grid_column_at(&grid, column);
  a.before[at.outside] = a.lambda[at.outside];
  for (int64_t i = 0; i <= grid.n[grid.axis]; ++i)
    a.before[at.floor + i * at.up] = a.lambda[at.floor + i * at.up];
}

/* After the solve: lambda goes on beyond the surface, a thread a node. */
static __global__ void __launch_bounds__(PBF_BLOCK)
    extrapolate_kernel(const __grid_constant__ pbf_pressure_grid grid,
                       const __grid_constant__ pressure_grid_arrays a) {
  const uint32_t index = thread_index();
  const pbf_pressure_grid_topology *t = &a.topology;
  const uint32_t torn = pbf_pressure_grid_torn_count(t);
  double *lambda = pressure_grid_lambda(a);
  if (a.control->largest == 0) return; /* lambda is 0 */
  if (index >= grid.nodes) {
    if (index - grid.nodes >= torn) return;
    const uint32_t node = t->torn_at[index - grid.nodes];
    if (pbf_pressure_grid_is_open(a.depths[node]))
      lambda[node] = pbf_pressure_grid_torn_beyond(&grid, t, a.depths, a.free_volumes, lambda,
                                                   index - grid.nodes);
    return;
  }
  if (!pbf_node_is_inside(&grid, index) || (torn && t->torn[index]) ||
      !pbf_pressure_grid_is_open(a.depths[index]))
    return;
  int i[PBF_DIM], first[PBF_DIM], last[PBF_DIM];
  pbf_pressure_grid_place(&grid, index, i);
  for (int k = 0; k < PBF_DIM; ++k) {
    first[k] = 1;
    last[k] = grid.n[k] + 1;
  }
  lambda[index] = pbf_pressure_grid_node_beyond(&grid, t, a.depths, a.free_volumes, lambda, index,
                                                i, first, last);
}

/* What the grid adds to the moves; of a fluid of the density `carried` where phases differ. Where
 * colliders push, collide_kernel comes next, and reads where particles have come from in `from`;
 * elsewhere it is null. */
template <surfaces_met SURFACES>
static __global__ void __launch_bounds__(PBF_BLOCK)
    apply_correction_kernel(sorted_particles p, const __grid_constant__ pbf_pressure_grid grid,
                            const __grid_constant__ pressure_grid_arrays a, bool torn,
                            pbf_real carried, pbf_real inv_time_step, point *from) {
  const uint32_t i = own_index(p);
  if (i >= p.count || (p.activity && pbf_is_asleep(p.activity[i]))) return;
  point own = load(p.points, i);
  if (from) store(from, i, own);
  pbf_vec x = position_of(own);
  double at[PBF_DIM];
  uint32_t cell = pbf_pressure_grid_cell(&grid, x, at);
  if (torn) cell = pbf_compartment_of(&grid, topology_met<SURFACES>(a), cell, x, at);
  if (cell == PBF_NO_INDEX) return;
  pbf_vec u = pbf_pressure_grid_correction(&grid, &a.topology, pressure_grid_lambda(a), cell, at);
  if (p.mobility) u = pbf_scaled(u, carried * p.mobility[i]);
  for (int k = 0; k < PBF_DIM; ++k) own.c[k] += u.c[k];
  store(p.points, i, own);
  p.velocities[i] = pbf_add_scaled(p.velocities[i], inv_time_step, u);
}

/* What reading pressures asks of the grid of the last step. */
struct grid_pressure {
  pbf_pressure_grid grid;
  pressure_grid_arrays arrays; /* without control: there is none */
  double scale;                /* of lambda */
};

static __device__ __forceinline__ pbf_real grid_pressure_at(const grid_pressure &d, pbf_vec x) {
  if (!PBF_HAS_PRESSURE_GRID || !d.arrays.control) return 0;
  double at[PBF_DIM];
  const pbf_pressure_grid_topology *t = &d.arrays.topology;
  uint32_t cell = pbf_pressure_grid_cell(&d.grid, x, at);
  cell = pbf_compartment_of(&d.grid, t, cell, x, at);
  if (cell == PBF_NO_INDEX) return 0;
  double lambda = pbf_pressure_grid_lambda(&d.grid, t, pressure_grid_lambda(d.arrays), cell, at);
  return (pbf_real)(-d.scale * lambda);
}

/* And its slope: means over a cube so many cells wide. */
static __device__ __forceinline__ double grid_pressure_sloped(const grid_pressure &d, pbf_vec x,
                                                              double cube, double slope[PBF_DIM]) {
  double at[PBF_DIM];
  const pbf_pressure_grid_topology *t = &d.arrays.topology;
  for (int k = 0; k < PBF_DIM; ++k) slope[k] = 0;
  uint32_t cell = pbf_pressure_grid_cell(&d.grid, x, at);
  cell = pbf_compartment_of(&d.grid, t, cell, x, at);
  if (cell == PBF_NO_INDEX) return 0;
  const double lambda = pbf_pressure_grid_lambda_sloped(&d.grid, t, pressure_grid_lambda(d.arrays),
                                                        cell, at, cube, slope);
  for (int k = 0; k < PBF_DIM; ++k) slope[k] *= -d.scale;
  return -d.scale * lambda;
}

#endif
