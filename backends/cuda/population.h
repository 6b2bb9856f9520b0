/* Particles in and out. Between steps the arrays of the sort are free: transfers go through them.
 */
#ifndef PBF_CUDA_POPULATION_H
#define PBF_CUDA_POPULATION_H

#include "cuda/launches.h"
#include "cuda/pressure_datum.h"
#include "cuda/pressures.h"
#include "cuda/rows.h"
#include "cuda/stats.h"

static inline pbf_status copy_in(solver *s, void *to, const void *from, uint64_t bytes) {
  return pbf_cuda_check(cudaMemcpyAsync(to, from, bytes, cudaMemcpyHostToDevice, s->stream),
                        "cudaMemcpyAsync to the device");
}

/* ---- What wakes between steps -------------------------------------------------------------- */

/* `count` particles from `first` on are new. */
static inline pbf_status init_new(solver *s, uint32_t first, uint32_t count) {
  if (!PBF_SLEEP || !s->activity || !count) return PBF_OK;
  ++s->epoch;
  init_new_kernel<<<blocks_for(count), PBF_BLOCK, 0, s->stream>>>(
      count, s->sleep, s->activity + s->first + first, s->tally);
  return pbf_cuda_check_launch("greet_kernel");
}

template <bool CONDITIONAL>
static inline pbf_status launch_wake_all(solver *s) {
  if (!PBF_SLEEP || !s->activity || !s->count) return PBF_OK;
  ++s->epoch;
  wake_all_kernel<CONDITIONAL><<<blocks_for(s->count), PBF_BLOCK, 0, s->stream>>>(
      s->count, s->sleep, s->activity + s->first, s->tally);
  return pbf_cuda_check_launch("wake_all_kernel");
}

static inline pbf_status wake_all(solver *s) {
  s->ranks.wakes = false;
  return launch_wake_all<false>(s);
}

/* Those near these colliders as they stood, or will stand, at a time. */
static inline pbf_status wake_near_colliders(solver *s, pbf_moving_obstacles moving_obstacles,
                                             double time) {
  if (!PBF_SLEEP || !s->activity || !s->count || !pbf_any_obstacle_moves(moving_obstacles))
    return PBF_OK;
  ++s->epoch;
  if (pbf_status status = place_surfaces(s, time)) return status;
  return wake_near_moving(s, moving_obstacles,
                          {pbf_domain_at(&s->params, time, s->schedule.close_phases),
                           (int)s->collider_count, surfaces_of_step(s, 0)});
}

/* What is awake near these colliders as they stand at a time. */
static inline pbf_status keep_awake_near(solver *s, pbf_moving_obstacles arriving, double time) {
  if (!PBF_SLEEP || !s->activity || !s->count || !pbf_any_obstacle_moves(arriving)) return PBF_OK;
  if (pbf_status status = place_surfaces(s, time)) return status;
  if (are_listed(s))
    if (pbf_status status = upload_set(s, MANY_MOVING, &arriving.more)) return status;
  const step_obstacles obstacles = {pbf_domain_at(&s->params, time, s->schedule.close_phases),
                                    (int)s->collider_count, surfaces_of_step(s, 0)};
  with_lists(s, [&](auto listed) {
    keep_awake_near_kernel<decltype(listed)::value>
        <<<blocks_for(s->count), PBF_BLOCK, 0, s->stream>>>(s->points + s->first, s->count,
                                                            s->sleep, arriving, obstacles,
                                                            s->constants.h, s->activity + s->first);
  });
  return pbf_cuda_check_launch("keep_awake_near_kernel");
}

/* Where any particle sleeps near these colliders as they stand at a time. Other ranks learn of it
 * as soon as all are asked. */
