/* The kernels of the density solve, which sum over neighbours by the passes of all backends
 * (physics/passes/). Gather only: the thread of a particle writes to that particle. */
#ifndef PBF_CUDA_KERNELS_SOLVE_H
#define PBF_CUDA_KERNELS_SOLVE_H

#include "cuda/driver.h"
#include "cuda/ghosts.h"
#include "cuda/solids.h"
#include "physics/passes/density.h"
#include "physics/passes/lambda.h"
#include "physics/passes/mobility.h"
#include "physics/passes/move.h"
#include "physics/passes/overlap.h"
#include "physics/passes/torque.h"

/* How an iteration's lambda comes about, other than from neighbours. */
struct lambda_parts {
  bool first, smooths; /* by the last pressure, unless phases differ: then end_mobility_kernel */
  const pbf_real *residual_density;    /* in very short steps; else null */
  const lambda_sums<pbf_real> *ghosts; /* where walls have them (ghosts.h); else null */
  boundary_sums boundary;
};

/* How an iteration's move ends. */
struct move_end {
  iteration_place place;
  pbf_real inv_time_step;
  int collide;                       /* with the obstacles, */
  int collide_last;                  /* and in the last iteration */
  pbf_vec *velocities;               /* with all moves so far, from the first on */
  const move_sums<pbf_real> *ghosts; /* where walls have them; else null */
  boundary_sums boundary;
};

/* Blocks that a multiprocessor is to hold. Told so, the compiler takes the registers for it, and
 * lets several loads of a thread be under way at once. */
constexpr int PBF_BLOCKS_AT_ONCE =
    resident_blocks(sizeof(pbf_real) == sizeof(float) ? 5 : 4, PBF_BLOCK);

/* ALL: for periodic axes and phases, too, which few scenes have. ALL and SLEEP are EXTRAS, too. */
template <int FEATURES, bool EXTRAS, bool ALL, bool SLEEP>
static __global__ void __launch_bounds__(PBF_BLOCK, PBF_BLOCKS_AT_ONCE)
    lambda_kernel(neighborhood n, iteration_extras extras, lambda_parts parts) {
  uint32_t i = own_index(n.particles);
  const pbf_constants *c = &n.constants;
  const bool checks_convergence = EXTRAS && PBF_TOLERANCE && extras.watch.watch;
  if (checks_convergence && is_converged(extras.watch)) return;
  point *points = n.particles.points;
  uint32_t own = min(i, n.particles.count - 1);
  pbf_real activity = SLEEP ? extras.rest.activity[own] : 0;
  bool inactive = SLEEP && pbf_is_inactive(activity);
  if (SLEEP && __all_sync(~0u, inactive)) {
    if (checks_convergence && i < n.particles.count)
      add_error_units(extras.watch, min(32u, n.particles.count - i / 32 * 32),
                      extras.watch.inactive);
    return;
  }
  pbf_vec x = position_of(load(points, own));
  /* Read long before it is written: a store to an address that a load is still waiting for holds up
   * the other loads of the multiprocessor, a whole lambda by two thirds. */
  bool accelerated = EXTRAS && PBF_CHEBYSHEV && extras.total;
  pbf_real total = accelerated && !parts.first ? extras.total[own] : 0;
  const lambda_pass<fixed<FEATURES>, SCALED_SUMS> pass = {c, {}};
  auto sums =
      sums_around(pass, n, i, x, {}, static_cast<const no_value *>(nullptr), at_points_of<ALL>{});
  if (i >= n.particles.count) return;
  pbf_real residual_density =
      EXTRAS && PBF_CHEBYSHEV && parts.residual_density ? parts.residual_density[i] : 0;
  if (EXTRAS && PBF_GHOSTS && parts.ghosts) add_sums(&sums, parts.ghosts[i]);
  const bool has_boundary = EXTRAS && parts.boundary.densities;
  if (has_boundary) add_boundary_of(parts.boundary, i, &sums);
  pbf_real lambda = finish_lambda<NO_SURFACES>(pass, extras.obstacles,
                                               EXTRAS && extras.wall_density && !has_boundary,
                                               residual_density, x, &sums);
  if (checks_convergence)
    add_error_units(
        extras.watch, min(32u, n.particles.count - i / 32 * 32),
        inactive ? extras.watch.inactive : pbf_error_units(c, residual_density, sums.density));
  if (inactive) return;
  if (EXTRAS && PBF_CHEBYSHEV && n.particles.overlap)
    n.particles.overlap[i] = pbf_overlap_of_error(n.particles.overlap[i], sums.density - c->target);
  if (SLEEP && parts.first && pbf_is_asleep(activity)) {
    extras.rest.kept[i].c[0] = points[i].lambda;
    points[i].lambda = 0;
  }
  if (accelerated) {
    pbf_real change = points[i].lambda;
    pbf_accelerate(c, sums.density, lambda, &total, &change);
    if (parts.smooths) pbf_smooth_pressure(c, n.particles.last_pressure[i], &total, &change);
    extras.total[i] = total;
    lambda = change;
  }
  points[i].lambda = lambda;
}

