/* A step as launches, one after another in the solver's stream; the host never waits. */
#ifndef PBF_CUDA_EXECUTOR_H
#define PBF_CUDA_EXECUTOR_H

#include "cuda/launcher.h"
#include "cuda/loads.h"
#include "cuda/pressure_datum.h"
#include "cuda/solid_forces.h"
#include "physics/step.h"

/* Launches of a stage each time that it runs. */
static inline uint32_t launches_of(const solver *s, pbf_stage stage) {
  const uint32_t ghosts = s->ghosts != nullptr, starts = s->starts != nullptr,
                 phases = s->phase != nullptr, solids = s->topology_memory != nullptr,
                 boundary = s->boundary_densities != nullptr, collides = collides_after_moves(s),
                 loads = notes_pushes(s), colliders = surfaces_of(s) != NO_SURFACES;
  const uint32_t launches[] = {
#define PBF_STAGE(ID, name, feature, times, launches) launches,
#include "physics/stages.def"
  };
  return launches[stage];
}

/* A pass over particles alone, of those awake; `activity` is null where nothing sleeps. */
template <class Pass>
static __global__ void __launch_bounds__(PBF_BLOCK)
    particles_kernel(Pass pass, uint32_t count, const pbf_real *activity, pbf_vec *velocities) {
  const uint32_t i = thread_index();
  if (i >= count || (PBF_SLEEP && activity && pbf_is_asleep(activity[i]))) return;
  velocities[i] = pass.finish(velocities[i]);
}

/* To the images in the domain. */
static __global__ void __launch_bounds__(PBF_BLOCK)
    inside_kernel(pbf_periods periods, uint32_t count, point *points) {
  const uint32_t i = thread_index();
  if (i >= count) return;
  point here = load(points, i);
  const pbf_vec x = pbf_image_inside(&periods, position_of(here));
  for (int k = 0; k < PBF_DIM; ++k) here.c[k] = x.c[k];
  store(points, i, here);
}

namespace {

/* The stages of physics/step.h. */
struct executor : launcher {
  using launcher::launcher;

  bool wake() {
    if (has_ranks(s)) ++s->epoch; /* the device's word is of this step */
    status =
        wake_near_moving(s, moving_obstacles_at(s, time - s->params.time_step), extras.obstacles);
    return true; /* the device alone knows whether all sleep: its kernels then do nothing */
  }

  void predict() {
    run(PBF_STAGE_PREDICT,
        [&] { status = launch_predict(s, state_of(s), n.grid, prediction_inputs); });
    if (has_ranks(s)) note_own(s, &n.particles);
    if (status == PBF_OK && finds_loads(s)) status = clear_load_sums(s);
  }

  bool find_neighbors() {
    run(PBF_STAGE_NEIGHBORS, [&] {
      status = launch_sort(s, state_of(s), n, prediction_inputs);
      if (s->phase) launch_held(phase_kernel, n.constants.phases);
      if (notes_pushes(s)) begin_pushes();
      if (status == PBF_OK) status = launch_lists(s, n);
      if (PBF_DAMPING_COMPENSATION && s->starts)
        launch_held(start_kernel, (pbf_real)s->params.time_step, s->starts);
    });
    return true; /* a particle without room for its list walks the cells */
  }

  /* What solids push with in the prediction, of what the sort has made of these. */
  void begin_push(const unsorted_particles &from, const sort_scratch &scratch) {
    if (from.count)
      launch_early(s, begin_push_kernel, blocks_for(from.count), PBF_BLOCK, 0, from,
                   prediction_inputs.forces, scratch, n.particles,
                   pbf_units_of_momentum(&n.constants, &prediction_inputs.forces), s->push,
                   changes_of_all(s));
  }

  void begin_pushes() {
    const unsorted_particles own = state_of(s);
    if (!has_ranks(s)) return begin_push(own, scratch_of(s));
    begin_push(own, rank_scratch_of(s, 0));
    begin_push(inbox_of(s, own, s->ranks.report->plan.received), rank_scratch_of(s, own.count));
  }

  /* Until the first move nothing reads the old state: where particles have come from takes the
   * place of its points, and of viscosity's changes one the place of its velocities. */
  void crowding() {
    changes = s->smoothed;
    next_changes = s->velocities;
    if (status != PBF_OK) return;
    launch(crowding_kernel, n, (pbf_real)s->params.time_step, extras.rest.activity, s->points);
    status = pbf_cuda_check_launch("crowding_kernel");
  }