static inline pbf_status wake_all_if_near(solver *s, pbf_moving_obstacles departing, double time) {
  if (!PBF_SLEEP || !s->activity || !s->count || !pbf_any_obstacle_moves(departing)) return PBF_OK;
  pbf_status status = pbf_cuda_check(
      cudaMemsetAsync(&s->tally->woken, 0, sizeof s->tally->woken, s->stream), "cudaMemsetAsync");
  if (status == PBF_OK) status = wake_near_colliders(s, departing, time);
  if (status != PBF_OK) return status;
  if (!has_ranks(s)) return launch_wake_all<true>(s);
  uint32_t woken = 0;
  status = copy_out(s, &woken, &s->tally->woken, sizeof woken);
  s->ranks.wakes = s->ranks.wakes || woken;
  return status;
}

/* On ranks: before what all ranks do that goes by which particles sleep. */
static inline pbf_status wake_ranks(solver *s) {
  if (!PBF_SLEEP || !has_ranks(s) || !s->activity) return PBF_OK;
  const bool any = !on_all_ranks(s, !s->ranks.wakes);
  if (s->ranks.failed) return s->ranks.failed;
  return any ? wake_all(s) : PBF_OK;
}

/* ---- Pressure of the last step --------------------------------------------------------------- */

static inline pressure_source pressures_of(const solver *s) {
  pressure_source source = {s->pressure_scale, {}};
  if (!PBF_HAS_PRESSURE_GRID || !s->pressure_grid_memory || !(s->pressure_scale > 0) ||
      !s->pressure_grid.nodes)
    return source;
  find_datum(s);
  source.grid = {s->pressure_grid, pressure_grid_of(s), s->pressure_grid_scale};
  return source;
}

/* Before the grid of the last step goes, or particles elsewhere: their lambda takes over what it
 * adds to their pressure. */
static inline pbf_status add_weight(solver *s) {
  pressure_source source = pressures_of(s);
  s->pressure_grid.nodes = 0;
  if (!source.grid.arrays.control || !s->count) return PBF_OK;
  add_weight_kernel<<<blocks_for(s->count), PBF_BLOCK, 0, s->stream>>>(s->points + s->first,
                                                                       s->count, source);
  return pbf_cuda_check_launch("add_weight_kernel");
}

/* ---- In and out ---------------------------------------------------------------------------- */

static inline pbf_status population_add(solver *s, const pbf_particles *p) {
  uint64_t bytes = p->count * sizeof(pbf_vec);
  pbf_vec *staged = reinterpret_cast<pbf_vec *>(s->other);
  if (!p->count) return PBF_OK;
  s->owned = 0;
  /* Those asleep keep lambda from step to step, and would take it over again and again. */
  if (!s->activity)
    if (pbf_status status = add_weight(s)) return status;
  if (pbf_status status = copy_in(s, staged, p->positions, bytes)) return status;
  append_points_kernel<<<blocks_for(p->count), PBF_BLOCK, 0, s->stream>>>(s->points + s->count,
                                                                          p->count, staged);
  if (pbf_status status = pbf_cuda_check_launch("append_points_kernel")) return status;
  if (pbf_status status = copy_in(s, s->ids + s->count, p->ids, p->count * sizeof(uint32_t)))
    return status;
  pbf_vec *velocities = s->velocities + s->count;
  pbf_status status =
      p->velocities
          ? copy_in(s, velocities, p->velocities, bytes)
          : pbf_cuda_check(cudaMemsetAsync(velocities, 0, bytes, s->stream), "cudaMemsetAsync");
  if (status == PBF_OK && s->last_pressure)
    status = pbf_cuda_check(cudaMemsetAsync(s->last_pressure + s->count, 0,
                                            p->count * sizeof *s->last_pressure, s->stream),
                            "cudaMemsetAsync");
  if (status == PBF_OK && s->overlap)
    status = pbf_cuda_check(
        cudaMemsetAsync(s->overlap + s->count, 0, p->count * sizeof *s->overlap, s->stream),
        "cudaMemsetAsync");
  if (status == PBF_OK && s->phase)
    status =
        pbf_cuda_check(cudaMemsetAsync(s->phase + s->count, (int)p->phase, p->count, s->stream),
                       "cudaMemsetAsync");
  if (status == PBF_OK && s->acceleration)
    status = pbf_cuda_check(cudaMemsetAsync(s->acceleration + s->count, 0, bytes, s->stream),
                            "cudaMemsetAsync");
  if (status == PBF_OK) status = init_new(s, s->count, p->count);
  if (status == PBF_OK) s->count += p->count;
  if (status == PBF_OK && p->wakes_all) status = wake_all(s);
  return status;
}

