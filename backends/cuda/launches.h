/* Launches of the kernels that have an instance for each kind of scene, and of what is asked for
 * outside a step, too. */
#ifndef PBF_CUDA_LAUNCHES_H
#define PBF_CUDA_LAUNCHES_H

#include "cuda/hold.h"
#include "cuda/placing.h"
#include "cuda/search.h"
#include "cuda/solver.h"

static inline surfaces_met surfaces_of(const solver *s) {
  if (are_listed(s)) return LISTED_SURFACES;
  if (s->shapes.count) return FIELD_SURFACES;
  return PBF_BUILT & PBF_FEATURE_COLLIDERS ? surfaces_of(s->collider_count) : NO_SURFACES;
}

/* What is in kernels for ALL. */
static inline bool has_images_or_phases(const solver *s) {
  return s->params.periodic || s->schedule.phases;
}

template <surfaces_met SURFACES>
struct surfaces_constant {
  static constexpr surfaces_met value = SURFACES;
};

/* Calls launch(constant) with what kernels that are built for lists, for fields, and for what has
 * neither, are to meet. */
template <class Launch>
static inline void with_surfaces(const solver *s, Launch launch) {
  switch (surfaces_of(s)) {
    case LISTED_SURFACES:
      return launch(surfaces_constant<LISTED_SURFACES>{});
    case FIELD_SURFACES:
      return launch(surfaces_constant<FIELD_SURFACES>{});
    default:
      launch(surfaces_constant<FEW_SURFACES>{});
  }
}

/* … with whether kernels that are built for lists, and for all else, are to meet the former. */
template <class Launch>
static inline void with_lists(const solver *s, Launch launch) {
  if (are_listed(s))
    launch(std::true_type());
  else
    launch(std::false_type());
}

/* Whether the sort asks for what few scenes have. */
static inline bool sorts_all(const solver *s, const unsorted_particles &from) {
  return from.activity || from.acceleration || has_images_or_phases(s);
}

/* Of these particles; each learns its cell, and is counted there unless `cell_count` is null. */
static inline void predict_into(const solver *s, const unsorted_particles &from,
                                const cell_grid &grid, const prediction &p, uint32_t *cell_count,
                                const sort_scratch &scratch) {
  const surfaces_met met = surfaces_of(s);
  const bool all = sorts_all(s, from);
  auto kernel = met == LISTED_SURFACES  ? predict_listed_kernel
                : met == FIELD_SURFACES ? predict_kernel<FIELD_SURFACES, true>
                : met == MANY_SURFACES  ? all ? predict_kernel<MANY_SURFACES, true>
                                              : predict_kernel<MANY_SURFACES, false>
                 : met == FEW_SURFACES
                    ? all ? predict_kernel<FEW_SURFACES, true> : predict_kernel<FEW_SURFACES, false>
                : all ? predict_kernel<NO_SURFACES, true>
                      : predict_kernel<NO_SURFACES, false>;
  if (from.count)
    launch_early(s, kernel, blocks_for(from.count), PBF_BLOCK, 0, from, p, grid, cell_count,
                 scratch);
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
  const surfaces_met met = surfaces_of(s);
  const bool all = sorts_all(s, from);
  auto place = met == LISTED_SURFACES  ? place_listed_kernel
               : met == FIELD_SURFACES ? place_kernel<FIELD_SURFACES, true>
               : met == MANY_SURFACES
                   ? all ? place_kernel<MANY_SURFACES, true> : place_kernel<MANY_SURFACES, false>
               : met == FEW_SURFACES
                   ? all ? place_kernel<FEW_SURFACES, true> : place_kernel<FEW_SURFACES, false>
               : all ? place_kernel<NO_SURFACES, true>
                     : place_kernel<NO_SURFACES, false>;
  if (from.count)
    launch_early(s, place, blocks_for(from.count), PBF_BLOCK, 0, from, p, scratch, n.particles);
}