  void viscosity(uint32_t k) {
    run(PBF_STAGE_VISCOSITY, [&] {
      if (s->schedule.accelerated)
        launch_viscous_stress(k);
      else
        launch_xsph();
    });
  }

  /* The smoothed velocities become the velocities by an exchange of the arrays. */
  void launch_xsph() {
    with_kernel(s->schedule.features, [&](auto features) {
      launch(viscosity_kernel<decltype(features)::value>, n, s->velocities, s->smoothed);
    });
    swap_arrays(&s->velocities, &s->smoothed);
  }

  void launch_viscous_stress(uint32_t k) {
    const viscous_stage stage = {pbf_viscosity_weights_of(&n.constants, k),
                                 extras.rest.activity,
                                 n.particles.velocities,
                                 s->viscous_force,
                                 changes,
                                 next_changes};
    neighborhood starts = n;
    starts.particles.points = s->points;
    with_no_slip_met(s, [&](auto surfaces, auto all) {
      constexpr surfaces_met MET = decltype(surfaces)::value;
      launch(viscous_stress_kernel<MET != NO_SURFACES, MET, decltype(all)::value>, starts,
             n.particles.points, stage, extras.obstacles,
             no_slip_for<MET == LISTED_SURFACES>(s, extras.obstacles.surfaces));
    });
    swap_arrays(&changes, &next_changes);
  }

  void move_by_viscosity() {
    if (status != PBF_OK) return;
    if (finds_loads(s) && s->schedule.no_slip)
      with_lists(s, [&](auto listed) {
        constexpr bool LISTED = decltype(listed)::value;
        launch(no_slip_loads_kernel<LISTED>, n, s->points, extras.obstacles,
               pbf_load_scales_of(&n.constants, &prediction_inputs.forces, &s->params),
               no_slip_for<LISTED>(s, extras.obstacles.surfaces), extras.rest.activity, changes,
               tally_for<LISTED>(s));
      });
    launch_way(extras.rest.activity, changes, n.particles.velocities);
    moves_later = true;
    status = pbf_cuda_check_launch("way_kernel");
  }

  void begin_solve() {
    if (status != PBF_OK || !s->schedule.checks_convergence) return;
    extras.watch = {s->watch, (long long)pbf_error_units_limit(&s->params, particles_of_all(s)),
                    pbf_inactive_error_units(&s->params), 0};
    if (PBF_SLEEP && s->activity) {
      clear_convergence_kernel<<<1, 1, 0, s->stream>>>(s->watch, s->tally);
      status = pbf_cuda_check_launch("clear_watch_kernel");
    } else {
      status = pbf_cuda_check(cudaMemsetAsync(s->watch, 0, sizeof *s->watch, s->stream),
                              "cudaMemsetAsync");
    }
  }

  void overlap() {
    if (s->found.struct_size) add_found_overlap();
    if (n.particles.overlap && surfaces_of(s) != NO_SURFACES)
      run(PBF_STAGE_OVERLAP, [&] {
        with_lists(s, [&](auto listed) {
          launch(overlap_in_solids_kernel<decltype(listed)::value>, n, extras.obstacles);
        });
      });
  }

  /* Its ghosts' sums lie in the overlap's array as it was before the sort. */
  void add_found_overlap() {
    const pbf_domain before =
        pbf_domain_at(&s->params, time - s->params.time_step, s->schedule.close_phases);
    const pbf_real time_step = (pbf_real)s->params.time_step;
    const pbf_overlap none = {sizeof none, 0, 1, 0, 0, 0, nullptr, 0, 0, 0, 0, nullptr};
    pbf_real *ghosts_at_start = ghosts_between(s, before) ? s->overlap : nullptr;
    run(PBF_STAGE_OVERLAP, [&] {
      launch_held(mark_placed_kernel, s->found, s->entering);
      with_kernel(s->schedule.features, [&](auto features) {
        constexpr int F = decltype(features)::value;
        typedef density_pass<fixed<F>> pass;
        if (ghosts_at_start)
          sum_ghosts<pass>(
              s, n, extras, before,
              reinterpret_cast<typename pass::template sums<pbf_real> *>(ghosts_at_start),
              at_start{time_step}, n.particles.velocities);
        with_lists(s, [&](auto listed) {
          launch(overlap_kernel<F, decltype(listed)::value>, n, extras, before, time_step,
                 ghosts_at_start, s->found, s->entering);
        });
      });
      launch_held(mark_placed_kernel, none, pbf_entering_of(&none));
    });
  }

