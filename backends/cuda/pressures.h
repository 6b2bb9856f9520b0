/* Part of population.h. Pressures of the last step, where they are read: lambda and what the
 * pressure grid adds to it, fitted to the particles around (passes/pressure_fit.h). */
#ifndef PBF_CUDA_PRESSURES_H
#define PBF_CUDA_PRESSURES_H

#include "cuda/pressure_grid.h"
#include "cuda/sort.h"
#include "physics/passes/pressure_fit.h"

/* Of the last step: that of the iterations, and of the grid in deep water. */
struct pressure_source {
  pbf_real scale;
  grid_pressure grid;
};

/* Lambda of the iterations and of the grid. */
static __device__ __forceinline__ pbf_real whole_lambda(const pressure_source &source,
                                                        const point &p) {
  if (!source.grid.arrays.control) return p.lambda;
  return p.lambda - grid_pressure_at(source.grid, position_of(p)) / source.scale;
}

static __global__ void add_weight_kernel(point *points, uint32_t count, pressure_source source) {
  uint32_t i = thread_index();
  if (i >= count) return;
  point p = load(points, i);
  p.lambda = whole_lambda(source, p);
  store(points, i, p);
}

/* The sorted points, which have none, get their lambda, and present[k] is where the k-th of them is
 * in the state. */
static __global__ void sort_lambda_kernel(unsorted_particles state, neighborhood n,
                                          pressure_source source, uint32_t *present) {
  uint32_t i = thread_index();
  if (i >= state.count) return;
  const sorted_particles &to = n.particles;
  point own = load(state.points, i);
  uint32_t cell = grid_cell(n.grid, position_of(own)), k = to.cell_start[cell];
  while (k < to.cell_start[cell + 1] && to.ids[k] != state.ids[i]) ++k;
  if (k == to.cell_start[cell + 1]) return; /* a place that is none */
  to.points[k].lambda = whole_lambda(source, own);
  present[k] = i;
}

/* In the order of the state. */
static __global__ void __launch_bounds__(PBF_BLOCK)
    fit_pressures_kernel(neighborhood n, pbf_real scale, const uint32_t *present, pbf_real *out) {
  uint32_t k = thread_index();
  if (k >= n.particles.count) return;
  const pressure_fit_pass pass = {&n.constants};
  const pbf_real own = n.particles.points[k].lambda;
  const pbf_real line = pass.line(sums_present(pass, n, k), own);
  out[present[k]] = pbf_pressure(scale, pass.finish(line, own));
}

#endif
