#include "prestabilize.h"

#include <math.h>

#include "backend_call.h"
#include "ids.h"
#include "memory.h"
#include "overlap.h"
#include "particles/coincident.h"
#include "physics/motion.h"
#include "physics/prestabilization.h"
#include "physics/spacing.h"
#include "solver_time.h"
#include "text.h"

/* Positions alone are projected onto the density constraint, as Macklin et al. do before a step
 * (Unified Particle Physics for Real-Time Applications, 2014, section 4.4): what a step corrects of
 * an error becomes velocity, error times h / dt, which is unphysical.
 * physics/prestabilization.h measures; here is when and how often the backend projects. */

/* Cells are sorted and the error is measured anew for each pass. Fluid that must rise by tens of
 * layers needs hundreds of passes, for one moves it by a few. MAX_STALLED passes that gain next to
 * nothing are the end, as where there is more fluid than free volume. */
enum { ITERATIONS = 8, MAX_PASSES = 400, MAX_STALLED = 8 };
static const double min_gain = 0.01;

/* The error at which the passes end, of the one at which they begin: less than steps leave. */
static const double remaining_part = 0.25;

/* With more neighbours the passes would take minutes; no fluid is meant to be so dense. */
static const double max_neighbors_mean = 1000;

static pbf_status measure(pbf_solver *solver, pbf_stats *stats, double *error) {
  *stats = (pbf_stats){.struct_size = sizeof *stats};
  pbf_status status =
      pbf_backend_result(solver, solver->api.get_stats(solver->backend, stats), "get_stats");
  *error = pbf_density_error(stats);
  return status;
}

static void warn(const pbf_solver *solver, double error) {
  char text[200];
  pbf_text_write(
      text, sizeof text,
      "pre-stabilization leaves a mean density error of %.3g: there may be too little room, or "
      "too much fluid in too little of it, for params.spacing",
      error);
  solver->log(solver->log_user, PBF_LOG_WARNING, text);
}

static uint64_t positions_bytes(const pbf_solver *solver) {
  return solver->count * pbf_point_bytes(solver);
}

static pbf_status write_rows(pbf_solver *solver, const void *positions) {
  const pbf_rows rows = pbf_ids_rows(solver, 0, solver->count);
  ++solver->generation;
  return pbf_backend_result(
      solver, solver->api.write(solver->backend, PBF_FIELD_POSITION, &rows, positions), "write");
}

static pbf_status read_rows(pbf_solver *solver, void **positions) {
  pbf_status status = pbf_memory_allocate(&solver->allocator, positions_bytes(solver),
                                          "positions before pre-stabilization", positions);
  if (status != PBF_OK) return status;
  const pbf_rows rows = pbf_ids_rows(solver, 0, solver->count);
  return pbf_backend_result(
      solver, solver->api.read(solver->backend, PBF_FIELD_POSITION, &rows, *positions), "read");
}

static void free_rows(const pbf_solver *solver, void **positions) {
  pbf_memory_free(&solver->allocator, *positions, positions_bytes(solver));
  *positions = NULL;
}

/* Two particles at a point push each other to no side: passes would leave them together, and a
 * later step throw them apart. What has come in several calls may lie upon each other, up to
 * rounding. */
static pbf_status set_apart(pbf_solver *solver, const void *positions) {
  const double grain = pbf_derive_spacing(&solver->params) / 1024;
  pbf_distinct distinct;
  pbf_status status = pbf_distinct_positions(solver, positions, solver->count, grain, &distinct);
  if (status == PBF_OK && distinct.copy) {
    status = write_rows(solver, distinct.copy);
    solver->placement.places |= PBF_PLACES_PARTED;
  }
  pbf_distinct_free(solver, &distinct);
  return status;
}

