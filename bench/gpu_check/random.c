/* Scenes drawn at random, on the checked backend and on `reference`: what verify's scenes do not
 * think of. No bound on distances can be stated for them, as fluid that splashes forgets where its
 * particles were; so the yardstick is how far `reference` in float32 is from itself in float64. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <pbf/emit.h>
#include <pbf/phases.h>
#include <pbf/shapes.h>

#include "commands.h"
#include "solver.h"

/* ---- Drawing ------------------------------------------------------------------------------- */

static uint64_t drawn; /* splitmix64 */

static double unit(void) {
  uint64_t z = drawn += UINT64_C(0x9e3779b97f4a7c15);
  z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
  z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
  return (double)((z ^ z >> 31) >> 11) / 9007199254740992.0;
}

static double from(double low, double high) { return low + (high - low) * unit(); }
static int chance(double p) { return unit() < p; }
static uint32_t one_of(uint32_t choices) { return (uint32_t)(unit() * choices); }

typedef struct random_scene {
  scene of;
  uint32_t precision;
  pbf_emitter emitter;
  pbf_volume drain;
  int emits, drains;
  double phases[2]; /* densities of the lower and the upper half; 0: one fluid */
  char names[512];  /* what it has */
} random_scene;

static void note(random_scene *r, const char *name) {
  const size_t length = strlen(r->names);
  snprintf(r->names + length, sizeof r->names - length, "%s%s", length ? " " : "", name);
}

static void draw_domain(random_scene *r) {
  scene *s = &r->of;
  for (uint32_t k = 0; k < s->dimension; ++k) {
    const double wide = s->counts[k] * s->spacing, room = chance(0.3) ? 0 : from(0, 2) * wide;
    s->params.domain_max[k] = wide + room;
    s->first[k] = 0.5 * s->spacing + (chance(0.5) ? 0 : unit() * room);
  }
}

static void draw_params(random_scene *r) {
  static const double widths[6] = {1.7, 2, 2, 2, 2.4, 3};
  scene *s = &r->of;
  pbf_params *p = &s->params;
  must(pbf_params_init(p, sizeof *p), "pbf_params_init");
  p->spacing = s->spacing;
  p->smoothing_radius = widths[one_of(6)] * s->spacing;
  p->time_step = 1 / (60.0 * (1 << one_of(4)));
  p->iterations = 1 + one_of(8);
  if (chance(0.15)) p->gravity[1] = 0;
  if (chance(0.2)) p->gravity[0] = from(-5, 5);
  if (chance(0.1)) p->solver = PBF_SOLVER_JACOBI, note(r, "jacobi");
  if (chance(0.1)) p->kernel = PBF_KERNEL_POLY6_SPIKY, note(r, "poly6");
  if (chance(0.2)) p->max_substeps = 4, note(r, "substeps");
  if (chance(0.3)) p->loads = 1, note(r, "loads");
  draw_domain(r);
  if (!chance(0.2)) return;
  p->periodic = 1 + one_of(s->dimension == 3 ? 7 : 3); /* what falls there falls for ever */
  for (uint32_t k = 0; k < s->dimension; ++k)
    if (p->periodic >> k & 1) p->gravity[k] = 0;
  note(r, "periodic");
}

