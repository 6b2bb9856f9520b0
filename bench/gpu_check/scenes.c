/* The scenes that are checked and timed: lattices of particles, some with obstacles. */
#include "scenes.h"

#include <math.h>
#include <string.h>

#include "solver.h"

uint32_t scene_count(const scene *s) {
  return s->counts[0] * s->counts[1] * (s->dimension == 3 ? s->counts[2] : 1);
}

/* Uniform in -0.5 … 0.5, a hash of k. */
static double noise(uint32_t k) {
  k = (k ^ 61u) ^ (k >> 16);
  k *= 9u;
  k ^= k >> 4;
  k *= 0x27d4eb2du;
  k ^= k >> 15;
  return (double)k / 4294967296.0 - 0.5;
}

double scene_coordinate(const scene *s, uint32_t particle, uint32_t axis) {
  uint32_t at[3] = {particle % s->counts[0], particle / s->counts[0] % s->counts[1],
                    particle / s->counts[0] / s->counts[1]};
  return s->first[axis] +
         s->spacing * (at[axis] + s->jitter * noise(particle * s->dimension + axis));
}

scene report_30k(void) {
  scene s = {.name = "report-30k",
             .dimension = 2,
             .counts = {500, 60},
             .first = {0.25, 0.25},
             .spacing = 0.575};
  must(pbf_params_init(&s.params, sizeof s.params), "pbf_params_init");
  pbf_params *p = &s.params;
  p->kernel = PBF_KERNEL_POLY6_SPIKY;
  p->solver = PBF_SOLVER_JACOBI;
  p->cohesion = 1;
  p->min_diagonal = p->wall_density = 0;
  p->smoothing_radius = 1.1;
  p->spacing = 0.575;
  p->particle_volume = 0.5138132684248845;
  p->time_step = 0.05;
  p->iterations = 5;
  p->collide = PBF_COLLIDE_AFTER_PREDICTION | PBF_COLLIDE_AFTER_SOLVE;
  p->gravity[1] = -3;
  p->over_relaxation = 0.8203125;
  p->cfm = 17.179038485712607;
  p->scorr_k = 0.003235295319316347;
  p->scorr_dq = 0.3;
  p->scorr_n = 4;
  p->domain_min[0] = p->domain_min[1] = 0.25;
  p->domain_max[0] = 368.39;
  p->domain_max[1] = 204.55;
  p->wall_amplitude[PBF_WALL_X_MAX] = 40.96;
  p->wall_frequency[PBF_WALL_X_MAX] = 0.13962634015954636;
  return s;
}

scene shallow_dam_break(uint32_t particles, double support) {
  uint32_t side = (uint32_t)(sqrt(particles / 30.0) + 0.5);
  scene s = {.name = "shallow-dam-break",
             .dimension = 3,
             .counts = {side, 30, side},
             .first = {0.025, 0.025, 0.025},
             .spacing = 0.05};
  must(pbf_params_init(&s.params, sizeof s.params), "pbf_params_init");
  s.params.smoothing_radius = support * s.spacing;
  s.params.spacing = s.spacing;
  s.params.domain_max[0] = 2 * side * s.spacing;
  s.params.domain_max[1] = 3;
  s.params.domain_max[2] = side * s.spacing;
  return s;
}

scene small_scene(uint32_t dimension) {
  scene s = {.name = "small",
             .dimension = dimension,
             .counts = {14, 16, 13},
             .first = {0.021, 0.017, 0.023},
             .spacing = 0.05,
             .jitter = 0.02};
  if (dimension == 2) s.counts[0] = 40, s.counts[1] = 30;
  must(pbf_params_init(&s.params, sizeof s.params), "pbf_params_init");
  s.params.cfm = 0.5;
  s.params.solver = PBF_SOLVER_JACOBI;
  s.params.cohesion = 0.5;
  s.params.min_diagonal = 0.5;
  s.params.wall_density = 0;
  s.params.collide = PBF_COLLIDE_IN_ITERATION | PBF_COLLIDE_AFTER_SOLVE;
  s.params.domain_max[0] = dimension == 2 ? 4 : 1.6;
  s.params.domain_max[1] = 2;
  s.params.domain_max[2] = 0.7;
  return s;
}

