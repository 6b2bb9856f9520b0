#include "values.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "check.h"
#include "error.h"
#include "params.h"
#include "solver/solver_time.h"
#include "text.h"

pbf_status pbf_values_check_layout(const char *call, const void *data, uint64_t stride,
                                   uint64_t least, uint32_t element_size) {
  char name[16];
  if (stride != 0 && (stride < least || stride % element_size != 0 || stride > UINT32_MAX))
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "%s.stride is %" PRIu64 "; it must be a multiple of %u from %" PRIu64
                    " up to 4294967295, or 0 for no gap",
                    call, stride, element_size, least);
  pbf_text_write(name, sizeof name, "%s.data", call);
  return pbf_check_pointer(name, data, element_size);
}

/* Bounds of numbers that recur: axes in turn, of rows in 2D as in 3D. */
enum { RECURRENCE = 12 };
typedef struct bounds {
  double lower[RECURRENCE], upper[RECURRENCE];
} bounds;

/* 1 where each of so many, a multiple of RECURRENCE, is between its bounds; NaN is not. Without
 * branches, as vectors. */
static int are_singles_between(const bounds *b, const float *values, uint64_t count) {
  float lower[RECURRENCE], upper[RECURRENCE];
  int32_t outside[RECURRENCE] = {0}, any = 0;
  for (uint32_t k = 0; k < RECURRENCE; ++k) {
    lower[k] = (float)fmax(b->lower[k], -FLT_MAX);
    upper[k] = (float)fmin(b->upper[k], FLT_MAX);
  }
  for (uint64_t i = 0; i < count; i += RECURRENCE)
    for (uint32_t k = 0; k < RECURRENCE; ++k)
      outside[k] |= !(values[i + k] >= lower[k]) | !(values[i + k] <= upper[k]);
  for (uint32_t k = 0; k < RECURRENCE; ++k) any |= outside[k];
  return !any;
}

static int are_doubles_between(const bounds *b, const double *values, uint64_t count) {
  int64_t outside[RECURRENCE] = {0}, any = 0;
  for (uint64_t i = 0; i < count; i += RECURRENCE)
    for (uint32_t k = 0; k < RECURRENCE; ++k)
      outside[k] |= !(values[i + k] >= b->lower[k]) | !(values[i + k] <= b->upper[k]);
  for (uint32_t k = 0; k < RECURRENCE; ++k) any |= outside[k];
  return !any;
}

/* How many of the first are known to be between their bounds: all but a few, or none. */
static uint64_t known_between(const pbf_solver *solver, const bounds *b, const void *values,
                              uint64_t count) {
  const uint64_t most = count - count % RECURRENCE;
  const int are = solver->kind.precision == PBF_FLOAT32 ? are_singles_between(b, values, most)
                                                        : are_doubles_between(b, values, most);
  return are ? most : 0;
}

/* `count` where all are at most that in size; NaN is not. */
static uint64_t first_beyond(const pbf_solver *solver, double most, const void *values,
                             uint64_t count) {
  bounds b;
  for (uint32_t k = 0; k < RECURRENCE; ++k) b.lower[k] = -most, b.upper[k] = most;
  uint64_t i = known_between(solver, &b, values, count);
  while (i < count && fabs(pbf_value_at(values, i, solver->kind.precision)) <= most) ++i;
  return i;
}

pbf_status pbf_values_check_finite(const pbf_solver *solver, const char *name, const void *values,
                                   uint32_t count, uint32_t first_row) {
  uint32_t dimension = solver->kind.dimension;
  const uint64_t total = (uint64_t)count * dimension;
  const uint64_t i = first_beyond(solver, pbf_check_most, values, total);
  char number[PBF_NUMBER_SIZE];
  if (i == total) return PBF_OK;
  const double value = pbf_value_at(values, i, solver->kind.precision);
  return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "%s[%u][%u] is %s; it must be %s", name,
                  (uint32_t)(first_row + i / dimension), (uint32_t)(i % dimension),
                  pbf_text_number(number, value),
                  isfinite(value) ? "at most 1e150 in size" : "finite");
}

pbf_status pbf_values_check_numbers(const pbf_solver *solver, const char *name, const void *values,
                                    uint64_t count) {
  uint64_t i = first_beyond(solver, DBL_MAX, values, count);
  char number[PBF_NUMBER_SIZE];
  if (i == count) return PBF_OK;
  return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "%s[%" PRIu64 "] is %s; it must be finite", name, i,
                  pbf_text_number(number, pbf_value_at(values, i, solver->kind.precision)));
}

/* Backends clamp to the walls in the particles' precision, so that is where the walls are. */
static double as_stored(double bound, uint32_t precision) {
  return precision == PBF_FLOAT32 ? (double)(float)bound : bound;
}

/* So many that no other number of the precision is written alike: what is outside by the last of
 * its bits would seem to be inside. */
static int digits_of(double number, uint32_t precision) {
  char text[32];
  int digits = 9;
  for (; digits < 17 && precision == PBF_FLOAT64; ++digits) {
    snprintf(text, sizeof text, "%.*g", digits, number);
    if (strtod(text, NULL) == number) break;
  }
  return digits;
}

static pbf_status refuse_outside(const pbf_solver *solver, const bounds *b, const void *positions,
                                 uint32_t count, uint32_t first_row) {
  const uint32_t dimension = solver->kind.dimension, precision = solver->kind.precision;
  for (uint32_t axis = 0; axis < dimension; ++axis) {
    const double lower = b->lower[axis], upper = b->upper[axis];
    for (uint32_t row = 0; row < count; ++row) {
      double x = pbf_value_at(positions, (uint64_t)row * dimension + axis, precision);
      if (x >= lower && x <= upper) continue;
      return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                      "positions[%u][%u] is %.*g; it must be inside the domain, %.*g … %.*g",
                      first_row + row, axis, digits_of(x, precision), x,
                      digits_of(lower, precision), lower, digits_of(upper, precision), upper);
    }
  }
  return PBF_OK;
}

/* What is inside the domain is finite, unless walls have moved beyond that. */
pbf_status pbf_values_check_positions(const pbf_solver *solver, const void *positions,
                                      uint32_t count, uint32_t first_row) {
  const uint32_t dimension = solver->kind.dimension, precision = solver->kind.precision;
  const pbf_box box = pbf_params_box(&solver->params, dimension, pbf_solver_time(solver));
  bounds b;
  for (uint32_t k = 0; k < RECURRENCE; ++k) {
    b.lower[k] = fmax(as_stored(box.lower[k % dimension], precision), -pbf_check_most);
    b.upper[k] = fmin(as_stored(box.upper[k % dimension], precision), pbf_check_most);
  }
  const uint32_t known =
      (uint32_t)known_between(solver, &b, positions, (uint64_t)count * dimension) / dimension;
  const void *rest = (const char *)positions + known * pbf_point_bytes(solver);
  if (known == count) return PBF_OK;
  pbf_status status =
      pbf_values_check_finite(solver, "positions", rest, count - known, first_row + known);
  if (status == PBF_OK) status = refuse_outside(solver, &b, rest, count - known, first_row + known);
  return status;
}
