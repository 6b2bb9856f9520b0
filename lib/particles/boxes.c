/* Particles by where they are: those in a box. */
#include <string.h>

#include "check.h"
#include "error.h"
#include "inside.h"
#include "solver/handles.h"
#include "text.h"

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

/* In 2D z is 0, and what the caller says of it nothing. */
static pbf_backend_box box_of(const pbf_solver *solver, const double *lower, const double *upper) {
  pbf_backend_box box = {{0}, {0}};
  memcpy(box.lower, lower, solver->kind.dimension * sizeof *lower);
  memcpy(box.upper, upper, solver->kind.dimension * sizeof *upper);
  return box;
}

static int has_point(const void *what, const double point[3]) {
  const pbf_backend_box *box = what;
  for (int k = 0; k < 3; ++k)
    if (!(point[k] >= box->lower[k] && point[k] <= box->upper[k])) return 0;
  return 1;
}

/* `inside` is empty. */
static pbf_status find(pbf_solver *solver, const double *lower, const double *upper,
                       pbf_row_set *inside) {
  const pbf_backend_box box = box_of(solver, lower, upper);
  return pbf_row_set_add_inside(solver, 1, &box, has_point, &box, inside);
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
