/* Density, velocity and pressure at points, and on grids of them. */
#include <pbf/query.h>

#include <math.h>

#include "check.h"
#include "error.h"
#include "points.h"
#include "solver/handles.h"
#include "structs.h"
#include "sums.h"
#include "text.h"

/* ---- One point ------------------------------------------------------------------------------- */

static uint32_t fields_of(const pbf_samples *samples) {
  return (samples->velocities ? (uint32_t)PBF_QUERY_VELOCITIES : 0) |
         (samples->pressures ? (uint32_t)PBF_QUERY_PRESSURES : 0);
}

static void sample_at(pbf_query_place *place, const double *point, const pbf_samples *to,
                      uint32_t i) {
  const uint32_t fields = fields_of(to), n = place->index->dimension;
  double values[4];
  if (to->densities || to->wet) {
    const double density = pbf_query_density(place, point, NULL);
    if (to->densities) to->densities[i] = density;
    if (to->wet) to->wet[i] = density >= PBF_QUERY_SURFACE;
  }
  if (!fields) return;
  pbf_query_fields(place, point, fields, values);
  for (uint32_t k = 0; k < n && to->velocities; ++k)
    to->velocities[(uint64_t)i * n + k] = values[k];
  if (to->pressures) to->pressures[i] = values[3];
}

/* ---- Points ---------------------------------------------------------------------------------- */

static pbf_status check_target(const char *name, const double *array) {
  return array ? pbf_check_pointer(name, array, sizeof *array) : PBF_OK;
}

static pbf_status check_targets(const pbf_samples *samples) {
  if (samples->count == 0) return PBF_OK;
  if (!samples->densities && !samples->velocities && !samples->pressures && !samples->wet)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "samples.densities, velocities, pressures and wet are null; at least one is to "
                    "be written to");
  pbf_status status = check_target("samples.densities", samples->densities);
  if (status == PBF_OK) status = check_target("samples.velocities", samples->velocities);
  if (status == PBF_OK) status = check_target("samples.pressures", samples->pressures);
  return status;
}

/* Some of the points, from `first` on. */
static pbf_status sample_some(pbf_solver *solver, const pbf_query_index *index,
                              const pbf_samples *samples, uint32_t first, uint32_t count) {
  const double *points = samples->points + (uint64_t)first * index->dimension;
  const pbf_query_key *order;
  pbf_query_place place = {.index = index};
  pbf_status status = pbf_query_order(solver, count, points, &order);
  for (uint32_t i = 0; i < count && status == PBF_OK; ++i) {
    const uint32_t at = order[i].element;
    sample_at(&place, points + (uint64_t)at * index->dimension, samples, first + at);
  }
  return status;
}

/* Memory for an order of as many as are ordered at once is there after the first ones: what can
 * fail comes before anything is written. */
static pbf_status sample_points(pbf_solver *solver, const pbf_query_index *index,
                                const pbf_samples *samples) {
  pbf_status status = PBF_OK;
  for (uint32_t first = 0, count; first < samples->count && status == PBF_OK; first += count) {
    const uint32_t rest = samples->count - first;
    count = rest < PBF_QUERY_ORDERED ? rest : PBF_QUERY_ORDERED;
    status = sample_some(solver, index, samples, first, count);
  }
  return status;
}

static pbf_status sample(pbf_solver *solver, const pbf_samples *theirs) {
  pbf_samples samples;
  const pbf_query_index *index;
  pbf_status status = pbf_struct_in(&pbf_kind_samples, theirs, &samples);
  if (status == PBF_OK) status = check_targets(&samples);
  if (status == PBF_OK)
    status = pbf_query_check_points(solver, "samples.points", samples.count, samples.points);
  if (status != PBF_OK || samples.count == 0) return status;
  status = pbf_query_index_get(solver, fields_of(&samples), &index);
  if (status == PBF_OK) status = sample_points(solver, index, &samples);
  return status;
}

pbf_status pbf_sample(pbf_solver *solver, const pbf_samples *samples) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, sample(solver, samples));
}

/* ---- Grids ----------------------------------------------------------------------------------- */

static pbf_status check_reals(const char *name, const double *numbers, uint32_t count) {
  char number[PBF_NUMBER_SIZE];
  for (uint32_t k = 0; k < count; ++k)
    if (!(fabs(numbers[k]) <= pbf_check_most))
      return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                      "grid.%s[%u] is %s; it must be finite, and at most 1e150 in size", name, k,
                      pbf_text_number(number, numbers[k]));
  return PBF_OK;
}

static pbf_status check_grid(const pbf_solver *solver, const pbf_sample_grid *grid,
                             const pbf_samples *samples) {
  const uint32_t n = solver->kind.dimension;
  double product = 1; /* exact where it matters: up to 2^53 */
  pbf_status status = check_reals("origin", grid->origin, n);
  if (status == PBF_OK) status = check_reals("step", grid->step, n);
  if (status != PBF_OK) return status;
  for (uint32_t k = 0; k < n; ++k) product *= grid->counts[k];
  if (product != samples->count)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "samples.count is %u; the grid has %.9g points, the product of grid.counts",
                    samples->count, product);
  if (samples->points)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "samples.points is not null; the points are those of the grid");
  return check_targets(samples);
}

static void sample_grid(pbf_query_place *place, const pbf_sample_grid *grid,
                        const pbf_samples *samples) {
  const uint32_t n = place->index->dimension, depth = n == 3 ? grid->counts[2] : 1;
  uint32_t at = 0;
  for (uint32_t i = 0; i < grid->counts[0]; ++i) {
    for (uint32_t j = 0; j < grid->counts[1]; ++j) {
      for (uint32_t k = 0; k < depth; ++k) {
        const double point[3] = {grid->origin[0] + i * grid->step[0],
                                 grid->origin[1] + j * grid->step[1],
                                 n == 3 ? grid->origin[2] + k * grid->step[2] : 0};
        sample_at(place, point, samples, at++);
      }
    }
  }
}

static pbf_status sample_on_grid(pbf_solver *solver, const pbf_sample_grid *their_grid,
                                 const pbf_samples *theirs) {
  pbf_sample_grid grid;
  pbf_samples samples;
  pbf_query_place place = {0};
  pbf_status status = pbf_struct_in(&pbf_kind_sample_grid, their_grid, &grid);
  if (status == PBF_OK) status = pbf_struct_in(&pbf_kind_samples, theirs, &samples);
  if (status == PBF_OK) status = check_grid(solver, &grid, &samples);
  if (status != PBF_OK || samples.count == 0) return status;
  status = pbf_query_index_get(solver, fields_of(&samples), &place.index);
  if (status == PBF_OK) sample_grid(&place, &grid, &samples);
  return status;
}

pbf_status pbf_sample_on_grid(pbf_solver *solver, const pbf_sample_grid *grid,
                              const pbf_samples *samples) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, sample_on_grid(solver, grid, samples));
}

static pbf_status end_queries(pbf_solver *solver) {
  pbf_query_index_free(solver);
  return PBF_OK;
}

pbf_status pbf_end_queries(pbf_solver *solver) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, end_queries(solver));
}