static inline void scatter_from(const solver *s, const unsorted_particles &from,
                                const sort_scratch &scratch) {
  if (from.count)
    launch_early(s, scatter_kernel, blocks_for(from.count), PBF_BLOCK, 0, from, s->cell_start,
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
    launch_early(s, kernel, list_blocks(own_count(n)), SEARCH_BLOCK, list_shared(s->lists.chunks),
                 n.particles, n.grid, s->constants.h2, n.lists);
}

static inline pbf_status launch_lists(solver *s, const neighborhood &n) {
  if (!PBF_SLEEP || !s->activity) {
    launch_list_kernel<SEARCH_ALL>(s, n);
    return PBF_OK;
  }
  if constexpr (PBF_SLEEP) {
    launch_list_kernel<SEARCH_AWAKE>(s, n);
    if (own_count(n))
      sleeping_boundary_kernel<<<blocks_for(own_count(n)), PBF_BLOCK, 0, s->stream>>>(n, s->tally);
    if (has_ranks(s))
      if (pbf_status status = exchange_notes(s, n.particles.activity, nullptr)) return status;
    launch_list_kernel<SEARCH_SLEEPING_BOUNDARY>(s, n);
  }
  return PBF_OK;
}

/* Sorts the present positions, also of those that sleep. */
static inline pbf_status sort_present(solver *s, const cell_grid &grid) {
  prediction at_rest = {};
  s->ranks.careful_once = true;
  at_rest.forces.max_speed =
      sizeof(pbf_real) == sizeof(float) ? (pbf_real)FLT_MAX : (pbf_real)DBL_MAX;
  unsorted_particles from = state_of(s);
  from.activity = nullptr;
  from.last_pressure = nullptr;
  from.overlap = nullptr;
  from.phase = nullptr;
  from.acceleration = nullptr;
  if (pbf_status status = launch_predict(s, from, grid, at_rest)) return status;
  return launch_sort(s, from, neighborhood_of(s, grid), at_rest);
}

static inline bool has_extras(const solver *s) {
  return s->schedule.wall_density || s->schedule.accelerated || s->schedule.checks_convergence ||
         s->schedule.phases || s->params.periodic;
}

/* What ghosts in these walls add to the sums of the kernel that comes next. */
template <class Pass, class Places = at_points, class Value = no_value>
static inline void sum_ghosts(solver *s, const neighborhood &n, const iteration_extras &extras,
                              const pbf_domain &domain, typename Pass::template sums<pbf_real> *all,
                              const Places &places = {}, const Value *values = nullptr) {
  if constexpr (PBF_GHOSTS)
    if (own_count(n))
      launch_early(s, ghost_kernel<Pass, Places, Value>, ghost_blocks_for(own_count(n)),
                   32 * PBF_GHOST_SHARES, 0, n, extras.watch, extras.rest.activity, domain, places,
                   values, all);
}

/* Where to put those of lambda or, in the same memory, of moves: then lambda is known. Null where
 * there are none. */
static inline lambda_sums<pbf_real> *ghosts_between(const solver *s, const pbf_domain &domain) {
  return domain.ghost_reach > 0 ? s->ghosts : nullptr;
}

/* Where there are colliders: what they and walls contribute, found where `moved` is free. */
static inline boundary_sums boundary_sums_of(const solver *s, point *moved) {
  return {s->boundary_densities, moved};
}

/* Calls launch(constant) with what a kernel for colliders meets, of which there are some. */
template <class Launch>
static inline void with_colliders(const solver *s, Launch launch) {
  switch (surfaces_of(s)) {
    case LISTED_SURFACES:
      return launch(surfaces_constant<LISTED_SURFACES>{});
    case FIELD_SURFACES:
      return launch(surfaces_constant<FIELD_SURFACES>{});
    case MANY_SURFACES:
      return launch(surfaces_constant<MANY_SURFACES>{});
    default:
      launch(surfaces_constant<FEW_SURFACES>{});
  }
}

/* Calls launch(constant, all) with what a kernel of viscosity meets that fluid sticks to. */
template <class Launch>
static inline void with_no_slip_met(const solver *s, Launch launch) {
  const bool all = has_images_or_phases(s);
  const surfaces_met met = s->schedule.no_slip ? surfaces_of(s) : NO_SURFACES;
  if (met == LISTED_SURFACES)
    launch(surfaces_constant<LISTED_SURFACES>{}, std::true_type{});
  else if (met == FIELD_SURFACES)
    launch(surfaces_constant<FIELD_SURFACES>{}, std::true_type{});
  else if (s->schedule.no_slip && all)
    launch(surfaces_constant<FEW_SURFACES>{}, std::true_type{});
  else if (s->schedule.no_slip)
    launch(surfaces_constant<FEW_SURFACES>{}, std::false_type{});
  else if (all)
    launch(surfaces_constant<NO_SURFACES>{}, std::true_type{});
  else
    launch(surfaces_constant<NO_SURFACES>{}, std::false_type{});
}

static inline void launch_boundary(solver *s, const neighborhood &n, const iteration_extras &extras,
                                   const boundary_sums &found) {
  const uint32_t blocks = blocks_for(own_count(n));
  if (!blocks || !found.densities) return;
  with_colliders(s, [&](auto surfaces) {
    boundary_kernel<decltype(surfaces)::value>
        <<<blocks, PBF_BLOCK, 0, s->stream>>>(n, extras, found);
  });
}

static inline void launch_lambda(solver *s, const neighborhood &n, const iteration_extras &extras,
                                 const lambda_parts &parts) {
  uint32_t blocks = blocks_for(own_count(n));
  if (!blocks) return;
  launch_boundary(s, n, extras, parts.boundary);
  with_kernel(s->schedule.features, [&](auto features) {
    constexpr int F = decltype(features)::value;
    auto kernel = has_images_or_phases(s) ? lambda_kernel<F, true, true, false>
                  : has_extras(s)         ? lambda_kernel<F, true, false, false>
                                          : lambda_kernel<F, false, false, false>;
    if constexpr (PBF_SLEEP)
      if (s->activity) kernel = lambda_kernel<F, true, true, true>;
    launch_early(s, kernel, blocks, PBF_BLOCK, 0, n, extras, parts);
  });
}

/* Whether colliders push in iterations, by a kernel of their own. */
static inline bool collides_after_moves(const solver *s) {
  return surfaces_of(s) != NO_SURFACES &&
         (s->schedule.collide_in_iteration || s->schedule.collide_after_solve);
}

static inline void launch_collide(solver *s, const neighborhood &n, point *moved,
                                  const iteration_extras &extras, const pushes_by_solids &pushes,
                                  pbf_real inv_time_step, pbf_vec *velocities, pbf_vec *push) {
  const uint32_t blocks = blocks_for(own_count(n));
  if (!blocks) return;
  with_colliders(s, [&](auto surfaces) {
    launch_early(s, collide_kernel<decltype(surfaces)::value>, blocks, PBF_BLOCK, 0, n, moved,
                 extras, pushes, inv_time_step, velocities, push);
  });
}

static inline void launch_move(solver *s, const neighborhood &n, point *moved,
                               const iteration_extras &extras, move_end end) {
  uint32_t blocks = blocks_for(own_count(n));
  if (!blocks) return;
  const pushes_by_solids pushes = {end.place, end.collide, end.collide_last};
  if (collides_after_moves(s)) end.collide = end.collide_last = 0;
  with_features(s->schedule.features, [&](auto features) {
    constexpr int F = decltype(features)::value;
    auto kernel = has_images_or_phases(s) ? move_kernel<F, true, true, false>
                  : has_extras(s)         ? move_kernel<F, true, false, false>
                                          : move_kernel<F, false, false, false>;
    if constexpr (PBF_SLEEP)
      if (s->activity) kernel = move_kernel<F, true, true, true>;
    launch_early(s, kernel, blocks, PBF_BLOCK, 0, n, moved, extras, end);
  });
  if (collides_after_moves(s))
    launch_collide(s, n, moved, extras, pushes, end.inv_time_step, end.velocities, nullptr);
}

/* Those that move in the step that begins at a time. */
static inline pbf_moving_obstacles moving_obstacles_at(const solver *s, double time) {
  const double elapsed = time - s->collider_time;
  if (are_many(s->many))
    pbf_note_still_moving(s->moving_obstacles, s->collider_count, s->colliders, elapsed,
                          s->many.table.still_moving);
  return pbf_still_moving(s->moving_obstacles, s->collider_count, s->colliders, elapsed,
                          s->many.table.still_moving);
}

/* Of the sets of many colliders, to the device; `more` is where it has it. */
static inline pbf_status upload_set(solver *s, many_set which, const uint64_t **more) {
  uint64_t *there = many_set_of(s->many, which);
  const uint64_t bytes = (pbf_words_of(s->collider_count) - 1) * sizeof *there;
  pbf_status status =
      pbf_cuda_check(cudaMemcpyAsync(there, *more, bytes, cudaMemcpyHostToDevice, s->stream),
                     "cudaMemcpyAsync of a set of colliders");
  *more = there;
  return status;
}

static inline pbf_status wake_near_moving(solver *s, pbf_moving_obstacles moving_obstacles,
                                          const step_obstacles &obstacles) {
  if (!PBF_SLEEP || !s->activity || !s->count || !pbf_any_obstacle_moves(moving_obstacles))
    return PBF_OK;
  if (are_listed(s))
    if (pbf_status status = upload_set(s, MANY_MOVING, &moving_obstacles.more)) return status;
  with_lists(s, [&](auto listed) {
    wake_near_moving_kernel<decltype(listed)::value>
        <<<blocks_for(s->count), PBF_BLOCK, 0, s->stream>>>(
            s->points + s->first, s->count, s->sleep, moving_obstacles, obstacles, s->constants.h,
            s->activity + s->first, s->tally);
  });
  return pbf_cuda_check_launch("wake_near_kernel");
}

#endif
