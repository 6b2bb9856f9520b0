/* Particles by where they are: those in a box. */
#include <math.h>

#include "check.h"
#include "error.h"
#include "numbers.h"
#include "row_set.h"
#include "solver/handles.h"
#include "solver/ids.h"
#include "text.h"
#include "values.h"

static pbf_status check_box(const pbf_solver *solver, const double *lower, const double *upper) {
  char low[PBF_NUMBER_SIZE], high[PBF_NUMBER_SIZE];
  if (!lower || !upper)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "%s is null; it is a corner of the box",
                    lower ? "upper" : "lower");
  pbf_status status = pbf_check_pointer("lower", lower, sizeof *lower);
  if (status == PBF_OK) status = pbf_check_pointer("upper", upper, sizeof *upper);
  if (status != PBF_OK) return status;
  for (uint32_t k = 0; k < solver->kind.dimension; ++k) {
    if (lower[k] <= upper[k]) continue;
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "lower[%u] is %s and upper[%u] %s; the first must be at most the second, and "
                    "both numbers",
                    k, pbf_text_number(low, lower[k]), k, pbf_text_number(high, upper[k]));
  }
  return PBF_OK;
}

static int is_inside(const pbf_numbers *positions, uint32_t element, pbf_check_kind kind,
                     const double *lower, const double *upper) {
  for (uint32_t k = 0; k < kind.dimension; ++k) {
    const double x = pbf_numbers_get(positions, element, k, kind.precision);
    if (!(x >= lower[k] && x <= upper[k])) return 0;
  }
  return 1;
}

/* `inside` is empty. */
static pbf_status find(pbf_solver *solver, const double *lower, const double *upper,
                       pbf_row_set *inside) {
  pbf_numbers positions;
  pbf_status status = pbf_numbers_find(solver, PBF_FIELD_POSITION, 0, solver->count, &positions);
  for (uint32_t i = 0; i < positions.elements && status == PBF_OK; ++i) {
    uint32_t row = i;
    if (!is_inside(&positions, i, solver->kind, lower, upper)) continue;
    if (!positions.ids || pbf_ids_find(solver, positions.ids[i], &row))
      pbf_row_set_add(inside, row);
  }
  pbf_numbers_free(solver, &positions);
  return status;
}

static pbf_status find_in_box(pbf_solver *solver, const double *lower, const double *upper,
                              uint32_t room, uint32_t *ids, uint32_t *count) {
  pbf_row_set inside;
  pbf_status status = pbf_check_pointer("count", count, sizeof *count);
  if (status == PBF_OK) status = check_box(solver, lower, upper);
  if (status == PBF_OK && room > 0) status = pbf_check_pointer("ids", ids, sizeof *ids);
  if (status == PBF_OK) status = pbf_row_set_allocate(solver, &inside);
  if (status != PBF_OK) return status;
  status = find(solver, lower, upper, &inside);
  if (status == PBF_OK) {
    pbf_row_set_ids(solver, &inside, room, ids);
    *count = inside.count;
  }
  pbf_row_set_free(solver, &inside);
  return status;
}

pbf_status pbf_find_in_box(pbf_solver *solver, const double lower[3], const double upper[3],
                           uint32_t room, uint32_t *ids, uint32_t *count) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, find_in_box(solver, lower, upper, room, ids, count));
}

static pbf_status remove_in_box(pbf_solver *solver, const double *lower, const double *upper,
                                uint32_t *count) {
  pbf_row_set inside;
  pbf_status status = pbf_check_unmapped(solver);
  if (status == PBF_OK && count) status = pbf_check_pointer("count", count, sizeof *count);
  if (status == PBF_OK) status = check_box(solver, lower, upper);
  if (status == PBF_OK) status = pbf_row_set_allocate(solver, &inside);
  if (status != PBF_OK) return status;
  status = find(solver, lower, upper, &inside);
  if (status == PBF_OK) status = pbf_row_set_remove(solver, &inside);
  if (status == PBF_OK && count) *count = inside.count;
  pbf_row_set_free(solver, &inside);
  return status;
}

pbf_status pbf_remove_in_box(pbf_solver *solver, const double lower[3], const double upper[3],
                             uint32_t *count) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, remove_in_box(solver, lower, upper, count));
}