/* Where phases differ: what they make of particles that have just been sorted, … */
static __global__ void __launch_bounds__(PBF_BLOCK)
    phase_kernel(sorted_particles p, pbf_phase_constants phases) {
  const uint32_t i = own_index(p);
  if (i < p.count) p.mobility[i] = phases.mobility[p.phase[i]];
}

/* Whether lambda_kernel finds this particle's, which does nothing once the solve has ended. */
static __device__ __forceinline__ bool has_lambda(const neighborhood &n,
                                                  const iteration_extras &extras, uint32_t i) {
  if (PBF_TOLERANCE && extras.watch.watch && is_converged(extras.watch)) return false;
  return i < n.particles.count &&
         !(PBF_SLEEP && extras.rest.activity && pbf_is_inactive(extras.rest.activity[i]));
}

/* … and around it lambda_kernel finds and bounds what particles are moved by, over what their
 * mobility makes of it: passes/mobility.h. */
template <int FEATURES>
static __global__ void __launch_bounds__(PBF_BLOCK)
    begin_mobility_kernel(neighborhood n, iteration_extras extras, bool first, pbf_real *around) {
  const uint32_t i = own_index(n.particles), own = min(i, n.particles.count - 1);
  const mobility_pass<fixed<FEATURES>> pass = {&n.constants, {}};
  const pbf_real *mobility = n.particles.mobility;
  const pbf_vec x = position_of(load(n.particles.points, own));
  const pbf_real found = pass.finish(sums_around(pass, n, i, x, {}, mobility), mobility[own]);
  if (!has_lambda(n, extras, i)) return;
  around[i] = found;
  if (first || !extras.total) return;
  extras.total[i] *= found;
  n.particles.points[i].lambda *= found;
}

static __global__ void __launch_bounds__(PBF_BLOCK)
    end_mobility_kernel(neighborhood n, iteration_extras extras, bool smooths,
                        const pbf_real *around) {
  const uint32_t i = own_index(n.particles);
  if (!has_lambda(n, extras, i)) return;
  pbf_real *change = &n.particles.points[i].lambda;
  *change /= around[i];
  if (!extras.total) return;
  extras.total[i] /= around[i];
  if (smooths)
    pbf_smooth_pressure(&n.constants, n.particles.last_pressure[i], &extras.total[i], change);
}

/* The sleeping boundary's move: its place, with the lambda that others read, and in the state the
 * one that it keeps. No later stage asks for its neighbours. */
static __device__ __forceinline__ void keep_sleeping_boundary(const neighborhood &n,
                                                              const iteration_extras &extras,
                                                              const point &own, const move_end &end,
                                                              bool last, point *moved, uint32_t i) {
  point to = own;
  if (last) {
    to.lambda = extras.rest.kept[i].c[0];
    end.velocities[i] = {{0}};
    n.lists.sizes[i] = 0;
  }
  store(moved, i, to);
}

/* That of other sleepers: both buffers hold the place. Where lambda adds up, they have none from
 * the first iteration on, and in the state all that they hold. */
