/* Spray, foam and bubbles as they are set, counted and moved by the caller. */
#include "diffuse.h"

#include <math.h>

#include "check.h"
#include "error.h"
#include "solids.h"
#include "particles/values.h"
#include "solver/handles.h"
#include "solver/rank_settings.h"
#include "solver/solver_time.h"
#include "structs.h"
#include "text.h"

static pbf_status need(const pbf_solver *solver) {
  if (solver->diffuse) return PBF_OK;
  return pbf_fail(PBF_ERROR_STATE,
                  "the solver has no spray, foam and bubbles; pbf_set_diffuse has it make them");
}

/* ---- Setting --------------------------------------------------------------------------------- */

/* All, or the youngest of those that there were; what is left over has made way. */
static void take_over(pbf_diffuse *to, const pbf_diffuse *from) {
  to->head = from->head;
  to->head.count = 0;
  const uint32_t count = from->head.count, room = to->desc.capacity;
  const uint32_t skipped = count > room ? count - room : 0;
  for (uint32_t n = skipped; n < count; ++n)
    to->particles[to->head.count++] = *pbf_diffuse_at(from, n);
  to->head.recycled += skipped;
}

static pbf_status set_diffuse(pbf_solver *solver, const pbf_diffuse_desc *theirs) {
  pbf_diffuse *made = NULL;
  pbf_diffuse_desc desc = {0};
  if (theirs) {
    pbf_status status = pbf_struct_in(&pbf_kind_diffuse_desc, theirs, &desc);
    if (status == PBF_OK) status = pbf_diffuse_check(&desc, solver->kind);
    if (status == PBF_OK) status = pbf_diffuse_allocate(solver, &desc, &made);
    if (status != PBF_OK) return status;
    made->work = &pbf_diffuse_in_steps;
    made->head.time = pbf_solver_time(solver);
    if (solver->diffuse) take_over(made, solver->diffuse);
  }
  pbf_diffuse_free(solver, solver->diffuse);
  solver->diffuse = made;
  pbf_rank_settings_note(solver, "pbf_set_diffuse", &desc, made ? sizeof desc : 0);
  return PBF_OK;
}

pbf_status pbf_set_diffuse(pbf_solver *solver, const pbf_diffuse_desc *desc) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, set_diffuse(solver, desc));
}

static pbf_status get_diffuse(const pbf_solver *solver, pbf_diffuse_desc *theirs) {
  pbf_status status = pbf_struct_check_out(&pbf_kind_diffuse_desc, theirs);
  if (status == PBF_OK) status = need(solver);
  if (status != PBF_OK) return status;
  pbf_struct_out(&pbf_kind_diffuse_desc, &solver->diffuse->desc, theirs, theirs->struct_size);
  return PBF_OK;
}

pbf_status pbf_get_diffuse(pbf_solver *solver, pbf_diffuse_desc *desc) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, get_diffuse(solver, desc));
}

/* ---- Counts ---------------------------------------------------------------------------------- */

static pbf_diffuse_info info_of(const pbf_diffuse *d) {
  uint32_t kinds[PBF_DIFFUSE_BUBBLE + 1] = {0, 0, 0};
  for (uint32_t n = 0; n < d->head.count; ++n) ++kinds[pbf_diffuse_at(d, n)->kind];
  return (pbf_diffuse_info){.struct_size = sizeof(pbf_diffuse_info),
                            .capacity = d->desc.capacity,
                            .count = d->head.count,
                            .spray = kinds[PBF_DIFFUSE_SPRAY],
                            .foam = kinds[PBF_DIFFUSE_FOAM],
                            .bubbles = kinds[PBF_DIFFUSE_BUBBLE],
                            .time = d->head.time,
                            .generated = d->head.generated,
                            .expired = d->head.expired,
                            .recycled = d->head.recycled};
}

static pbf_status get_info(const pbf_solver *solver, pbf_diffuse_info *theirs) {
  pbf_diffuse_info info = {0};
  pbf_status status = pbf_struct_check_out(&pbf_kind_diffuse_info, theirs);
  if (status != PBF_OK) return status;
  if (solver->diffuse) info = info_of(solver->diffuse);
  pbf_struct_out(&pbf_kind_diffuse_info, &info, theirs, theirs->struct_size);
  return PBF_OK;
}

pbf_status pbf_get_diffuse_info(pbf_solver *solver, pbf_diffuse_info *info) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, get_info(solver, info));
}

