/* One time step, launch after launch in the solver's stream; the host never waits. */
#ifndef PBF_CUDA_STEP_H
#define PBF_CUDA_STEP_H

#include "cuda/deep_host.h"
#include "cuda/search.h"
#include "cuda/solver.h"
#include "physics/overfull.h"

/* Launches of a stage each time that it runs. */
static inline uint32_t launches_of(const solver *s, pbf_stage stage) {
  const uint32_t images = s->images ? 1 : 0; /* what they add */
  switch (stage) {
    case PBF_STAGE_PREDICT:
      return 2; /* with the clearing of the cells */
    case PBF_STAGE_NEIGHBORS:
      return PBF_CUDA_SCAN_LAUNCHES + 3 + (s->starts ? 1 : 0);
    case PBF_STAGE_VELOCITY:
      return 0; /* the last move's end */
    case PBF_STAGE_GRID:
      return 7 + images; /* with the clearing of sums and of what blocks tell each other */
    case PBF_STAGE_SLACK:
    case PBF_STAGE_LAMBDA:
    case PBF_STAGE_MOVE:
      return 1 + images;
    case PBF_STAGE_SLEEP:
      return 5; /* with the shore's, among those of the neighbours */
    default:
      return 1;
  }
}

static inline solids_met solids_of(const solver *s) {
  return PBF_BUILT & PBF_FEATURE_COLLIDERS ? solids_of(s->collider_count) : NO_SOLIDS;
}

/* Predicts and counts the particles of each cell. */
static inline pbf_status launch_predict(solver *s, const unsorted_particles &from,
                                        const cell_grid &grid, const prediction &p) {
  if (pbf_status status = pbf_cuda_check(
          cudaMemsetAsync(s->cell_start, 0, (grid.count + 1) * sizeof(uint32_t), s->stream),
          "cudaMemsetAsync"))
    return status;
  solids_met met = solids_of(s);
  auto kernel = met == MANY_SOLIDS  ? predict_kernel<MANY_SOLIDS, false>
                : met == FEW_SOLIDS ? predict_kernel<FEW_SOLIDS, false>
                                    : predict_kernel<NO_SOLIDS, false>;
  if constexpr (PBF_SLEEP)
    if (from.unrest)
      kernel =
          met == MANY_SOLIDS ? predict_kernel<MANY_SOLIDS, true> : predict_kernel<FEW_SOLIDS, true>;
  kernel<<<blocks_for(s->count), PBF_BLOCK, 0, s->stream>>>(from, p, grid, s->cell_start,
                                                            scratch_of(s));
  return PBF_OK;
}

/* Sorts the predicted particles into s->other. */
static inline pbf_status launch_sort(solver *s, const unsorted_particles &from,
                                     const neighborhood &n, const prediction &p) {
  uint32_t blocks = blocks_for(s->count);
  if (pbf_status status =
          pbf_cuda_scan(s->cell_start, n.grid.count + 1, s->scan_scratch, s->scan_bytes, s->stream))
    return status;
  scatter_kernel<<<blocks, PBF_BLOCK, 0, s->stream>>>(from, s->cell_start, scratch_of(s));
  solids_met met = solids_of(s);
  auto place = met == MANY_SOLIDS  ? place_kernel<MANY_SOLIDS, false>
               : met == FEW_SOLIDS ? place_kernel<FEW_SOLIDS, false>
                                   : place_kernel<NO_SOLIDS, false>;
  if constexpr (PBF_SLEEP)
    if (from.unrest)
      place = met == MANY_SOLIDS ? place_kernel<MANY_SOLIDS, true> : place_kernel<FEW_SOLIDS, true>;
  place<<<blocks, PBF_BLOCK, 0, s->stream>>>(from, p, scratch_of(s), n.particles);
  return PBF_OK;
}