static __device__ __forceinline__ void keep_inactive(const iteration_extras &extras,
                                                     const point &own, const move_end &end,
                                                     bool last, point *moved, uint32_t i) {
  point to = own;
  if (end.place.first) end.velocities[i] = {{0}};
  if (!extras.total) {
    if (end.place.first) store(moved, i, own);
    return;
  }
  if (end.place.first) extras.total[i] = own.lambda;
  if (!end.place.first && !end.place.second && !last) return;
  to.lambda = last ? extras.total[i] : 0;
  store(moved, i, to);
}

/* Of the step, for the next one. */
static __device__ __forceinline__ void keep_pressure(const neighborhood &n, uint32_t i,
                                                     pbf_real total) {
  if (PBF_CHEBYSHEV && n.particles.last_pressure)
    n.particles.last_pressure[i] = pbf_pressure_to_keep(&n.constants, total);
}

/* From n.particles.points to `moved`. ALL and SLEEP are EXTRAS, too. */
template <int FEATURES, bool EXTRAS, bool ALL, bool SLEEP>
static __global__ void __launch_bounds__(PBF_BLOCK, PBF_BLOCKS_AT_ONCE)
    move_kernel(neighborhood n, point *moved, iteration_extras extras, move_end end) {
  uint32_t i = own_index(n.particles);
  const pbf_constants *c = &n.constants;
  const point *points = n.particles.points;
  point own = load(points, min(i, n.particles.count - 1));
  bool last = end.place.last;
  if (SLEEP && *extras.rest.all) {
    if (end.place.first && i < n.particles.count) {
      store(moved, i, own);
      end.velocities[i] = {{0}};
    }
    return;
  }
  if (EXTRAS && PBF_TOLERANCE && extras.watch.watch) {
    if (is_converged(extras.watch)) { /* x* changes its place, and nothing else */
      if (i < n.particles.count) store(moved, i, own);
      return;
    }
    last = ends(extras.watch, last, i - n.particles.first);
  }
  pbf_real activity = SLEEP ? extras.rest.activity[min(i, n.particles.count - 1)] : 0;
  bool asleep = SLEEP && pbf_is_asleep(activity);
  if (asleep && i < n.particles.count) {
    if (pbf_is_inactive(activity))
      keep_inactive(extras, own, end, last, moved, i);
    else
      keep_sleeping_boundary(n, extras, own, end, last, moved, i);
    if (last) keep_pressure(n, i, moved[i].lambda);
  }
  if (SLEEP && __all_sync(~0u, asleep)) return;
  pbf_vec x = position_of(own);
  const move_pass_of<fixed<FEATURES>, SCALED_SUMS> pass = {c, {}};
  auto sums = sums_around(pass, n, i, x, {own.lambda}, static_cast<const no_value *>(nullptr),
                          at_points_of<ALL>{});
  if (i >= n.particles.count || (SLEEP && asleep)) return;
  pbf_vec v = end.place.first ? n.particles.velocities[i] : end.velocities[i];
  if (EXTRAS && PBF_GHOSTS && end.ghosts) add_sums(&sums, end.ghosts[i]);
  const bool has_boundary = EXTRAS && end.boundary.densities;
  if (has_boundary) correct_by_boundary_of(end.boundary, i, own.lambda, &sums);
  x = finish_move<NO_SURFACES>(
      pass, extras.obstacles,
      {EXTRAS && extras.wall_density && !has_boundary, end.collide + (last && end.collide_last),
       end.inv_time_step, ALL && n.particles.mobility ? n.particles.mobility + i : nullptr},
      own.lambda, n.particles.overlap && n.particles.overlap[i] > 0, n.particles.ids[i], x, x, sums,
      &v);
  bool accelerated = EXTRAS && PBF_CHEBYSHEV && extras.total;
  point to = point_at(x);
  if (accelerated || SLEEP) to.lambda = own.lambda;
  if (accelerated && last) {
    to.lambda = extras.total[i];
    keep_pressure(n, i, to.lambda);
  }
  store(moved, i, to);
  if (SLEEP && last && pbf_just_woke(&extras.rest.sleep, extras.rest.activity[i])) v = {{0}};
  end.velocities[i] = v;
}

/* Where particles were at the start of the step. */
static __global__ void __launch_bounds__(PBF_BLOCK)
    start_kernel(sorted_particles p, pbf_real time_step, point *starts) {
  uint32_t i = own_index(p);
  if (i < p.count)
    store(starts, i, point_at(at_start{time_step}.place(load(p.points, i), p.velocities[i])));
}

