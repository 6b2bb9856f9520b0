/* Launches of the kernels that have an instance for each kind of scene, and of what is asked for
 * outside a step, too. */
#ifndef PBF_CUDA_LAUNCHES_H
#define PBF_CUDA_LAUNCHES_H

#include "cuda/hold.h"
#include "cuda/search.h"
#include "cuda/solver.h"

static inline surfaces_met surfaces_of(const solver *s) {
  if (s->shapes.count || s->params.periodic || s->schedule.phases) return FIELD_SURFACES;
  return PBF_BUILT & PBF_FEATURE_COLLIDERS ? surfaces_of(s->collider_count) : NO_SURFACES;
}

template <surfaces_met SURFACES>
struct surfaces_constant {
  static constexpr surfaces_met value = SURFACES;
};

/* Calls launch(constant) with what kernels that are built for fields, and for what has none, are to
 * meet. */
template <class Launch>
static inline void with_surfaces(const solver *s, Launch launch) {
  if (surfaces_of(s) == FIELD_SURFACES)
    launch(surfaces_constant<FIELD_SURFACES>{});
  else
    launch(surfaces_constant<FEW_SURFACES>{});
}

/* Of these particles; each learns its cell, and is counted there unless `cell_count` is null. */
static inline void predict_into(const solver *s, const unsorted_particles &from,
                                const cell_grid &grid, const prediction &p, uint32_t *cell_count,
                                const sort_scratch &scratch) {
  surfaces_met met = surfaces_of(s);
  auto kernel = met == FIELD_SURFACES  ? predict_kernel<FIELD_SURFACES, false>
                : met == MANY_SURFACES ? predict_kernel<MANY_SURFACES, false>
                : met == FEW_SURFACES  ? predict_kernel<FEW_SURFACES, false>
                                       : predict_kernel<NO_SURFACES, false>;
  if constexpr (PBF_SLEEP)
    if (from.activity)
      kernel = met == FIELD_SURFACES  ? predict_kernel<FIELD_SURFACES, true>
               : met == MANY_SURFACES ? predict_kernel<MANY_SURFACES, true>
                                      : predict_kernel<FEW_SURFACES, true>;
  if (from.count)
    kernel<<<blocks_for(from.count), PBF_BLOCK, 0, s->stream>>>(from, p, grid, cell_count, scratch);
}

/* Predicts and counts the particles of each cell. Ranks come to hold theirs. */
static inline pbf_status launch_predict(solver *s, const unsorted_particles &from,
                                        const cell_grid &grid, const prediction &p) {
  if (has_ranks(s)) {
    const bool holds = hold_and_count(
        s, from, grid,
        [&](const unsorted_particles &some, uint32_t *cell_count, const sort_scratch &scratch) {
          predict_into(s, some, grid, p, cell_count, scratch);
        });
    return holds ? PBF_OK : s->ranks.failed;
  }
  if (pbf_status status = pbf_cuda_check(
          cudaMemsetAsync(s->cell_start, 0, (grid.count + 1) * sizeof(uint32_t), s->stream),
          "cudaMemsetAsync"))
    return status;
  predict_into(s, from, grid, p, s->cell_start, scratch_of(s));
  return PBF_OK;
}

/* Once cells know where their particles begin. */
static inline void place_from(const solver *s, const unsorted_particles &from,
                              const neighborhood &n, const prediction &p,
                              const sort_scratch &scratch) {
  surfaces_met met = surfaces_of(s);
  auto place = met == FIELD_SURFACES  ? place_kernel<FIELD_SURFACES, false>
               : met == MANY_SURFACES ? place_kernel<MANY_SURFACES, false>
               : met == FEW_SURFACES  ? place_kernel<FEW_SURFACES, false>
                                      : place_kernel<NO_SURFACES, false>;
  if constexpr (PBF_SLEEP)
    if (from.activity)
      place = met == FIELD_SURFACES  ? place_kernel<FIELD_SURFACES, true>
              : met == MANY_SURFACES ? place_kernel<MANY_SURFACES, true>
                                     : place_kernel<FEW_SURFACES, true>;
  if (from.count)
    place<<<blocks_for(from.count), PBF_BLOCK, 0, s->stream>>>(from, p, scratch, n.particles);
}

static inline void scatter_from(const solver *s, const unsorted_particles &from,
                                const sort_scratch &scratch) {
  if (from.count)
    scatter_kernel<<<blocks_for(from.count), PBF_BLOCK, 0, s->stream>>>(from, s->cell_start,
                                                                        scratch);
}