static inline void launch_lists(solver *s, const neighborhood &n) {
  uint32_t blocks = list_blocks(s->count);
  size_t shared = list_shared(s->lists.chunks);
  if (!PBF_SLEEP || !s->unrest) {
    list_kernel<SEARCH_ALL><<<blocks, SEARCH_BLOCK, shared, s->stream>>>(n.particles, n.grid,
                                                                         s->constants.h2, s->lists);
    return;
  }
  if constexpr (PBF_SLEEP) {
    list_kernel<SEARCH_AWAKE><<<blocks, SEARCH_BLOCK, shared, s->stream>>>(
        n.particles, n.grid, s->constants.h2, s->lists);
    shore_kernel<<<blocks_for(s->count), PBF_BLOCK, 0, s->stream>>>(n, s->tally);
    list_kernel<SEARCH_SHORE><<<blocks, SEARCH_BLOCK, shared, s->stream>>>(
        n.particles, n.grid, s->constants.h2, s->lists);
  }
}

/* Sorts the present positions, also of those that sleep. */
static inline pbf_status sort_present(solver *s, const cell_grid &grid) {
  prediction at_rest = {};
  unsorted_particles from = state_of(s);
  from.unrest = nullptr;
  if (pbf_status status = launch_predict(s, from, grid, at_rest)) return status;
  return launch_sort(s, from, neighborhood_of(s, grid), at_rest);
}

static inline bool has_extras(const solver *s) {
  return s->schedule.wall_density || s->schedule.accelerated || s->schedule.watched;
}

/* What images in these walls add to the sums of the kernel that comes next. */
template <class Terms>
static inline void sum_images(solver *s, const neighborhood &n, const iteration_extras &extras,
                              const pbf_walls &walls, const Terms &terms,
                              typename Terms::sum *all) {
  if constexpr (PBF_MIRRORS)
    image_kernel<Terms><<<image_blocks_for(s->count), 32 * PBF_IMAGE_SHARES, 0, s->stream>>>(
        n, extras.watch, extras.rest.unrest, walls, terms, all);
}

/* Where to put those of lambda or, in the same memory, of moves: then lambda is known. Null where
 * nothing is mirrored. */
static inline image_sums *images_between(const solver *s, const pbf_walls &walls) {
  return walls.reach > 0 ? s->images : nullptr;
}

static inline void launch_lambda(solver *s, const neighborhood &n, const iteration_extras &extras,
                                 const lambda_parts &parts) {
  uint32_t blocks = blocks_for(s->count);
  with_kernel(s->schedule.features, [&](auto features) {
    constexpr int F = decltype(features)::value;
    bool many = solids_of(s) == MANY_SOLIDS;
    auto kernel = many            ? lambda_kernel<F, true, MANY_SOLIDS, false>
                  : has_extras(s) ? lambda_kernel<F, true, FEW_SOLIDS, false>
                                  : lambda_kernel<F, false, FEW_SOLIDS, false>;
    if constexpr (PBF_SLEEP)
      if (s->unrest)
        kernel = many ? lambda_kernel<F, true, MANY_SOLIDS, true>
                      : lambda_kernel<F, true, FEW_SOLIDS, true>;
    kernel<<<blocks, PBF_BLOCK, 0, s->stream>>>(n, extras, parts);
  });
}

static inline void launch_move(solver *s, const neighborhood &n, point *moved,
                               const iteration_extras &extras, const move_end &end) {
  uint32_t blocks = blocks_for(s->count);
  with_features(s->schedule.features, [&](auto features) {
    constexpr int F = decltype(features)::value;
    solids_met met = solids_of(s);
    auto kernel = met == MANY_SOLIDS  ? move_kernel<F, true, MANY_SOLIDS, false>
                  : met == FEW_SOLIDS ? move_kernel<F, true, FEW_SOLIDS, false>
                  : has_extras(s)     ? move_kernel<F, true, NO_SOLIDS, false>
                                      : move_kernel<F, false, NO_SOLIDS, false>;
    if constexpr (PBF_SLEEP)
      if (s->unrest)
        kernel = met == MANY_SOLIDS ? move_kernel<F, true, MANY_SOLIDS, true>
                                    : move_kernel<F, true, FEW_SOLIDS, true>;
    kernel<<<blocks, PBF_BLOCK, 0, s->stream>>>(n, moved, extras, end);
  });
}