int add_optional(scene *s, const char *name) {
  pbf_params *p = &s->params;
  int found = 0;
#define PBF_PARAM_REAL(offset, param, initial, range, when, min_solver, low, high, usual, feature, \
                       projected, unit, doc)                                                       \
  if (usual != 0 && (name ? strcmp(name, #param) == 0 : p->param <= 0)) {                          \
    p->param = usual;                                                                              \
    if (PBF_SOLVER_##min_solver > (int)p->solver) p->solver = PBF_SOLVER_##min_solver;             \
    found = 1;                                                                                     \
  }
#include "physics/params.def"
  if (p->sleep_speed > 0) p->sleep_time = 0.5;
  return found;
}

void add_colliders(scene *s) {
  static const uint32_t shapes[4] = {PBF_COLLIDER_PLANE, PBF_COLLIDER_SPHERE, PBF_COLLIDER_CAPSULE,
                                     PBF_COLLIDER_BOX};
  for (uint32_t k = 0; k < 4; ++k) {
    pbf_collider *c = &s->colliders[k];
    must(pbf_collider_init(c, sizeof *c, shapes[k]), "pbf_collider_init");
    c->position[0] = 0.4 + 0.25 * k;
    c->position[1] = k == 0 ? 0.03 : 0.15;
    c->position[2] = 0.3;
    c->radius = c->half_length = 0.1;
    for (int a = 0; a < 3; ++a) c->half_extents[a] = 0.1;
    if (k > 0) c->velocity[0] = 0.2;
    if (k > 1) c->angular_velocity[2] = 1.5;
  }
  s->collider_count = 4;
}

/* So slow that neighbours stay neighbours. */
void add_turning_floor(scene *s) {
  pbf_collider *floor = &s->colliders[0];
  s->collider_count = 1;
  must(pbf_collider_init(floor, sizeof *floor, PBF_COLLIDER_PLANE), "pbf_collider_init");
  floor->position[1] = 0.001;
  floor->velocity[0] = 0.2;
  floor->angular_velocity[2] = 0.02;
}

enum { MANY = 64 };

/* The k-th of many. */
static pbf_collider many_collider(const scene *s, uint32_t k) {
  pbf_collider c;
  must(pbf_collider_init(&c, sizeof c, k == 0 ? PBF_COLLIDER_PLANE : 1 + k % 3),
       "pbf_collider_init");
  for (uint32_t a = 0; a < s->dimension && k > 0; ++a) {
    double size = s->spacing * s->counts[a];
    c.position[a] = size * (0.5 + 1.2 * noise(11 * k + a));
    c.velocity[a] = noise(11 * k + a + 4);
    c.half_extents[a] = s->spacing * (0.6 + noise(11 * k + a + 8));
  }
  c.radius = c.half_length = s->spacing * (0.7 + noise(977 * k));
  if (k % 4 == 3) c.angular_velocity[2] = 3;
  return c;
}

/* In and around the fluid, most of them under way. */
void add_many_colliders(scene *s) {
  for (uint32_t k = 0; k < MANY; ++k) s->colliders[k] = many_collider(s, k);
  s->collider_count = MANY;
}

/* The others turn far above it. */
void add_thousand_colliders(scene *s) {
  for (uint32_t k = 0; k < SCENE_COLLIDERS; ++k) {
    pbf_collider *c = &s->colliders[k];
    *c = many_collider(s, k * MANY / SCENE_COLLIDERS);
    if (k > 0 && k * MANY / SCENE_COLLIDERS != (k - 1) * MANY / SCENE_COLLIDERS) continue;
    if (k == 0) continue;
    must(pbf_collider_init(c, sizeof *c, 1 + k % 3), "pbf_collider_init");
    c->position[0] = 0.04 * (k % 40);
    c->position[1] = 1.6 + 0.04 * (k / 40 % 10);
    c->position[2] = s->dimension == 3 ? 0.2 * (k / 400) : 0;
    for (uint32_t a = 0; a < s->dimension; ++a) c->half_extents[a] = 0.3 * s->spacing;
    c->radius = c->half_length = 0.3 * s->spacing;
    c->angular_velocity[2] = 3;
  }
  s->collider_count = SCENE_COLLIDERS;
}

/* Round the whole fluid, which it holds. */
void add_container(scene *s, uint32_t shape) {
  pbf_collider *c = &s->colliders[0];
  must(pbf_collider_init(c, sizeof *c, shape), "pbf_collider_init");
  c->inverted = 1;
  c->radius = 0;
  for (uint32_t k = 0; k < s->dimension; ++k) {
    c->half_extents[k] = 0.5 * s->counts[k] * s->spacing;
    c->position[k] = s->first[k] - 0.5 * s->spacing + c->half_extents[k];
    c->radius += c->half_extents[k] * c->half_extents[k];
  }
  c->radius = sqrt(c->radius);
  c->angular_velocity[2] = 0.5;
  s->collider_count = 1;
  for (int k = 0; k < 3; ++k) s->params.domain_min[k] -= 2, s->params.domain_max[k] += 2;
}

scene accelerated_scene(uint32_t dimension, int brief) {
  scene s = small_scene(dimension);
  s.all_pairs = 1;
  s.params.solver = PBF_SOLVER_CHEBYSHEV;
  s.params.cohesion = 0;
  s.params.wall_density = 1;
  s.params.scorr_k = 1e-5;
  s.params.iterations = 6;
  for (int a = 0; a < 3; ++a) s.first[a] = 0.0252;
  s.params.time_step = brief ? 2e-4 : 0.01;
  if (!brief) s.params.gravity[1] = 0;
  s.params.smoothing_radius = s.spacing / 0.6; /* between two distances of the lattice */
  s.params.spacing = 1.0003 * s.spacing;
  return s;
}

void add_mirrors(scene *s) {
  s->params.smoothing_radius = 2.65 * s->spacing; /* between two distances of the lattice */
  s->params.spacing = 1.0003 * s->spacing;
  s->params.wall_density = 1;
  for (int a = 0; a < 3; ++a) {
    s->first[a] = 0.0252;
    if (a != 1) s->params.domain_max[a] = s->spacing * s->counts[a] + 0.0004;
  }
}

void set_kernel(scene *s, int combination) {
  if (combination & 1) {
    s->params.kernel = PBF_KERNEL_POLY6_SPIKY;
    s->params.cfm = 5;
  }
  if (combination & 2) s->params.scorr_k = 0.001;
}