  /* Between the walls, and the colliders, of the step's start. */
  void residual_density() {
    const pbf_domain before =
        pbf_domain_at(&s->params, time - s->params.time_step, s->schedule.close_phases);
    const pbf_real time_step = (pbf_real)s->params.time_step;
    const bool with_ghosts = ghosts_between(s, before) != nullptr;
    run(PBF_STAGE_RESIDUAL_DENSITY, [&] {
      with_kernel(s->schedule.features, [&](auto features) {
        constexpr int F = decltype(features)::value;
        typedef density_pass<fixed<F>> pass;
        if (with_ghosts)
          sum_ghosts<pass>(
              s, n, extras, before,
              reinterpret_cast<typename pass::template sums<pbf_real> *>(s->residual_density),
              at_start{time_step}, n.particles.velocities);
        launch(density_at_start_kernel<F>, n, time_step, with_ghosts, s->residual_density);
      });
      const step_obstacles then = {before, extras.obstacles.count, extras.obstacles.surfaces};
      with_surfaces(s, [&](auto surfaces) {
        launch(residual_density_kernel<decltype(surfaces)::value>, n, then,
               s->schedule.wall_density, time_step, s->residual_density);
      });
    });
  }

  void pressure_grid() {
    run(PBF_STAGE_GRID, [&] {
      const double carried = s->constants.phases.carried;
      s->pressure_grid_scale = carried / (s->params.time_step * s->params.time_step);
      const auto over_particles = [&](auto kernel, const auto &...arguments) {
        launch(kernel, arguments...);
      };
      status = place_pressure_grid(s, domain(), time, [&](pbf_fluid_bounds *fluid) {
        return find_fluid(s, n.particles, over_particles, fluid);
      });
      if (status != PBF_OK) return;
      const pressure_grid_arrays arrays = pressure_grid_of(s);
      pressure_grid_arrays own = arrays; /* on ranks what their own particles add */
      if (has_ranks(s)) own.sums = rank_sums(s->ranks.room, s->ranks.count, s->ranks.halo_room);
      if (has_ranks(s)) own.places = own.sums + (arrays.places - arrays.sums);
      if (has_ranks(s) && arrays.cell_moves)
        own.cell_moves = own.sums + 2 * pressure_grid_indices(s);
      status = clear_pressure_grid(s, arrays, own);
      const pbf_moving_obstacles moving = moving_obstacles_at(s, time - s->params.time_step);
      const bool stand = !moving.surfaces && !moving.others;
      if (status == PBF_OK) status = find_topology(s, arrays, extras.obstacles.surfaces, stand);
      if (status != PBF_OK) return;
      const bool torn = s->pressure_grid_is_torn;
      pbf_real *densities = reinterpret_cast<pbf_real *>(moved); /* free before the first move */
      with_kernel(s->schedule.features, [&](auto features) {
        constexpr int F = decltype(features)::value;
        sum_ghosts_of_lambda<F>(n);
        launch(grid_density_kernel<F>, n, ghosts, densities);
      });
      with_surfaces(s, [&](auto surfaces) {
        launch(deposit_kernel<decltype(surfaces)::value>, n, extras, densities, s->pressure_grid,
               own, torn);
      });
      if (has_ranks(s)) status = add_sums_of_ranks(s, arrays);
      if (status != PBF_OK) return;
      status = solve_pressure_grid(s, extras.obstacles);
      if (status != PBF_OK) return;
      const bool collides = collides_with_surfaces();
      launch(s->shapes.count ? apply_correction_kernel<FIELD_SURFACES>
                             : apply_correction_kernel<FEW_SURFACES>,
             n.particles, s->pressure_grid, arrays, torn, (pbf_real)carried,
             (pbf_real)(1 / s->params.time_step), collides ? moved : nullptr);
      if (collides) collide_on_way(extras.rest.activity, n.particles.velocities, nullptr);
      if (notes_pushes(s)) find_datum(s);
    });
    moves_later = true;
  }