/* In the step that ends at `time`. */
static inline pbf_status find_slack(solver *s, const neighborhood &n,
                                    const iteration_extras &extras, double time) {
  if (!PBF_CHEBYSHEV || !s->slack) return PBF_OK;
  const pbf_walls walls = pbf_walls_at(&s->params, time - s->params.time_step);
  return run_stage(&s->clock, s->stream, PBF_STAGE_SLACK, [&] {
    with_kernel(s->schedule.features, [&](auto features) {
      constexpr int F = decltype(features)::value;
      const pbf_real time_step = (pbf_real)s->params.time_step;
      const bool mirrored = images_between(s, walls) != nullptr;
      if (mirrored)
        sum_images(s, n, extras, walls, images_at_start<F>{n.particles.velocities, time_step},
                   s->slack);
      slack_kernel<F><<<blocks_for(s->count), PBF_BLOCK, 0, s->stream>>>(
          n, extras, walls, time_step, mirrored, s->slack);
    });
    return PBF_OK;
  });
}

/* The grid's equations and their solution, once the particles have been summed up. */
static inline pbf_status solve_deep(solver *s, const step_obstacles &obstacles) {
  const pbf_coarse &grid = s->deep_grid;
  deep_arrays arrays = deep_of(s);
  uint32_t blocks = blocks_for(grid.nodes);
  deep_cells_kernel<<<blocks, PBF_BLOCK, 0, s->stream>>>(grid, obstacles, arrays);
  deep_depths_kernel<<<blocks, PBF_BLOCK, 0, s->stream>>>(grid, arrays);
  deep_cut_kernel<<<blocks, PBF_BLOCK, 0, s->stream>>>(grid, arrays);
  deep_nodes_kernel<<<blocks, PBF_BLOCK, 0, s->stream>>>(grid, arrays);
  deep_guess_kernel<<<blocks_for(32 * pbf_coarse_columns(&grid)), PBF_BLOCK, 0, s->stream>>>(
      grid, arrays);
  return launch_deep_solve(s, grid, arrays);
}

/* Of the step that ends at `time`, between these walls and in the containers. */
static inline pbf_coarse deep_grid_at(const solver *s, pbf_walls walls, double time) {
  for (uint32_t k = 0; k < s->collider_count; ++k) {
    pbf_solid solid = pbf_solid_at(&s->colliders[k], time - s->collider_time, s->params.time_step);
    walls = pbf_walls_within(walls, &solid);
  }
  return pbf_coarse_between(&s->params, &walls, pbf_coarse_limit(s->capacity));
}

static inline pbf_status carry_weight(solver *s, const neighborhood &n,
                                      const iteration_extras &extras, double time) {
  if (!PBF_DEEP || !s->deep_room) return PBF_OK;
  s->deep_scale = 1 / (s->params.time_step * s->params.time_step);
  s->deep_grid = deep_grid_at(s, extras.obstacles.walls, time);
  deep_arrays arrays = deep_of(s);
  return run_stage(&s->clock, s->stream, PBF_STAGE_GRID, [&] {
    if (pbf_status status = pbf_cuda_check(
            cudaMemsetAsync(arrays.control, 0,
                            sizeof *arrays.control + 2 * s->deep_grid.nodes * sizeof *arrays.sums,
                            s->stream),
            "cudaMemsetAsync"))
      return status;
    with_kernel(s->schedule.features, [&](auto features) {
      constexpr int F = decltype(features)::value;
      const pbf_walls &walls = extras.obstacles.walls;
      image_sums *images = images_between(s, walls);
      if (images) sum_images(s, n, extras, walls, images_of_lambda<F>{}, images);
      weigh_kernel<F><<<blocks_for(s->count), PBF_BLOCK, 0, s->stream>>>(n, extras, images,
                                                                         s->deep_grid, arrays);
    });
    if (pbf_status status = solve_deep(s, extras.obstacles)) return status;
    carry_kernel<<<blocks_for(s->count), PBF_BLOCK, 0, s->stream>>>(
        n.particles, s->deep_grid, arrays, (pbf_real)(1 / s->params.time_step));
    return (pbf_status)PBF_OK;
  });
}

