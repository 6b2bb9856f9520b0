/* Part of executor.h: what the fluid does to solids (physics/loads.h). What they do to particles is
 * noted around the kernels in which they do it, of those near solids alone: what others get there
 * is in the sum of all. */
#ifndef PBF_CUDA_LOADS_H
#define PBF_CUDA_LOADS_H

#include "cuda/launches.h"
#include "cuda/pressures.h"
#include "physics/grid_loads.h"
#include "physics/no_slip_loads.h"

/* ---- Sums ----------------------------------------------------------------------------------- */

static __device__ __forceinline__ void add_number(int64_t *to, int64_t more) {
  if (more)
    atomicAdd(reinterpret_cast<unsigned long long *>(to), static_cast<unsigned long long>(more));
}

static __device__ __forceinline__ void add_wide(pbf_wide_sum *to, const pbf_wide_sum &more) {
  add_number(&to->high, more.high);
  add_number(&to->low, more.low);
}

/* Adds a change of each thread to the sum of all, by way of its block's. All threads call it. */
static __device__ __forceinline__ void add_changes(pbf_wide_sum *all, double units,
                                                   const pbf_vec &change, bool counts) {
  __shared__ pbf_wide_sum sums[PBF_DIM];
  if (threadIdx.x < PBF_DIM) sums[threadIdx.x] = {0, 0};
  __syncthreads();
  for (int k = 0; k < PBF_DIM && counts; ++k)
    add_wide(&sums[k], pbf_wide_of(units * (double)change.c[k]));
  __syncthreads();
  if (threadIdx.x < PBF_DIM) add_wide(&all[threadIdx.x], sums[threadIdx.x]);
}

/* ---- What solids do to particles ------------------------------------------------------------- */

/* Whether one of them may have something to do with a particle at x. */
template <class Obstacles>
static __device__ __forceinline__ bool is_near_solid(const Obstacles &o, pbf_vec x,
                                                     pbf_real reach) {
  if (pbf_domain_distance(&o.domain, x) < reach) return true;
  for (int k = 0; k < pbf_surface_count(o); ++k) {
    pbf_vec normal;
    if (pbf_surface_is_beyond(&o.surfaces[k], x, reach)) continue;
    if (pbf_surface_distance(&o.surfaces[k], x, &normal) < reach) return true;
  }
  return false;
}

/* In the prediction, once particles are sorted; the sort's scratch is as it was. Others' particles
 * that a rank holds have one, too, which is not its own to count. */
static __global__ void __launch_bounds__(PBF_BLOCK)
    begin_push_kernel(unsorted_particles from, pbf_forces forces, sort_scratch scratch,
                      sorted_particles to, double units, pbf_vec *push, pbf_wide_sum *changes) {
  const uint32_t i = thread_index();
  pbf_vec forced = {{0}};
  bool counts = false;
  if (i < from.count && scratch.cell[i] != PBF_NO_CELL) {
    const uint32_t cell = scratch.cell[i], id = from.ids[i];
    uint32_t place = to.cell_start[cell];
    for (uint32_t k = to.cell_start[cell]; k < to.cell_start[cell + 1]; ++k)
      place += scratch.id_by_cell[k] < id;
    if (PBF_SLEEP && from.activity && *from.all_asleep) place = i;
    const bool asleep = PBF_SLEEP && from.activity && pbf_is_asleep(from.activity[i]);
    const pbf_vec v = to.velocities[place];
    forced = asleep ? v
                    : pbf_apply_forces(&forces, position_of(load(from.points, i)),
                                       velocity_of<true>(from, forces, i));
    push[place] = pbf_sub(v, forced);
    if (to.mobility) forced = pbf_scaled(forced, 1 / to.mobility[place]);
    counts = place - to.first < to.count - to.first;
  }
  if (changes) add_changes(changes, -units, forced, counts);
}