/* The torque of the move that is next. */
template <int FEATURES>
static __global__ void __launch_bounds__(PBF_BLOCK)
    torque_kernel(neighborhood n, convergence_check watch, bool first, const point *starts,
                  pbf_curl *torques) {
  uint32_t i = own_index(n.particles), own = min(i, n.particles.count - 1);
  if (PBF_TOLERANCE && watch.watch && is_converged(watch)) return;
  const point here = load(n.particles.points, own);
  const pbf_vec start = position_of(load(starts, own));
  const torque_pass<fixed<FEATURES>> pass = {&n.constants, {}};
  auto sums = pass.template begin<pbf_real>();
  for (int k = 0; k < PBF_CURL_DIM && !first; ++k) sums.torque[k] = torques[own].c[k];
  add_neighbors(pass, n, i, position_of(here), {here.lambda, lanes_of(start)},
                reinterpret_cast<const start_point *>(starts), &sums);
  if (i < n.particles.count) torques[i] = curl_of(sums.torque);
}

/* The density where the particles were at the start of the step. `with_ghosts`: `densities` holds
 * what these add to it. */
template <int FEATURES>
static __global__ void __launch_bounds__(PBF_BLOCK)
    density_at_start_kernel(neighborhood n, pbf_real time_step, bool with_ghosts,
                            pbf_real *densities) {
  uint32_t i = own_index(n.particles), own = min(i, n.particles.count - 1);
  const density_pass<fixed<FEATURES>> pass = {&n.constants, {}};
  const pbf_vec *velocities = n.particles.velocities;
  const at_start places = {time_step};
  const pbf_vec x = places.place(load(n.particles.points, own), velocities[own]);
  const pbf_real density = sums_around(pass, n, i, x, {}, velocities, places).density;
  if (i < n.particles.count) densities[i] = density + (with_ghosts ? densities[i] : 0);
}

/* From that, and what solids of that time contribute, to what a very short step leaves of the
 * density error. */
template <surfaces_met SURFACES>
static __global__ void __launch_bounds__(PBF_BLOCK)
    residual_density_kernel(const __grid_constant__ neighborhood n,
                            const __grid_constant__ step_obstacles before, bool wall_density,
                            pbf_real time_step, pbf_real *residual_density) {
  const uint32_t i = own_index(n.particles);
  const pbf_constants *c = &n.constants;
  if (i >= n.particles.count) return;
  const at_start places = {time_step};
  const pbf_vec x = places.place(load(n.particles.points, i), n.particles.velocities[i]);
  pbf_real density = residual_density[i];
  pbf_vec gradient = {{0}};
  if (wall_density) {
    const pbf_boundary boundary =
        pbf_boundary_at_time(constants_for<SURFACES == LISTED_SURFACES>(before, c),
                             obstacles_near<SURFACES>(before, x, (double)c->h), x, x, 1);
    pbf_add_boundary(&boundary, &density, &gradient);
  }
  const pbf_real overlap = n.particles.overlap ? n.particles.overlap[i] : 0;
  residual_density[i] = pbf_real_max(pbf_residual_density(c, density), overlap);
}

/* rho/rho0, but for what surfaces contribute, and the number of neighbours nearer than h. */
template <int FEATURES>
static __device__ __forceinline__ pbf_real density_at(const neighborhood &n,
                                                      const pbf_domain &domain, uint32_t i,
                                                      uint32_t *neighbors) {
  const density_pass<fixed<FEATURES>> pass = {&n.constants, {}};
  const wall_ghosts ghosts = ghosts_at(domain, position_of(load(n.particles.points, i)));
  auto sums = pass.template begin<pbf_real>();
  add_ghosts(pass, ghosts, {}, {{0}}, 0, &sums);
  for_present_neighbors(n, i, [&](const neighbor_of<pbf_real> &j) {
    pass.pair(&sums, {}, j);
    add_ghosts(pass, ghosts, {}, vec_of(j.x_ij), 0, &sums);
    ++*neighbors;
  });
  return sums.density;
}

#endif