static inline pbf_status begin_watch(solver *s, watch_pass *pass) {
  if (!s->schedule.watched) return PBF_OK;
  *pass = {s->watch, (long long)pbf_excess_limit(&s->params, s->count), pbf_idle_excess(&s->params),
           0};
  if (PBF_SLEEP && s->unrest) {
    clear_watch_kernel<<<1, 1, 0, s->stream>>>(s->watch, s->tally);
    return pbf_cuda_check_launch("clear_watch_kernel");
  }
  return pbf_cuda_check(cudaMemsetAsync(s->watch, 0, sizeof *s->watch, s->stream),
                        "cudaMemsetAsync");
}

static inline void find_starts(solver *s, const sorted_particles &p) {
  if (PBF_UNDAMPING && s->starts)
    start_kernel<<<blocks_for(s->count), PBF_BLOCK, 0, s->stream>>>(
        p, (pbf_real)s->params.time_step, s->starts);
}

static inline pbf_status add_torques(solver *s, const neighborhood &n, const watch_pass &watch,
                                     bool first) {
  return run_stage(&s->clock, s->stream, PBF_STAGE_TORQUE, [&] {
    with_features(s->schedule.features, [&](auto features) {
      torque_kernel<decltype(features)::value><<<blocks_for(s->count), PBF_BLOCK, 0, s->stream>>>(
          n, watch, first, s->starts, s->torques);
    });
    return PBF_OK;
  });
}

static inline pbf_status solve_density(solver *s, neighborhood *n, const step_obstacles &obstacles,
                                       double time) {
  const pbf_schedule &has = s->schedule;
  point *moved = s->points;
  uint32_t iterations = s->params.iterations;
  iteration_extras extras = {obstacles, has.wall_density, s->total, {}, {}};
  image_sums *images = images_between(s, obstacles.walls);
  pbf_vec *image_moves = reinterpret_cast<pbf_vec *>(images);
  if (PBF_SLEEP && s->unrest)
    extras.rest = {s->other_unrest, &s->tally->all, s->velocities, s->sleep};
  if (pbf_status status = begin_watch(s, &extras.watch)) return status;
  if (pbf_status status = find_slack(s, *n, extras, time)) return status;
  if (pbf_status status = carry_weight(s, *n, extras, time)) return status;
  for (uint32_t k = 0; k < iterations; ++k) {
    iteration_place place = {k == 0, k == 1, k + 1 == iterations};
    pbf_set_iteration(&n->constants, k);
    move_end end = {place,
                    (pbf_real)pbf_per_time_step(&s->params),
                    has.collide_in_iteration,
                    has.collide_after_solve,
                    s->velocities,
                    image_moves};
    extras.watch.iteration = k;
    if (pbf_status status = run_stage(&s->clock, s->stream, PBF_STAGE_LAMBDA, [&] {
          if (images)
            with_kernel(has.features, [&](auto features) {
              sum_images(s, *n, extras, obstacles.walls,
                         images_of_lambda<decltype(features)::value>{}, images);
            });
          launch_lambda(s, *n, extras, {place.first, s->slack, images});
          return PBF_OK;
        }))
      return status;
    if (PBF_UNDAMPING && has.runs[PBF_STAGE_TORQUE])
      if (pbf_status status = add_torques(s, *n, extras.watch, place.first)) return status;
    if (pbf_status status = run_stage(&s->clock, s->stream, PBF_STAGE_MOVE, [&] {
          if (images)
            with_features(has.features, [&](auto features) {
              sum_images(s, *n, extras, obstacles.walls,
                         images_of_move<decltype(features)::value>{}, image_moves);
            });
          launch_move(s, *n, moved, extras, end);
          return PBF_OK;
        }))
      return status;
    exchange(&n->particles.points, &moved);
  }
  return PBF_OK;
}

/* The mean flow takes the points that the solve has left behind. */
static inline pbf_status undamp_flow(solver *s, const neighborhood &n,
                                     const step_obstacles &obstacles) {
  uint32_t blocks = blocks_for(s->count);
  if (pbf_status status = run_stage(&s->clock, s->stream, PBF_STAGE_FLOW, [&] {
        with_kernel(s->schedule.features, [&](auto features) {
          flow_kernel<decltype(features)::value>
              <<<blocks, PBF_BLOCK, 0, s->stream>>>(n, s->velocities, s->other);
        });
        return PBF_OK;
      }))
    return status;
  return run_stage(&s->clock, s->stream, PBF_STAGE_UNDAMP, [&] {
    with_kernel(s->schedule.features, [&](auto features) {
      constexpr int F = decltype(features)::value;
      auto kernel = s->torques ? undamp_kernel<F | PBF_FEATURE_TORQUE> : undamp_kernel<F>;
      kernel<<<blocks, PBF_BLOCK, 0, s->stream>>>(n, obstacles, s->schedule.wall_density,
                                                  (pbf_real)pbf_per_time_step(&s->params), s->other,
                                                  s->torques, s->velocities);
    });
    return PBF_OK;
  });
}