static inline pbf_status population_remove(solver *s, uint32_t count, const uint32_t *ids) {
  if (!count) return PBF_OK;
  s->owned = 0;
  if (pbf_status status = wake_all(s)) return status;
  uint32_t *removed = s->cells, *place = static_cast<uint32_t *>(s->list_storage);
  uint32_t blocks = blocks_for(s->count + 1);
  if (pbf_status status = copy_in(s, removed, ids, count * sizeof(uint32_t))) return status;
  mark_kept_kernel<<<blocks, PBF_BLOCK, 0, s->stream>>>(s->ids, s->count, removed, count, place);
  if (pbf_status status =
          pbf_cuda_scan(place, s->count + 1, s->scan_scratch, s->scan_bytes, s->stream))
    return status;
  compact_kernel<<<blocks, PBF_BLOCK, 0, s->stream>>>(
      {s->points, s->velocities, s->ids, s->activity, s->last_pressure, s->overlap, s->phase,
       s->acceleration},
      s->count, place,
      {s->other, s->other_velocities, s->other_ids, s->other_activity, s->other_last_pressure,
       s->other_overlap, s->other_phase, s->other_acceleration});
  if (pbf_status status = pbf_cuda_check_launch("compact_kernel")) return status;
  swap_arrays(&s->points, &s->other);
  swap_arrays(&s->velocities, &s->other_velocities);
  swap_arrays(&s->ids, &s->other_ids);
  swap_arrays(&s->activity, &s->other_activity);
  swap_arrays(&s->last_pressure, &s->other_last_pressure);
  swap_arrays(&s->overlap, &s->other_overlap);
  swap_arrays(&s->phase, &s->other_phase);
  swap_arrays(&s->acceleration, &s->other_acceleration);
  s->count -= count;
  return PBF_OK;
}

/* The ids of `rows` go to the device, but for such as follow each other. */
static inline pbf_status upload_rows(solver *s, const pbf_rows *rows, row_range *range) {
  const uint32_t *ids = rows->ids && rows->count ? rows->ids + rows->first : nullptr;
  *range = {nullptr, ids ? ids[0] : rows->first, rows->count, rows->first};
  if (!ids || ids[rows->count - 1] - ids[0] == rows->count - 1) return PBF_OK;
  range->ids = s->cells;
  return copy_in(s, s->cells, ids, rows->count * sizeof(uint32_t));
}

/* Walls and colliders where the last step left them. */
static inline pbf_status present_extras(solver *s, iteration_extras *extras) {
  *extras = {};
  extras->obstacles = {pbf_domain_at(&s->params, s->time, s->schedule.close_phases),
                       (int)s->collider_count, surfaces_of_step(s, 0)};
  extras->wall_density = s->schedule.wall_density;
  return place_surfaces(s, s->time);
}

static inline cell_grid present_grid(const solver *s, const pbf_domain &domain) {
  const pbf_periods periods = pbf_periods_of(&s->params);
  return grid_over(&domain, &periods, s->params.smoothing_radius,
                   grid_cell_limit(particles_of_all(s)), PBF_FINEST);
}

