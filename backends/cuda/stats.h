/* Part of population.h: statistics: sums in float64 by a fixed number of blocks, each in a fixed
 * order, so that they are the same from run to run. The host adds up the blocks. */
#ifndef PBF_CUDA_STATS_H
#define PBF_CUDA_STATS_H

#include "cuda/kernels_solve.h"

enum { PBF_SUM_BLOCKS = 264 };

struct partial_stats {
  double position[PBF_DIM], velocity[PBF_DIM], kinetic_energy;
  double density, density_error, neighbors;
  double position_min[PBF_DIM], position_max[PBF_DIM];
  double speed2_max, density_max;
  uint32_t neighbors_max, squeezed;
};

static __host__ __device__ inline double larger(double a, double b) { return a > b ? a : b; }

static __host__ __device__ inline void merge(partial_stats *a, const partial_stats &b) {
  for (int k = 0; k < PBF_DIM; ++k) {
    a->position[k] += b.position[k];
    a->velocity[k] += b.velocity[k];
    a->position_min[k] = -larger(-a->position_min[k], -b.position_min[k]);
    a->position_max[k] = larger(a->position_max[k], b.position_max[k]);
  }
  a->kinetic_energy += b.kinetic_energy;
  a->density += b.density;
  a->density_error += b.density_error;
  a->neighbors += b.neighbors;
  a->squeezed += b.squeezed;
  a->speed2_max = larger(a->speed2_max, b.speed2_max);
  a->density_max = larger(a->density_max, b.density_max);
  a->neighbors_max = a->neighbors_max > b.neighbors_max ? a->neighbors_max : b.neighbors_max;
}

static __host__ __device__ inline partial_stats empty_stats() {
  partial_stats s = {};
  for (int k = 0; k < PBF_DIM; ++k) s.position_min[k] = 1e300, s.position_max[k] = -1e300;
  return s;
}

/* Of sorted particles: rho/rho0, and how many neighbours each has unless that is null. */
struct found_densities {
  pbf_real *densities;
  uint32_t *neighbors;
};

static inline uint64_t stats_bytes(uint32_t padded) {
  const uint64_t blocks = (padded + PBF_BLOCK - 1) / PBF_BLOCK;
  return padded * (sizeof(pbf_real) + sizeof(uint32_t)) +
         (blocks < PBF_SUM_BLOCKS ? blocks : (uint64_t)PBF_SUM_BLOCKS) * sizeof(partial_stats);
}

/* In such room: densities, neighbours, sums of blocks. */
static inline found_densities found_densities_in(void *room, uint32_t padded) {
  pbf_real *densities = static_cast<pbf_real *>(room);
  return {densities, reinterpret_cast<uint32_t *>(densities + padded)};
}

/* Without what solids contribute, … */
template <int FEATURES>
static __global__ void __launch_bounds__(PBF_BLOCK)
    density_kernel(const __grid_constant__ neighborhood n,
                   const __grid_constant__ pbf_domain domain, found_densities found) {
  const uint32_t i = own_index(n.particles);
  uint32_t neighbors = 0;
  if (i >= n.particles.count) return;
  found.densities[i] = density_at<FEATURES>(n, domain, i, &neighbors);
  if (found.neighbors) found.neighbors[i] = neighbors;
}

/* … which is added. */
template <surfaces_met SURFACES>
static __global__ void __launch_bounds__(PBF_BLOCK)
    add_solid_density_kernel(const __grid_constant__ neighborhood n,
                             const __grid_constant__ step_obstacles obstacles,
                             pbf_real *densities) {
  const uint32_t i = own_index(n.particles);
  if (i >= n.particles.count) return;
  const pbf_vec x = position_of(load(n.particles.points, i));
  pbf_real density = densities[i];
  pbf_vec gradient = {{0}};
  add_boundary<SURFACES>(&n.constants, obstacles, x, &density, &gradient);
  densities[i] = density;
}

static __device__ inline void add_motion(partial_stats *s, pbf_vec x, pbf_vec v) {
  double v2 = 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    double at = (double)x.c[k], speed = (double)v.c[k];
    s->position[k] += at;
    s->velocity[k] += speed;
    s->position_min[k] = -larger(-s->position_min[k], -at);
    s->position_max[k] = larger(s->position_max[k], at);
    v2 += speed * speed;
  }
  s->kinetic_energy += 0.5 * v2;
  s->speed2_max = larger(s->speed2_max, v2);
}

/* `state` gives positions and velocities, `found` what has been found of the same particles sorted,
 * `first` their first. */
template <surfaces_met SURFACES>
static __global__ void __launch_bounds__(PBF_BLOCK)
    stats_kernel(unsorted_particles state, uint32_t first, found_densities found,
                 const __grid_constant__ step_obstacles obstacles, partial_stats *partial) {
  __shared__ partial_stats shared[PBF_BLOCK / 32];
  partial_stats s = empty_stats();
  for (uint32_t i = first + thread_index(); i < state.count; i += gridDim.x * blockDim.x) {
    const double density = (double)found.densities[i];
    const uint32_t neighbors = found.neighbors[i];
    const pbf_vec x = position_of(load(state.points, i));
    add_motion(&s, x, state.velocities[i]);
    s.density += density;
    s.density_error += larger(density - 1, 0);
    s.density_max = larger(s.density_max, density);
    s.neighbors += neighbors;
    s.neighbors_max = max(s.neighbors_max, neighbors);
    s.squeezed += pbf_is_squeezed_by(obstacles_near<SURFACES>(obstacles, x, 0), x);
  }
  /* Every warp's leader takes its lanes in order, then the block's leader the warps. */
  for (uint32_t lane = 0; lane < 32; ++lane) {
    if (threadIdx.x % 32 == lane) {
      if (lane == 0)
        shared[threadIdx.x / 32] = s;
      else
        merge(&shared[threadIdx.x / 32], s);
    }
    __syncwarp();
  }
  __syncthreads();
  if (threadIdx.x != 0) return;
  s = shared[0];
  for (int warp = 1; warp < PBF_BLOCK / 32; ++warp) merge(&s, shared[warp]);
  partial[blockIdx.x] = s;
}

#endif