/* Most scenes have few. */
static void draw_optional(random_scene *r) {
  scene *s = &r->of;
  const double each = chance(0.5) ? 0.05 : 0.2;
#define PBF_PARAM_REAL(offset, param, initial, range, when, min_solver, low, high, usual, feature, \
                       projected, unit, doc)                                                       \
  if (usual != 0 && chance(each)) {                                                                \
    s->params.param = usual;                                                                       \
    if (PBF_SOLVER_##min_solver > (int)s->params.solver)                                           \
      s->params.solver = PBF_SOLVER_##min_solver;                                                  \
    note(r, #param);                                                                               \
  }
#include "physics/params.def"
  if (s->params.sleep_speed > 0) s->params.sleep_time = 0.1;
}

static void draw_walls(random_scene *r) {
  pbf_params *p = &r->of.params;
  const uint32_t wall = one_of(2 * r->of.dimension);
  if (!chance(0.2)) return;
  note(r, "walls");
  if (chance(0.5)) {
    p->wall_velocity[wall] = from(-0.3, 0.3);
  } else {
    p->wall_amplitude[wall] = from(0, 2) * r->of.spacing;
    p->wall_frequency[wall] = from(1, 12);
  }
}

static pbf_shape *draw_hull(const scene *s) {
  double points[10][3] = {{0}};
  pbf_shape *shape = NULL;
  for (int i = 0; i < 10; ++i)
    for (uint32_t k = 0; k < s->dimension; ++k) points[i][k] = from(-3, 3) * s->spacing;
  pbf_hull_desc hull = {.struct_size = sizeof hull, .dimension = s->dimension, .point_count = 10};
  double flat[20];
  for (int i = 0; i < 20; ++i) flat[i] = points[i / 2][i % 2];
  hull.points = s->dimension == 3 ? points[0] : flat;
  hull.cell = 0.5 * s->spacing;
  must(pbf_shape_from_points(&hull, &shape), "pbf_shape_from_points");
  return shape;
}

static void draw_turn(const scene *s, pbf_collider *c) {
  double length = 0;
  for (int k = s->dimension == 3 ? 0 : 2; k < 4; ++k) c->orientation[k] = from(-1, 1);
  for (int k = 0; k < 4; ++k) length += c->orientation[k] * c->orientation[k];
  for (int k = 0; k < 4; ++k) c->orientation[k] /= sqrt(length);
}

/* Whether a ball of 6 spacings there is apart from the fluid. */
static int is_apart(const scene *s, const double at[3]) {
  double r2 = 0;
  for (uint32_t k = 0; k < s->dimension; ++k) {
    const double low = s->first[k], high = low + (s->counts[k] - 1) * s->spacing;
    r2 += pow(fmax(fmax(low - at[k], at[k] - high), 0), 2);
  }
  return r2 > pow(6 * s->spacing, 2);
}

/* Mostly where no fluid is at first. */
static void draw_place(const scene *s, double at[3]) {
  for (int tries = chance(0.2) ? 1 : 30; tries > 0; --tries) {
    for (uint32_t k = 0; k < s->dimension; ++k) at[k] = unit() * s->params.domain_max[k];
    if (is_apart(s, at)) return;
  }
}

static void draw_collider(random_scene *r, pbf_collider *c) {
  static const uint32_t shapes[5] = {PBF_COLLIDER_PLANE, PBF_COLLIDER_SPHERE, PBF_COLLIDER_CAPSULE,
                                     PBF_COLLIDER_BOX, PBF_COLLIDER_SHAPE};
  const scene *s = &r->of;
  const uint32_t shape = shapes[chance(0.1) ? 0 : 1 + one_of(4)];
  must(pbf_collider_init(c, sizeof *c, shape), "pbf_collider_init");
  draw_place(s, c->position);
  for (uint32_t k = 0; k < s->dimension; ++k) c->half_extents[k] = from(0.5, 3.5) * s->spacing;
  c->radius = from(0.5, 3.5) * s->spacing;
  c->half_length = from(0.5, 2.5) * s->spacing;
  if (shape == PBF_COLLIDER_PLANE)
    c->axis[1] = 1, c->position[1] = 0.01;
  else
    draw_turn(s, c);
  if (shape == PBF_COLLIDER_SHAPE) c->geometry = draw_hull(s), c->scale = from(0.7, 1.5);
  if (chance(0.3)) c->velocity[one_of(s->dimension)] = from(-0.5, 0.5);
  if (chance(0.3) && shape != PBF_COLLIDER_PLANE) c->angular_velocity[2] = from(-4, 4);
  if (chance(0.2)) c->friction = 0.4;
  if (chance(0.2)) c->no_slip = 1;
}

static void draw_colliders(random_scene *r) {
  scene *s = &r->of;
  if (!chance(0.6)) return;
  s->collider_count = chance(0.2) ? 8 + one_of(30) : 1 + one_of(4);
  note(r, "colliders");
  for (uint32_t i = 0; i < s->collider_count; ++i) draw_collider(r, &s->colliders[i]);
  if (!chance(0.15)) return;
  pbf_collider *c = &s->colliders[0]; /* a container around half of the domain and more */
  pbf_release_shape(c->geometry);
  must(pbf_collider_init(c, sizeof *c, PBF_COLLIDER_BOX), "pbf_collider_init");
  c->inverted = 1;
  for (uint32_t k = 0; k < s->dimension; ++k) {
    c->position[k] = 0.5 * s->params.domain_max[k];
    c->half_extents[k] = from(0.35, 0.55) * s->params.domain_max[k];
  }
  note(r, "container");
}

static void draw_flow(random_scene *r) {
  const scene *s = &r->of;
  if ((r->emits = chance(0.15))) {
    note(r, "emitter");
    must(pbf_emitter_init(&r->emitter, sizeof r->emitter, PBF_EMITTER_RECTANGLE), "emitter");
    for (uint32_t k = 0; k < s->dimension; ++k)
      r->emitter.position[k] = from(0.4, 0.6) * s->params.domain_max[k];
    r->emitter.half_width = r->emitter.half_height = 2 * s->spacing;
    r->emitter.recycle = (uint32_t)chance(0.5);
    r->emitter.velocity[1] = -from(0.3, 2);
  }
  if ((r->drains = chance(0.1))) {
    note(r, "drain");
    must(pbf_volume_init(&r->drain, sizeof r->drain, PBF_VOLUME_SPHERE), "pbf_volume_init");
    r->drain.radius = 2 * s->spacing;
  }
}

static void draw(random_scene *r, uint64_t seed) {
  memset(r, 0, sizeof *r);
  drawn = seed * UINT64_C(0xd1342543de82ef95) + 1;
  r->of.name = "random";
  r->of.dimension = 2 + one_of(2);
  r->of.spacing = 0.05;
  r->of.jitter = chance(0.5) ? 0.02 : 0;
  r->precision = chance(0.3) ? PBF_FLOAT64 : PBF_FLOAT32;
  const uint32_t most = r->of.dimension == 2 ? 36 : 14;
  for (uint32_t k = 0; k < 3; ++k) r->of.counts[k] = 3 + one_of(most);
  draw_params(r);
  draw_optional(r);
  draw_walls(r);
  draw_colliders(r);
  draw_flow(r);
  if (chance(0.1)) r->phases[0] = 1, r->phases[1] = from(0.5, 2), note(r, "phases");
  /* It repeats iterations until the error is small: afterwards backends differ as after a splash.
   */
  r->of.params.prestabilization = 0;
}

/* ---- Running ------------------------------------------------------------------------------- */

static pbf_status set_phases(const random_scene *r, pbf_solver *solver, uint32_t count) {
  pbf_phase phases[2];
  uint32_t *of = malloc(count * sizeof *of);
  for (int i = 0; i < 2; ++i) {
    must(pbf_phase_init(&phases[i], sizeof phases[i]), "pbf_phase_init");
    phases[i].rest_density = r->phases[i];
  }
  for (uint32_t i = 0; i < count; ++i) of[i] = 2 * i >= count;
  pbf_status status = pbf_set_phases(solver, 2, phases);
  if (status == PBF_OK) status = pbf_set_particle_phases(solver, 0, count, of);
  free(of);
  return status;
}

/* What is refused is so with a sentence, the same by all backends. */
static pbf_status begin(const random_scene *r, const char *backend, uint32_t precision,
                        pbf_solver **out) {
  const scene *s = &r->of;
  const uint32_t count = scene_count(s);
  pbf_desc desc;
  pbf_solver *solver = NULL;
  must(pbf_desc_init(&desc, sizeof desc), "pbf_desc_init");
  desc.backend = backend;
  desc.strict = 1;
  desc.dimension = s->dimension;
  desc.precision = precision;
  desc.capacity = count + 200 * (uint32_t)r->emits;
  pbf_status status = pbf_create(&desc, &s->params, &solver);
  *out = solver;
  if (status != PBF_OK) return status;
  char *x = malloc((size_t)count * s->dimension * precision);
  for (uint32_t i = 0; i < count * s->dimension; ++i) {
    const float at = (float)scene_coordinate(s, i / s->dimension, i % s->dimension);
    if (precision == PBF_FLOAT32)
      ((float *)(void *)x)[i] = at;
    else
      ((double *)(void *)x)[i] = at;
  }
  status = pbf_add_particles(solver, count, x, NULL, NULL);
  free(x);
  if (status == PBF_OK && s->collider_count)
    status = pbf_set_colliders(solver, s->collider_count, s->colliders);
  if (status == PBF_OK && r->phases[0] > 0) status = set_phases(r, solver, count);
  if (status == PBF_OK && r->emits) status = pbf_set_emitters(solver, 1, &r->emitter);
  if (status == PBF_OK && r->drains) status = pbf_set_drains(solver, 1, &r->drain);
  return status;
}

enum { RUNS = 3 }; /* the checked one, the reference in float32, and in float64 */

typedef struct outcome {
  pbf_status status;
  char sentence[512];
  pbf_stats stats;
  double load[3]; /* of all colliders, a mean force */
} outcome;

static pbf_status measure(const scene *s, pbf_solver *solver, double time, outcome *o) {
  static pbf_collider_load loads[SCENE_COLLIDERS];
  o->stats = (pbf_stats){.struct_size = sizeof o->stats};
  pbf_status status = pbf_get_stats(solver, &o->stats);
  if (status != PBF_OK || !s->params.loads || !s->collider_count) return status;
  memset(loads, 0, sizeof loads);
  for (uint32_t i = 0; i < s->collider_count; ++i) loads[i].struct_size = sizeof loads[i];
  status = pbf_get_collider_loads(solver, s->collider_count, loads);
  for (uint32_t i = 0; i < s->collider_count; ++i)
    for (int k = 0; k < 3; ++k) o->load[k] += loads[i].impulse_sum[k] / time;
  return status;
}

static outcome run(const random_scene *r, const char *backend, uint32_t precision, uint32_t steps) {
  outcome o = {.status = PBF_OK};
  pbf_solver *solver = NULL;
  o.status = begin(r, backend, precision, &solver);
  if (o.status == PBF_OK) o.status = pbf_step(solver, steps);
  if (o.status == PBF_OK) o.status = measure(&r->of, solver, steps * r->of.params.time_step, &o);
  if (o.status != PBF_OK) snprintf(o.sentence, sizeof o.sentence, "%s", pbf_last_error());
  pbf_destroy(solver);
  return o;
}

/* ---- Judging ------------------------------------------------------------------------------- */

typedef struct measured {
  const char *name;
  double of[RUNS], floor; /* what two runs may differ by in any case */
} measured;

static int is_near(const measured *m, double part) {
  const double own = fabs(m->of[1] - m->of[2]), off = fabs(m->of[0] - m->of[2]);
  return off <= 4 * own + part * m->floor;
}

/* The floors are what chaos alone makes of scenes of a few hundred particles. */
static int judge(const random_scene *r, uint64_t seed, uint32_t steps, const outcome o[RUNS]) {
  const scene *s = &r->of;
  const double part = steps < 10 ? 0.2 : 1;
  const double d = s->spacing, c = sqrt(10 * d), n = scene_count(s);
  const pbf_stats *t[RUNS] = {&o[0].stats, &o[1].stats, &o[2].stats};
  int good = 1;
  double weight = 10 * n * pow(d, s->dimension);
#define OF(value) {t[0]->value, t[1]->value, t[2]->value}
  measured all[] = {
      {"x", OF(center_of_mass[0]), 0.3 * d},
      {"y", OF(center_of_mass[1]), 0.3 * d},
      {"z", OF(center_of_mass[2]), 0.3 * d},
      {"kinetic energy", OF(kinetic_energy), 0.02 * c * c + 0.15 * t[2]->kinetic_energy},
      {"density error", OF(density_error_mean), 0.004 + 0.25 * t[2]->density_error_mean},
      {"density", OF(density_mean), 0.01},
      {"count", OF(count), 0.02 * n},
      {"squeezed", OF(squeezed), 0.03 * n},
      {"load x", {o[0].load[0], o[1].load[0], o[2].load[0]}, 0.1 * weight},
      {"load y", {o[0].load[1], o[1].load[1], o[2].load[1]}, 0.1 * weight},
  };
#undef OF
  printf(
      "{\"check\": \"random\", \"seed\": %llu, \"dimension\": %u, \"precision\": %u, "
      "\"particles\": %u, \"steps\": %u, \"time_step\": %.4g, \"support\": %.3g, \"has\": \"%s\"",
      (unsigned long long)seed, s->dimension, 8 * r->precision, scene_count(s), steps,
      s->params.time_step, s->params.smoothing_radius / d, r->names);
  for (size_t i = 0; i < sizeof all / sizeof *all; ++i) {
    if (is_near(&all[i], part)) continue;
    good = 0;
    printf(", \"%s\": [%.5g, %.5g, %.5g]", all[i].name, all[i].of[0], all[i].of[1], all[i].of[2]);
  }
  return good;
}

/* Whether `ours` has come out as the reference has. */
static int check(const random_scene *r, uint64_t seed, uint32_t steps) {
  const outcome o[RUNS] = {run(r, checked_backend, r->precision, steps),
                           run(r, "reference", PBF_FLOAT32, steps),
                           run(r, "reference", PBF_FLOAT64, steps)};
  const outcome *same = &o[r->precision == PBF_FLOAT32 ? 1 : 2];
  int good = o[0].status == same->status && strcmp(o[0].sentence, same->sentence) == 0;
  if (good && o[0].status != PBF_OK) return 1;
  if (!good)
    printf(
        "{\"check\": \"random\", \"seed\": %llu, \"has\": \"%s\", \"sentences\": [\"%s\", \"%s\"]",
        (unsigned long long)seed, r->names, o[0].sentence, same->sentence);
  else
    good = judge(r, seed, steps, o);
  printf(", \"good\": %s}\n", good ? "true" : "false");
  fflush(stdout);
  return good;
}

int random_all(uint64_t first, uint64_t count) {
  static random_scene r;
  int failures = 0;
  for (uint64_t seed = first; seed < first + count; ++seed) {
    draw(&r, seed);
    failures += !check(&r, seed, 3) || !check(&r, seed, 40);
    for (uint32_t i = 0; i < r.of.collider_count; ++i)
      pbf_release_shape(r.of.colliders[i].geometry);
  }
  return failures;
}