/* Of the sorted particles, at the places that they have. */
static inline void launch_densities(const solver *s, const neighborhood &n,
                                    const iteration_extras &extras, const found_densities &found) {
  const uint32_t blocks = blocks_for(own_count(n));
  if (!blocks) return;
  with_kernel(s->schedule.features, [&](auto features) {
    density_kernel<decltype(features)::value>
        <<<blocks, PBF_BLOCK, 0, s->stream>>>(n, extras.obstacles.domain, found);
  });
  if (!extras.wall_density) return;
  with_surfaces(s, [&](auto surfaces) {
    add_solid_density_kernel<decltype(surfaces)::value>
        <<<blocks, PBF_BLOCK, 0, s->stream>>>(n, extras.obstacles, found.densities);
  });
}

/* Of these rows, to where lists lie. */
static inline pbf_status stage_densities(solver *s, const pbf_rows *rows) {
  iteration_extras extras;
  if (pbf_status status = present_extras(s, &extras)) return status;
  cell_grid grid = present_grid(s, extras.obstacles.domain);
  row_range range;
  uint32_t blocks = blocks_for(s->count);
  pbf_real *densities = reinterpret_cast<pbf_real *>(s->other_velocities);
  pbf_real *staged = static_cast<pbf_real *>(s->list_storage);
  if (pbf_status status = sort_present(s, grid)) return status;
  launch_densities(s, neighborhood_of(s, grid), extras, {densities, nullptr});
  if (pbf_status status = upload_rows(s, rows, &range)) return status;
  read_values_kernel<<<blocks, PBF_BLOCK, 0, s->stream>>>(densities, s->other_ids, s->count, range,
                                                          staged);
  return pbf_cuda_check_launch("density_kernel");
}

static inline pbf_status read_densities(solver *s, const pbf_rows *rows, pbf_real *out) {
  if (pbf_status status = stage_densities(s, rows)) return status;
  return copy_out(s, out, s->list_storage, rows->count * sizeof(pbf_real));
}

static inline pbf_status population_read_rest(solver *s, const pbf_rows *rows, void *out) {
  if (!rows->count || !s->activity) return PBF_OK;
  row_range range;
  pbf_real *staged = reinterpret_cast<pbf_real *>(s->other);
  if (pbf_status status = upload_rows(s, rows, &range)) return status;
  read_rest_kernel<<<blocks_for(s->count), PBF_BLOCK, 0, s->stream>>>(
      s->points, s->activity, s->ids, s->count, range, staged);
  if (pbf_status status = pbf_cuda_check_launch("read_rest_kernel")) return status;
  return copy_out(s, out, staged, 2 * (uint64_t)rows->count * sizeof(pbf_real));
}

static inline pbf_status population_write_rest(solver *s, const pbf_rows *rows, const void *in) {
  if (!rows->count || !s->activity) return PBF_OK;
  row_range range;
  pbf_real *staged = reinterpret_cast<pbf_real *>(s->other);
  if (pbf_status status = wake_all(s)) return status;
  if (pbf_status status = upload_rows(s, rows, &range)) return status;
  if (pbf_status status = copy_in(s, staged, in, 2 * (uint64_t)rows->count * sizeof(pbf_real)))
    return status;
  write_rest_kernel<<<blocks_for(s->count), PBF_BLOCK, 0, s->stream>>>(
      s->points, s->activity, s->ids, s->count, range, staged);
  return pbf_cuda_check_launch("write_rest_kernel");
}

/* A number of each, where there are any. */
static inline pbf_status population_read_reals(solver *s, const pbf_real *of, const pbf_rows *rows,
                                               void *out) {
  if (!of) return PBF_OK;
  row_range range;
  pbf_real *staged = reinterpret_cast<pbf_real *>(s->other);
  if (pbf_status status = upload_rows(s, rows, &range)) return status;
  read_values_kernel<<<blocks_for(s->count), PBF_BLOCK, 0, s->stream>>>(of, s->ids, s->count, range,
                                                                        staged);
  if (pbf_status status = pbf_cuda_check_launch("read_values_kernel")) return status;
  return copy_out(s, out, staged, rows->count * sizeof(pbf_real));
}

