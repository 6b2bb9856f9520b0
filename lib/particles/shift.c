#include "shift.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "params.h"
#include "solver/solver_time.h"
#include "values.h"

/* What the ways of two particles that go the same may differ by, per axis: their positions are
 * rounded where they were and where they are set to. */
static void rounding_of(const pbf_solver *solver, double rounding[3]) {
  const double epsilon = solver->kind.precision == PBF_FLOAT32 ? FLT_EPSILON : DBL_EPSILON;
  pbf_box box = pbf_params_box(&solver->params, solver->kind.dimension, pbf_solver_time(solver));
  for (uint32_t k = 0; k < solver->kind.dimension; ++k)
    rounding[k] = 2 * epsilon * fmax(fabs(box.lower[k]), fabs(box.upper[k]));
}

/* 1 where a way is another one's, up to rounding here and there. */
static int are_alike(const pbf_solver *solver, const double rounding[3], const double a[3],
                     const double b[3]) {
  const double epsilon = solver->kind.precision == PBF_FLOAT32 ? FLT_EPSILON : DBL_EPSILON;
  for (uint32_t k = 0; k < solver->kind.dimension; ++k)
    if (!(fabs(a[k] - b[k]) <= rounding[k] + 2 * epsilon * fabs(b[k]))) return 0;
  return 1;
}

static void way_of(const pbf_solver *solver, uint32_t row, const void *from, const void *to,
                   double way[3]) {
  const pbf_check_kind *kind = &solver->kind;
  for (uint32_t k = 0; k < kind->dimension; ++k) {
    uint64_t at = (uint64_t)row * kind->dimension + k;
    way[k] = pbf_value_at(to, at, kind->precision) - pbf_value_at(from, at, kind->precision);
  }
}

/* A majority vote in one pass (Boyer and Moore 1981), so that a few that are set elsewhere at the
 * same time, or the first, decide nothing: half of the votes are left where three quarters go the
 * same way, and only where half of them do. */
int pbf_is_shift(const pbf_solver *solver, const void *before, const void *positions,
                 double shift[3]) {
  double rounding[3], way[3] = {0, 0, 0};
  uint32_t votes = 0;
  rounding_of(solver, rounding);
  for (uint32_t row = 0; row < solver->count; ++row) {
    way_of(solver, row, before, positions, way);
    if (votes == 0) memcpy(shift, way, sizeof way);
    if (are_alike(solver, rounding, way, shift))
      ++votes;
    else
      --votes;
  }
  return 2 * (uint64_t)votes >= solver->count;
}
