#include "look_ahead.h"

#include <float.h>
#include <math.h>

#include "check.h"
#include "error.h"
#include "params.h"
#include "physics/motion.h"
#include "solver_time.h"

/* A call may be of all steps that there will ever be, until it is cancelled. */
enum { AT_ONCE = 1024 };

/* Whether what moves is where it could be set, and its particles be read from a saved state. */
static int is_beyond(const pbf_solver *solver, double place) {
  return pbf_check_finite(place, solver->kind.precision) || fabs(place) > pbf_check_most;
}

/* ---- Walls ----------------------------------------------------------------------------------- */

/* Why the domain's walls can't be where they are when a step ends. */
typedef enum closing { WALLS_STAND, WALLS_MEET, WALL_OVERFLOWS } closing;

static closing closing_after(const pbf_solver *solver, uint32_t steps) {
  const uint32_t dimension = solver->kind.dimension;
  const pbf_box box = pbf_params_box(&solver->params, dimension, pbf_time_of_step(solver, steps));
  for (uint32_t k = 0; k < dimension; ++k)
    if (is_beyond(solver, box.lower[k]) || is_beyond(solver, box.upper[k])) return WALL_OVERFLOWS;
  return pbf_box_closed_axis(&box, dimension) != dimension ? WALLS_MEET : WALLS_STAND;
}

static uint32_t before_walls_close(const pbf_solver *solver, uint32_t steps) {
  if (!pbf_params_walls_move(&solver->params, solver->kind.dimension)) return steps;
  for (uint32_t i = 0; i < steps; ++i)
    if (closing_after(solver, i + 1) != WALLS_STAND) return i;
  return steps;
}

/* ---- Colliders ------------------------------------------------------------------------------- */

/* Null when all of it is a number for the backend, else the member that is not. */
static const char *overflowing_member(const pbf_solver *solver, const pbf_collider *now) {
  const uint32_t precision = solver->kind.precision;
  for (uint32_t k = 0; k < solver->kind.dimension; ++k) {
    if (pbf_check_finite(now->position[k], precision)) return "position";
    if (pbf_check_finite(now->half_extents[k], precision)) return "half_extents";
  }
  for (int k = 0; k < 4; ++k)
    if (!isfinite(now->orientation[k])) return "orientation";
  if (pbf_check_finite(now->radius, precision)) return "radius";
  return pbf_check_finite(now->half_length, precision) ? "half_length" : NULL;
}

/* What can't be placed of a collider when a step ends, or null. */
static const char *overflowing_after(const pbf_solver *solver, uint32_t collider, uint32_t steps) {
  pbf_collider now;
  pbf_motion_collider(&solver->colliders[collider],
                      pbf_time_of_step(solver, steps) - solver->collider_time, &now);
  return overflowing_member(solver, &now);
}

/* What goes straight is a number on its way when it is one at the end; on a screw it comes back
 * from where it is none. No screw is longer than it would be straight, nor wider than its turn. */
static int may_overflow_between(const pbf_solver *solver, const pbf_collider *c, uint32_t steps) {
  if (c->path != PBF_PATH_SCREW || !pbf_motion_turns(c)) return 0;
  const double *v = c->velocity, *w = c->angular_velocity;
  const double time = pbf_motion_time(c, pbf_time_of_step(solver, steps) - solver->collider_time);
  const double rate = pbf_motion_length(w), speed = pbf_motion_length(v);
  const double along = fabs(v[0] * w[0] + v[1] * w[1] + v[2] * w[2]) / rate;
  const double way = fmin(speed * time, along * time + 2 * speed / rate);
  const double most = 0.5 * (solver->kind.precision == PBF_FLOAT32 ? (double)FLT_MAX : DBL_MAX);
  return !(pbf_motion_length(c->position) + way <= most);
}

static int is_clear(const pbf_solver *solver, uint32_t collider, uint32_t steps) {
  return !overflowing_after(solver, collider, steps) &&
         !may_overflow_between(solver, &solver->colliders[collider], steps);
}

static uint32_t before_overflow(const pbf_solver *solver, uint32_t steps) {
  uint32_t count = steps;
  for (uint32_t k = 0; k < solver->collider_count; ++k) {
    if (is_clear(solver, k, count)) continue;
    uint32_t i = 0;
    while (i < count && !overflowing_after(solver, k, i + 1)) ++i;
    count = i;
  }
  return count;
}

/* ---- Both ------------------------------------------------------------------------------------ */

uint32_t pbf_steps_to_look_at(const pbf_solver *solver, uint32_t steps) {
  if (steps <= AT_ONCE) return steps;
  if (pbf_params_walls_move(&solver->params, solver->kind.dimension)) return AT_ONCE;
  for (uint32_t k = 0; k < solver->collider_count; ++k)
    if (!is_clear(solver, k, steps)) return AT_ONCE;
  return steps;
}

uint32_t pbf_steps_possible(const pbf_solver *solver, uint32_t steps) {
  const uint32_t with_room = before_walls_close(solver, steps);
  const uint32_t count = before_overflow(solver, with_room);
  return count;
}

static pbf_status fail_to_place(const pbf_solver *solver, uint32_t step, uint32_t steps) {
  const char *member = NULL;
  uint32_t k = 0;
  while (k < solver->collider_count && !(member = overflowing_after(solver, k, 1))) ++k;
  return pbf_fail(PBF_ERROR_STATE,
                  "step %u of %u would end at time %.9g, when colliders[%u].%s is beyond what "
                  "float%u holds; set it with other velocities first",
                  step, steps, pbf_time_of_step(solver, 1), k, member ? member : "position",
                  8 * solver->kind.precision);
}

pbf_status pbf_fail_to_move(const pbf_solver *solver, uint32_t step, uint32_t steps) {
  const double time = pbf_time_of_step(solver, 1);
  switch (closing_after(solver, 1)) {
    case WALLS_MEET:
      return pbf_fail(PBF_ERROR_STATE,
                      "step %u of %u would end at time %.9g, when the moving walls have left no "
                      "room between them; change params.wall_… first",
                      step, steps, time);
    case WALL_OVERFLOWS:
      return pbf_fail(PBF_ERROR_STATE,
                      "step %u of %u would end at time %.9g, when a moving wall is beyond what "
                      "float%u holds; change params.wall_… first",
                      step, steps, time, 8 * solver->kind.precision);
    default:
      return fail_to_place(solver, step, steps);
  }
}
