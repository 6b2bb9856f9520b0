#include "guided.h"

#include <math.h>

#include "new_particles.h"
#include "opening.h"
#include "params.h"
#include "particles/values.h"
#include "physics/spacing.h"
#include "solver/backend_call.h"
#include "solver/ids.h"
#include "solver/solid.h"
#include "solver/solver_time.h"

double pbf_guided_speed(const pbf_guided *guided) {
  const double *v = guided->velocity;
  return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

void pbf_guided_place(const pbf_guided *guided, double place[3]) {
  const double speed = pbf_guided_speed(guided);
  for (int k = 0; k < 3; ++k)
    place[k] = guided->from[k] + guided->ahead * (guided->velocity[k] / speed);
}

/* ---- Solids ---------------------------------------------------------------------------------- */

/* How far its line goes before it runs into the solid, infinite where that is farther than `most`.
 * An opening may lie in a solid, which its stream has to have left before. */
static double way_to_solid(const pbf_solid *solid, const pbf_guided *g, double most,
                           double spacing) {
  const double least = spacing / 16, speed = pbf_guided_speed(g);
  double outside = -1; /* so far it is outside, from where it has left the solid; none: below 0 */
  double at = 0;
  for (int looks = 1000; at <= most && looks > 0; --looks) {
    double place[3], normal[3];
    for (int k = 0; k < 3; ++k) place[k] = g->from[k] + at * (g->velocity[k] / speed);
    const double distance = pbf_solid_distance(solid, place, normal);
    if (outside >= 0 && distance < -least) return outside;
    if (distance >= 0) outside = at + distance;
    at += fmax(fabs(distance), 2 * least);
  }
  return INFINITY;
}

static double way_to_walls(const pbf_solver *solver, const pbf_box *box, const pbf_guided *g) {
  const double speed = pbf_guided_speed(g);
  double way = INFINITY;
  for (uint32_t k = 0; k < solver->kind.dimension; ++k) {
    const double to = g->velocity[k] > 0 ? box->upper[k] - g->from[k] : box->lower[k] - g->from[k];
    if (solver->params.periodic >> k & 1 || !(fabs(g->velocity[k]) > 0)) continue;
    way = fmin(way, fmax(to / g->velocity[k], 0) * speed);
  }
  return way;
}

/* How far before solids streams end, by source, and most of all. */
typedef struct stream_ends {
  pbf_guided_end end;
  double half; /* of a spacing */
  double room[PBF_MAX_EMITTERS], most;
} stream_ends;

/* A particle at a solid is half a spacing off it; so near to one a stream moves none. And it moves
 * none so near that what is between its front and the solid has no room to leave as fast as it
 * comes: that would be thrown aside, as from under a piston. */
static stream_ends ends_of(const pbf_solver *solver, pbf_guided_end end) {
  const double spacing = pbf_derive_spacing(&solver->params);
  const pbf_emission *e = solver->emission;
  stream_ends ends = {.end = end, .half = spacing / 2, .most = spacing / 2};
  for (uint32_t i = 0; i < e->head.source_count; ++i) {
    const pbf_opening opening =
        pbf_opening_of(&e->sources[i].emitter, solver->kind.dimension, spacing);
    ends.room[i] = ends.half + (end == PBF_GUIDED_STOPS ? 0 : pbf_opening_gap(&opening));
    ends.most = fmax(ends.most, ends.room[i]);
  }
  return ends;
}

/* A particle goes half a spacing where there is as much, and always an eighth: the next row would
 * else find it in the opening. */
static double least_way(const stream_ends *ends, double way) {
  if (ends->end == PBF_GUIDED_STOPS) return 0;
  return fmax(fmin(ends->half, way - ends->half), ends->half / 4);
}

static void end_before(const stream_ends *ends, double way, pbf_guided *g) {
  const double free = fmax(way - ends->room[g->source], least_way(ends, way));
  if (free < g->ahead) g->ahead = ends->end == PBF_GUIDED_STOPS ? free : INFINITY;
}

/* The ball around all lines: most colliders of a large scene are not near it. */
static double ball_around(const pbf_guided *guided, uint32_t count, double centre[3]) {
  double lower[3] = {INFINITY, INFINITY, INFINITY}, upper[3] = {-INFINITY, -INFINITY, -INFINITY};
  double square = 0, longest = 0;
  for (uint32_t i = 0; i < count; ++i) {
    if (!(guided[i].ahead < INFINITY)) continue;
    longest = fmax(longest, guided[i].ahead);
    for (int k = 0; k < 3; ++k) {
      lower[k] = fmin(lower[k], guided[i].from[k]);
      upper[k] = fmax(upper[k], guided[i].from[k]);
    }
  }
  for (int k = 0; k < 3; ++k) {
    centre[k] = 0.5 * (lower[k] + upper[k]);
    square += 0.25 * (upper[k] - lower[k]) * (upper[k] - lower[k]);
  }
  return sqrt(square) + longest;
}

void pbf_guided_meet_solids(const pbf_solver *solver, pbf_guided *guided, uint32_t count,
                            pbf_guided_end end) {
  const double spacing = pbf_derive_spacing(&solver->params), now = pbf_solver_time(solver);
  const pbf_box box = pbf_params_box(&solver->params, solver->kind.dimension, now);
  const stream_ends ends = ends_of(solver, end);
  double centre[3];
  for (uint32_t i = 0; i < count; ++i)
    end_before(&ends, way_to_walls(solver, &box, &guided[i]), &guided[i]);
  if (solver->collider_count == 0 || count == 0) return;
  const double radius = ball_around(guided, count, centre) + ends.most;
  for (uint32_t s = 0; s < solver->collider_count; ++s) {
    const pbf_solid solid = pbf_solid_at(solver, s, now);
    if (pbf_solid_is_beyond(&solid, centre, radius)) continue;
    for (uint32_t i = 0; i < count; ++i) {
      pbf_guided *g = &guided[i];
      const double most = g->ahead + ends.room[g->source];
      if (!(most < INFINITY) || pbf_solid_is_beyond(&solid, g->from, most)) continue;
      end_before(&ends, way_to_solid(&solid, g, most, spacing), g);
    }
  }
}

/* ---- Positions that are set ------------------------------------------------------------------ */

/* Those on their way that are among the rows; how many lie between the first and the last. */
static uint32_t find_among(const pbf_solver *solver, uint32_t first, uint32_t count,
                           uint32_t *begin) {
  const pbf_emission *e = solver->emission;
  uint32_t row, end = 0;
  *begin = UINT32_MAX;
  for (uint32_t i = 0; i < e->head.guided_count; ++i) {
    if (!pbf_ids_find(solver, e->guided[i].id, &row) || row < first || row - first >= count)
      continue;
    *begin = row < *begin ? row : *begin;
    end = row >= end ? row + 1 : end;
  }
  return end > *begin ? end - *begin : 0;
}

pbf_status pbf_guided_keep(pbf_solver *solver, uint32_t first, uint32_t count) {
  pbf_emission *e = solver->emission;
  uint32_t begin;
  const uint32_t among = find_among(solver, first, count, &begin);
  if (among == 0) return PBF_OK;
  pbf_status status = pbf_emission_reserve(solver, e, among);
  if (status != PBF_OK) return status;
  const pbf_rows rows = pbf_ids_rows(solver, begin, among);
  return pbf_backend_result(
      solver, solver->api.read(solver->backend, PBF_FIELD_POSITION, &rows, e->particles), "read");
}

void pbf_guided_move(pbf_solver *solver, uint32_t first, uint32_t count, const void *positions) {
  pbf_emission *e = solver->emission;
  const pbf_check_kind *kind = &solver->kind;
  uint32_t begin, row;
  if (find_among(solver, first, count, &begin) == 0) return;
  for (uint32_t i = 0; i < e->head.guided_count; ++i) {
    pbf_guided *g = &e->guided[i];
    if (!pbf_ids_find(solver, g->id, &row) || row < first || row - first >= count) continue;
    for (uint32_t k = 0; k < kind->dimension; ++k)
      g->from[k] +=
          pbf_value_at(positions, (uint64_t)(row - first) * kind->dimension + k, kind->precision) -
          pbf_value_at(e->particles, (uint64_t)(row - begin) * kind->dimension + k,
                       kind->precision);
  }
}