  bool collides_with_surfaces() const {
    return s->schedule.collide_after_prediction && surfaces_of(s) != NO_SURFACES;
  }

  /* The device alone knows: kernels after the solve's end do nothing. */
  bool is_converged(uint32_t) const { return false; }

  void begin_iteration(uint32_t k) {
    place = {k == 0, k == 1, k + 1 == s->params.iterations};
    extras.watch.iteration = k;
    pbf_set_iteration(&n.constants, k);
    if (place.first && status == PBF_OK) part_edges();
  }

  template <int FEATURES>
  void sum_ghosts_of_lambda(const neighborhood &of) {
    typedef lambda_pass<fixed<FEATURES>, SCALED_PAIRS> pass;
    if (ghosts) sum_ghosts<pass>(s, of, extras, domain(), ghosts);
  }

  void lambda(uint32_t) {
    run(PBF_STAGE_LAMBDA, [&] {
      const bool in_steps = s->schedule.runs[PBF_STAGE_RESIDUAL_DENSITY];
      const bool smooths = place.last && s->last_pressure;
      in_parts([&](const neighborhood &part) {
        if (s->phase)
          with_kernel(s->schedule.features, [&](auto features) {
            launch_of(part, begin_mobility_kernel<decltype(features)::value>, extras, place.first,
                      s->mobility_around);
          });
        with_kernel(s->schedule.features,
                    [&](auto features) { sum_ghosts_of_lambda<decltype(features)::value>(part); });
        launch_lambda(s, part, extras,
                      {place.first, smooths && !s->phase,
                       in_steps ? s->residual_density : n.particles.overlap, ghosts,
                       boundary_sums_of(s, moved)});
        if (s->phase) launch_of(part, end_mobility_kernel, extras, smooths, s->mobility_around);
      });
      if (has_ranks(s) && extras.watch.watch) status = add_errors_of_ranks();
    });
  }

  /* Of this iteration: all ranks end the solve in the same one. Where a rank has no particles no
   * kernel clears the sum. */
  pbf_status add_errors_of_ranks() {
    unsigned long long *sum = &s->watch->error_units[extras.watch.iteration % 2];
    if (!own_count(n))
      if (pbf_status failed =
              pbf_cuda_check(cudaMemsetAsync(sum, 0, sizeof *sum, s->stream), "cudaMemsetAsync"))
        return failed;
    return add_numbers_of_ranks(s, {sum, nullptr, 1, 0, 1, 0, 0});
  }

  void torque_deficit(uint32_t) {
    run(PBF_STAGE_TORQUE, [&] {
      with_features(s->schedule.features, [&](auto features) {
        launch(torque_kernel<decltype(features)::value>, n, extras.watch, place.first, s->starts,
               s->torques);
      });
    });
  }

  /* Lambda is known: in its ghosts' memory are those of moves. */
  void move(uint32_t) {
    auto *ghost_moves = reinterpret_cast<move_sums<pbf_real> *>(ghosts);
    run(PBF_STAGE_MOVE, [&] {
      const push_noting noting = {extras, n.constants.h, (pbf_real)pbf_per_time_step(&s->params),
                                  place.first};
      in_parts([&](const neighborhood &part) {
        if (notes_pushes(s))
          with_features(s->schedule.features, [&](auto features) {
            with_lists(s, [&](auto listed) {
              launch_of(part,
                        push_before_kernel<decltype(features)::value, decltype(listed)::value>,
                        noting, s->velocities, s->push);
            });
          });
        if (ghosts)
          with_features(s->schedule.features, [&](auto features) {
            typedef move_pass_of<fixed<decltype(features)::value>, SCALED_PAIRS> pass;
            sum_ghosts<pass>(s, part, extras, domain(), ghost_moves);
          });
        launch_move(s, part, moved, extras,
                    {place, (pbf_real)pbf_per_time_step(&s->params),
                     s->schedule.collide_in_iteration, s->schedule.collide_after_solve,
                     s->velocities, ghost_moves, boundary_sums_of(s, moved)});
        if (notes_pushes(s))
          with_lists(s, [&](auto listed) {
            launch_of(part, push_after_kernel<decltype(listed)::value>, noting, s->velocities,
                      s->push);
          });
      });
    });
    swap_arrays(&n.particles.points, &moved);
    moves_later = true;
  }

