#include "solids.h"

#include <math.h>
#include <string.h>

#include "collider.h"
#include "physics/motion.h"
#include "shape/distance.h"

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

/* One at a time, as its distance is asked for. */
typedef struct solid {
  pbf_collider now;
  uint32_t dimension;
  double frame[3][3]; /* rows: its own axes in the world; the first a plane's or capsule's axis */
  double bound;       /* nothing of it is farther from its position */
} solid;

static void turn(const double q[4], const double v[3], double turned[3]) {
  const double p[4] = {v[0], v[1], v[2], 0}, back[4] = {-q[0], -q[1], -q[2], q[3]};
  double half[4], whole[4];
  pbf_motion_quaternion_product(q, p, half);
  pbf_motion_quaternion_product(half, back, whole);
  memcpy(turned, whole, 3 * sizeof *turned);
}

static void set_frame(solid *s) {
  const double length = pbf_motion_length(s->now.axis);
  const int has_axis = s->now.shape == PBF_COLLIDER_PLANE || s->now.shape == PBF_COLLIDER_CAPSULE;
  for (int row = 0; row < 3; ++row) {
    double own[3] = {row == 0, row == 1, row == 2};
    for (int k = 0; k < 3 && has_axis; ++k) own[k] = s->now.axis[k] / length;
    turn(s->now.orientation, own, s->frame[row]);
  }
}

static double bound_of(const pbf_collider *c, uint32_t dimension) {
  double square = 0;
  if (c->inverted || c->shape == PBF_COLLIDER_PLANE) return INFINITY;
  if (c->shape == PBF_COLLIDER_SHAPE) return c->scale * c->geometry->bound;
  if (c->shape == PBF_COLLIDER_SPHERE) return c->radius;
  if (c->shape == PBF_COLLIDER_CAPSULE) return c->radius + c->half_length;
  for (uint32_t k = 0; k < dimension; ++k) square += c->half_extents[k] * c->half_extents[k];
  return sqrt(square);
}

static solid solid_at(const pbf_solver *solver, uint32_t index, double time) {
  solid s = {.dimension = solver->kind.dimension};
  pbf_collider moving = solver->colliders[index];
  pbf_collider_clean(&moving, s.dimension);
  pbf_motion_collider_state(&moving, time - solver->collider_time, &s.now);
  set_frame(&s);
  s.bound = bound_of(&s.now, s.dimension);
  return s;
}

static double dot(const double *a, const double *b, uint32_t n) {
  double sum = 0;
  for (uint32_t k = 0; k < n; ++k) sum += a[k] * b[k];
  return sum;
}

/* Out of the very centre it is along x. */
static double from_centre(const double p[3], double radius, uint32_t n, double normal[3]) {
  const double r = sqrt(dot(p, p, n));
  for (uint32_t k = 0; k < n; ++k) normal[k] = r > 0 ? p[k] / r : k == 0;
  return r - radius;
}

static double from_box(const double p[3], const double half[3], uint32_t n, double normal[3]) {
  double inside = -INFINITY, outside = 0, out[3] = {0, 0, 0};
  uint32_t face = 0;
  for (uint32_t k = 0; k < n; ++k) {
    const double d = fabs(p[k]) - half[k];
    if (d > inside) inside = d, face = k;
    out[k] = d > 0 ? copysign(d, p[k]) : 0;
    outside += out[k] * out[k];
  }
  const double distance = sqrt(outside);
  for (uint32_t k = 0; k < n; ++k)
    normal[k] = distance > 0 ? out[k] / distance : k == face ? copysign(1, p[k]) : 0;
  return distance > 0 ? distance : inside;
}

static double from_field(const solid *s, const double p[3], double normal[3]) {
  const uint32_t n = s->dimension;
  double place[3] = {0, 0, 0};
  if (!(s->now.scale > 0)) return INFINITY;
  for (uint32_t k = 0; k < n; ++k) place[k] = p[k] / s->now.scale;
  const double distance = s->now.scale * pbf_shape_distance_at(s->now.geometry, place, normal);
  const double length = sqrt(dot(normal, normal, n));
  for (uint32_t k = 0; k < n; ++k) normal[k] = length > 0 ? normal[k] / length : k == 0;
  return distance;
}

/* In its own frame. */
static double local_distance(const solid *s, double p[3], double normal[3]) {
  const uint32_t n = s->dimension;
  if (s->now.shape == PBF_COLLIDER_BOX) return from_box(p, s->now.half_extents, n, normal);
  if (s->now.shape == PBF_COLLIDER_SHAPE) return from_field(s, p, normal);
  return from_centre(p, s->now.radius, n, normal);
}

/* Negative where fluid must not be; *normal points to the fluid. */
static double distance_of(const solid *s, const double *x, double normal[3]) {
  const uint32_t n = s->dimension;
  const double sign = s->now.inverted ? -1 : 1;
  double p[3] = {0, 0, 0}, local[3] = {0, 0, 0}, found[3] = {0, 0, 0}, distance;
  for (uint32_t k = 0; k < n; ++k) p[k] = x[k] - s->now.position[k];
  if (s->now.shape == PBF_COLLIDER_PLANE) {
    memcpy(normal, s->frame[0], sizeof s->frame[0]);
    distance = dot(p, normal, n);
  } else if (s->now.shape == PBF_COLLIDER_CAPSULE) {
    const double h = s->now.half_length, along = fmax(fmin(dot(p, s->frame[0], n), h), -h);
    for (uint32_t k = 0; k < n; ++k) p[k] -= along * s->frame[0][k];
    distance = from_centre(p, s->now.radius, n, normal);
  } else {
    for (uint32_t k = 0; k < n; ++k) local[k] = dot(p, s->frame[k], n);
    distance = local_distance(s, local, found);
    for (uint32_t k = 0; k < n; ++k) {
      normal[k] = 0;
      for (uint32_t row = 0; row < n; ++row) normal[k] += s->frame[row][k] * found[row];
    }
  }
  for (uint32_t k = 0; k < n; ++k) normal[k] *= sign;
  return sign * distance;
}

/* Whether nothing of it is within `reach`. */
static int is_beyond(const solid *s, const double *x, double reach) {
  double square = 0;
  for (uint32_t k = 0; k < s->dimension; ++k)
    square += (x[k] - s->now.position[k]) * (x[k] - s->now.position[k]);
  return square > (s->bound + reach) * (s->bound + reach);
}

/* How fast its surface goes along a normal of it, at a point. */
static double speed_along(const solid *s, const double *x, const double normal[3]) {
  const double *w = s->now.angular_velocity;
  double p[3] = {0, 0, 0}, speed = 0;
  for (uint32_t k = 0; k < s->dimension; ++k) p[k] = x[k] - s->now.position[k];
  for (uint32_t a = 0; a < s->dimension; ++a) {
    const uint32_t b = (a + 1) % 3, c = (a + 2) % 3;
    speed += normal[a] * (s->now.velocity[a] + w[b] * p[c] - w[c] * p[b]);
  }
  return speed;
}

static void push(const solid *s, pbf_diffuse_particle *p) {
  double normal[3] = {0, 0, 0};
  if (is_beyond(s, p->position, 0)) return;
  const double distance = distance_of(s, p->position, normal);
  if (!(distance < 0)) return;
  for (uint32_t k = 0; k < s->dimension; ++k) p->position[k] -= distance * normal[k];
  const double in = speed_along(s, p->position, normal) - dot(p->velocity, normal, s->dimension);
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
    const solid s = solid_at(solver, i, time);
    if (is_beyond(&s, centre, radius)) continue;
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