/* ---- The caller's own ------------------------------------------------------------------------ */

static pbf_status check_lives(const pbf_solver *solver, uint32_t count, const void *lives) {
  char number[PBF_NUMBER_SIZE];
  pbf_status status = pbf_check_pointer("lives", lives, pbf_element_size(solver));
  if (status == PBF_OK) status = pbf_values_check_numbers(solver, "lives", lives, count);
  for (uint32_t i = 0; status == PBF_OK && i < count; ++i) {
    const double life = pbf_value_at(lives, i, solver->kind.precision);
    if (!(life > 0))
      status = pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "lives[%u] is %s; it must be above 0", i,
                        pbf_text_number(number, life));
  }
  return status;
}

static pbf_status check_added(const pbf_solver *solver, uint32_t count, const void *positions,
                              const void *velocities, const void *lives) {
  const uint32_t size = pbf_element_size(solver), capacity = solver->diffuse->desc.capacity;
  if (count > capacity)
    return pbf_fail(PBF_ERROR_CAPACITY, "count is %u; desc.capacity of pbf_set_diffuse is %u",
                    count, capacity);
  if (count == 0) return PBF_OK;
  pbf_status status = pbf_check_pointer("positions", positions, size);
  if (status == PBF_OK) status = pbf_values_check_finite(solver, "positions", positions, count, 0);
  if (status == PBF_OK && velocities) status = pbf_check_pointer("velocities", velocities, size);
  if (status == PBF_OK && velocities)
    status = pbf_values_check_finite(solver, "velocities", velocities, count, 0);
  if (status == PBF_OK) status = check_lives(solver, count, lives);
  return status;
}

/* Its kind is found when it moves first. */
static pbf_status add(pbf_solver *solver, uint32_t count, const void *positions,
                      const void *velocities, const void *lives) {
  pbf_status status = need(solver);
  if (status == PBF_OK) status = check_added(solver, count, positions, velocities, lives);
  if (status != PBF_OK) return status;
  pbf_diffuse *d = solver->diffuse;
  const uint32_t dimension = solver->kind.dimension, precision = solver->kind.precision;
  const pbf_diffuse_walls walls = pbf_diffuse_walls_at(solver, d->head.time, 0);
  for (uint32_t i = 0; i < count; ++i) {
    pbf_diffuse_particle *p = pbf_diffuse_push(d);
    for (uint32_t k = 0; k < dimension; ++k) {
      const uint64_t at = (uint64_t)i * dimension + k;
      p->position[k] = pbf_value_at(positions, at, precision);
      if (velocities) p->velocity[k] = pbf_value_at(velocities, at, precision);
    }
    p->born = d->head.time;
    p->dies = pbf_diffuse_end(d->head.time, pbf_value_at(lives, i, precision));
    pbf_diffuse_keep_inside(solver, &walls, p);
    pbf_rank_settings_note(solver, "pbf_add_diffuse", p, sizeof *p);
  }
  return PBF_OK;
}

pbf_status pbf_add_diffuse(pbf_solver *solver, uint32_t count, const void *positions,
                           const void *velocities, const void *lives) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, add(solver, count, positions, velocities, lives));
}

static pbf_status shift(pbf_solver *solver, const double *way) {
  char number[PBF_NUMBER_SIZE];
  pbf_diffuse *d = solver->diffuse;
  pbf_status status = pbf_check_pointer("way", way, sizeof *way);
  if (status != PBF_OK) return status;
  for (uint32_t k = 0; k < solver->kind.dimension; ++k)
    if (!(fabs(way[k]) <= pbf_check_most))
      return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                      "way[%u] is %s; it must be finite, and at most 1e150 in size", k,
                      pbf_text_number(number, way[k]));
  for (uint32_t n = 0; d && n < d->head.count; ++n)
    for (uint32_t k = 0; k < solver->kind.dimension; ++k) {
      double *x = &pbf_diffuse_at(d, n)->position[k];
      *x = fmin(fmax(*x + way[k], -pbf_check_most), pbf_check_most);
    }
  pbf_rank_settings_note(solver, "pbf_shift_diffuse", way, solver->kind.dimension * sizeof *way);
  return PBF_OK;
}

pbf_status pbf_shift_diffuse(pbf_solver *solver, const double *way) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, shift(solver, way));
}