  /* The last move's end has made it. From here the old state gives way to the new one. */
  void velocity() {
    if (status == PBF_OK) join_edges();
    if (status != PBF_OK) return;
    if (n.particles.points == s->other) swap_arrays(&s->points, &s->other);
    swap_arrays(&s->ids, &s->other_ids);
    swap_arrays(&s->activity, &s->other_activity);
    swap_arrays(&s->last_pressure, &s->other_last_pressure);
    swap_arrays(&s->overlap, &s->other_overlap);
    swap_arrays(&s->phase, &s->other_phase);
    swap_arrays(&s->acceleration, &s->other_acceleration);
    s->ordered = false;
    s->time = time;
    if (!has_ranks(s)) return;
    s->first = s->ranks.first;
    s->count = s->ranks.last - s->ranks.first;
  }

  /* A solve that has ended by its tolerance needs the sums of ghosts here, too. */
  void deviator() {
    const bool with_ghosts = s->fabric_ghosts && domain().ghost_reach > 0;
    iteration_extras unwatched = extras;
    unwatched.watch = {};
    run(PBF_STAGE_DEVIATOR, [&] {
      with_kernel(s->schedule.features, [&](auto features) {
        constexpr int F = decltype(features)::value;
        if (with_ghosts)
          sum_ghosts<fabric_pass<fixed<F>>>(s, n, unwatched, domain(), s->fabric_ghosts);
        launch(deviator_kernel<F>, n, domain(), s->schedule.wall_density, s->activity,
               with_ghosts ? s->fabric_ghosts : nullptr, s->deviators, s->other);
      });
      if (s->schedule.wall_density && surfaces_of(s) != NO_SURFACES)
        with_surfaces(s, [&](auto surfaces) {
          launch(leave_colliders_kernel<decltype(surfaces)::value>, n, extras.obstacles,
                 s->deviators);
        });
    });
  }

  /* Pushes take the points that the solve has left behind, … */
  void shear_push() {
    run(PBF_STAGE_SHEAR_PUSH, [&] {
      with_kernel(s->schedule.features, [&](auto features) {
        launch(shear_push_kernel<decltype(features)::value>, n, s->deviators, s->other);
      });
    });
  }

  /* Deviators are not read any more. */
  void correct_shear_stress() {
    static_assert(sizeof(pbf_vec) <= sizeof(pbf_deviator), "changes take their place");
    pbf_vec *changes = reinterpret_cast<pbf_vec *>(s->deviators);
    run(PBF_STAGE_SHEAR_STRESS, [&] {
      with_kernel(s->schedule.features, [&](auto features) {
        launch(shear_stress_kernel<decltype(features)::value>, n, s->other, changes);
      });
      launch_way(s->activity, changes, s->velocities);
    });
    moves_later = true;
  }

  /* By what velocities change by. */
  void launch_way(const pbf_real *activity, const pbf_vec *changes, pbf_vec *velocities) {
    const bool collides = surfaces_of(s) != NO_SURFACES;
    pbf_vec *push = notes_pushes(s) ? s->push : nullptr;
    launch(way_kernel, n.particles, activity, extras.obstacles.domain,
           (pbf_real)s->params.time_step, (pbf_real)pbf_per_time_step(&s->params), changes,
           velocities, push, collides ? moved : nullptr);
    if (collides) collide_on_way(activity, velocities, push);
  }

  /* Takes particles that have come from `moved` out of solids. */
  void collide_on_way(const pbf_real *activity, pbf_vec *velocities, pbf_vec *push) {
    neighborhood from = n;
    from.particles.points = moved;
    iteration_extras unwatched = extras;
    unwatched.watch = {};
    unwatched.rest.activity = activity;
    const iteration_place first = {true, false, false};
    launch_collide(s, from, n.particles.points, unwatched, {first, 1, 0},
                   (pbf_real)pbf_per_time_step(&s->params), velocities, push);
  }

  /* … as do mean velocities, … */
  void mean_velocity() {
    run(PBF_STAGE_MEAN_VELOCITY, [&] {
      with_kernel(s->schedule.features, [&](auto features) {
        launch(flow_kernel<decltype(features)::value>, n, s->velocities, s->other);
      });
    });
  }

