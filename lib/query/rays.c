/* Where rays meet the surface, and how high it is. */
#include <pbf/query.h>

#include <math.h>

#include "check.h"
#include "error.h"
#include "points.h"
#include "solver/handles.h"
#include "sums.h"
#include "text.h"

/* `direction` is a unit vector. */
typedef struct ray {
  double origin[3], direction[3];
  double begin, end; /* what of it can meet anything */
} ray;

static void point_at(const ray *r, double t, double point[3]) {
  for (int k = 0; k < 3; ++k) point[k] = r->origin[k] + t * r->direction[k];
}

/* ---- Going along a ray ----------------------------------------------------------------------- */

/* To where particles are near; end < begin where that is nowhere. */
static void clip(const pbf_query_index *index, ray *r) {
  for (uint32_t k = 0; k < index->dimension; ++k) {
    const double lower = index->lower[k] - index->radius - r->origin[k];
    const double upper = index->upper[k] + index->radius - r->origin[k];
    if (r->direction[k] == 0) {
      if (lower > 0 || upper < 0) r->end = -INFINITY;
      continue;
    }
    const double a = lower / r->direction[k], b = upper / r->direction[k];
    r->begin = fmax(r->begin, fmin(a, b));
    r->end = fmin(r->end, fmax(a, b));
  }
}

/* Where the ray leaves the cell that the place is at. The outermost cells have no outer end. */
static double leave_cell(const pbf_query_place *place, const ray *r, double t) {
  const pbf_query_index *index = place->index;
  double leaves = INFINITY;
  for (uint32_t k = 0; k < index->dimension; ++k) {
    const uint32_t cell = place->cell[k] - PBF_QUERY_REACH;
    const double lower = index->lower[k] + cell * index->cell;
    const int is_last = place->cell[k] + 1 + PBF_QUERY_REACH == index->cells[k];
    if (r->direction[k] > 0 && !is_last)
      leaves = fmin(leaves, (lower + index->cell - r->origin[k]) / r->direction[k]);
    if (r->direction[k] < 0 && cell > 0)
      leaves = fmin(leaves, (lower - r->origin[k]) / r->direction[k]);
  }
  return fmax(leaves, t) + 1e-6 * index->cell; /* into the next one, whatever is rounded */
}

/* Whether the cell is one of those that hold all that is farther out than cells are counted. Images
 * beyond periodic faces are near others, and count as in cells of their own. */
static int has_no_end(const pbf_query_place *place) {
  const pbf_query_index *index = place->index;
  int found = 0;
  for (uint32_t k = 0; k < index->dimension; ++k) {
    const int is_last = place->cell[k] + 1 + PBF_QUERY_REACH == index->cells[k];
    if (index->period[k] > 0) return 0;
    found |= is_last && index->lower[k] + index->cells[k] * index->cell < index->upper[k];
  }
  return found;
}

/* From one place to another along an axis, or to the nearest of its images. */
static double way_along(const pbf_query_index *index, uint32_t axis, double way) {
  const double period = index->period[axis], to = fabs(way);
  if (!(period > 0)) return to;
  const double beyond = to - period * floor(to / period);
  return fmin(beyond, period - beyond);
}

/* How far the nearest of some particles is. */
static double nearest_of(const pbf_query_index *index, uint32_t begin, uint32_t end,
                         const double point[3]) {
  const uint32_t n = index->dimension;
  double nearest = INFINITY;
  for (uint32_t i = begin; i < end; ++i) {
    double square = 0;
    for (uint32_t k = 0; k < n; ++k) {
      const double x = pbf_query_number(index->points, (uint64_t)i * n + k, index->precision);
      const double to = way_along(index, k, x - point[k]);
      square += to * to;
    }
    nearest = fmin(nearest, square);
  }
  return sqrt(nearest);
}

/* From how far on a particle near the cell can contribute to the density at the place. */
static double gap_at(const pbf_query_place *place, const ray *r, double t) {
  double point[3], nearest = INFINITY;
  point_at(r, t, point);
  for (uint32_t run = 0; run < place->count; ++run)
    nearest = fmin(nearest,
                   nearest_of(place->index, place->runs[run].begin, place->runs[run].end, point));
  return nearest - place->index->radius;
}

/* From where nothing is near to a cell before those that have something near, whichever particle is
 * the nearest: what flew far away may leave a million of empty cells between. */
static double leap(const pbf_query_index *index, const ray *r, double t) {
  enum { CELLS = 8 }; /* more than the corner of the farthest cell that is looked at */
  double point[3];
  point_at(r, t, point);
  return t + nearest_of(index, 0, index->count, point) - CELLS * index->cell;
}

