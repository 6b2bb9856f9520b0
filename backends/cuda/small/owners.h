/* Part of small/host.h. Which block of a small scene owns which particle. Neighbours should be
 * together, so that ghosts are few: particles in the order of a Z curve through coarse cells, which
 * a block takes a piece of. Any order is right, and none changes a bit of the result, so an order
 * lasts for a few steps.
 */
#ifndef PBF_CUDA_SMALL_OWNERS_H
#define PBF_CUDA_SMALL_OWNERS_H

#include "cuda/small/kernel.h"

/* Into the order of ids: a particle's place is the number of ids below its own. */
static __global__ void order_kernel(unsorted_particles from, point *points, pbf_vec *velocities,
                                    uint32_t *ids, pbf_real *last_pressure) {
  uint32_t i = thread_index(), place = 0;
  if (i >= from.count) return;
  uint32_t id = from.ids[i];
  for (uint32_t k = 0; k < from.count; ++k) place += from.ids[k] < id;
  store(points, place, load(from.points, i));
  velocities[place] = from.velocities[i];
  ids[place] = id;
  if (from.last_pressure) last_pressure[place] = from.last_pressure[i];
}

struct owner_grid {
  pbf_vec origin;
  pbf_real scale;
  uint32_t bits; /* an axis; coordinates beyond begin anew */
};

/* No more than the cells of the search, which there is room to scan. */
static inline uint32_t owner_bits(uint32_t count) {
  bool many = count >= 1 << 14;
  return PBF_DIM == 3 ? (many ? 5 : 4) : (many ? 7 : 6);
}

/* Cells that cover the domain if that leaves them of about the size that suits a block. */
static inline owner_grid owner_grid_over(const pbf_domain *domain, double h, uint32_t bits) {
  double width = 0, min_width = PBF_DIM == 3 ? 0.75 : 1.5;
  for (int k = 0; k < PBF_DIM; ++k)
    width = fmax(width, ((double)domain->upper.c[k] - (double)domain->lower.c[k]) / (1 << bits));
  width = fmin(fmax(width, min_width * h), 3 * min_width * h);
  return {domain->lower, (pbf_real)(1 / width), bits};
}

static __device__ __forceinline__ uint32_t owner_key(const owner_grid &g, pbf_vec x) {
  uint32_t key = 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    uint32_t at = (uint32_t)(int)((x.c[k] - g.origin.c[k]) * g.scale);
    for (uint32_t bit = 0; bit < g.bits; ++bit) key |= (at >> bit & 1) << (bit * PBF_DIM + k);
  }
  return key;
}

static __global__ void count_owned_kernel(const point *points, uint32_t count, owner_grid grid,
                                          uint32_t *counts, sort_scratch scratch) {
  uint32_t i = thread_index();
  if (i >= count) return;
  uint32_t key = owner_key(grid, position_of(load(points, i)));
  scratch.cell[i] = key;
  scratch.arrival[i] = atomicAdd(counts + key, 1u);
}

static __global__ void place_owned_kernel(uint32_t count, const uint32_t *starts,
                                          sort_scratch scratch, uint16_t *owners) {
  uint32_t i = thread_index();
  if (i < count) owners[starts[scratch.cell[i]] + scratch.arrival[i]] = (uint16_t)i;
}

#endif