  void compensate_damping() {
    run(PBF_STAGE_DAMPING_COMPENSATION, [&] {
      with_kernel(s->schedule.features, [&](auto features) {
        constexpr int F = decltype(features)::value;
        with_surfaces(s, [&](auto surfaces) {
          launch(compensate_damping_kernel<F, decltype(surfaces)::value>, n, extras.obstacles,
                 s->schedule.wall_density, (pbf_real)pbf_per_time_step(&s->params), s->other,
                 s->torques, s->velocities);
        });
      });
    });
  }

  /* … as do rates, … */
  void correction_rate() {
    run(PBF_STAGE_CORRECTION_RATE, [&] { launch(turn_rate_kernel, n, s->torques, s->other); });
  }

  void correct_angular_momentum() {
    run(PBF_STAGE_ANGULAR_MOMENTUM, [&] { launch(turn_kernel, n, s->other, s->velocities); });
  }

  void friction() {
    const pbf_friction_scales scales =
        pbf_friction_scales_of(&n.constants, &prediction_inputs.forces, &s->params, s->colliders);
    run(PBF_STAGE_FRICTION, [&] {
      with_lists(s, [&](auto listed) {
        constexpr bool LISTED = decltype(listed)::value;
        launch(friction_kernel<LISTED>, n, extras.obstacles,
               friction_for<LISTED>(s, scales, extras.obstacles.surfaces), present_pressures(s),
               s->activity, (pbf_real)pbf_per_time_step(&s->params), s->velocities, s->push,
               tally_for<LISTED>(s));
      });
    });
    moves_later = true;
  }

  template <bool LISTED>
  void launch_grid_loads(const pbf_load_scales &scales) {
    const pressure_source source = present_pressures(s);
    if (!source.grid.arrays.control) return;
    load_cells cells = {0, 1};
    if (has_ranks(s)) cells = {s->ranks.rank, s->ranks.count};
    if (cells.first >= source.grid.grid.nodes) return;
    const uint32_t blocks = (source.grid.grid.nodes - cells.first - 1) / cells.step + 1;
    grid_loads_kernel<LISTED><<<blocks, GRID_LOADS_BLOCK, 0, s->stream>>>(
        extras.obstacles, scales, cells, source, extras.rest.all, tally_for<LISTED>(s));
  }

  void loads() {
    const pbf_load_scales scales =
        pbf_load_scales_of(&n.constants, &prediction_inputs.forces, &s->params);
    run(PBF_STAGE_LOADS, [&] {
      with_lists(s, [&](auto listed) {
        constexpr bool LISTED = decltype(listed)::value;
        launch_grid_loads<LISTED>(scales);
        launch(loads_kernel<LISTED>, n, extras.obstacles, scales, present_pressures(s), s->activity,
               extras.rest.all, s->velocities, s->push, tally_for<LISTED>(s));
      });
      if (has_ranks(s)) status = add_loads_of_ranks(s);
      if (status != PBF_OK) return;
      launch_end_loads(s, extras.obstacles, scales, extras.rest.all);
    });
  }

  void curl() {
    run(PBF_STAGE_CURL, [&] {
      with_kernel(s->schedule.features, [&](auto features) {
        launch(curl_kernel<decltype(features)::value>, n, s->velocities, s->curls, curl_sizes());
      });
    });
  }

  void confine() {
    run(PBF_STAGE_CONFINE, [&] {
      with_kernel(s->schedule.features, [&](auto features) {
        launch(confine_kernel<decltype(features)::value>, n, s->curls, curl_sizes(), s->velocities);
      });
    });
  }

  void missing_neighbors() { /* with the pull, but on ranks */
    if (!has_ranks(s) || status != PBF_OK) return;
    find_missing();
    status = pbf_cuda_check_launch("missing_neighbors_kernel");
  }

  void find_missing() {
    with_surfaces(s, [&](auto surfaces) {
      launch(missing_neighbors_kernel<decltype(surfaces)::value>, n, extras.obstacles,
             s->schedule.wall_density, s->activity, missing());
    });
  }

  void surface_tension() {
    run(PBF_STAGE_SURFACE_TENSION, [&] {
      if (!has_ranks(s)) find_missing();
      launch(surface_tension_kernel, n, missing(), s->activity, s->velocities);
      if (s->schedule.adhesion) adhere();
    });
  }

