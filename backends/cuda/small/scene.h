/* Small scenes: all steps of a call in one launch. A step of 30,000 particles is a matter of
 * latency: a launch takes longer than its work. Here a particle stays with the same few threads of
 * a resident grid. A block keeps in shared memory all that its particles need: the particles in the
 * cells around them (tile.h), the lists (search.h), positions and lambdas. After every
 * pass it publishes its own values and fetches its neighbours' (exchange.h), so that it waits for
 * its neighbours alone; all blocks meet once a step, between the filling of the cells and the
 * search. The particles are in the order of their ids, so that the order of every sum is a matter
 * of cells and ids, as everywhere; which block has which particle (owners.h) changes no bit.
 *
 * Cells and lists have room for what fluids do. When one overflows, all blocks learn of it, and do
 * this step over by general_step, which has no limits and takes its time. A block whose particles
 * are too far apart for its shared memory reads neighbours from memory in this step instead. */
#ifndef PBF_CUDA_SMALL_SCENE_H
#define PBF_CUDA_SMALL_SCENE_H

#include "cuda/barrier.h"
#include "cuda/small/exchange.h"
#include "cuda/iteration.h"

enum {
  SMALL_MAX_PARTICLES = 65535,          /* cells and lists hold 16-bit numbers of particles */
  SMALL_STEPS = PBF_DIM == 3 ? 16 : 64, /* a launch, and the most that owners last */
  SMALL_THREADS = 512,                  /* of a block */
  SMALL_MIN_OWN = 16,                   /* particles of a block */
  SMALL_CELL_CAPACITY = PBF_DIM == 3 ? 32 : 16,
  SMALL_ITERATIONS = 256,
  SMALL_CHUNK = 4,        /* entries of a list that lie side by side */
  SMALL_MAX_LISTED = 128, /* by a thread */
  SMALL_KEPT = 8,         /* pairs of a thread in registers */
  SMALL_NO_PARTICLE = 0xffff
};

/* What differs from step to step. */
struct small_step {
  pbf_domain domain;
  cell_grid grid;
  pbf_real rounding; /* of pbf_forces */
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

struct alignas(PBF_DIM == 3 ? 16 : 8) small_position {
  float c[PBF_DIM == 3 ? 4 : 2];
};

namespace {

/* How a block divides up its dynamic shared memory. */
struct small_layout {
  uint32_t words;         /* of a bit each cell of the grid */
  uint32_t cell_capacity; /* cells of a tile, … */
  uint32_t
      slot_capacity; /* … its particles, both even; SMALL_NO_PARTICLE is none of their numbers */
  uint32_t list_capacity; /* entries of a thread's list, SMALL_CHUNK more than it may have */

  __host__ __device__ size_t bytes() const {
    size_t slots = (size_t)slot_capacity + 2, words_even = ((size_t)words + 1) / 2 * 2;
    return (size_t)SMALL_THREADS * list_capacity * sizeof(uint16_t) +
           slots * (sizeof(small_position) + sizeof(float) + 2 * sizeof(uint16_t)) +
           words_even * (sizeof(uint32_t) + sizeof(uint16_t)) + cell_capacity * sizeof(uint32_t) +
           (cell_capacity + 2) * sizeof(uint16_t) + slots;
  }
};

}  // namespace

struct small_scene {
  point *points;
  pbf_vec *velocities;
  pbf_real *last_pressure; /* where lambda adds up, else null */
  const uint16_t *owners;  /* the particles in the order in which blocks own them */
  uint32_t count, own;     /* particles in all, and of a block */
  uint32_t cells, steps, iterations;
  uint32_t lanes; /* threads of a particle, a power of two up to 8 */
  small_layout layout;
  pbf_constants constants;
  pbf_forces forces;
  pbf_real inv_time_step;
  int wall_density, accelerated;
  int collide_after_prediction, collide_in_iteration, collide_after_solve;
  const small_step *table; /* a step each */
  const small_iteration *iteration_table;
  const pbf_surface *surfaces; /* surface_count a step */
  int surface_count;
};

struct small_control {
  grid_counter filled;   /* all particles are in their cells */
  grid_counter searched; /* all lists are there */
  grid_counter general;  /* other barriers: before the first step, in general_step */
};

struct small_buffers {
  particle_exchange exchange;
  uint32_t *cell_count; /* lower half of even steps, upper half of odd ones */
  uint16_t *cell_list;  /* SMALL_CELL_CAPACITY each */
  small_control *control;
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

static __device__ __forceinline__ pbf_forces forces_at(const small_scene &scene,
                                                       const small_step &step) {
  pbf_forces forces = scene.forces;
  forces.rounding = step.rounding;
  return forces;
}

/* Where in a cell's count that of this step begins. */
static __device__ __forceinline__ uint32_t count_shift(uint32_t step) { return step % 2 * 16; }

/* How many of a cell's particles are listed. */
static __device__ __forceinline__ uint32_t listed_in(const small_buffers &buffers, uint32_t cell,
                                                     uint32_t shift) {
  return min(buffers.cell_count[cell] >> shift & 0xffff, (uint32_t)SMALL_CELL_CAPACITY);
}

/* Clears the counts of all cells, with all threads of the grid. */
static __device__ __forceinline__ void clear_counts(const small_buffers &buffers, uint32_t cells) {
  for (uint32_t k = thread_index(); k < cells; k += gridDim.x * blockDim.x)
    buffers.cell_count[k] = 0;
}

/* Clears a cell's count of this step; the same again does no harm. */
static __device__ __forceinline__ void clear_count(const small_buffers &buffers, uint32_t cell,
                                                   uint32_t shift) {
  atomicAnd(buffers.cell_count + cell, 0xffff0000u >> shift);
}

#endif
