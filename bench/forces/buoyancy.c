/* A cube and a ball that float, free to move up and down, and Archimedes: what is below the level
 * weighs as much as the body. The level follows from the volumes. */
#include <math.h>
#include <stdio.h>

#include "cases.h"

static const double width = 0.8, depth = 0.45, size = 0.3, gravity = 9.81, frame_time = 1.0 / 120;

typedef struct body {
  uint32_t shape;
  double ratio; /* of its density to that of water */
  double y, v, a;
} body;

static double volume_of(const body *b) {
  return b->shape == PBF_COLLIDER_BOX ? size * size * size : acos(-1) / 6 * size * size * size;
}

static double surface_of(const body *b) {
  return b->shape == PBF_COLLIDER_BOX ? 6 * size * size : acos(-1) * size * size;
}

/* The part of its volume that is below a level. */
static double part_below(const body *b, double level) {
  const double deep = fmin(fmax((level - (b->y - size / 2)) / size, 0), 1);
  return b->shape == PBF_COLLIDER_BOX ? deep : deep * deep * (3 - 2 * deep);
}

/* Where it floats. */
static double height_of(const body *b, double level) {
  body at = *b;
  double low = level - size, high = level + size;
  for (int k = 0; k < 60; ++k) {
    at.y = 0.5 * (low + high);
    if (part_below(&at, level) > b->ratio)
      low = at.y;
    else
      high = at.y;
  }
  return low;
}

static int is_outside(const double x[3], const void *context) {
  const body *b = context;
  double r2 = 0, far = 0;
  for (int k = 0; k < 3; ++k) {
    const double away = fabs(x[k] - (k == 1 ? b->y : width / 2));
    r2 += away * away;
    far = fmax(far, away);
  }
  return (b->shape == PBF_COLLIDER_BOX ? far : sqrt(r2)) > size / 2;
}

static pbf_collider collider_of(const body *b) {
  pbf_collider c;
  check(pbf_collider_init(&c, sizeof c, b->shape));
  for (int k = 0; k < 3; ++k) {
    c.position[k] = k == 1 ? b->y : width / 2;
    c.half_extents[k] = size / 2;
  }
  c.radius = size / 2;
  return c;
}

/* As examples/floating.cpp: with the mass of water that it takes along, as far as it is wet. */
static void push(body *b, const pbf_collider_load *load) {
  const double mass = b->ratio * volume_of(b);
  const double added = volume_of(b) * sqrt(fmin(1, load->wetted_area / surface_of(b)));
  const double force = load->time_sum > 0 ? load->impulse_sum[1] / load->time_sum : 0;
  b->a = (force - mass * gravity + 0.5 * added * b->a) / (mass + added);
  b->v += frame_time * b->a;
  b->y += frame_time * b->v;
}

/* It begins where it floats, at the level that there then is, and its mean height once it has come
 * to rest is looked at. */
static double floats_at(body *b, double spacing, double level, double *lift) {
  const double domain[3] = {width, 1, width}, water[3] = {width, level, width};
  enum { SETTLES = 360, LOOKS = 240 };
  pbf_params params = params_of(spacing, domain, sqrt(2 * gravity * depth));
  const uint32_t steps = (uint32_t)ceil(frame_time / params.time_step);
  double sum = 0;
  params.time_step = frame_time / steps;
  pbf_solver *fluid = water_of(&params, water, is_outside, b);
  pbf_collider c = collider_of(b);
  pbf_collider_load load = {.struct_size = sizeof load};
  check(pbf_set_colliders(fluid, 1, &c));
  *lift = 0;
  for (int frame = 0; frame < SETTLES + LOOKS; ++frame) {
    push(b, &load);
    c = collider_of(b);
    check(pbf_move_colliders(fluid, 1, &c, frame_time));
    check(pbf_step(fluid, steps));
    check(pbf_get_collider_loads(fluid, 1, &load));
    if (frame < SETTLES) continue;
    sum += b->y / LOOKS;
    *lift += load.impulse_sum[1] / load.time_sum / LOOKS;
  }
  pbf_destroy(fluid);
  return sum;
}

/* The level is that of the particles that there are, with what is displaced. */
static int run_body(uint32_t shape, double ratio, double spacing) {
  body b = {shape, ratio, 0, 0, 0};
  char figure[80];
  double lift;
  const double level = depth;
  b.y = height_of(&b, level);
  body rests = b;
  rests.y = floats_at(&b, spacing, level, &lift);
  const char *name = shape == PBF_COLLIDER_BOX ? "cube" : "ball";
  int missed = 0;
  snprintf(figure, sizeof figure, "lift of a %s of %g of water's density, N over ρ0", name, ratio);
  missed += forces_report("buoyancy", figure, lift, ratio * volume_of(&b) * gravity, 0.02);
  snprintf(figure, sizeof figure, "part below the level of a %s of %g", name, ratio);
  missed += forces_report("buoyancy", figure, part_below(&rests, level), ratio, 0.02);
  return missed;
}

int run_buoyancy(double spacing) {
  static const double ratios[] = {0.25, 0.5, 0.75};
  int missed = 0;
  for (int k = 0; k < 3; ++k) missed += run_body(PBF_COLLIDER_BOX, ratios[k], spacing);
  for (int k = 0; k < 3; ++k) missed += run_body(PBF_COLLIDER_SPHERE, ratios[k], spacing);
  return missed;
}

int run_half_sunk_cube(double spacing) { return run_body(PBF_COLLIDER_BOX, 0.5, spacing); }
