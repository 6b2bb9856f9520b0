#include "prestabilize.h"

#include <math.h>
#include <stdio.h>

#include "backend_call.h"
#include "error.h"
#include "physics/motion.h"
#include "solver_time.h"

/* Positions alone are projected onto the density constraint, as Macklin et al. do before a step
 * (Unified Particle Physics for Real-Time Applications, 2014, section 4.4): what a step undoes of
 * an error becomes velocity, error times h / dt, which is nothing that anybody has asked for. */

/* The cells are sorted and the error is looked at anew for each pass. What must rise by tens of
 * layers wants hundreds: a pass carries over a few. PATIENCE passes that gain next to nothing are
 * the end, as where there is more fluid than room. */
enum { ITERATIONS = 8, MOST_PASSES = 400, PATIENCE = 8 };
static const double least_gain = 0.01;

/* Of the error that makes a start wanting: what is left is less than steps leave. */
static const double remainder_of_error = 0.25;

/* With more than that it is no fluid that has been placed badly, but overload: its pairs would take
 * minutes. */
static const double most_neighbors = 1000;

/* A mean says nothing of a few in a place of their own: the largest error counts, too, as that of
 * one particle in so many. Flows have larger ones of their own only where they collide. */
static const double largest_as_of = 25;

/* In solver->placed: walls have jumped over fluid. Whatever its density is, it is to come back
 * without the velocity that a step would give it. */
static const uint32_t behind_walls = UINT32_MAX;

static pbf_status look(pbf_solver *solver, pbf_stats *stats, double *error) {
  *stats = (pbf_stats){.struct_size = sizeof *stats};
  pbf_status status =
      pbf_backend_result(solver, solver->api.get_stats(solver->backend, stats), "get_stats");
  *error = fmax(stats->density_error_mean, stats->density_error_max / largest_as_of);
  return status;
}

static void warn(const pbf_solver *solver, double error) {
  char text[200];
  snprintf(
      text, sizeof text,
      "pre-stabilization leaves a mean density error of %.3g: there may be too little room, or "
      "too much fluid in too little of it, for params.spacing",
      error);
  solver->log(solver->log_user, PBF_LOG_WARNING, text);
}

static pbf_status project(pbf_solver *solver) {
  double wanted = solver->params.prestabilization, most = wanted, best = INFINITY, error;
  pbf_stats now;
  for (int pass = 0, stalled = 0; pass < MOST_PASSES; ++pass) {
    pbf_status status = look(solver, &now, &error);
    int is_due = pass == 0 && solver->placed == behind_walls;
    if (status != PBF_OK || (error <= most && !is_due)) return status;
    int gains = error < (1 - least_gain) * best;
    stalled = gains ? 0 : stalled + 1;
    if (gains) best = error;
    if (now.neighbors_mean > most_neighbors || stalled == PATIENCE) break;
    status = solver->api.project(solver->backend, pbf_solver_time(solver), ITERATIONS);
    status = pbf_backend_result(solver, status, "project");
    if (status != PBF_OK) return status;
    ++solver->generation;
    most = remainder_of_error * wanted;
  }
  if (now.density_error_mean > wanted) warn(solver, now.density_error_mean);
  return PBF_OK;
}

void pbf_note_placed(pbf_solver *solver, uint32_t count) {
  if (solver->placed == behind_walls) return;
  uint32_t left = behind_walls - 1 - solver->placed;
  solver->placed += count < left ? count : left;
}

/* One that comes in where others are has an error of 1 there, and lends as much to them: fewer than
 * these don't raise the mean to what is asked for. */
static int are_enough(const pbf_solver *solver) {
  return 2.0 * solver->placed >= fmin(solver->params.prestabilization, 1) * solver->count;
}

pbf_status pbf_prestabilize(pbf_solver *solver) {
  if (solver->placed == 0) return PBF_OK;
  int wanted = solver->params.prestabilization > 0 &&
               solver->params.solver == PBF_SOLVER_CHEBYSHEV && solver->api.project &&
               are_enough(solver);
  pbf_status status = wanted ? project(solver) : PBF_OK;
  if (status == PBF_OK) solver->placed = 0;
  return status;
}

static int sizes_differ(const pbf_params *before, const pbf_params *after) {
  return before->kernel != after->kernel || before->smoothing_radius != after->smoothing_radius ||
         before->spacing != after->spacing || before->particle_volume != after->particle_volume ||
         before->wall_density != after->wall_density;
}

/* By more than a wall that moves goes in a step. */
static int walls_jump(const pbf_params *before, const pbf_params *after, uint32_t dimension,
                      double time) {
  double most = 0;
  for (int wall = 0; wall < 2 * (int)dimension; ++wall) {
    double way = pbf_motion_wall(after, wall, time) - pbf_motion_wall(before, wall, time);
    most = fmax(most, wall % 2 ? -way : way);
  }
  return most > 0.5 * after->smoothing_radius;
}

void pbf_note_params(pbf_solver *solver, const pbf_params *params) {
  if (sizes_differ(&solver->params, params)) pbf_note_placed(solver, solver->count);
  if (walls_jump(&solver->params, params, solver->kind.dimension, pbf_solver_time(solver)))
    solver->placed = behind_walls;
}