/* Rates take the same points. */
static inline pbf_status turn_pairs(solver *s, const neighborhood &n) {
  uint32_t blocks = blocks_for(s->count);
  if (pbf_status status = run_stage(&s->clock, s->stream, PBF_STAGE_TURN_RATE, [&] {
        turn_rate_kernel<<<blocks, PBF_BLOCK, 0, s->stream>>>(n, s->torques, s->other);
        return PBF_OK;
      }))
    return status;
  return run_stage(&s->clock, s->stream, PBF_STAGE_TURN, [&] {
    turn_kernel<<<blocks, PBF_BLOCK, 0, s->stream>>>(n, s->other, s->velocities);
    return PBF_OK;
  });
}

/* The sizes of curls, too. */
static inline pbf_status confine_vorticity(solver *s, const neighborhood &n) {
  uint32_t blocks = blocks_for(s->count);
  pbf_real *sizes = reinterpret_cast<pbf_real *>(s->other);
  if (pbf_status status = run_stage(&s->clock, s->stream, PBF_STAGE_CURL, [&] {
        with_kernel(s->schedule.features, [&](auto features) {
          curl_kernel<decltype(features)::value>
              <<<blocks, PBF_BLOCK, 0, s->stream>>>(n, s->velocities, s->curls, sizes);
        });
        return PBF_OK;
      }))
    return status;
  return run_stage(&s->clock, s->stream, PBF_STAGE_CONFINE, [&] {
    with_kernel(s->schedule.features, [&](auto features) {
      confine_kernel<decltype(features)::value>
          <<<blocks, PBF_BLOCK, 0, s->stream>>>(n, s->curls, sizes, s->velocities);
    });
    return PBF_OK;
  });
}

/* The smoothed velocities become the velocities by an exchange of the arrays. */
static inline pbf_status apply_viscosity(solver *s, const neighborhood &n) {
  pbf_status status = run_stage(&s->clock, s->stream, PBF_STAGE_VISCOSITY, [&] {
    with_kernel(s->schedule.features, [&](auto features) {
      viscosity_kernel<decltype(features)::value>
          <<<blocks_for(s->count), PBF_BLOCK, 0, s->stream>>>(n, s->velocities, s->smoothed);
    });
    return PBF_OK;
  });
  exchange(&s->velocities, &s->smoothed);
  return status;
}

static inline pbf_status wake_near(solver *s, pbf_movers movers, const step_obstacles &obstacles) {
  if (!PBF_SLEEP || !s->unrest || !s->count || !pbf_any_moves(movers)) return PBF_OK;
  wake_near_kernel<<<blocks_for(s->count), PBF_BLOCK, 0, s->stream>>>(
      s->points, s->count, s->sleep, movers, obstacles, s->constants.h, s->unrest, s->tally);
  return pbf_cuda_check_launch("wake_near_kernel");
}

/* The marks take the points that the solve has left behind. */
static inline pbf_status settle(solver *s, const neighborhood &n) {
  uint32_t blocks = blocks_for(s->count);
  uint8_t *room = reinterpret_cast<uint8_t *>(s->other);
  sleep_marks marks = {room, room + s->capacity};
  return run_stage(&s->clock, s->stream, PBF_STAGE_SLEEP, [&] {
    with_kernel(s->schedule.features, [&](auto features) {
      unrest_kernel<decltype(features)::value><<<blocks, PBF_BLOCK, 0, s->stream>>>(
          n, s->velocities, s->sleep, s->unrest, s->tally, marks);
    });
    stir_kernel<<<blocks, PBF_BLOCK, 0, s->stream>>>(n, s->tally, marks);
    settle_kernel<<<blocks, PBF_BLOCK, 0, s->stream>>>(s->count, s->sleep, s->unrest, s->velocities,
                                                       s->tally, marks, s->all_asleep, s->epoch);
    return PBF_OK;
  });
}