/* What an iteration is to be noted by. */
struct push_noting {
  iteration_extras extras;
  pbf_real reach, inv_time_step;
  bool first; /* iteration */
};

template <bool LISTED>
static __device__ __forceinline__ bool notes_push(const push_noting &p, const neighborhood &n,
                                                  uint32_t i, pbf_vec x) {
  if (i >= n.particles.count) return false;
  if (PBF_SLEEP && p.extras.rest.activity && pbf_is_asleep(p.extras.rest.activity[i])) return false;
  return is_near_solid(asked_near<LISTED>(p.extras.obstacles, x, (double)p.reach), x, p.reach);
}

/* Takes from pushes the velocities that pairs alone would make in the move that comes. */
template <int FEATURES, bool LISTED>
static __global__ void __launch_bounds__(PBF_BLOCK)
    push_before_kernel(neighborhood n, push_noting p, const pbf_vec *velocities, pbf_vec *push) {
  const uint32_t i = own_index(n.particles);
  if (PBF_TOLERANCE && p.extras.watch.watch && is_converged(p.extras.watch)) return;
  const point own = load(n.particles.points, min(i, n.particles.count - 1));
  const pbf_vec x = position_of(own);
  const bool notes = notes_push<LISTED>(p, n, i, x);
  if (__all_sync(~0u, !notes)) return;
  const move_pass_of<fixed<FEATURES>, SCALED_SUMS> pass = {&n.constants, {}};
  auto sums = sums_around(pass, n, i, x, {own.lambda}, static_cast<const no_value *>(nullptr));
  if (!notes) return;
  if (n.particles.mobility) sums.change.scale(n.particles.mobility[i]);
  const pbf_vec v = p.first ? n.particles.velocities[i] : velocities[i];
  push[i] = pbf_sub(push[i], pbf_push(&n.constants, p.inv_time_step, v, vec_of(sums.change)));
}

/* And adds those that it has made. */
template <bool LISTED>
static __global__ void __launch_bounds__(PBF_BLOCK)
    push_after_kernel(neighborhood n, push_noting p, const pbf_vec *velocities, pbf_vec *push) {
  const uint32_t i = own_index(n.particles);
  if (PBF_TOLERANCE && p.extras.watch.watch && is_converged(p.extras.watch)) return;
  const pbf_vec x = position_of(load(n.particles.points, min(i, n.particles.count - 1)));
  if (notes_push<LISTED>(p, n, i, x)) push[i] = pbf_add_scaled(push[i], 1, velocities[i]);
}

/* ---- Shares --------------------------------------------------------------------------------- */

static __device__ __forceinline__ load_particle load_particle_of(const pressure_source &source,
                                                                 const point &own, pbf_vec v,
                                                                 pbf_vec push) {
  return {position_of(own), v, push, own.lambda, source.grid.arrays.control != nullptr};
}

/* What the pressure grid adds to a particle's lambda. */
static __device__ __forceinline__ pbf_real grid_lambda_of(const pressure_source &source,
                                                          const point &own) {
  return whole_lambda(source, own) - own.lambda;
}

static __device__ __forceinline__ void add_shared_part(pbf_load_sums *to, const load_part &part,
                                                       bool counts) {
  for (int k = 0; k < PBF_LOAD_SUMS; ++k) add_wide(&to->of[k], part.of[k]);
  if (counts) atomicAdd(reinterpret_cast<unsigned long long *>(&to->contacts), 1ull);
  if (part.depth)
    atomicMax(reinterpret_cast<unsigned long long *>(&to->depth),
              static_cast<unsigned long long>(part.depth));
}

/* Of few solids kernels take what is known by value, of many the device has it. */
template <bool LISTED>
using load_tally_asked = std::conditional_t<LISTED, pbf_load_tally, pbf_few_load_tally>;

/* The solids that may be within `reach` of x. */
struct listed_numbers {
  listed_obstacles near;

  template <class Visit>
  PBF_IN void each(int, Visit visit) const {
    for (int k = 0; k < near.count; ++k) visit(near.surfaces.number(k));
  }
};