/* Of how many empty cells it is worth a look at all particles. */
static uint32_t cells_worth_a_leap(const pbf_query_index *index) { return 32 + index->count / 256; }

static double density_at(pbf_query_place *place, const ray *r, double t) {
  double point[3];
  point_at(r, t, point);
  return pbf_query_density(place, point, NULL);
}

/* Where the density is that of the surface between `a` and `b`, at which it is `at_a` and `at_b`
 * beyond that, on both sides: by the false position, an end that stays counting half (Illinois). */
static double refine(pbf_query_place *place, const ray *r, double a, double at_a, double b,
                     double at_b) {
  enum { MOST = 20 };
  const double enough = 1e-6;
  for (int i = 0; i < MOST; ++i) {
    const double c = b - at_b * (b - a) / (at_b - at_a);
    const double at_c = density_at(place, r, c) - PBF_QUERY_SURFACE;
    if (fabs(at_c) < enough) return c;
    if ((at_c < 0) == (at_b < 0)) {
      at_a *= 0.5;
    } else {
      a = b;
      at_a = at_b;
    }
    b = c;
    at_b = at_c;
  }
  return b;
}

/* Where to look next: by a step, or beyond where there is nothing. */
static double next_look(const pbf_query_place *place, const ray *r, double t, double density) {
  const pbf_query_index *index = place->index;
  const double step = t + 0.5 * index->spacing;
  if (place->is_set && place->count == 0) return leave_cell(place, r, t);
  if (density > 0 || !has_no_end(place)) return step;
  return fmax(step, t + gap_at(place, r, t));
}

/* The first meeting's distance, or INFINITY. */
static double meet(pbf_query_place *place, ray *r) {
  const uint32_t worth = cells_worth_a_leap(place->index);
  clip(place->index, r);
  double t = r->begin;
  if (!(t <= r->end)) return INFINITY;
  double beyond = density_at(place, r, t) - PBF_QUERY_SURFACE;
  uint32_t empty = 0; /* cells, since the last leap */
  while (t < r->end) {
    double next = next_look(place, r, t, beyond + PBF_QUERY_SURFACE);
    empty = place->is_set && place->count == 0 ? empty + 1 : 0;
    if (empty == worth) {
      next = fmax(next, leap(place->index, r, t));
      empty = 0;
    }
    next = fmin(next, r->end);
    const double beyond_next = density_at(place, r, next) - PBF_QUERY_SURFACE;
    if ((beyond_next < 0) != (beyond < 0)) return refine(place, r, t, beyond, next, beyond_next);
    if (!(next > t)) break; /* too far out for steps of this length */
    t = next;
    beyond = beyond_next;
  }
  return INFINITY;
}

/* ---- Rays ------------------------------------------------------------------------------------ */

/* Reads each number once: arrays may overlap, and another thread may write there. */
static double read_direction(const pbf_solver *solver, const double *direction, ray *r) {
  double square = 0;
  for (uint32_t k = 0; k < solver->kind.dimension; ++k) {
    r->direction[k] = ((const volatile double *)direction)[k];
    square += r->direction[k] * r->direction[k];
  }
  const double length = sqrt(square);
  for (uint32_t k = 0; k < solver->kind.dimension; ++k) r->direction[k] /= length;
  return length;
}

static int is_length(double length) { return length > 0 && isfinite(length); }

static pbf_status check_direction(const pbf_solver *solver, const double *direction, uint32_t i) {
  ray r;
  const double length = read_direction(solver, direction, &r);
  char number[PBF_NUMBER_SIZE];
  if (is_length(length)) return PBF_OK;
  return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                  "directions[%u] has the length %s; it must be above 0 and finite", i,
                  pbf_text_number(number, length));
}

static pbf_status check_rays(const pbf_solver *solver, uint32_t count, const double *origins,
                             const double *directions, double length, const double *distances,
                             const double *normals) {
  char number[PBF_NUMBER_SIZE];
  pbf_status status = pbf_query_check_points(solver, "origins", count, origins);
  if (status == PBF_OK) status = pbf_query_check_points(solver, "directions", count, directions);
  for (uint32_t i = 0; i < count && status == PBF_OK; ++i)
    status = check_direction(solver, directions + (uint64_t)i * solver->kind.dimension, i);
  if (status == PBF_OK && !(length > 0))
    status = pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "length is %s; it must be above 0, or INFINITY",
                      pbf_text_number(number, length));
  if (status == PBF_OK && count > 0)
    status = pbf_check_pointer("distances", distances, sizeof *distances);
  if (status == PBF_OK && count > 0 && normals)
    status = pbf_check_pointer("normals", normals, sizeof *normals);
  return status;
}