/* Its own, and those that it has got of other ranks. */
static inline pbf_status launch_sort_on_ranks(solver *s, const unsorted_particles &own,
                                              const neighborhood &n, const prediction &p) {
  const rank_share &share = s->ranks.shares[s->ranks.rank];
  const unsorted_particles got = inbox_of(s, own, s->ranks.report->plan.received);
  const sort_scratch of_own = rank_scratch_of(s, 0), of_got = rank_scratch_of(s, own.count);
  if (pbf_status status =
          pbf_cuda_scan(s->ranks.cell_memory, share.cell_last - share.cell_first + 2,
                        s->scan_scratch, s->scan_bytes, s->stream))
    return status;
  scatter_from(s, own, of_own);
  scatter_from(s, got, of_got);
  place_from(s, own, n, p, of_own);
  place_from(s, got, n, p, of_got);
  return PBF_OK;
}

/* Sorts the predicted particles into s->other. */
static inline pbf_status launch_sort(solver *s, const unsorted_particles &from,
                                     const neighborhood &n, const prediction &p) {
  if (has_ranks(s)) return launch_sort_on_ranks(s, from, n, p);
  if (pbf_status status =
          pbf_cuda_scan(s->cell_start, n.grid.count + 1, s->scan_scratch, s->scan_bytes, s->stream))
    return status;
  scatter_from(s, from, scratch_of(s));
  place_from(s, from, n, p, scratch_of(s));
  return PBF_OK;
}

/* Particles that stages work on: on ranks there may be none. */
static inline uint32_t own_count(const neighborhood &n) {
  return n.particles.count - n.particles.first;
}

template <searchers WHICH>
static inline void launch_list_kernel(solver *s, const neighborhood &n) {
  auto kernel = n.grid.periodic ? list_kernel<WHICH, true> : list_kernel<WHICH, false>;
  if (own_count(n))
    kernel<<<list_blocks(own_count(n)), SEARCH_BLOCK, list_shared(s->lists.chunks), s->stream>>>(
        n.particles, n.grid, s->constants.h2, s->lists);
}

static inline void launch_lists(solver *s, const neighborhood &n) {
  if (!PBF_SLEEP || !s->activity) {
    launch_list_kernel<SEARCH_ALL>(s, n);
    return;
  }
  if constexpr (PBF_SLEEP) {
    launch_list_kernel<SEARCH_AWAKE>(s, n);
    sleeping_boundary_kernel<<<blocks_for(s->count), PBF_BLOCK, 0, s->stream>>>(n, s->tally);
    launch_list_kernel<SEARCH_SLEEPING_BOUNDARY>(s, n);
  }
}

/* Sorts the present positions, also of those that sleep. */
static inline pbf_status sort_present(solver *s, const cell_grid &grid) {
  prediction at_rest = {};
  s->ranks.careful_once = true;
  at_rest.forces.max_speed =
      sizeof(pbf_real) == sizeof(float) ? (pbf_real)FLT_MAX : (pbf_real)DBL_MAX;
  unsorted_particles from = state_of(s);
  from.activity = nullptr;
  from.overlap = nullptr;
  from.phase = nullptr;
  if (pbf_status status = launch_predict(s, from, grid, at_rest)) return status;
  return launch_sort(s, from, neighborhood_of(s, grid), at_rest);
}

static inline bool has_extras(const solver *s) {
  return s->schedule.wall_density || s->schedule.accelerated || s->schedule.checks_convergence ||
         s->schedule.phases;
}

/* What ghosts in these walls add to the sums of the kernel that comes next. */
template <class Pass, class Places = at_points, class Value = no_value>
static inline void sum_ghosts(solver *s, const neighborhood &n, const iteration_extras &extras,
                              const pbf_domain &domain, typename Pass::template sums<pbf_real> *all,
                              const Places &places = {}, const Value *values = nullptr) {
  if constexpr (PBF_GHOSTS)
    if (own_count(n))
      ghost_kernel<Pass><<<ghost_blocks_for(own_count(n)), 32 * PBF_GHOST_SHARES, 0, s->stream>>>(
          n, extras.watch, extras.rest.activity, domain, places, values, all);
}

/* Where to put those of lambda or, in the same memory, of moves: then lambda is known. Null where
 * there are none. */
static inline lambda_sums<pbf_real> *ghosts_between(const solver *s, const pbf_domain &domain) {
  return domain.ghost_reach > 0 ? s->ghosts : nullptr;
}

static inline void launch_lambda(solver *s, const neighborhood &n, const iteration_extras &extras,
                                 const lambda_parts &parts) {
  uint32_t blocks = blocks_for(own_count(n));
  if (!blocks) return;
  with_kernel(s->schedule.features, [&](auto features) {
    constexpr int F = decltype(features)::value;
    surfaces_met met = surfaces_of(s);
    auto kernel = met == FIELD_SURFACES  ? lambda_kernel<F, true, FIELD_SURFACES, false>
                  : met == MANY_SURFACES ? lambda_kernel<F, true, MANY_SURFACES, false>
                  : !has_extras(s)       ? lambda_kernel<F, false, NO_SURFACES, false>
                  : met == FEW_SURFACES  ? lambda_kernel<F, true, FEW_SURFACES, false>
                                         : lambda_kernel<F, true, NO_SURFACES, false>;
    if constexpr (PBF_SLEEP)
      if (s->activity)
        kernel = met == FIELD_SURFACES  ? lambda_kernel<F, true, FIELD_SURFACES, true>
                 : met == MANY_SURFACES ? lambda_kernel<F, true, MANY_SURFACES, true>
                                        : lambda_kernel<F, true, FEW_SURFACES, true>;
    kernel<<<blocks, PBF_BLOCK, 0, s->stream>>>(n, extras, parts);
  });
}