static inline pbf_status population_write_reals(solver *s, pbf_real *to, const pbf_rows *rows,
                                                const void *in) {
  if (!to) return PBF_OK;
  row_range range;
  pbf_real *staged = reinterpret_cast<pbf_real *>(s->other);
  if (pbf_status status = upload_rows(s, rows, &range)) return status;
  if (pbf_status status = copy_in(s, staged, in, rows->count * sizeof(pbf_real))) return status;
  write_values_kernel<pbf_real>
      <<<blocks_for(s->count), PBF_BLOCK, 0, s->stream>>>(to, s->ids, s->count, range, staged);
  return pbf_cuda_check_launch("write_values_kernel");
}

static inline pbf_status population_write_phases(solver *s, const pbf_rows *rows, const void *in) {
  if (!s->phase) return PBF_OK;
  row_range range;
  uint8_t *staged = reinterpret_cast<uint8_t *>(s->other);
  if (pbf_status status = wake_all(s)) return status;
  if (pbf_status status = upload_rows(s, rows, &range)) return status;
  if (pbf_status status = copy_in(s, staged, in, rows->count)) return status;
  write_values_kernel<uint8_t><<<blocks_for(s->count), PBF_BLOCK, 0, s->stream>>>(
      s->phase, s->ids, s->count, range, staged);
  return pbf_cuda_check_launch("write_values_kernel");
}

static inline pbf_status population_read(solver *s, uint32_t field, const pbf_rows *rows,
                                         void *out) {
  if (!rows->count) return PBF_OK;
  if (field == PBF_BACKEND_FIELD_REST) return population_read_rest(s, rows, out);
  if (field == PBF_BACKEND_FIELD_OVERLAP) return population_read_reals(s, s->overlap, rows, out);
  if (field == PBF_BACKEND_FIELD_LAST_PRESSURE)
    return population_read_reals(s, s->last_pressure, rows, out);
  if (field == PBF_FIELD_DENSITY) return read_densities(s, rows, static_cast<pbf_real *>(out));
  row_range range;
  uint32_t blocks = blocks_for(s->count);
  pbf_vec *staged = reinterpret_cast<pbf_vec *>(s->other);
  if (pbf_status status = upload_rows(s, rows, &range)) return status;
  if (field == PBF_FIELD_POSITION)
    read_points_kernel<<<blocks, PBF_BLOCK, 0, s->stream>>>(s->points, s->ids, s->count, range,
                                                            staged);
  else
    read_values_kernel<<<blocks, PBF_BLOCK, 0, s->stream>>>(s->velocities, s->ids, s->count, range,
                                                            staged);
  if (pbf_status status = pbf_cuda_check_launch("read kernel")) return status;
  return copy_out(s, out, staged, rows->count * sizeof(pbf_vec));
}

/* The same of a vector, into an array of `room` rows on the device; zeros behind it. */
static inline pbf_status population_read_array(solver *s, uint32_t field, const pbf_rows *rows,
                                               uint32_t room, pbf_vec *out) {
  row_range range;
  uint32_t blocks = blocks_for(s->count);
  if (room > rows->count)
    if (pbf_status status = pbf_cuda_check(
            cudaMemsetAsync(out + rows->count, 0, (room - rows->count) * sizeof *out, s->stream),
            "cudaMemsetAsync"))
      return status;
  if (!rows->count) return PBF_OK;
  if (pbf_status status = upload_rows(s, rows, &range)) return status;
  if (field == PBF_FIELD_POSITION)
    read_points_kernel<<<blocks, PBF_BLOCK, 0, s->stream>>>(s->points, s->ids, s->count, range,
                                                            out);
  else
    read_values_kernel<<<blocks, PBF_BLOCK, 0, s->stream>>>(s->velocities, s->ids, s->count, range,
                                                            out);
  return pbf_cuda_check_launch("read kernel");
}