/* Whether no step has anything to do: a look, without waiting. A step launched for want of having
 * seen it changes nothing, so that results do not depend on when it is seen. */
static inline bool all_asleep(const solver *s) {
  return PBF_SLEEP && s->unrest && !pbf_any_moves(s->movers) &&
         *static_cast<const volatile uint64_t *>(s->all_asleep) == s->epoch;
}

/* The step that ends at `time`. */
static inline pbf_status run_step(solver *s, double time, const pbf_solid *solids) {
  const pbf_schedule &has = s->schedule;
  step_obstacles obstacles = {pbf_walls_at(&s->params, time), (int)s->collider_count, solids};
  prediction p = {pbf_forces_of(&s->params, time - s->params.time_step), obstacles,
                  has.collide_after_prediction};
  cell_grid grid = grid_over(&obstacles.walls, s->params.smoothing_radius,
                             grid_cell_limit(s->capacity), PBF_FINEST);
  neighborhood n = neighborhood_of(s, grid);
  pbf_fit_to_room(&n.constants, &s->constants, &s->params, s->count, &s->schedule, time);
  if (pbf_status status = wake_near(s, s->movers, obstacles)) return status;
  if (pbf_status status = run_stage(&s->clock, s->stream, PBF_STAGE_PREDICT,
                                    [&] { return launch_predict(s, state_of(s), grid, p); }))
    return status;
  if (pbf_status status = run_stage(&s->clock, s->stream, PBF_STAGE_NEIGHBORS, [&] {
        pbf_status sorted = launch_sort(s, state_of(s), n, p);
        launch_lists(s, n);
        find_starts(s, n.particles);
        return sorted;
      }))
    return status;
  if (pbf_status status = solve_density(s, &n, obstacles, time)) return status;
  if (n.particles.points == s->other) exchange(&s->points, &s->other);
  exchange(&s->ids, &s->other_ids);
  exchange(&s->unrest, &s->other_unrest);
  s->ordered = false;
  s->time = time;
  if (PBF_UNDAMPING && has.runs[PBF_STAGE_UNDAMP])
    if (pbf_status status = undamp_flow(s, n, obstacles)) return status;
  if (PBF_UNDAMPING && has.runs[PBF_STAGE_TURN])
    if (pbf_status status = turn_pairs(s, n)) return status;
  if (has.runs[PBF_STAGE_CURL])
    if (pbf_status status = confine_vorticity(s, n)) return status;
  if (has.runs[PBF_STAGE_VISCOSITY])
    if (pbf_status status = apply_viscosity(s, n)) return status;
  return PBF_SLEEP && has.runs[PBF_STAGE_SLEEP] ? settle(s, n) : PBF_OK;
}

/* Places the colliders for `steps` moments, time_step apart, the first one at `time`, and uploads
 * them in one go. */
static inline pbf_status place_solids(solver *s, double time, uint32_t steps) {
  uint64_t bytes = (uint64_t)steps * s->collider_count * sizeof(pbf_solid);
  if (!bytes) return PBF_OK;
  pbf_solid *placed =
      static_cast<pbf_solid *>(s->allocator.allocate(s->allocator.user, bytes, alignof(pbf_solid)));
  if (!placed) {
    pbf_cuda_host->set_error("no host memory to place the colliders; fewer of them would do");
    return PBF_ERROR_OUT_OF_MEMORY;
  }
  for (uint32_t k = 0; k < steps; ++k)
    for (uint32_t c = 0; c < s->collider_count; ++c)
      placed[k * s->collider_count + c] = pbf_solid_at(
          &s->colliders[c], time + k * s->params.time_step - s->collider_time, s->params.time_step);
  /* From pageable memory, which the copy has read when it returns. */
  pbf_status status =
      pbf_cuda_check(cudaMemcpyAsync(s->solids, placed, bytes, cudaMemcpyHostToDevice, s->stream),
                     "cudaMemcpyAsync of the colliders");
  s->allocator.release(s->allocator.user, placed, bytes, alignof(pbf_solid));
  return status;
}

#endif
