/* Part of solver.h: the kernels of what is placed in fluid (physics/passes/overlap.h). */
#ifndef PBF_CUDA_OVERLAP_H
#define PBF_CUDA_OVERLAP_H

#include "cuda/kernels_solve.h"

/* In place of lambda, before the solve, of what has been placed: this, and its number, -2 … 1. */
constexpr pbf_real PBF_PLACED_MARK = 4;

static __device__ __forceinline__ pbf_real placed_number_of(const point &p) {
  const pbf_real number = p.lambda - PBF_PLACED_MARK;
  return number >= -2 && number <= 1 ? number : 0;
}

/* Marks what `found` says has been placed, or enters; with nothing placed it takes the marks away.
 * Sleepers keep their lambda. */
static __global__ void __launch_bounds__(PBF_BLOCK)
    mark_placed_kernel(sorted_particles p, pbf_overlap found, pbf_entering entering) {
  uint32_t i = own_index(p);
  if (i >= p.count || (p.activity && pbf_is_asleep(p.activity[i]))) return;
  const pbf_real number = pbf_placed_number(found, entering, p.ids[i], p.overlap[i]);
  p.points[i].lambda = number != 0 ? PBF_PLACED_MARK + number : 0;
}

/* Adds the overlap that is found at the start of the step, between these walls, and the colliders,
 * of that time. `ghosts`: what these add to densities, or null. Of listed colliders the device has
 * found.more_colliders. */
template <int FEATURES, bool LISTED>
static __global__ void __launch_bounds__(PBF_BLOCK)
    overlap_kernel(const __grid_constant__ neighborhood n,
                   const __grid_constant__ iteration_extras extras,
                   const __grid_constant__ pbf_domain domain, pbf_real time_step,
                   const pbf_real *ghosts, pbf_overlap found, pbf_entering entering) {
  uint32_t i = own_index(n.particles), own = min(i, n.particles.count - 1);
  const pbf_constants *c = &n.constants;
  const density_pass<fixed<FEATURES>> all = {c, {}};
  const placed_density_pass<fixed<FEATURES>> placed = {c, {}};
  const pbf_vec *velocities = n.particles.velocities;
  const at_start places = {time_step};
  const pbf_vec x = places.place(load(n.particles.points, own), velocities[own]);
  if (!__syncthreads_or(i < n.particles.count && pbf_overlap_reaches(entering, x))) return;
  auto sums = all.template begin<pbf_real>();
  auto placed_sums = placed.template begin<pbf_real>();
  for_points_with(
      n.particles, n.grid, n.lists, i, x, velocities,
      [&](const point &other, const pbf_vec &v) {
        neighbor_of<pbf_real> j = neighbor_between(x, places.place(other, v));
        j.number = placed_number_of(other);
        all.pair(&sums, {}, j);
        placed.pair(&placed_sums, {}, j);
      },
      places.meets(n, own));
  if (i >= n.particles.count) return;
  if (extras.rest.activity && pbf_is_inactive(extras.rest.activity[i])) return;
  pbf_vec gradient = {{0}};
  pbf_real density = sums.density + (ghosts ? ghosts[i] : 0), by_placed = placed_sums.density;
  if (extras.wall_density) {
    const step_obstacles all = {domain, extras.obstacles.count, extras.obstacles.surfaces};
    const auto &before = asked_near<LISTED>(all, x, (double)c->h);
    const pbf_constants *of_solids = constants_for<LISTED>(all, c);
    pbf_boundary boundary = pbf_boundary_at_time(of_solids, before, x, x, 1);
    pbf_add_boundary(&boundary, &density, &gradient);
    by_placed += placed_boundary(of_solids, before, found, LISTED ? found.more_colliders : nullptr,
                                 x, 1, pbf_enters(entering, n.particles.ids[i]));
  }
  pbf_real *overlap = n.particles.overlap + i;
  *overlap = pbf_overlap_found(c, found, entering, n.particles.ids[i], density, by_placed,
                               placed_sums.stream, *overlap);
}

/* Of what is still inside a solid. */
template <bool LISTED>
static __global__ void __launch_bounds__(PBF_BLOCK)
    overlap_in_solids_kernel(const __grid_constant__ neighborhood n,
                             const __grid_constant__ step_obstacles obstacles) {
  const uint32_t i = own_index(n.particles);
  if (i >= n.particles.count) return;
  const pbf_vec x = position_of(load(n.particles.points, i));
  n.particles.overlap[i] =
      pbf_overlap_at(asked_near<LISTED>(obstacles, x, 0.0), x, n.particles.overlap[i]);
}

#endif