/* In the order of the particles. */
static inline pbf_status find_pressures(solver *s, pbf_real *out) {
  cell_grid grid = present_grid(s, pbf_domain_at(&s->params, s->time, s->schedule.close_phases));
  uint32_t blocks = blocks_for(s->count), *present = static_cast<uint32_t *>(s->list_storage);
  neighborhood n = neighborhood_of(s, grid);
  if (pbf_status status = sort_present(s, grid)) return status;
  sort_lambda_kernel<<<blocks, PBF_BLOCK, 0, s->stream>>>(state_of(s), n, pressures_of(s), present);
  fit_pressures_kernel<<<blocks, PBF_BLOCK, 0, s->stream>>>(n, s->pressure_scale, present, out);
  return pbf_cuda_check_launch("fit_pressures_kernel");
}

/* Of these rows, to where lists lie. */
static inline pbf_status stage_pressures(solver *s, const pbf_rows *rows) {
  row_range range;
  pbf_real *pressures = reinterpret_cast<pbf_real *>(s->other_velocities);
  pbf_real *staged = static_cast<pbf_real *>(s->list_storage);
  if (pbf_status status = find_pressures(s, pressures)) return status;
  if (pbf_status status = upload_rows(s, rows, &range)) return status;
  read_values_kernel<<<blocks_for(s->count), PBF_BLOCK, 0, s->stream>>>(pressures, s->ids, s->count,
                                                                        range, staged);
  return pbf_cuda_check_launch("read_values_kernel");
}

static inline pbf_status population_read_pressures(solver *s, const pbf_rows *rows, pbf_real *out) {
  if (!rows->count) return PBF_OK;
  if (pbf_status status = stage_pressures(s, rows)) return status;
  return copy_out(s, out, s->list_storage, rows->count * sizeof(pbf_real));
}

/* Into s->pressures. */
static inline pbf_status population_pressures(solver *s) {
  if (!s->pressures)
    if (pbf_status status =
            pbf_cuda_take(&s->memory, "pressure", (uint64_t)s->capacity * sizeof(pbf_real),
                          reinterpret_cast<void **>(&s->pressures)))
      return status;
  return s->count ? find_pressures(s, s->pressures) : PBF_OK;
}

static inline pbf_status population_write(solver *s, uint32_t field, const pbf_rows *rows,
                                          const void *in) {
  if (field == PBF_BACKEND_FIELD_REST) return population_write_rest(s, rows, in);
  if (!rows->count) return PBF_OK;
  if (field == PBF_BACKEND_FIELD_OVERLAP) return population_write_reals(s, s->overlap, rows, in);
  if (field == PBF_BACKEND_FIELD_LAST_PRESSURE)
    return population_write_reals(s, s->last_pressure, rows, in);
  if (field == PBF_BACKEND_FIELD_PHASE) return population_write_phases(s, rows, in);
  if (field == PBF_FIELD_POSITION) {
    s->owned = 0;
    if (pbf_status status = add_weight(s)) return status;
  }
  row_range range;
  uint32_t blocks = blocks_for(s->count);
  pbf_vec *staged = reinterpret_cast<pbf_vec *>(s->other);
  if (pbf_status status = wake_all(s)) return status;
  if (pbf_status status = upload_rows(s, rows, &range)) return status;
  if (pbf_status status = copy_in(s, staged, in, rows->count * sizeof(pbf_vec))) return status;
  if (field == PBF_FIELD_POSITION)
    write_points_kernel<<<blocks, PBF_BLOCK, 0, s->stream>>>(s->points, s->ids, s->count, range,
                                                             staged);
  else
    write_values_kernel<pbf_vec><<<blocks, PBF_BLOCK, 0, s->stream>>>(
        field == PBF_BACKEND_FIELD_ACCELERATION ? s->acceleration : s->velocities, s->ids, s->count,
        range, staged);
  return pbf_cuda_check_launch("write kernel");
}

#endif