/* Where they are before anything moves them. */
static pbf_status keep_positions(pbf_solver *solver, pbf_before_projection *before) {
  if (before->positions) return PBF_OK;
  pbf_status status = read_rows(solver, &before->positions);
  if (status == PBF_OK) return set_apart(solver, before->positions);
  pbf_prestabilize_accept(solver, before);
  return status;
}

/* The first pass takes all out of solids and walls: rows across a face come to one point of it. */
static pbf_status set_apart_at_faces(pbf_solver *solver) {
  void *positions = NULL;
  pbf_status status = read_rows(solver, &positions);
  if (status == PBF_OK) status = set_apart(solver, positions);
  free_rows(solver, &positions);
  return status;
}

/* The least errors so far. */
typedef struct least_errors {
  double mean, max;
} least_errors;

/* Whether one of them has become less. */
static int improve(least_errors *least, const pbf_stats *stats) {
  const int mean = stats->density_error_mean < (1 - min_gain) * least->mean;
  const int max = stats->density_error_max < (1 - min_gain) * least->max;
  if (mean) least->mean = stats->density_error_mean;
  if (max) least->max = stats->density_error_max;
  return mean || max;
}

/* At least one pass, whatever the error, where walls have jumped or particles been set apart. */
static pbf_status project(pbf_solver *solver, int jumped, pbf_before_projection *before) {
  const int at_least = jumped || solver->placement.places & PBF_PLACES_PARTED;
  double wanted = solver->params.prestabilization, max_error = wanted, error;
  least_errors least = {INFINITY, INFINITY};
  pbf_stats stats;
  for (int pass = 0, stalled = 0; pass < MAX_PASSES; ++pass) {
    pbf_status status = measure(solver, &stats, &error);
    if (status != PBF_OK || (error <= max_error && pass >= at_least)) return status;
    stalled = improve(&least, &stats) ? 0 : stalled + 1;
    if (stats.neighbors_mean > max_neighbors_mean || stalled == MAX_STALLED) break;
    status = keep_positions(solver, before);
    if (status != PBF_OK) return status;
    status = solver->api.project(solver->backend, pbf_solver_time(solver), ITERATIONS);
    status = pbf_backend_result(solver, status, "project");
    if (status == PBF_OK && pass == 0) status = set_apart_at_faces(solver);
    if (status != PBF_OK) return status;
    ++solver->generation;
    max_error = remaining_part * wanted;
  }
  if (stats.density_error_mean > wanted) warn(solver, stats.density_error_mean);
  if (error > wanted) pbf_overlap_note_all(solver);
  return PBF_OK;
}

static int is_wanted(const pbf_solver *solver) {
  const pbf_params *params = &solver->params;
  return params->prestabilization > 0 && params->solver == PBF_SOLVER_CHEBYSHEV &&
         solver->api.project;
}

static int is_first(const pbf_solver *solver) { return !solver->overlap.moved; }

/* Whether a wall has been set farther in than a moving one goes in a step, and so over particles
 * that have not been shifted with it. Whatever their density is, those are moved back by a
 * projection, without the velocity that a step would give them. */
static int walls_have_jumped(const pbf_solver *solver) {
  const double most = 0.5 * solver->params.smoothing_radius;
  const pbf_placement *placed = &solver->placement;
  int jumped = 0;
  for (uint32_t wall = 0; wall < 2 * solver->kind.dimension; ++wall) {
    double inwards = wall % 2 ? -1 : 1, shift = placed->wall_shift[wall];
    jumped |= inwards * shift > most && inwards * (shift - placed->shift[wall / 2]) > most;
  }
  return jumped;
}

static pbf_collider_set shifted_colliders(const pbf_solver *solver) {
  return pbf_colliders_set(solver, solver->placement.colliders, PBF_COLLIDERS_SHIFTED);
}

