#include "points.h"

#include <math.h>

#include "check.h"
#include "error.h"
#include "text.h"

pbf_status pbf_query_check_points(const pbf_solver *solver, const char *name, uint32_t count,
                                  const double *points) {
  const uint32_t n = solver->kind.dimension;
  char number[PBF_NUMBER_SIZE];
  if (count == 0) return PBF_OK;
  pbf_status status = pbf_check_pointer(name, points, sizeof *points);
  if (status != PBF_OK) return status;
  for (uint64_t i = 0; i < (uint64_t)count * n; ++i)
    if (!(fabs(points[i]) <= pbf_check_most))
      return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                      "%s[%u][%u] is %s; it must be finite, and at most 1e150 in size", name,
                      (uint32_t)(i / n), (uint32_t)(i % n), pbf_text_number(number, points[i]));
  return PBF_OK;
}