template <bool LISTED>
static __device__ __forceinline__ auto solids_near(const step_obstacles &o, pbf_vec x,
                                                   double reach) {
  if constexpr (LISTED)
    return listed_numbers{listed_near(o, x, reach)};
  else
    return all_surfaces{};
}

/* What solids take by viscosity, of what it leaves of the prediction's velocities. */
template <bool LISTED>
static __global__ void __launch_bounds__(PBF_BLOCK)
    no_slip_loads_kernel(const __grid_constant__ neighborhood n, const point *starts,
                         const __grid_constant__ step_obstacles o, pbf_load_scales scales,
                         no_slip_asked<LISTED> no_slip, const pbf_real *activity,
                         const pbf_vec *changes, load_tally_asked<LISTED> *tally) {
  const uint32_t i = own_index(n.particles);
  if (i >= n.particles.count || (PBF_SLEEP && activity && pbf_is_asleep(activity[i]))) return;
  const pbf_vec x = position_of(load(starts, i));
  const pbf_vec v = pbf_add_scaled(n.particles.velocities[i], 1, changes[i]);
  const pbf_real mobility = n.particles.mobility ? n.particles.mobility[i] : (pbf_real)1;
  share_no_slip(
      constants_for<LISTED>(o, &n.constants), asked_near<LISTED>(o, x, (double)n.constants.h),
      no_slip, x, v,
      [&](const pbf_load_plane &plane, const load_share &share) {
        add_shared_part(&tally->sums[plane.solid],
                        load_part_beside(&scales, o, x, plane, with_mass(share, mobility)), false);
      },
      n.particles.phase ? n.constants.phases.viscosity[n.particles.phase[i]] : (pbf_real)1);
}

/* Walls have many particles at them, and are summed up by blocks first. */
struct wall_sums {
  pbf_load_sums of[2 * PBF_DIM];
};

static __device__ __forceinline__ void begin_wall_sums(wall_sums *walls) {
  for (uint32_t k = threadIdx.x; k < sizeof *walls / sizeof(uint64_t); k += blockDim.x)
    reinterpret_cast<uint64_t *>(walls)[k] = 0;
  __syncthreads();
}

/* Once all threads of the block have added to them. */
static __device__ __forceinline__ void end_wall_sums(const wall_sums *walls, pbf_load_sums *sums) {
  if (threadIdx.x >= 2 * PBF_DIM) return;
  const pbf_load_sums &mine = walls->of[threadIdx.x];
  pbf_load_sums *to = &sums[threadIdx.x];
  for (int k = 0; k < PBF_LOAD_SUMS; ++k) add_wide(&to->of[k], mine.of[k]);
  atomicAdd(reinterpret_cast<unsigned long long *>(&to->contacts),
            static_cast<unsigned long long>(mine.contacts));
  atomicMax(reinterpret_cast<unsigned long long *>(&to->depth),
            static_cast<unsigned long long>(mine.depth));
}

enum { GRID_LOADS_BLOCK = 64 };

/* What the pressure grid does: a block a cell, on ranks of every so many of them. */
struct load_cells {
  uint32_t first, step;
};

