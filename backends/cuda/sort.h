/* Prediction, and the sort by cell: a counting sort whose order within a cell is that of the ids,
 * whatever the order in which the atomics arrive. */
#ifndef PBF_CUDA_SORT_H
#define PBF_CUDA_SORT_H

#include "cuda/grid.h"
#include "cuda/launch.h"
#include "cuda/obstacles.h"
#include "cuda/particles.h"
#include "physics/passes/overlap.h"
#include "physics/passes/predict.h"
#include "physics/sleep.h"

/* Whether the build lets fluid sleep. */
constexpr bool PBF_SLEEP = (PBF_BUILT & PBF_FEATURE_SLEEP) != 0;

struct prediction {
  pbf_forces forces;
  step_obstacles obstacles;
  int collide;
  pbf_periods periods; /* of the domain */
};

struct unsorted_particles {
  const point *points;
  const pbf_vec *velocities;
  const uint32_t *ids;
  uint32_t count;
  const pbf_real *activity;      /* where fluid sleeps, else null, */
  const uint32_t *all_asleep;    /* and then: when not 0 all stay in their order; */
  uint32_t *some_asleep;         /* the sort sets it where a particle sleeps */
  const pbf_real *last_pressure; /* where lambda adds up, else null */
  const pbf_real *overlap;       /* where fluid has been placed in other fluid, else null; */
  pbf_real overlap_decay;        /* in this step */
  const uint8_t *phase;          /* where phases differ, else null */
  const pbf_vec *acceleration;   /* where particles have some, else null */
};

/* Of a particle that other ranks hold alone. */
constexpr uint32_t PBF_NO_CELL = ~0u;

/* One entry a particle; dead after the sort. */
struct sort_scratch {
  uint32_t *cell, *arrival, *id_by_cell;
};

/* Whether a particle of a kernel for ALL sleeps. */
template <bool ALL>
static __device__ __forceinline__ bool sleeps(const unsorted_particles &from, uint32_t i) {
  return ALL && PBF_SLEEP && from.activity && pbf_is_asleep(from.activity[i]);
}

/* With what an acceleration of its own adds to it. */
template <bool ALL>
static __device__ __forceinline__ pbf_vec velocity_of(const unsorted_particles &from,
                                                      const pbf_forces &forces, uint32_t i) {
  const pbf_vec v = from.velocities[i];
  return ALL && from.acceleration ? pbf_add_acceleration(&forces, v, from.acceleration[i]) : v;
}

/* ALL: of scenes that have what few have: sleep, periodic axes, phases, accelerations. */
template <surfaces_met SURFACES, bool ALL>
static __device__ __forceinline__ pbf_vec predicted_position(const unsorted_particles &from,
                                                             const prediction &p, uint32_t i,
                                                             pbf_vec x) {
  if (sleeps<ALL>(from, i)) return x;
  pbf_vec y = pbf_predict(&p.forces, x, velocity_of<ALL>(from, p.forces, i));
  return p.collide ? resolve_collisions<SURFACES>(p.obstacles, 1, x, y) : y;
}

/* The stages of the sort for particle i. Without `cell_count` it learns its cell alone. */
template <surfaces_met SURFACES, bool ALL>
static __device__ __forceinline__ void count_particle(const unsorted_particles &from,
                                                      const prediction &p, const cell_grid &grid,
                                                      uint32_t *cell_count,
                                                      const sort_scratch &scratch, uint32_t i) {
  pbf_vec x = position_of(load(from.points, i));
  pbf_vec predicted = predicted_position<SURFACES, ALL>(from, p, i, x);
  if (ALL && p.periods.any) predicted = pbf_image_inside(&p.periods, predicted);
  uint32_t cell = grid_cell(grid, predicted);
  scratch.cell[i] = cell;
  if (cell_count) scratch.arrival[i] = atomicAdd(&cell_count[cell], 1u);
}

static __device__ __forceinline__ void scatter_particle(const unsorted_particles &from,
                                                        const uint32_t *cell_start,
                                                        const sort_scratch &scratch, uint32_t i) {
  scratch.id_by_cell[cell_start[scratch.cell[i]] + scratch.arrival[i]] = from.ids[i];
}

