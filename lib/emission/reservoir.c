/* Reservoirs as they are set. */
#include "reservoir.h"

#include <stdio.h>
#include <string.h>

#include "error.h"
#include "params.h"
#include "particles/phases.h"
#include "physics/spacing.h"
#include "solver/handles.h"
#include "solver/rank_settings.h"
#include "solver/solver_time.h"
#include "structs.h"
#include "text.h"

#define REAL(member, components, range) \
  { #member, offsetof(pbf_reservoir, member), components, range, 0 }
#define LENGTH(array) (sizeof(array) / sizeof((array)[0]))

static const pbf_real_rule reals[] = {
    REAL(depth, 1, PBF_ABOVE_ZERO),
    REAL(pressure, 1, PBF_AT_LEAST_ZERO),
};

/* ---- Checks ---------------------------------------------------------------------------------- */

pbf_status pbf_reservoir_check(const pbf_reservoir *r, uint32_t index, pbf_check_kind kind) {
  char label[32];
  const pbf_volume box = pbf_reservoir_box(r);
  snprintf(label, sizeof label, "reservoirs[%u]", index);
  pbf_status status = pbf_volume_check(&box, label, kind.dimension);
  if (status == PBF_OK) status = pbf_check_reals(reals, LENGTH(reals), label, r, kind);
  if (status == PBF_OK && r->depth > 2 * r->half_extents[1])
    status = pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                      "%s.depth is %.9g; it must be at most the height of its box, %.9g", label,
                      r->depth, 2 * r->half_extents[1]);
  return status;
}

/* The corners of the box are in the domain, but for rounding. */
static pbf_status check_corners(const pbf_volume_frame *box, uint32_t index,
                                const pbf_solver *solver) {
  const uint32_t n = solver->kind.dimension;
  const pbf_box domain = pbf_params_box(&solver->params, n, pbf_solver_time(solver));
  for (uint32_t corner = 0; corner < 1u << n; ++corner)
    for (uint32_t k = 0; k < n; ++k) {
      const double hair = 1e-6 * (domain.upper[k] - domain.lower[k]);
      double at = box->position[k];
      for (uint32_t axis = 0; axis < n; ++axis)
        at += (corner >> axis & 1 ? 1 : -1) * box->half[axis] * box->axes[axis][k];
      if (!(at >= domain.lower[k] - hair && at <= domain.upper[k] + hair))
        return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                        "reservoirs[%u] reaches to %.9g along axis %u; it must be inside the "
                        "domain, %.9g … %.9g",
                        index, at, k, domain.lower[k], domain.upper[k]);
    }
  return PBF_OK;
}

static pbf_status check_place(const pbf_reservoir *r, uint32_t index, const pbf_solver *solver) {
  const pbf_reservoir_frame f =
      pbf_reservoir_frame_of(r, solver->kind.dimension, pbf_derive_spacing(&solver->params));
  if (!(f.particles <= solver->capacity))
    return pbf_fail(PBF_ERROR_CAPACITY, "reservoirs[%u] holds %.9g particles; desc.capacity is %u",
                    index, f.particles, solver->capacity);
  if ((uint64_t)f.cells[0] * f.cells[1] > solver->capacity)
    return pbf_fail(
        PBF_ERROR_CAPACITY,
        "reservoirs[%u] has room for more particles in one layer than desc.capacity, %u", index,
        solver->capacity);
  pbf_status status = check_corners(&f.box, index, solver);
  if (status != PBF_OK) return status;
  return pbf_phases_check_number(solver->phases, "reservoirs", index, r->phase);
}

/* ---- Calls ----------------------------------------------------------------------------------- */