template <bool LISTED>
static __global__ void __launch_bounds__(GRID_LOADS_BLOCK)
    grid_loads_kernel(const __grid_constant__ step_obstacles o, pbf_load_scales scales,
                      load_cells cells, pressure_source source, const uint32_t *all_asleep,
                      load_tally_asked<LISTED> *tally) {
  __shared__ wall_sums walls;
  const pbf_pressure_grid *c = &source.grid.grid;
  const uint32_t cell = cells.first + blockIdx.x * cells.step;
  int i[PBF_DIM], points = 1;
  if (PBF_SLEEP && all_asleep && *all_asleep) return;
  pbf_pressure_grid_place(c, cell, i);
  if (!pbf_cell_is_inside(c, i)) return;
  begin_wall_sums(&walls);
  const pbf_grid_load_cubes cubes = grid_load_cubes_of(&scales, c);
  for (int k = 0; k < PBF_DIM; ++k) points *= cubes.points;
  for (int point = (int)threadIdx.x; point < points; point += (int)blockDim.x) {
    const pbf_vec x = grid_load_point(c, cubes.points, i, point);
    share_grid_pressure_around(
        &scales, cubes, o,
        solids_near<LISTED>(o, x, pbf_grid_load_reach(scales.spacing) + 0.5 * scales.spacing), x,
        [&](pbf_vec at, double slope[]) {
          return grid_pressure_sloped(source.grid, at, cubes.part, slope);
        },
        [&](const pbf_load_plane &plane, pbf_vec at, const load_share &share) {
          pbf_load_sums *to =
              plane.solid < PBF_WALLS ? &walls.of[plane.solid] : &tally->sums[plane.solid];
          add_shared_part(to, load_part_beside(&scales, o, at, plane, share), false);
        });
  }
  __syncthreads();
  end_wall_sums(&walls, tally->sums);
}

template <bool LISTED>
static __global__ void __launch_bounds__(PBF_BLOCK)
    loads_kernel(const __grid_constant__ neighborhood n, const __grid_constant__ step_obstacles o,
                 pbf_load_scales scales, pressure_source source, const pbf_real *activity,
                 const uint32_t *all_asleep, const pbf_vec *velocities, const pbf_vec *push,
                 load_tally_asked<LISTED> *tally) {
  __shared__ wall_sums walls;
  const uint32_t i = own_index(n.particles);
  if (PBF_SLEEP && all_asleep && *all_asleep) return;
  begin_wall_sums(&walls);
  load_particle p = {};
  if (i < n.particles.count) {
    const point own = load(n.particles.points, i);
    p = load_particle_of(source, own, velocities[i], push[i]);
    if (PBF_SLEEP && activity && pbf_is_asleep(activity[i]))
      p = sleeping_load_particle(constants_for<LISTED>(o, &n.constants), &scales, o,
                                 solids_near<LISTED>(o, p.x, scales.reach), p,
                                 [&] { return grid_lambda_of(source, own); });
    else if (n.particles.mobility)
      p = with_mass(p, n.particles.mobility[i]);
    int last = -1;
    p.has_grid = false;
    share_push(
        constants_for<LISTED>(o, &n.constants), &scales, o,
        solids_near<LISTED>(o, p.x, scales.reach), p, [] { return (pbf_real)0; },
        [&](const pbf_load_plane &plane, const load_share &share) {
          const load_part part = load_part_of(&scales, o, p.x, plane, share);
          pbf_load_sums *to =
              plane.solid < PBF_WALLS ? &walls.of[plane.solid] : &tally->sums[plane.solid];
          add_shared_part(to, part, part.touches && plane.solid != last);
          if (part.touches) last = plane.solid;
        });
  }
  add_changes(tally->change, scales.velocity, p.change, i < n.particles.count);
  end_wall_sums(&walls, tally->sums);
}

/* A thread a solid. Where all sleep they keep what they had. */
static __global__ void end_loads_kernel(step_obstacles o, pbf_load_scales scales,
                                        const uint32_t *all_asleep, pbf_few_load_tally *tally) {
  const int solid = (int)threadIdx.x;
  if (PBF_SLEEP && all_asleep && *all_asleep) {
    add_load(&tally->loads[solid], 1, scales.time_step);
    return;
  }
  end_load(tally, o, load_rests_of(tally), &scales, solid);
}

/* Of many solids, by one block: what is left of the whole is found once, a thread an axis. */
enum { MANY_SOLIDS_BLOCK = 512 };

