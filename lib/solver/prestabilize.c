#include "prestabilize.h"

#include <math.h>
#include <stdio.h>

#include "backend_call.h"
#include "error.h"
#include "overlap.h"
#include "physics/prestabilization.h"
#include "solver_time.h"

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

/* In solver->placed: walls have jumped over particles. Whatever their density is, they are moved
 * back by a projection, without the velocity that a step would give them. */
static const uint32_t walls_have_jumped = UINT32_MAX;

static pbf_status measure(pbf_solver *solver, pbf_stats *stats, double *error) {
  *stats = (pbf_stats){.struct_size = sizeof *stats};
  pbf_status status =
      pbf_backend_result(solver, solver->api.get_stats(solver->backend, stats), "get_stats");
  *error = pbf_density_error(stats);
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
  double wanted = solver->params.prestabilization, max_error = wanted, best = INFINITY, error;
  pbf_stats stats;
  for (int pass = 0, stalled = 0; pass < MAX_PASSES; ++pass) {
    pbf_status status = measure(solver, &stats, &error);
    int is_due = pass == 0 && solver->placed == walls_have_jumped;
    if (status != PBF_OK || (error <= max_error && !is_due)) return status;
    int improves = error < (1 - min_gain) * best;
    stalled = improves ? 0 : stalled + 1;
    if (improves) best = error;
    if (stats.neighbors_mean > max_neighbors_mean || stalled == MAX_STALLED) break;
    status = solver->api.project(solver->backend, pbf_solver_time(solver), ITERATIONS);
    status = pbf_backend_result(solver, status, "project");
    if (status != PBF_OK) return status;
    ++solver->generation;
    max_error = remaining_part * wanted;
  }
  if (stats.density_error_mean > wanted) warn(solver, stats.density_error_mean);
  return PBF_OK;
}

void pbf_note_placed(pbf_solver *solver, uint32_t count) {
  if (solver->placed == walls_have_jumped) return;
  uint32_t left = walls_have_jumped - 1 - solver->placed;
  solver->placed += count < left ? count : left;
}

pbf_status pbf_prestabilize(pbf_solver *solver) {
  if (solver->placed == 0) return PBF_OK;
  const pbf_params *params = &solver->params;
  int wanted = params->prestabilization > 0 && params->solver == PBF_SOLVER_CHEBYSHEV &&
               solver->api.project && pbf_placed_can_matter(params, solver->placed, solver->count);
  pbf_status status = wanted ? pbf_overlap_forget(solver) : PBF_OK;
  if (status == PBF_OK && wanted) status = project(solver);
  if (status == PBF_OK) solver->placed = 0;
  return status;
}

void pbf_note_params(pbf_solver *solver, const pbf_params *params) {
  if (pbf_densities_change(&solver->params, params)) pbf_note_placed(solver, solver->count);
  if (pbf_walls_jump(&solver->params, params, solver->kind.dimension, pbf_solver_time(solver)))
    solver->placed = walls_have_jumped;
}