  void adhere() {
    const pbf_adhesion_scales scales =
        pbf_adhesion_scales_of(&n.constants, &prediction_inputs.forces, &s->params, s->colliders);
    with_lists(s, [&](auto listed) {
      constexpr bool LISTED = decltype(listed)::value;
      launch(adhesion_kernel<LISTED>, n, extras.obstacles,
             adhesion_for<LISTED>(s, scales, extras.obstacles.surfaces), missing(), s->activity,
             s->velocities, tally_for<LISTED>(s));
    });
  }

  template <class Pass>
  void over_particles(pbf_stage stage) {
    run(stage, [&] {
      launch(particles_kernel<Pass>, Pass::of(&s->params), own_count(n),
             s->activity ? s->activity + n.particles.first : nullptr,
             s->velocities + n.particles.first);
    });
  }

  /* … and the marks. */
  bool update_sleep() {
    uint8_t *room = reinterpret_cast<uint8_t *>(s->other);
    const sleep_marks marks = {room, room + s->capacity};
    const uint32_t first = n.particles.first;
    run(PBF_STAGE_SLEEP, [&] {
      if (has_ranks(s)) status = begin_marks_on_ranks(marks);
      if (status != PBF_OK) return;
      with_kernel(s->schedule.features, [&](auto features) {
        launch(activity_kernel<decltype(features)::value>, n, s->velocities, s->sleep, s->activity,
               s->tally, marks);
      });
      launch(wake_neighbors_kernel, n, s->tally, marks);
      if (has_ranks(s)) status = exchange_notes(s, s->activity, marks.awakened);
      if (status != PBF_OK) return;
      const sleep_marks own = {marks.wakes_neighbors + first, marks.awakened + first};
      launch(update_sleep_kernel, own_count(n), s->sleep, s->activity + first,
             s->velocities + first, s->tally, own, s->all_asleep, s->epoch);
    });
    return false; /* the device tells the host: all_asleep */
  }

  /* Of others' particles none is marked yet; and those of other ranks may sleep where none of its
   * own does. */
  pbf_status begin_marks_on_ranks(const sleep_marks &marks) {
    if (pbf_status failed = pbf_cuda_check(
            cudaMemsetAsync(marks.awakened, 0, s->ranks.held, s->stream), "cudaMemsetAsync"))
      return failed;
    return pbf_cuda_check(cudaMemsetAsync(&s->tally->near_sleep_count, 1,
                                          sizeof s->tally->near_sleep_count, s->stream),
                          "cudaMemsetAsync");
  }

  /* The grid's part of lambda is added where pressures are asked for. */
  void end() {
    if (status != PBF_OK || !prediction_inputs.periods.any) return;
    launch(inside_kernel, prediction_inputs.periods, own_count(n), s->points + n.particles.first);
    status = pbf_cuda_check_launch("inside_kernel");
  }
};

}  // namespace

/* The step that ends at `time`, the nth of its length, between these colliders. */
static inline pbf_status step_once(solver *s, double time, uint64_t nth,
                                   const pbf_surface *surfaces) {
  executor e(s, time, nth, surfaces);
  const bool with_sleep = PBF_SLEEP && has_ranks(s) && s->activity;
  if (with_sleep && s->ranks.all_asleep) {
    e.wake();
    if (e.status == PBF_OK) e.status = look_for_awakened(s);
    if (e.status != PBF_OK) return e.status;
    if (s->ranks.all_asleep) {
      s->time = time;
      return repeat_loads(s, 1);
    }
  }
  run_step(e, s->schedule);
  return with_sleep && e.status == PBF_OK ? note_sleep_of_ranks(s) : e.status;
}

/* Whether no step from `time` on has anything to do: a look, without waiting. A step launched for
 * want of having seen it changes nothing, so that results do not depend on when it is seen. On
 * ranks step_once looks. */
static inline bool all_asleep(const solver *s, double time) {
  return PBF_SLEEP && s->activity && !has_ranks(s) &&
         !pbf_any_obstacle_moves(moving_obstacles_at(s, time)) &&
         *static_cast<const volatile uint64_t *>(s->all_asleep) == s->epoch;
}

#endif