static pbf_status copy_in(const pbf_solver *solver, uint32_t count, const pbf_reservoir *theirs,
                          pbf_reservoir *ours) {
  if (count > PBF_MAX_RESERVOIRS)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "count is %u; it must be at most %u", count,
                    PBF_MAX_RESERVOIRS);
  if (count > 0 && !theirs) return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "reservoirs is null");
  const uint32_t first = count > 0 ? pbf_struct_size(theirs) : 0;
  for (uint32_t i = 0; i < count; ++i) {
    pbf_status status =
        pbf_struct_in_array(&pbf_kind_reservoir, "reservoirs", theirs, first, i, &ours[i]);
    if (status == PBF_OK) status = pbf_reservoir_check(&ours[i], i, solver->kind);
    if (status == PBF_OK) status = check_place(&ours[i], i, solver);
    if (status != PBF_OK) return status;
  }
  return PBF_OK;
}

static pbf_status set_reservoirs(pbf_solver *solver, uint32_t count, const pbf_reservoir *theirs) {
  pbf_reservoir ours[PBF_MAX_RESERVOIRS];
  pbf_emission *e;
  pbf_status status = copy_in(solver, count, theirs, ours);
  if (status != PBF_OK || (count == 0 && !solver->emission)) return status;
  status = pbf_emission_need(solver, &e);
  if (status != PBF_OK) return status;
  for (uint32_t i = 0; i < count; ++i) {
    const int goes_on = i < e->head.reservoir_count;
    ours[i].added = goes_on ? e->reservoirs[i].added : 0;
    ours[i].removed = goes_on ? e->reservoirs[i].removed : 0;
  }
  memset(e->reservoirs, 0, sizeof e->reservoirs);
  if (count > 0) memcpy(e->reservoirs, ours, count * sizeof *ours);
  e->head.reservoir_count = count;
  for (uint32_t i = 0; i < count; ++i) pbf_reservoir_clean(&ours[i], solver->kind.dimension);
  pbf_rank_settings_note(solver, "pbf_set_reservoirs", ours, count * sizeof *ours);
  pbf_emission_bound_stage(e);
  return PBF_OK;
}

pbf_status pbf_set_reservoirs(pbf_solver *solver, uint32_t count, const pbf_reservoir *reservoirs) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, set_reservoirs(solver, count, reservoirs));
}

static uint32_t count_of(const pbf_solver *solver) {
  return solver->emission ? solver->emission->head.reservoir_count : 0;
}

pbf_status pbf_get_reservoir_count(pbf_solver *solver, uint32_t *count) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, pbf_count_out(count_of(solver), count));
}

static pbf_status get_reservoir(const pbf_solver *solver, uint32_t index,
                                pbf_reservoir *reservoir) {
  pbf_status status = pbf_struct_check_out(&pbf_kind_reservoir, reservoir);
  if (status == PBF_OK && index >= count_of(solver))
    status = pbf_fail(PBF_ERROR_NOT_FOUND, "index is %u; the solver has %u reservoirs", index,
                      count_of(solver));
  if (status == PBF_OK)
    pbf_struct_out(&pbf_kind_reservoir, &solver->emission->reservoirs[index], reservoir,
                   reservoir->struct_size);
  return status;
}

pbf_status pbf_get_reservoir(pbf_solver *solver, uint32_t index, pbf_reservoir *reservoir) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, get_reservoir(solver, index, reservoir));
}

static pbf_reservoir initial(void) {
  return (pbf_reservoir){.struct_size = sizeof(pbf_reservoir),
                         .orientation = {0, 0, 0, 1},
                         .half_extents = {1, 1, 1},
                         .depth = 1};
}

void pbf_reservoir_clean(pbf_reservoir *reservoir, uint32_t dimension) {
  const pbf_reservoir clean = initial();
  for (uint32_t k = dimension; k < 3; ++k) {
    reservoir->position[k] = clean.position[k];
    reservoir->half_extents[k] = clean.half_extents[k];
  }
}

pbf_status pbf_reservoir_init(pbf_reservoir *reservoir, uint32_t struct_size) {
  const pbf_reservoir ours = initial();
  if (!reservoir) return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "reservoir is null");
  pbf_status status = pbf_struct_check_size(&pbf_kind_reservoir, struct_size);
  if (status == PBF_OK) pbf_struct_out(&pbf_kind_reservoir, &ours, reservoir, struct_size);
  return status;
}