/* What has not been shifted with the particles lies in their places now. */
static void note_jumps(pbf_solver *solver, int walls) {
  const pbf_placement *placed = &solver->placement;
  double way2 = 0, h = solver->params.smoothing_radius;
  for (int k = 0; k < 3; ++k) {
    const double way = placed->collider_shift[k] - placed->shift[k];
    way2 += way * way;
  }
  const pbf_collider_set shifted = shifted_colliders(solver);
  if (placed->shifted && way2 >= h * h) pbf_overlap_note_colliders(solver, &shifted);
  if (walls) pbf_overlap_note_walls(solver);
}

pbf_status pbf_prestabilize(pbf_solver *solver, pbf_before_projection *before) {
  *before = (pbf_before_projection){.placement = solver->placement};
  int jumped = walls_have_jumped(solver);
  const uint64_t places = solver->placement.places;
  int wanted = is_wanted(solver) && (jumped || places & PBF_PLACES_SET_ANEW || is_first(solver));
  note_jumps(solver, jumped);
  pbf_status status = wanted ? pbf_overlap_forget(solver) : PBF_OK;
  if (status == PBF_OK && wanted && places & PBF_PLACES_UNSEEN)
    status = keep_positions(solver, before);
  if (status == PBF_OK && wanted) status = project(solver, jumped, before);
  if (status == PBF_OK) solver->placement = (pbf_placement){0};
  return status;
}

void pbf_prestabilize_undo(pbf_solver *solver, pbf_before_projection *before) {
  solver->placement = before->placement;
  if (!before->positions) return;
  const pbf_rows rows = pbf_ids_rows(solver, 0, solver->count);
  (void)solver->api.write(solver->backend, PBF_FIELD_POSITION, &rows, before->positions);
  pbf_prestabilize_accept(solver, before);
}

void pbf_prestabilize_accept(pbf_solver *solver, pbf_before_projection *before) {
  free_rows(solver, &before->positions);
}

int pbf_setting_matters(const pbf_solver *solver) {
  return solver->params.solver == PBF_SOLVER_CHEBYSHEV && !is_first(solver) &&
         !(solver->placement.places & PBF_PLACES_SET_ANEW);
}

void pbf_note_shift(pbf_solver *solver, const double shift[3]) {
  for (int k = 0; k < 3; ++k) solver->placement.shift[k] += shift[k];
}

void pbf_note_collider_shift(pbf_solver *solver, const pbf_collider_set *colliders,
                             const double shift[3]) {
  pbf_placement *placed = &solver->placement;
  pbf_collider_set shifted = shifted_colliders(solver);
  if (pbf_collider_set_is_empty(colliders)) return;
  if (placed->shifted && pbf_collider_sets_differ(&shifted, colliders)) {
    pbf_overlap_note_colliders(solver, &shifted);
    for (int k = 0; k < 3; ++k) placed->collider_shift[k] = 0;
  }
  pbf_collider_set_copy(&shifted, colliders);
  placed->shifted = 1;
  placed->colliders = shifted.first;
  for (int k = 0; k < 3; ++k) placed->collider_shift[k] += shift[k];
}

void pbf_note_set(pbf_solver *solver) { solver->placement.places |= PBF_PLACES_UNSEEN; }

void pbf_note_set_anew(pbf_solver *solver) {
  solver->placement.places |= PBF_PLACES_SET_ANEW | PBF_PLACES_UNSEEN;
}

void pbf_note_added(pbf_solver *solver, int were_parted) {
  if (!is_first(solver)) return;
  if (solver->count > 0) pbf_note_set(solver);
  if (were_parted) solver->placement.places |= PBF_PLACES_PARTED;
}

void pbf_note_params(pbf_solver *solver, const pbf_params *params) {
  double now = pbf_solver_time(solver);
  if (pbf_densities_change(&solver->params, params))
    solver->placement.places |= PBF_PLACES_SET_ANEW;
  for (int wall = 0; wall < 2 * (int)solver->kind.dimension; ++wall)
    solver->placement.wall_shift[wall] +=
        pbf_motion_wall(params, wall, now) - pbf_motion_wall(&solver->params, wall, now);
}
