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

/* What ways may differ by from `way`, per axis, up to rounding here and there. */
static inline void allow_around(pbf_check_kind kind, const double rounding[3], const double way[3],
                                double allowed[3]) {
  const double epsilon = kind.precision == PBF_FLOAT32 ? FLT_EPSILON : DBL_EPSILON;
  for (uint32_t k = 0; k < kind.dimension; ++k)
    allowed[k] = rounding[k] + 2 * epsilon * fabs(way[k]);
}

static inline void way_of(pbf_check_kind kind, uint32_t row, const void *from, const void *to,
                          double way[3]) {
  for (uint32_t k = 0; k < kind.dimension; ++k) {
    uint64_t at = (uint64_t)row * kind.dimension + k;
    way[k] = pbf_value_at(to, at, kind.precision) - pbf_value_at(from, at, kind.precision);
  }
}

/* The votes that are left to a way, *shift, in the end. */
static inline uint32_t vote(pbf_check_kind kind, uint32_t count, const double rounding[3],
                            const void *before, const void *positions, double shift[3]) {
  double way[3] = {0, 0, 0}, allowed[3] = {0, 0, 0};
  uint32_t votes = 0;
  for (uint32_t row = 0; row < count; ++row) {
    int alike = 1;
    way_of(kind, row, before, positions, way);
    if (votes == 0) {
      memcpy(shift, way, sizeof way);
      allow_around(kind, rounding, shift, allowed);
    }
    for (uint32_t k = 0; k < kind.dimension; ++k) alike &= fabs(way[k] - shift[k]) <= allowed[k];
    votes = alike ? votes + 1 : votes - 1;
  }
  return votes;
}

/* A majority vote in one pass (Boyer and Moore 1981), so that a few that are set elsewhere at the
 * same time, or the first, decide nothing: half of the votes are left where three quarters go the
 * same way, and only where half of them do. */
int pbf_is_shift(const pbf_solver *solver, const void *before, const void *positions,
                 double shift[3]) {
  double rounding[3];
  rounding_of(solver, rounding);
  const uint32_t votes =
      PBF_OF_KIND(solver->kind, vote, solver->count, rounding, before, positions, shift);
  return 2 * (uint64_t)votes >= solver->count;
}