/* Against the gradient of the density. */
static void write_normal(pbf_query_place *place, const ray *r, double distance, double *normal) {
  const uint32_t n = place->index->dimension;
  double point[3], gradient[3] = {0, 0, 0}, square = 0;
  for (uint32_t k = 0; k < n; ++k) normal[k] = 0;
  if (isinf(distance)) return;
  point_at(r, distance, point);
  pbf_query_density(place, point, gradient);
  for (uint32_t k = 0; k < n; ++k) square += gradient[k] * gradient[k];
  for (uint32_t k = 0; k < n && square > 0; ++k) normal[k] = -gradient[k] / sqrt(square);
}

/* What was a ray when it was checked may be none by now: then it meets nothing. */
static int read_ray(const pbf_solver *solver, const double *origin, const double *direction,
                    ray *r) {
  int is_finite = 1;
  for (uint32_t k = 0; k < solver->kind.dimension; ++k) {
    r->origin[k] = ((const volatile double *)origin)[k];
    is_finite &= isfinite(r->origin[k]);
  }
  return is_length(read_direction(solver, direction, r)) && is_finite;
}

static pbf_status cast(pbf_solver *solver, uint32_t count, const double *origins,
                       const double *directions, double length, double *distances,
                       double *normals) {
  const uint32_t n = solver->kind.dimension;
  pbf_query_place place = {0};
  pbf_status status = check_rays(solver, count, origins, directions, length, distances, normals);
  if (status == PBF_OK) status = pbf_query_index_get(solver, 0, &place.index);
  for (uint32_t i = 0; i < count && status == PBF_OK; ++i) {
    ray r = {.end = length};
    const uint64_t at = (uint64_t)i * n;
    const int meets = read_ray(solver, origins + at, directions + at, &r);
    const double distance = meets && place.index->count > 0 ? meet(&place, &r) : INFINITY;
    distances[i] = distance;
    if (normals) write_normal(&place, &r, distance, normals + at);
  }
  return status;
}

pbf_status pbf_cast_rays(pbf_solver *solver, uint32_t count, const double *origins,
                         const double *directions, double length, double *distances,
                         double *normals) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, cast(solver, count, origins, directions, length, distances, normals));
}

/* ---- Levels ---------------------------------------------------------------------------------- */

/* A unit vector against gravity. */
static pbf_status find_up(const pbf_solver *solver, double up[3]) {
  double square = 0;
  for (uint32_t k = 0; k < solver->kind.dimension; ++k)
    square += solver->params.gravity[k] * solver->params.gravity[k];
  if (!(square > 0))
    return pbf_fail(PBF_ERROR_STATE,
                    "params.gravity is 0, by which there is no up or down and no level");
  for (uint32_t k = 0; k < 3; ++k)
    up[k] = k < solver->kind.dimension ? -solver->params.gravity[k] / sqrt(square) : 0;
  return PBF_OK;
}

/* Downwards from above all particles to below them. */
static double level_at(pbf_query_place *place, const double *point, const double up[3]) {
  const pbf_query_index *index = place->index;
  double top = 0, bottom = 0, height = 0;
  ray r = {{0}, {0}, 0, 0};
  for (uint32_t k = 0; k < index->dimension; ++k) {
    const double a = up[k] * index->lower[k], b = up[k] * index->upper[k];
    top += fmax(a, b);
    bottom += fmin(a, b);
    height += up[k] * point[k];
  }
  top += index->radius;
  for (uint32_t k = 0; k < index->dimension; ++k) {
    r.origin[k] = point[k] + (top - height) * up[k];
    r.direction[k] = -up[k];
  }
  r.end = top - bottom + index->radius;
  const double distance = meet(place, &r);
  return isinf(distance) ? NAN : top - distance;
}

static pbf_status get_levels(pbf_solver *solver, uint32_t count, const double *points,
                             double *levels) {
  const uint32_t n = solver->kind.dimension;
  pbf_query_place place = {0};
  double up[3];
  pbf_status status = find_up(solver, up);
  if (status == PBF_OK) status = pbf_query_check_points(solver, "points", count, points);
  if (status == PBF_OK && count > 0) status = pbf_check_pointer("levels", levels, sizeof *levels);
  if (status == PBF_OK) status = pbf_query_index_get(solver, 0, &place.index);
  for (uint32_t i = 0; i < count && status == PBF_OK; ++i)
    levels[i] = place.index->count > 0 ? level_at(&place, points + (uint64_t)i * n, up) : NAN;
  return status;
}

pbf_status pbf_get_levels(pbf_solver *solver, uint32_t count, const double *points,
                          double *levels) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, get_levels(solver, count, points, levels));
}
