#include "entering.h"

#include <math.h>

#include "emitter.h"
#include "guided.h"
#include "new_particles.h"
#include "opening.h"
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

/* What a source's stream still moves: the opening, and a box around it. */
typedef struct stream {
  pbf_opening opening;
  double lower[3], upper[3];
} stream;

static stream stream_of(const pbf_solver *solver, const pbf_source *source) {
  const pbf_opening opening =
      pbf_opening_of(&source->emitter, solver->kind.dimension, pbf_derive_spacing(&solver->params));
  return (stream){opening, {INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}

/* Returns whether it is of one lattice with what leaves now. */
static int take_in(stream *s, const pbf_guided *g) {
  double place[3];
  pbf_guided_place(g, place);
  for (int k = 0; k < 3; ++k) {
    s->lower[k] = fmin(s->lower[k], place[k]);
    s->upper[k] = fmax(s->upper[k], place[k]);
  }
  return pbf_opening_fits(&s->opening, g->from, g->velocity);
}

/* By as much as the particles of one are. */
static int are_apart(const stream *one, const stream *other) {
  const double distance = 0.999 * one->opening.spacing;
  for (uint32_t k = 0; k < one->opening.dimension; ++k)
    if (one->lower[k] >= other->upper[k] + distance || other->lower[k] >= one->upper[k] + distance)
      return 1;
  return 0;
}

static int share(const stream *one, const stream *other) {
  return pbf_emitters_share(one->opening.emitter, other->opening.emitter, one->opening.dimension);
}

/* Those of one opening take turns, as long as it carries all of them. */
static int is_carried(const stream *streams, uint32_t count, uint32_t number) {
  const pbf_opening *o = &streams[number].opening;
  const double column = o->dimension == 3 ? o->spacing * o->spacing : o->spacing, hair = 1e-6;
  double rate = 0;
  for (uint32_t i = 0; i < count; ++i)
    if (share(&streams[i], &streams[number])) rate += streams[i].opening.rate;
  return rate <= (1 + hair) * (double)o->columns * column * o->speed;
}

static int are_beside(const stream *streams, uint32_t count) {
  for (uint32_t i = 0; i < count; ++i)
    for (uint32_t j = 0; j < i; ++j)
      if (!are_apart(&streams[i], &streams[j]) &&
          !(share(&streams[i], &streams[j]) && is_carried(streams, count, i)))
        return 0;
  return 1;
}

/* Streams that are lattices make no densities above that at rest: where they are denser solids or
 * other fluid hold them up, and that is to press. In a pipe with a neck what was allowed for of it
 * would go on with the fluid, and press it ever more. */
static int are_lattices(const pbf_solver *solver, const pbf_emission *e) {
  stream streams[PBF_MAX_EMITTERS];
  int are = 1;
  for (uint32_t i = 0; i < e->head.source_count; ++i)
    streams[i] = stream_of(solver, &e->sources[i]);
  for (uint32_t i = 0; i < e->head.guided_count && are; ++i)
    are = take_in(&streams[e->guided[i].source], &e->guided[i]);
  return are && are_beside(streams, e->head.source_count);
}

/* All particles that their stream still moves: also those of which nothing is outside any more, for
 * what solids and the stream contribute to their densities is allowed for until they are h away. */
int pbf_emission_find_entering(const pbf_solver *solver, pbf_entering *entering) {
  const pbf_emission *e = solver->emission;
  if (e->head.guided_count == 0) return 0;
  begin(solver, entering);
  for (uint32_t i = 0; i < e->head.guided_count; ++i) add(solver, &e->guided[i], entering);
  entering->stream_first_id = are_lattices(solver, e) ? UINT32_MAX : first_of_stream(entering);
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
