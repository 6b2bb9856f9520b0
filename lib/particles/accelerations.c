/* They change velocities before the prediction, as Algorithm 1's line 2 does with gravity, and need
 * no array in a backend that follows the particles. */
#include "accelerations.h"

#include <math.h>
#include <string.h>

#include "check.h"
#include "error.h"
#include "memory.h"
#include "particles.h"
#include "solver/backend_call.h"
#include "solver/handles.h"
#include "solver/ids.h"
#include "solver/solver_time.h"
#include "values.h"

enum { GIVEN, BEFORE, AFTER };

static double component(const pbf_solver *solver, uint32_t row, uint32_t k) {
  const char *a = pbf_acceleration_values(solver, GIVEN, row);
  return solver->kind.precision == PBF_FLOAT32 ? (double)((const float *)a)[k]
                                               : ((const double *)a)[k];
}

static int is_zero(const pbf_solver *solver, uint32_t row) {
  double sum = 0;
  for (uint32_t k = 0; k < solver->kind.dimension; ++k) sum += fabs(component(solver, row, k));
  return !(sum > 0);
}

double pbf_largest_acceleration(const pbf_solver *solver) {
  const double *gravity = solver->params.gravity;
  double largest2 = 0;
  for (uint32_t row = 0; row < solver->acceleration_count; ++row) {
    double sum2 = 0;
    for (uint32_t k = 0; k < solver->kind.dimension; ++k) {
      const double a = gravity[k] + component(solver, row, k);
      sum2 += a * a;
    }
    largest2 = fmax(largest2, sum2);
  }
  return sqrt(largest2);
}

/* Without those that have none at both ends: what is not written does not wake. */
static pbf_accelerated_rows rows_with_some(const pbf_solver *solver) {
  uint32_t first = 0, last = solver->acceleration_count;
  while (first < last && is_zero(solver, first)) ++first;
  while (last > first && is_zero(solver, last - 1)) --last;
  return (pbf_accelerated_rows){first, last - first};
}

/* The solver's precision throughout, so that one that all have is gravity. */
static void find_velocities_after(const pbf_solver *solver, const pbf_accelerated_rows *rows) {
  const uint64_t numbers = (uint64_t)rows->count * solver->kind.dimension;
  const void *a = pbf_acceleration_values(solver, GIVEN, rows->first),
             *before = pbf_acceleration_values(solver, BEFORE, 0);
  void *after = pbf_acceleration_values(solver, AFTER, 0);
  if (solver->kind.precision == PBF_FLOAT32) {
    const float time_step = (float)pbf_part_time_step(solver);
    for (uint64_t i = 0; i < numbers; ++i)
      ((float *)after)[i] = ((const float *)before)[i] + time_step * ((const float *)a)[i];
  } else {
    const double time_step = pbf_part_time_step(solver);
    for (uint64_t i = 0; i < numbers; ++i)
      ((double *)after)[i] = ((const double *)before)[i] + time_step * ((const double *)a)[i];
  }
}

pbf_status pbf_accelerate(pbf_solver *solver, pbf_accelerated_rows *out) {
  *out = (pbf_accelerated_rows){0, 0};
  if (!solver->accelerations) return PBF_OK;
  const pbf_accelerated_rows some = rows_with_some(solver);
  if (some.count == 0) return PBF_OK;
  const pbf_rows rows = pbf_ids_rows(solver, some.first, some.count);
  pbf_status status = solver->api.read(solver->backend, PBF_FIELD_VELOCITY, &rows,
                                       pbf_acceleration_values(solver, BEFORE, 0));
  if (status != PBF_OK) return pbf_backend_result(solver, status, "read");
  find_velocities_after(solver, &some);
  status = solver->api.write(solver->backend, PBF_FIELD_VELOCITY, &rows,
                             pbf_acceleration_values(solver, AFTER, 0));
  if (status == PBF_OK) *out = some;
  return pbf_backend_result(solver, status, "write");
}

void pbf_undo_accelerations(pbf_solver *solver, const pbf_accelerated_rows *changed) {
  if (changed->count == 0) return;
  const pbf_rows rows = pbf_ids_rows(solver, changed->first, changed->count);
  (void)solver->api.write(solver->backend, PBF_FIELD_VELOCITY, &rows,
                          pbf_acceleration_values(solver, BEFORE, 0));
}

static pbf_status clear(pbf_solver *solver, uint32_t first, uint32_t count) {
  if (first || count)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "accelerations is null, first is %u and count %u; null with 0 and 0 takes all "
                    "accelerations away",
                    first, count);
  pbf_accelerations_free(solver);
  return PBF_OK;
}

static pbf_status set(pbf_solver *solver, uint32_t first, uint32_t count, const void *in) {
  pbf_status status = pbf_check_unmapped(solver);
  if (status != PBF_OK) return status;
  if (!in) return clear(solver, first, count);
  status = pbf_check_rows(solver, first, count);
  if (status != PBF_OK || count == 0) return status;
  status = pbf_check_pointer("accelerations", in, pbf_element_size(solver));
  if (status == PBF_OK) status = pbf_values_check_finite(solver, "accelerations", in, count, first);
  if (status == PBF_OK && !solver->accelerations)
    status = pbf_memory_allocate(&solver->allocator, pbf_accelerations_bytes(solver),
                                 "accelerations", &solver->accelerations);
  if (status != PBF_OK) return status;
  const uint32_t there = solver->acceleration_count;
  if (first > there)
    memset(pbf_acceleration_values(solver, GIVEN, there), 0,
           (first - there) * pbf_point_bytes(solver));
  memcpy(pbf_acceleration_values(solver, GIVEN, first), in, count * pbf_point_bytes(solver));
  if (first + count > there) solver->acceleration_count = first + count;
  return PBF_OK;
}

pbf_status pbf_set_accelerations(pbf_solver *solver, uint32_t first, uint32_t count,
                                 const void *accelerations) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, set(solver, first, count, accelerations));
}
