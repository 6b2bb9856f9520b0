#include "prestabilize.h"

#include <math.h>
#include <stdio.h>

#include "error.h"

/* Positions alone are projected onto the density constraint, as Macklin et al. do before a step
 * (Unified Particle Physics for Real-Time Applications, 2014, section 4.4): what a step undoes of
 * an error becomes velocity, error times h / dt, and a start has done nothing to deserve it. */

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

static pbf_status look(pbf_solver *solver, pbf_stats *stats) {
  *stats = (pbf_stats){.struct_size = sizeof *stats};
  return pbf_backend_result(solver, solver->api.get_stats(solver->backend, stats), "get_stats");
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
  double wanted = solver->params.prestabilization, most = wanted, best = INFINITY;
  pbf_stats now;
  for (int pass = 0, stalled = 0; pass < MOST_PASSES; ++pass) {
    pbf_status status = look(solver, &now);
    if (status != PBF_OK || now.density_error_mean <= most) return status;
    int gains = now.density_error_mean < (1 - least_gain) * best;
    stalled = gains ? 0 : stalled + 1;
    if (gains) best = now.density_error_mean;
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

pbf_status pbf_prestabilize(pbf_solver *solver) {
  if (!solver->is_start) return PBF_OK;
  int wanted = solver->params.prestabilization > 0 &&
               solver->params.solver == PBF_SOLVER_CHEBYSHEV && solver->api.project;
  pbf_status status = wanted ? project(solver) : PBF_OK;
  if (status == PBF_OK) solver->is_start = 0;
  return status;
}

int pbf_params_make_start(const pbf_params *before, const pbf_params *after) {
  return before->kernel != after->kernel || before->smoothing_radius != after->smoothing_radius ||
         before->spacing != after->spacing || before->particle_volume != after->particle_volume ||
         before->wall_density != after->wall_density;
}
