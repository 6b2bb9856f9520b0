/* One time step, launch after launch in the solver's stream; the host never waits. */
#ifndef PBF_CUDA_STEP_H
#define PBF_CUDA_STEP_H

#include "cuda/deep_host.h"
#include "cuda/launches.h"
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

#endif