static __global__ void __launch_bounds__(MANY_SOLIDS_BLOCK)
    end_many_loads_kernel(step_obstacles o, pbf_load_scales scales, const uint32_t *all_asleep,
                          pbf_load_tally *tally) {
  __shared__ load_rests rests;
  const int solids = PBF_WALLS + o.count;
  const bool asleep = PBF_SLEEP && all_asleep && *all_asleep;
  if (!asleep && threadIdx.x < 3) find_load_rests(tally, (int)threadIdx.x, &rests);
  __syncthreads();
  for (int solid = (int)threadIdx.x; solid < solids; solid += (int)blockDim.x)
    if (asleep)
      add_load(&tally->loads[solid], 1, scales.time_step);
    else
      end_load(tally, o, rests, &scales, solid);
}

/* Steps in which all sleep, and which are not launched: one after another, as those that are, so
 * that it shows in no bit how many were before the host saw it. */
static __global__ void repeat_loads_kernel(uint32_t steps, double time_step, uint32_t solids,
                                           pbf_collider_load *loads) {
  const uint32_t solid = thread_index();
  if (solid >= solids) return;
  for (uint32_t k = 0; k < steps; ++k) add_load(&loads[solid], 1, time_step);
}

static __global__ void begin_load_sums_kernel(uint32_t solids, pbf_collider_load *loads) {
  const uint32_t solid = thread_index();
  if (solid < solids) pbf_begin_load_sums(&loads[solid]);
}

/* ---- By the host ---------------------------------------------------------------------------- */

static inline bool finds_loads(const solver *s) {
  return (PBF_BUILT & PBF_FEATURE_LOADS) && s->schedule.runs[PBF_STAGE_LOADS];
}

/* Whether what solids push with is wanted of each particle. */
static inline bool notes_pushes(const solver *s) {
  return finds_loads(s) ||
         ((PBF_BUILT & PBF_FEATURE_LOADS) && s->schedule.runs[PBF_STAGE_FRICTION]);
}

/* The tally that kernels with lists add to, or that of few solids. */
template <bool LISTED>
static inline load_tally_asked<LISTED> *tally_for(const solver *s) {
  if constexpr (LISTED)
    return s->many.loads;
  else
    return s->load_tally;
}

/* In both it is what they begin with. */
static inline pbf_wide_sum *changes_of_all(const solver *s) {
  static_assert(!offsetof(pbf_few_load_tally, change) && !offsetof(pbf_load_tally, change), "");
  return are_listed(s) ? reinterpret_cast<pbf_wide_sum *>(s->many.loads)
                       : reinterpret_cast<pbf_wide_sum *>(s->load_tally);
}

static inline pbf_collider_load *loads_on_device(const solver *s) {
  return s->many.loads ? many_loads(s->many) : s->load_tally->loads;
}

static inline uint32_t solids_with_loads(const solver *s) {
  return s->many.loads ? (uint32_t)s->many.solids : (uint32_t)PBF_FEW_SOLIDS;
}

static inline pbf_status clear_load_sums(solver *s) {
  if (are_listed(s)) {
    if (pbf_status status =
            pbf_cuda_check(cudaMemsetAsync(s->many.loads, 0, 3 * sizeof(pbf_wide_sum), s->stream),
                           "cudaMemsetAsync"))
      return status;
    return pbf_cuda_check(
        cudaMemsetAsync(s->many.loads + 1, 0, s->many.solids * sizeof(pbf_load_sums), s->stream),
        "cudaMemsetAsync");
  }
  return pbf_cuda_check(
      cudaMemsetAsync(s->load_tally, 0, offsetof(pbf_few_load_tally, loads), s->stream),
      "cudaMemsetAsync");
}

/* What lies beside the surfaces of a step where they are many. */
template <class Element>
static inline const Element *beside_surfaces(const pbf_surface *surfaces, uint64_t place) {
  return reinterpret_cast<const Element *>(reinterpret_cast<const char *>(surfaces) + place);
}

