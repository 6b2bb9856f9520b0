#include "entering.h"

#include <math.h>

#include "guided.h"
#include "new_particles.h"
#include "physics/spacing.h"
#include "solver/backend_call.h"
#include "solver/ids.h"
#include "solver/solver_time.h"

/* A particle enters within the way of a spacing. */
static double part_outside(const pbf_solver *solver, const pbf_guided *g) {
  return fmax(1 - g->ahead / pbf_derive_spacing(&solver->params), 0);
}

static void begin(const pbf_solver *solver, pbf_entering *entering) {
  const double spacings = solver->emission->work->speed(solver) * pbf_part_time_step(solver) /
                          pbf_derive_spacing(&solver->params);
  *entering = (pbf_entering){.struct_size = sizeof *entering, .first_id = UINT32_MAX};
  entering->kept = fmax(1 - 2 * spacings, 0); /* what lasts longer than its stream takes to enter
                                                 would press what comes next */
  for (int k = 0; k < 3; ++k) {
    const int ends = k < (int)solver->kind.dimension && !(solver->params.periodic >> k & 1);
    entering->lower[k] = ends ? INFINITY : -INFINITY;
    entering->upper[k] = -entering->lower[k];
  }
}

/* With what is within h of it, wherever rounding has put that. */
static void add(const pbf_solver *solver, const pbf_guided *g, pbf_entering *entering) {
  const double reach = 1.01 * solver->params.smoothing_radius;
  double place[3];
  pbf_guided_place(g, place);
  entering->first_id = g->id < entering->first_id ? g->id : entering->first_id;
  entering->last_id = g->id > entering->last_id ? g->id : entering->last_id;
  for (int k = 0; k < 3; ++k) {
    entering->lower[k] = fmin(entering->lower[k], place[k] - reach);
    entering->upper[k] = fmax(entering->upper[k], place[k] + reach);
  }
}

/* Ids ascend: those that their stream moves go h, and on the next 2 h are twice as many, which came
 * before. */
static uint32_t first_of_stream(const pbf_entering *entering) {
  const uint64_t before = 2 * ((uint64_t)entering->last_id - entering->first_id + 1);
  return before < entering->first_id ? entering->first_id - (uint32_t)before : 0;
}

/* All particles that their stream still moves: also those of which nothing is outside any more, for
 * what solids and the stream contribute to their densities is allowed for until they are h away. */
int pbf_emission_find_entering(const pbf_solver *solver, pbf_entering *entering) {
  const pbf_emission *e = solver->emission;
  if (e->head.guided_count == 0) return 0;
  begin(solver, entering);
  for (uint32_t i = 0; i < e->head.guided_count; ++i) add(solver, &e->guided[i], entering);
  entering->stream_first_id = first_of_stream(entering);
  return 1;
}

static uint32_t present(const pbf_solver *solver) {
  const pbf_emission *e = solver->emission;
  uint32_t row, count = 0;
  for (uint32_t i = 0; i < e->head.guided_count; ++i)
    count += (uint32_t)pbf_ids_find(solver, e->guided[i].id, &row);
  return count;
}

/* The rows from the first to the last of them. Others between these keep what is allowed for of
 * them, which is read where there are any. */
pbf_status pbf_emission_tell_entering(pbf_solver *solver, const pbf_entering *entering) {
  pbf_emission *e = solver->emission;
  uint32_t first, last, row;
  pbf_ids_find(solver, entering->first_id, &first);
  const uint32_t end = pbf_ids_find(solver, entering->last_id, &last) ? last + 1 : last;
  const pbf_rows rows = pbf_ids_rows(solver, first, end - first);
  if (rows.count == 0) return PBF_OK;
  pbf_status status = pbf_emission_reserve(solver, e, rows.count);
  if (status == PBF_OK && rows.count > present(solver))
    status = pbf_backend_result(
        solver, solver->api.read(solver->backend, PBF_BACKEND_FIELD_OVERLAP, &rows, e->particles),
        "read");
  if (status != PBF_OK) return status;
  for (uint32_t i = 0; i < e->head.guided_count; ++i)
    if (pbf_ids_find(solver, e->guided[i].id, &row))
      pbf_emission_put(solver, e->particles, row - first, part_outside(solver, &e->guided[i]));
  status = solver->api.write(solver->backend, PBF_BACKEND_FIELD_OVERLAP, &rows, e->particles);
  return pbf_backend_result(solver, status, "write");
}
