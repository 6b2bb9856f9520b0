/* Part of population.h and executor.h: the datum of the pressure grid's closed bodies
 * (physics/pressure_grid/datum.h). */
#ifndef PBF_CUDA_PRESSURE_DATUM_H
#define PBF_CUDA_PRESSURE_DATUM_H

#include "cuda/pressure_grid_host.h"
#include "physics/pressure_grid/datum.h"

/* Of a grid that has been solved: the right sides and what is not lambda have been read. */
static __device__ __forceinline__ pbf_pressure_datum
pressure_datum_of(const pbf_pressure_grid &grid, const pressure_grid_arrays &a) {
  double *other = a.control->odd ? a.lambda : a.before;
  return {&grid,
          &a.topology,
          pressure_grid_integers(a.sums),
          pressure_grid_integers(a.places),
          a.free_volumes,
          a.inverse,
          pressure_grid_lambda(a),
          reinterpret_cast<int64_t *>(a.right),
          reinterpret_cast<int64_t *>(other)};
}

/* A thread an index. */
static __global__ void __launch_bounds__(PBF_BLOCK)
    begin_datum_kernel(const __grid_constant__ pbf_pressure_grid grid,
                       const __grid_constant__ pressure_grid_arrays a, uint32_t indices) {
  const uint32_t index = thread_index();
  const pbf_pressure_datum d = pressure_datum_of(grid, a);
  if (index < indices) pbf_datum_begin(&d, index);
}

/* What `visit` does at each node that is in a body of fluid. */
template <void (*visit)(const pbf_pressure_datum *, uint32_t)>
static __global__ void __launch_bounds__(PBF_BLOCK)
    datum_kernel(const __grid_constant__ pbf_pressure_grid grid,
                 const __grid_constant__ pressure_grid_arrays a) {
  const uint32_t index = thread_index();
  const pbf_pressure_datum d = pressure_datum_of(grid, a);
  if (has_compartment(grid, a, index)) visit(&d, index);
}

/* A thread a node, and behind these one a torn node. */
static __global__ void __launch_bounds__(PBF_BLOCK)
    end_datum_kernel(const __grid_constant__ pbf_pressure_grid grid,
                     const __grid_constant__ pressure_grid_arrays a) {
  const pbf_pressure_grid_topology *t = &a.topology;
  const uint32_t index = thread_index(), torn = pbf_pressure_grid_torn_count(t);
  const pbf_pressure_datum d = pressure_datum_of(grid, a);
  if (index < grid.nodes) {
    if (a.inverse[index] > 0) pbf_datum_end(&d, index);
  } else if (index - grid.nodes < torn && t->inverse[index - grid.nodes] > 0) {
    pbf_datum_end(&d, t->torn_at[index - grid.nodes]);
  }
}

/* What is behind the last node is read by the next solve, and must be a number. */
static __global__ void __launch_bounds__(PBF_BLOCK)
    clear_datum_kernel(const __grid_constant__ pbf_pressure_grid grid,
                       const __grid_constant__ pressure_grid_arrays a, uint32_t indices) {
  const uint32_t index = thread_index();
  const pbf_pressure_datum d = pressure_datum_of(grid, a);
  if (index < indices) d.bodies[index] = d.least[index] = 0;
}

/* Once no more particle is moved by the grid. */
static inline void find_datum(const solver *s) {
  const pbf_pressure_grid &grid = s->pressure_grid;
  const pressure_grid_arrays arrays = pressure_grid_of(s);
  const uint32_t indices = pressure_grid_indices(s), torn = s->pressure_grid_is_torn ? indices : 0;
  const uint32_t blocks = blocks_for(indices);
  begin_datum_kernel<<<blocks, PBF_BLOCK, 0, s->stream>>>(grid, arrays, indices);
  datum_kernel<pbf_datum_join><<<blocks, PBF_BLOCK, 0, s->stream>>>(grid, arrays);
  datum_kernel<pbf_datum_note><<<blocks, PBF_BLOCK, 0, s->stream>>>(grid, arrays);
  end_datum_kernel<<<blocks_for(grid.nodes + torn), PBF_BLOCK, 0, s->stream>>>(grid, arrays);
  clear_datum_kernel<<<blocks, PBF_BLOCK, 0, s->stream>>>(grid, arrays, indices);
}

#endif
