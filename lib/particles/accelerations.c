/* The backend has them, and adds them to velocities before the prediction, as Algorithm 1's line 2
 * does with gravity; they follow the particles there. The library keeps a copy: the longest stable
 * step goes by the largest. */
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
#include "values.h"

static double component(const pbf_solver *solver, uint32_t row, uint32_t k) {
  const char *a = pbf_acceleration_of_row(solver, row);
  return solver->kind.precision == PBF_FLOAT32 ? (double)((const float *)a)[k]
                                               : ((const double *)a)[k];
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

static pbf_status tell_backend(pbf_solver *solver, uint32_t on) {
  return pbf_backend_result(solver, solver->api.set_accelerations(solver->backend, on),
                            "set_accelerations");
}

static pbf_status clear(pbf_solver *solver, uint32_t first, uint32_t count) {
  if (first || count)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "accelerations is null, first is %u and count %u; null with 0 and 0 takes all "
                    "accelerations away",
                    first, count);
  if (!pbf_has_accelerations(solver)) return PBF_OK;
  pbf_accelerations_free(solver);
  return tell_backend(solver, 0);
}

/* Room for them, here and in the backend. */
static pbf_status begin(pbf_solver *solver) {
  if (pbf_has_accelerations(solver)) return PBF_OK;
  if (!solver->api.set_accelerations)
    return pbf_fail(PBF_ERROR_UNSUPPORTED, "the backend \"%s\" has no accelerations of particles",
                    solver->plugin->name);
  pbf_status status = pbf_memory_allocate(&solver->allocator, pbf_accelerations_bytes(solver),
                                          "accelerations", &solver->accelerations);
  if (status != PBF_OK) return status;
  status = tell_backend(solver, 1);
  if (status != PBF_OK) pbf_accelerations_free(solver);
  return status;
}

static pbf_status write_rows(pbf_solver *solver, const pbf_rows *rows, const void *in) {
  return pbf_backend_result(
      solver, solver->api.write(solver->backend, PBF_BACKEND_FIELD_ACCELERATION, rows, in),
      "write");
}

pbf_status pbf_accelerations_to_backend(pbf_solver *solver, const void *accelerations,
                                        uint32_t rows, uint32_t count, const uint32_t *ids) {
  const pbf_rows given = {sizeof given, 0, rows, count, ids};
  if (!solver->api.set_accelerations) return PBF_OK; /* so that there are none */
  pbf_status status = tell_backend(solver, accelerations != NULL);
  return status == PBF_OK && rows ? write_rows(solver, &given, accelerations) : status;
}

static void note(pbf_solver *solver, uint32_t first, uint32_t count, const void *in) {
  const uint32_t there = solver->acceleration_count;
  if (first > there)
    memset(pbf_acceleration_of_row(solver, there), 0, (first - there) * pbf_point_bytes(solver));
  memcpy(pbf_acceleration_of_row(solver, first), in, count * pbf_point_bytes(solver));
  if (first + count > there) solver->acceleration_count = first + count;
}

static pbf_status set(pbf_solver *solver, uint32_t first, uint32_t count, const void *in) {
  pbf_status status = pbf_check_unmapped(solver);
  if (status != PBF_OK) return status;
  if (!in) return clear(solver, first, count);
  status = pbf_check_rows(solver, first, count);
  if (status != PBF_OK || count == 0) return status;
  status = pbf_check_pointer("accelerations", in, pbf_element_size(solver));
  if (status == PBF_OK) status = pbf_values_check_finite(solver, "accelerations", in, count, first);
  if (status == PBF_OK) status = begin(solver);
  if (status != PBF_OK) return status;
  const pbf_rows rows = pbf_ids_rows(solver, first, count);
  status = write_rows(solver, &rows, in);
  if (status == PBF_OK) note(solver, first, count, in);
  return status;
}

pbf_status pbf_set_accelerations(pbf_solver *solver, uint32_t first, uint32_t count,
                                 const void *accelerations) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, set(solver, first, count, accelerations));
}
