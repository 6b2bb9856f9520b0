#include "solids.h"

#include <math.h>

#include "solver/solid.h"

/* ---- Walls ----------------------------------------------------------------------------------- */

pbf_diffuse_walls pbf_diffuse_walls_at(const pbf_solver *solver, double time, double elapsed) {
  const uint32_t n = solver->kind.dimension;
  pbf_diffuse_walls walls = {.box = pbf_params_box(&solver->params, n, time)};
  if (!(elapsed > 0)) return walls;
  const pbf_box before = pbf_params_box(&solver->params, n, time - elapsed);
  for (uint32_t k = 0; k < n; ++k) {
    walls.lower_velocity[k] = (walls.box.lower[k] - before.lower[k]) / elapsed;
    walls.upper_velocity[k] = (walls.box.upper[k] - before.upper[k]) / elapsed;
  }
  return walls;
}

static double wrapped(double x, double lower, double upper) {
  const double period = upper - lower;
  const double in = x - period * floor((x - lower) / period);
  return in >= lower && in < upper ? in : lower;
}

void pbf_diffuse_keep_inside(const pbf_solver *solver, const pbf_diffuse_walls *walls,
                             pbf_diffuse_particle *p) {
  for (uint32_t k = 0; k < solver->kind.dimension; ++k) {
    const double lower = walls->box.lower[k], upper = walls->box.upper[k];
    double *x = &p->position[k], *v = &p->velocity[k];
    if (*x >= lower && *x <= upper) continue;
    if (solver->params.periodic >> k & 1) {
      *x = wrapped(*x, lower, upper);
    } else if (*x > upper) {
      *x = upper;
      *v = fmin(*v, walls->upper_velocity[k]);
    } else {
      *x = lower;
      *v = fmax(*v, walls->lower_velocity[k]);
    }
  }
}

/* ---- Colliders ------------------------------------------------------------------------------- */

/* How fast its surface goes along a normal of it, at a point. */
static double speed_along(const pbf_solid *s, const double *x, const double normal[3]) {
  const double *w = s->now.angular_velocity;
  double p[3] = {0, 0, 0}, speed = 0;
  for (uint32_t k = 0; k < s->dimension; ++k) p[k] = x[k] - s->now.position[k];
  for (uint32_t a = 0; a < s->dimension; ++a) {
    const uint32_t b = (a + 1) % 3, c = (a + 2) % 3;
    speed += normal[a] * (s->now.velocity[a] + w[b] * p[c] - w[c] * p[b]);
  }
  return speed;
}

static void push(const pbf_solid *s, pbf_diffuse_particle *p) {
  double normal[3] = {0, 0, 0};
  if (pbf_solid_is_beyond(s, p->position, 0)) return;
  const double distance = pbf_solid_distance(s, p->position, normal);
  if (!(distance < 0)) return;
  for (uint32_t k = 0; k < s->dimension; ++k) p->position[k] -= distance * normal[k];
  double in = speed_along(s, p->position, normal);
  for (uint32_t k = 0; k < s->dimension; ++k) in -= normal[k] * p->velocity[k];
  for (uint32_t k = 0; k < s->dimension && in > 0; ++k) p->velocity[k] += in * normal[k];
}

/* The ball around all particles: most colliders of a large scene are not near it. */
static double ball_around(const pbf_diffuse *d, uint32_t dimension, double centre[3]) {
  const uint32_t n = dimension == 3 ? 3 : 2;
  double lower[3] = {INFINITY, INFINITY, INFINITY}, upper[3] = {-INFINITY, -INFINITY, -INFINITY};
  double square = 0;
  for (uint32_t i = 0; i < d->head.count; ++i)
    for (uint32_t k = 0; k < n; ++k) {
      const double x = pbf_diffuse_at(d, i)->position[k];
      lower[k] = fmin(lower[k], x);
      upper[k] = fmax(upper[k], x);
    }
  for (uint32_t k = 0; k < n; ++k) {
    centre[k] = 0.5 * (lower[k] + upper[k]);
    square += 0.25 * (upper[k] - lower[k]) * (upper[k] - lower[k]);
  }
  return sqrt(square);
}

void pbf_diffuse_push_out(const pbf_solver *solver, double time) {
  const pbf_diffuse *d = solver->diffuse;
  double centre[3] = {0, 0, 0};
  if (solver->collider_count == 0 || d->head.count == 0) return;
  const double radius = ball_around(d, solver->kind.dimension, centre);
  for (uint32_t i = 0; i < solver->collider_count; ++i) {
    const pbf_solid s = pbf_solid_at(solver, i, time);
    if (pbf_solid_is_beyond(&s, centre, radius)) continue;
    for (uint32_t n = 0; n < d->head.count; ++n) push(&s, pbf_diffuse_at(d, n));
  }
}

/* ---- What is near ---------------------------------------------------------------------------- */

int pbf_diffuse_faces_wall(const pbf_solver *solver, const pbf_diffuse_walls *walls,
                           const double *point, const double *direction, double reach) {
  for (uint32_t k = 0; k < solver->kind.dimension; ++k) {
    if (solver->params.periodic >> k & 1) continue;
    if (direction[k] < -0.5 && point[k] < walls->box.lower[k] + reach) return 1;
    if (direction[k] > 0.5 && point[k] > walls->box.upper[k] - reach) return 1;
  }
  return 0;
}