template <surfaces_met SURFACES, bool ALL>
static __device__ __forceinline__ void place_particle(const unsorted_particles &from,
                                                      const prediction &p,
                                                      const sort_scratch &scratch,
                                                      const sorted_particles &to, uint32_t i) {
  uint32_t cell = scratch.cell[i], id = from.ids[i];
  uint32_t start = to.cell_start[cell], end = to.cell_start[cell + 1], place = start;
  for (uint32_t k = start; k < end; ++k) place += scratch.id_by_cell[k] < id;
  if (ALL && PBF_SLEEP && from.activity && *from.all_asleep) place = i;
  point own = load(from.points, i);
  pbf_vec x = position_of(own);
  pbf_vec predicted = predicted_position<SURFACES, ALL>(from, p, i, x);
  if (sleeps<ALL>(from, i)) {
    store(to.points, place, own);
    to.velocities[place] = {{0}};
    *from.some_asleep = 1;
  } else {
    pbf_vec inside = predicted;
    if (ALL && p.periods.any) inside = pbf_image_inside(&p.periods, predicted);
    store(to.points, place, point_at(inside));
    pbf_vec v = velocity_of<ALL>(from, p.forces, i), free = pbf_predict(&p.forces, x, v);
    to.velocities[place] = pbf_predicted_velocity(&p.forces, x, v, free, predicted);
  }
  if (ALL && PBF_SLEEP && from.activity) to.activity[place] = from.activity[i];
  if (from.last_pressure) to.last_pressure[place] = from.last_pressure[i];
  if (from.overlap) to.overlap[place] = pbf_overlap_left(from.overlap_decay, from.overlap[i]);
  if (ALL && from.phase) to.phase[place] = from.phase[i];
  if (ALL && from.acceleration) to.acceleration[place] = from.acceleration[i];
  to.ids[place] = id;
  to.cells[place] = cell;
}

template <surfaces_met SURFACES, bool ALL>
static __global__ void __launch_bounds__(PBF_BLOCK)
    predict_kernel(unsorted_particles from, prediction p, cell_grid grid, uint32_t *cell_count,
                   sort_scratch scratch) {
  uint32_t i = thread_index();
  if (i < from.count) count_particle<SURFACES, ALL>(from, p, grid, cell_count, scratch, i);
}

static __global__ void __launch_bounds__(PBF_BLOCK)
    scatter_kernel(unsorted_particles from, const uint32_t *cell_start, sort_scratch scratch) {
  uint32_t i = thread_index();
  if (i < from.count && scratch.cell[i] != PBF_NO_CELL)
    scatter_particle(from, cell_start, scratch, i);
}

template <surfaces_met SURFACES, bool ALL>
static __global__ void __launch_bounds__(PBF_BLOCK)
    place_kernel(unsorted_particles from, prediction p, sort_scratch scratch, sorted_particles to) {
  uint32_t i = thread_index();
  if (i < from.count && scratch.cell[i] != PBF_NO_CELL)
    place_particle<SURFACES, ALL>(from, p, scratch, to, i);
}

/* The same among listed surfaces, which few threads meet: these are not to take the registers of
 * all. */
enum { BLOCKS_OF_LISTED = 4 };

static __global__ void __launch_bounds__(PBF_BLOCK, BLOCKS_OF_LISTED)
    predict_listed_kernel(unsorted_particles from, prediction p, cell_grid grid,
                          uint32_t *cell_count, sort_scratch scratch) {
  uint32_t i = thread_index();
  if (i < from.count) count_particle<LISTED_SURFACES, true>(from, p, grid, cell_count, scratch, i);
}

static __global__ void __launch_bounds__(PBF_BLOCK, BLOCKS_OF_LISTED)
    place_listed_kernel(unsorted_particles from, prediction p, sort_scratch scratch,
                        sorted_particles to) {
  uint32_t i = thread_index();
  if (i < from.count && scratch.cell[i] != PBF_NO_CELL)
    place_particle<LISTED_SURFACES, true>(from, p, scratch, to, i);
}

#endif