template <bool LISTED>
static inline no_slip_asked<LISTED> no_slip_for(const solver *s, const pbf_surface *surfaces) {
  const pbf_no_slip all = pbf_no_slip_of(&s->params, s->colliders);
  no_slip_asked<LISTED> asked = {all.walls, all.inv_time_step, {}};
  if constexpr (LISTED)
    asked.of = beside_surfaces<pbf_real>(surfaces, s->many.layout.no_slip);
  else
    for (uint32_t k = 0; k < s->collider_count; ++k) asked.of[k] = all.of[(int)k];
  return asked;
}

/* What the particles of all ranks have added to the tally. */
static inline pbf_status add_loads_of_ranks(solver *s) {
  const uint32_t solids = PBF_WALLS + s->collider_count;
  void *rest = are_listed(s) ? s->many.loads + 1 : static_cast<void *>(s->load_tally->sums);
  return add_numbers_of_ranks(s, {reinterpret_cast<unsigned long long *>(changes_of_all(s)),
                                  static_cast<unsigned long long *>(rest), CHANGES_OF_ALL,
                                  solids * SUMS_OF_SOLID, SUMS_OF_SOLID, 0, 0});
}

static inline void launch_end_loads(solver *s, const step_obstacles &o,
                                    const pbf_load_scales &scales, const uint32_t *all_asleep) {
  if (are_listed(s))
    end_many_loads_kernel<<<1, MANY_SOLIDS_BLOCK, 0, s->stream>>>(o, scales, all_asleep,
                                                                  s->many.loads);
  else
    end_loads_kernel<<<1, PBF_FEW_SOLIDS, 0, s->stream>>>(o, scales, all_asleep, s->load_tally);
}

/* Of the step that ends; its grid is the last one's. */
static inline pressure_source present_pressures(const solver *s) {
  pressure_source source = {s->constants.pressure, {}};
  if (!PBF_HAS_PRESSURE_GRID || !s->schedule.runs[PBF_STAGE_GRID] || !(source.scale > 0) ||
      !s->pressure_grid.nodes)
    return source;
  source.grid = {s->pressure_grid, pressure_grid_of(s), s->pressure_grid_scale};
  return source;
}

static inline pbf_status repeat_loads(solver *s, uint32_t steps) {
  if (!finds_loads(s) || !steps) return PBF_OK;
  const uint32_t solids = solids_with_loads(s);
  repeat_loads_kernel<<<blocks_for(solids), PBF_BLOCK, 0, s->stream>>>(steps, s->params.time_step,
                                                                       solids, loads_on_device(s));
  return pbf_cuda_check_launch("repeat_loads_kernel");
}

/* Colliders from this number on are other ones. */
static inline pbf_status forget_loads(solver *s, uint32_t collider) {
  const uint32_t solids = solids_with_loads(s);
  if (!s->load_tally || PBF_WALLS + collider >= solids) return PBF_OK;
  return pbf_cuda_check(
      cudaMemsetAsync(&loads_on_device(s)[PBF_WALLS + collider], 0,
                      (solids - PBF_WALLS - collider) * sizeof(pbf_collider_load), s->stream),
      "cudaMemsetAsync");
}

static inline pbf_status read_loads(solver *s, uint32_t first, uint32_t count,
                                    pbf_collider_load *loads) {
  pbf_collider_load *there = loads_on_device(s) + first;
  const uint64_t bytes = count * sizeof *loads;
  if (pbf_status status =
          pbf_cuda_check(cudaMemcpyAsync(loads, there, bytes, cudaMemcpyDeviceToHost, s->stream),
                         "cudaMemcpyAsync to the host"))
    return status;
  if (pbf_status status = pbf_cuda_check(cudaStreamSynchronize(s->stream), "cudaStreamSynchronize"))
    return status;
  begin_load_sums_kernel<<<blocks_for(count), PBF_BLOCK, 0, s->stream>>>(count, there);
  return pbf_cuda_check_launch("begin_load_sums_kernel");
}

#endif