static inline void launch_move(solver *s, const neighborhood &n, point *moved,
                               const iteration_extras &extras, const move_end &end) {
  uint32_t blocks = blocks_for(own_count(n));
  if (!blocks) return;
  with_features(s->schedule.features, [&](auto features) {
    constexpr int F = decltype(features)::value;
    surfaces_met met = surfaces_of(s);
    auto kernel = met == FIELD_SURFACES  ? move_kernel<F, true, FIELD_SURFACES, false>
                  : met == MANY_SURFACES ? move_kernel<F, true, MANY_SURFACES, false>
                  : met == FEW_SURFACES  ? move_kernel<F, true, FEW_SURFACES, false>
                  : has_extras(s)        ? move_kernel<F, true, NO_SURFACES, false>
                                         : move_kernel<F, false, NO_SURFACES, false>;
    if constexpr (PBF_SLEEP)
      if (s->activity)
        kernel = met == FIELD_SURFACES  ? move_kernel<F, true, FIELD_SURFACES, true>
                 : met == MANY_SURFACES ? move_kernel<F, true, MANY_SURFACES, true>
                                        : move_kernel<F, true, FEW_SURFACES, true>;
    kernel<<<blocks, PBF_BLOCK, 0, s->stream>>>(n, moved, extras, end);
  });
}

/* Those that move in the step that begins at a time. */
static inline pbf_moving_obstacles moving_obstacles_at(const solver *s, double time) {
  return pbf_still_moving(s->moving_obstacles, s->collider_count, s->colliders,
                          time - s->collider_time, nullptr);
}

static inline pbf_status wake_near_moving(solver *s, pbf_moving_obstacles moving_obstacles,
                                          const step_obstacles &obstacles) {
  if (!PBF_SLEEP || !s->activity || !s->count || !pbf_any_obstacle_moves(moving_obstacles))
    return PBF_OK;
  wake_near_moving_kernel<<<blocks_for(s->count), PBF_BLOCK, 0, s->stream>>>(
      s->points, s->count, s->sleep, moving_obstacles, obstacles, s->constants.h, s->activity,
      s->tally);
  return pbf_cuda_check_launch("wake_near_kernel");
}

/* The colliders at the ends of `steps` steps. */
static inline void write_surfaces(const solver *s, const pbf_step_times &times, uint32_t steps,
                                  pbf_surface *placed) {
  for (uint32_t k = 0; k < steps; ++k) {
    const double end = pbf_time_after(&times, k + 1);
    const pbf_domain domain = pbf_domain_at(&s->params, end, s->schedule.close_phases);
    for (uint32_t c = 0; c < s->collider_count; ++c)
      placed[k * s->collider_count + c] =
          pbf_obstacle_at(&s->params, &domain, &s->colliders[c], end - s->collider_time);
    for (uint32_t c = 0; c < s->collider_count && s->shapes.count; ++c) {
      pbf_surface *one = &placed[k * s->collider_count + c];
      one->field = shape_on_device(s->shapes, one->field_id);
    }
  }
}

/* Places the colliders for the ends of `steps` steps, and uploads them in one go. */
static inline pbf_status place_surfaces(solver *s, const pbf_step_times &times, uint32_t steps) {
  uint64_t bytes = (uint64_t)steps * s->collider_count * sizeof(pbf_surface);
  if (!bytes) return PBF_OK;
  pbf_surface *placed = static_cast<pbf_surface *>(
      s->allocator.allocate(s->allocator.user, bytes, alignof(pbf_surface)));
  if (!placed) {
    pbf_cuda_host->set_error("no host memory to place the colliders; fewer of them would do");
    return PBF_ERROR_OUT_OF_MEMORY;
  }
  write_surfaces(s, times, steps, placed);
  /* From pageable memory, which the copy has read when it returns. */
  pbf_status status =
      pbf_cuda_check(cudaMemcpyAsync(s->surfaces, placed, bytes, cudaMemcpyHostToDevice, s->stream),
                     "cudaMemcpyAsync of the colliders");
  s->allocator.release(s->allocator.user, placed, bytes, alignof(pbf_surface));
  return status;
}

/* … and for one moment. */
static inline pbf_status place_surfaces(solver *s, double time) {
  return place_surfaces(s, {time, 0, 0}, 1);
}

#endif
