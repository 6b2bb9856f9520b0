/* Random scenes of solids of all forms, and places near each other, inside and at walls. */
#ifndef PBF_TEST_CPU_SOLID_SCENES_H
#define PBF_TEST_CPU_SOLID_SCENES_H

#include "physics/support.h"

#include "cpu/boundary.h"
#include "cpu/isa.h"
#include "support/amount.h"
#include "support/random.h"

enum { MOST = 12 };

static const double h = 1, around = 4;

/* So many are drawn: more of them find what is rarer. */
static int scenes() { return test_is_long() ? 3000 : 600; }

typedef struct scene {
  pbf_constants constants;
  pbf_surface surfaces[MOST];
  pbf_obstacles o;
  uint16_t room[PBF_OBSTACLE_LISTS * MOST];
} scene;

static void turn_at_random(uint64_t *random, double orientation[4]) {
  double norm2 = 0;
  for (int k = PBF_DIM == 3 ? 0 : 2; k < 4; ++k) {
    orientation[k] = random_in(random, -1, 1);
    norm2 += orientation[k] * orientation[k];
  }
  for (int k = 0; k < 4; ++k) orientation[k] /= sqrt(norm2);
}

static double distance_from_box(const double p[PBF_DIM], const double half[PBF_DIM]) {
  double inside = -INFINITY, outside2 = 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    const double d = fabs(p[k]) - half[k];
    inside = fmax(inside, d);
    outside2 += d > 0 ? d * d : 0;
  }
  return outside2 > 0 ? sqrt(outside2) : inside;
}

/* What is inside of a box with these half extents, as distances on a grid, which ends less than h
 * from it. */
template <class Distance>
static pbf_shape *field_of(const double half[PBF_DIM], double bound, Distance distance) {
  enum { NODES = 17 };
  static float values[NODES * NODES * NODES];
  static pbf_shape f;
  f.nodes[2] = 1;
  f.cell = 0.15;
  f.steepest = 1;
  f.bound = bound;
  f.values = values;
  for (int k = 0; k < PBF_DIM; ++k) {
    f.nodes[k] = NODES;
    f.origin[k] = -0.5 * (NODES - 1) * f.cell;
    f.lower[k] = -half[k], f.upper[k] = half[k];
  }
  for (int i = 0; i < NODES * NODES * (PBF_DIM == 3 ? NODES : 1); ++i) {
    double at[PBF_DIM];
    for (int k = 0, rest = i; k < PBF_DIM; ++k, rest /= NODES)
      at[k] = f.origin[k] + rest % NODES * f.cell;
    values[i] = (float)distance(at);
  }
  return &f;
}

/* Two boxes that cross, which have corners that fluid is in, or a ball, which fills the one around
 * it. */
static pbf_shape *random_field(uint64_t *random) {
  static const double half[] = {0.8, 0.3, 0.6}, across[] = {0.3, 0.8, 0.5}, all[] = {0.8, 0.8, 0.8};
  static pbf_shape *const boxes = field_of(all, 1.2, [](const double *p) {
    return fmin(distance_from_box(p, half), distance_from_box(p, across));
  });
  static pbf_shape *const ball = field_of(all, 0.8, [](const double *p) {
    double r2 = 0;
    for (int k = 0; k < PBF_DIM; ++k) r2 += p[k] * p[k];
    return sqrt(r2) - 0.8;
  });
  return random_in(random, 0, 1) < 0.5 ? boxes : ball;
}

/* Of all closed forms, or of any; some hold all of the fluid, some move, and of some the edges are
 * level with the axes, where planes through them are at right angles to walls. Where fields are
 * some lie upon the one before. */
static pbf_surface random_surface(uint64_t *random, bool fields, const pbf_surface *before) {
  pbf_collider c;
  memset(&c, 0, sizeof c);
  c.shape = (uint32_t)fmin(random_in(random, 0, fields ? 7 : 4), PBF_COLLIDER_SHAPE);
  c.inverted = random_in(random, 0, 1) < 0.1 && c.shape != PBF_COLLIDER_PLANE;
  if (c.shape == PBF_COLLIDER_SHAPE) c.inverted = 0, c.geometry = random_field(random), c.scale = 1;
  c.radius = c.inverted ? around : random_in(random, 0.2, 1.5);
  c.half_length = random_in(random, 0.2, 2);
  c.axis[1] = 1;
  c.orientation[3] = 1;
  const bool moves = random_in(random, 0, 1) < 0.1;
  for (int k = 0; k < PBF_DIM; ++k) {
    c.half_extents[k] = c.inverted ? around : random_in(random, 0.1, 2);
    c.position[k] = c.inverted ? 0 : random_in(random, -around, around);
    c.velocity[k] = moves ? random_in(random, -2, 2) : 0;
  }
  for (int k = 0; k < PBF_DIM && fields && before && !c.inverted; ++k)
    c.position[k] = (double)before->center.c[k] + random_in(random, -0.5, 0.5);
  if (c.shape == PBF_COLLIDER_PLANE) c.position[1] = -around;
  if (random_in(random, 0, 1) < 0.5) turn_at_random(random, c.orientation);
  pbf_surface s = pbf_surface_at(&c, 0, 1);
  s.skin = pbf_surface_is_unbounded(&s) ? 0 : (pbf_real)0.002;
  s.rounding = (pbf_real)1e-5;
  s.prediction_push = (pbf_real)INFINITY;
  return s;
}

/* Every other one has fields. */
static void make_scene(uint64_t *random, int which, scene *s) {
  pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
  p.smoothing_radius = h;
  p.spacing = h / 2;
  p.wall_density = 1;
  p.solver = PBF_SOLVER_CHEBYSHEV;
  for (int k = 0; k < 3; ++k) p.domain_min[k] = -around, p.domain_max[k] = around;
  s->constants = pbf_constants_of(&p);
  memset(&s->o, 0, sizeof s->o);
  s->o.domain = pbf_domain_at(&p, 0);
  s->o.count = 1 + (int)random_in(random, 0, MOST);
  s->o.surfaces = {s->surfaces, NULL};
  s->o.room = s->room;
  for (int k = 0; k < s->o.count; ++k)
    s->surfaces[k] = random_surface(random, which % 2, k % 3 ? &s->surfaces[k - 1] : NULL);
}

/* Near each other, inside and at walls. */
static lane_values random_places(uint64_t *random) {
  lane_values x;
  for (int k = 0; k < PBF_DIM; ++k) {
    const double middle = random_in(random, -around, around);
    for (uint32_t l = 0; l < WIDTH; ++l)
      x.c[k][l] = (pbf_real)(middle + random_in(random, -0.7, 0.7));
  }
  return x;
}

/* Runs the tests of an instruction set, or skips them. */
static int run_on_this_machine(const CMUnitTest *tests, size_t count) {
  cpu_isa best;
  char reason[128];
  if (!cpu_isa_best(&best, reason, sizeof reason) || best < PBF_TEST_ISA) {
    print_message("skipped: this processor lacks the instructions under test, %s\n",
                  cpu_isa_name(PBF_TEST_ISA));
    return 77;
  }
  return _cmocka_run_group_tests("tests", tests, count, NULL, NULL);
}

#endif
