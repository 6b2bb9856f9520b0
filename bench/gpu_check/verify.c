/* verify: how far results are from those of `reference` in float64. */
#include "commands.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "solver.h"

typedef struct distance {
  double rms, max; /* in spacings */
} distance;

static distance between(pbf_solver *a, uint32_t precision, pbf_solver *b, const scene *s) {
  uint32_t count, dim = s->dimension;
  must(pbf_get_count(a, &count), "pbf_get_count");
  double *x = positions_of(a, count, dim, precision);
  double *y = positions_of(b, count, dim, PBF_FLOAT64);
  distance d = {0, 0};
  for (uint32_t i = 0; i < count; ++i) {
    double r2 = 0;
    for (uint32_t k = 0; k < dim; ++k) r2 += pow(x[i * dim + k] - y[i * dim + k], 2);
    d.rms += r2;
    if (!(sqrt(r2) <= d.max)) d.max = sqrt(r2);
  }
  d.rms = sqrt(d.rms / count) / s->spacing;
  d.max /= s->spacing;
  free(x);
  free(y);
  return d;
}

static double relative(double a, double b) {
  return fabs(a - b) / fmax(fmax(fabs(a), fabs(b)), 1e-12);
}

/* Two speeds that come from the same fluid: what densities are rounded by is undone within a step,
 * too, and in a short one that is a speed, however slow the fluid is. */
static int speeds_agree(double a, double b, double bound, const scene *s, uint32_t precision) {
  double rounding = precision == PBF_FLOAT32 ? 1e-5 : 1e-14;
  double noise = rounding * s->params.smoothing_radius / s->params.time_step;
  return fabs(a - b) <= bound * fmax(fabs(a), fabs(b)) + noise;
}

/* `by_stage`: with a drag that changes no number, yet is a stage that the kernel of small scenes
 * does not know. */
static const double no_drag = 1e-30;

/* What a bound can be set to: distances after few steps of one iteration each. Where a step has
 * several, a backend with neighbour lists need not meet pairs that come near within it (Algorithm 1
 * finds neighbours once a step), one that walks cells does: there distances are reported only,
 * unless the scene says that this makes no difference. */
static int strictly_near(const scene *given, uint32_t precision, int by_stage, distance *d) {
  scene s = *given;
  if (by_stage) s.params.drag = no_drag;
  if (!s.all_pairs) s.params.iterations = 1;
  /* What one iteration leaves would call for the grid, whose sums are rounded to 2^-20. */
  if (s.params.pressure_grid < 0) s.params.pressure_grid = 0;
  s.params.prestabilization = 0; /* sixteen iterations in one */
  pbf_solver *ours = solver_for(&s, checked_backend, precision);
  pbf_solver *oracle = solver_for(&s, "reference", PBF_FLOAT64);
  must(pbf_step(ours, 3), "pbf_step");
  must(pbf_step(oracle, 3), "pbf_step");
  *d = between(ours, precision, oracle, &s);
  pbf_stats a = stats_of(ours), b = stats_of(oracle);
  double bound = precision == PBF_FLOAT32 ? 2e-3 : 1e-9;
  /* The last stages sum over pairs after the move: there, too, lists and cells may differ. */
  if (s.params.vorticity > 0 && precision == PBF_FLOAT64) bound = 1e-5;
  pbf_destroy(ours);
  pbf_destroy(oracle);
  return d->max <= bound && relative(a.density_mean, b.density_mean) <= bound &&
         speeds_agree(sqrt(2 * a.kinetic_energy), sqrt(2 * b.kinetic_energy), bound / 2, &s,
                      precision) &&
         fabs(a.density_error_mean - b.density_error_mean) <= bound * b.density_mean &&
         relative(a.neighbors_mean, b.neighbors_mean) <= bound &&
         speeds_agree(a.speed_max, b.speed_max, bound, &s, precision);
}

/* Whether it is near. */
static int verify_way(const char *name, const scene *given, uint32_t precision, uint32_t steps,
                      int by_stage) {
  distance strict, first, last;
  scene own = *given, *s = &own;
  if (by_stage) s->params.drag = no_drag;
  int good = strictly_near(s, precision, by_stage, &strict);
  pbf_solver *ours = solver_for(s, checked_backend, precision);
  pbf_solver *oracle = solver_for(s, "reference", PBF_FLOAT64);
  must(pbf_step(ours, 1), "pbf_step");
  must(pbf_step(oracle, 1), "pbf_step");
  first = between(ours, precision, oracle, s);
  must(pbf_step(ours, steps - 1), "pbf_step");
  must(pbf_step(oracle, steps - 1), "pbf_step");
  last = between(ours, precision, oracle, s);
  pbf_stats a = stats_of(ours), b = stats_of(oracle);
  double away = 0;
  for (int k = 0; k < 3; ++k)
    away = fmax(away, fabs(a.center_of_mass[k] - b.center_of_mass[k]) / s->spacing);
  printf(
      "{\"check\": \"verify\", \"scene\": \"%s\", \"dimension\": %u, \"precision\": %u, "
      "\"by_stage\": %d, \"particles\": %u, \"one_iteration_3_steps_max\": %.3g, "
      "\"steps\": %u, \"rms_after_1\": %.3g, \"max_after_1\": %.3g, \"rms_after_all\": %.3g, "
      "\"max_after_all\": %.3g, \"center_of_mass\": %.3g, \"density_error_mean\": [%.5f, %.5f], "
      "\"good\": %s}\n",
      name, s->dimension, 8 * precision, by_stage, scene_count(s), strict.max, steps, first.rms,
      first.max, last.rms, last.max, away, a.density_error_mean, b.density_error_mean,
      good ? "true" : "false");
  fflush(stdout);
  pbf_destroy(ours);
  pbf_destroy(oracle);
  return good;
}

/* What all scenes of a dimension and a precision have in common. */
typedef struct kind {
  uint32_t dim, precision;
  const char *only; /* the scene to verify; null: all */
  int failures, verified;
} kind;

static void verify(kind *k, const char *name, const scene *s, uint32_t steps) {
  if (k->only && strcmp(k->only, name) != 0) return;
  ++k->verified;
  k->failures += !verify_way(name, s, k->precision, steps, 0);
  if (k->precision == PBF_FLOAT32 && scene_count(s) < 5000)
    k->failures += !verify_way(name, s, k->precision, steps, 1);
}

static void verify_kernels(kind *k) {
  static const char *const kernels[4] = {"wendland", "poly6", "wendland-scorr", "poly6-scorr"};
  char name[96];
  for (int combination = 0; combination < 4; ++combination) {
    scene s = small_scene(k->dim);
    set_kernel(&s, combination);
    verify(k, kernels[combination], &s, 50);
    s.params.vorticity = 0.05;
    s.params.viscosity = 0.05;
    s.params.scorr_n = 3;
    s.params.iterations = 3;
    snprintf(name, sizeof name, "%s-vorticity-viscosity", kernels[combination]);
    verify(k, name, &s, 50);
  }
}

static void verify_obstacles(kind *k) {
  scene s = small_scene(k->dim);
  add_colliders(&s);
  s.params.collide = PBF_COLLIDE_AFTER_PREDICTION | PBF_COLLIDE_IN_ITERATION;
  s.params.wall_velocity[PBF_WALL_X_MAX] = -0.3;
  s.params.wall_amplitude[PBF_WALL_X_MIN] = 0.05;
  s.params.wall_frequency[PBF_WALL_X_MIN] = 9;
  verify(k, "colliders-and-moving-walls", &s, 50);
  s.params.wall_density = 1;
  s.params.cohesion = 0;
  s.params.solver = PBF_SOLVER_CHEBYSHEV;
  verify(k, "wall-density-chebyshev-colliders", &s, 50);
  s = small_scene(k->dim);
  add_many_colliders(&s);
  verify(k, "many-colliders", &s, 50);
  s.params.collide |= PBF_COLLIDE_AFTER_PREDICTION;
  s.params.wall_density = 1;
  s.params.cohesion = 0;
  s.params.solver = PBF_SOLVER_CHEBYSHEV;
  verify(k, "many-colliders-wall-density", &s, 50);
  add_thousand_colliders(&s);
  verify(k, "thousand-colliders-wall-density", &s, 50);
  s = small_scene(k->dim);
  add_thousand_colliders(&s);
  verify(k, "thousand-colliders", &s, 50);
}

static void verify_containers(kind *k) {
  static const struct {
    uint32_t shape;
    const char *name;
  } containers[] = {{PBF_COLLIDER_SPHERE, "in-a-turning-sphere"},
                    {PBF_COLLIDER_CAPSULE, "in-a-turning-capsule"},
                    {PBF_COLLIDER_BOX, "in-a-turning-box"}};
  for (int c = 0; c < 3; ++c) {
    scene s = small_scene(k->dim);
    add_container(&s, containers[c].shape);
    s.params.solver = PBF_SOLVER_CHEBYSHEV;
    s.params.wall_density = 1;
    s.params.cohesion = 0;
    s.params.collide |= PBF_COLLIDE_AFTER_PREDICTION;
    verify(k, containers[c].name, &s, 50);
  }
}

/* Many more neighbours than lists have room for. */
static void widen(scene *s, double smoothing_radius) {
  s->params.smoothing_radius = smoothing_radius;
  s->params.spacing = 0.15;
  s->params.particle_volume = pow(0.05, s->dimension);
  s->params.over_relaxation = 0.05;
}

static void verify_overflow(kind *k) {
  scene s = small_scene(k->dim);
  widen(&s, 0.2);
  verify(k, "lists-overflow", &s, 10);
  s = accelerated_scene(k->dim, 0);
  widen(&s, 0.1935);
  verify(k, "chebyshev-lists-overflow", &s, 10);
}

/* Torn a little from the start, and hardly heavy. */
static void verify_pull(kind *k) {
  scene s = accelerated_scene(k->dim, 0);
  s.params.cohesion = 1;
  s.params.scorr_k = 0;
  s.params.spacing = 0.998 * s.spacing;
  s.params.gravity[1] = -0.2;
  verify(k, "held-together", &s, 10);
}

/* Falling, so that there is something to correct. */
static void verify_torque(kind *k) {
  scene s = accelerated_scene(k->dim, 0);
  s.params.angular_momentum_correction = 1;
  s.params.gravity[1] = -0.5;
  verify(k, "torque-correction", &s, 10);
  s.params.damping_compensation = 0.8;
  verify(k, "torque-correction-damping_compensation", &s, 10);
}

/* Pressed together by its weight. */
static void verify_shear_stress(kind *k) {
  scene s = accelerated_scene(k->dim, 0);
  s.params.shear_stress_correction = 0.7;
  verify(k, "shear-stress", &s, 10);
  s.params.angular_momentum_correction = s.params.damping_compensation = 1;
  add_turning_floor(&s);
  verify(k, "shear-stress-over-a-turning-floor", &s, 10);
  s = accelerated_scene(k->dim, 0);
  add_mirrors(&s);
  s.params.shear_stress_correction = 0.7;
  verify(k, "shear-stress-mirrors", &s, 10);
}

static void verify_viscosity(kind *k) {
  scene s = accelerated_scene(k->dim, 0);
  s.params.viscosity = 0.02;
  verify(k, "viscous", &s, 10);
  add_turning_floor(&s);
  s.params.wall_no_slip = 1;
  for (uint32_t c = 0; c < s.collider_count; ++c) s.colliders[c].no_slip = 1;
  verify(k, "viscous-no-slip", &s, 10);
}

static void verify_adhesion(kind *k) {
  scene s = accelerated_scene(k->dim, 0);
  s.params.surface_tension = 0.002;
  add_turning_floor(&s);
  s.params.wall_adhesion = 0.4;
  for (uint32_t c = 0; c < s.collider_count; ++c) s.colliders[c].adhesion = 0.7;
  verify(k, "adhesion", &s, 10);
}

/* In a box that is full at first and then too small: its lid comes down. */
static void verify_overfull(kind *k) {
  static const char *const names[3] = {"overfull", "overfull-short-steps", "overfull-deep"};
  for (int c = 0; c < 3; ++c) {
    scene s = accelerated_scene(k->dim, c == 1);
    for (uint32_t axis = 0; axis < k->dim; ++axis)
      s.params.domain_max[axis] = s.counts[axis] * s.spacing;
    for (uint32_t axis = 0; axis < k->dim; ++axis) s.first[axis] = 0.5 * s.spacing;
    s.params.wall_velocity[PBF_WALL_Y_MAX] = -0.02 * s.spacing / s.params.time_step;
    if (c == 2) s.params.pressure_grid = 2, s.params.gravity[1] = -9.81;
    verify(k, names[c], &s, 10);
  }
}

static void verify_iterations(kind *k) {
  scene s = accelerated_scene(k->dim, 0);
  verify(k, "chebyshev-all-iterations", &s, 50);
  s.params.damping_compensation = 1;
  verify(k, "damping_compensation", &s, 50);
  add_turning_floor(&s);
  verify(k, "damping_compensation-over-a-turning-floor", &s, 50);
  s = accelerated_scene(k->dim, 1);
  verify(k, "chebyshev-short-steps", &s, 50);
}

/* Few steps: the reference takes its time for images. */
static void verify_mirrors(kind *k) {
  static const char *const kernels[4] = {"mirrors", "mirrors-poly6", "mirrors-scorr",
                                         "mirrors-poly6-scorr"};
  for (int combination = 0; combination < 4; ++combination) {
    scene s = accelerated_scene(k->dim, 0);
    add_mirrors(&s);
    s.params.scorr_k = 0;
    set_kernel(&s, combination);
    if (combination == 1) s.params.damping_compensation = 1;
    if (combination == 2) s.params.wall_density = 0.5;
    verify(k, kernels[combination], &s, 10);
  }
  scene s = accelerated_scene(k->dim, 1);
  add_mirrors(&s);
  verify(k, "mirrors-short-steps", &s, 10);
  s = small_scene(k->dim);
  add_mirrors(&s);
  s.params.pressure_grid = 2;
  s.params.solver = PBF_SOLVER_CHEBYSHEV;
  s.params.cohesion = 0;
  verify(k, "mirrors-deep", &s, 10);
  s = small_scene(k->dim);
  add_mirrors(&s);
  add_turning_floor(&s);
  s.params.wall_velocity[PBF_WALL_X_MAX] = -0.3;
  verify(k, "mirrors-and-what-moves", &s, 10);
}

static void verify_places(kind *k) {
  scene s = small_scene(k->dim);
  for (int a = 0; a < 3; ++a) s.params.domain_max[a] = k->precision == PBF_FLOAT32 ? 4e3 : 1e6;
  verify(k, "vast-domain", &s, 50);
  s.counts[0] = k->dim == 2 ? 400 : 160; /* longer than what the domain is folded to */
  s.counts[1] = s.counts[2] = k->dim == 2 ? 5 : 4;
  verify(k, "vast-domain-canal", &s, 50);
  s = small_scene(k->dim);
  s.params.collide = PBF_COLLIDE_AFTER_SOLVE;
  for (int a = 0; a < 3; ++a) s.first[a] -= 700, s.params.domain_min[a] -= 700;
  for (int a = 0; a < 3; ++a) s.params.domain_max[a] -= 700;
  if (k->precision == PBF_FLOAT64) verify(k, "far-from-origin", &s, 50);
}

static void verify_crowding(kind *k) {
  scene s = small_scene(k->dim);
  s.params.gravity[1] = 0;
  s.params.attraction = 3;
  s.params.attraction_center[0] = s.params.attraction_center[1] = 0.5;
  verify(k, "attraction", &s, 50);
  s = small_scene(k->dim);
  s.spacing = 1e-4; /* all in a cell or two */
  s.params.particle_volume = pow(0.05, k->dim);
  s.params.over_relaxation = 1e-4;
  s.params.gravity[1] = 0;
  verify(k, "one-cell", &s, 3);
}

static void verify_large(kind *k) {
  scene s = report_30k();
  verify(k, "report-30k", &s, 50);
  s = shallow_dam_break(27000, 1 / 0.6);
  verify(k, "shallow-dam-break", &s, 50);
  s = shallow_dam_break(27000, 2);
  s.jitter = 0.02; /* on the lattice, whether 2 d is nearer than h = 2 d is a matter of rounding */
  verify(k, "shallow-dam-break-2d", &s, 50);
}

static void verify_kind(kind *k) {
  verify_kernels(k);
  verify_obstacles(k);
  verify_viscosity(k);
  verify_adhesion(k);
  verify_containers(k);
  verify_overflow(k);
  verify_iterations(k);
  verify_pull(k);
  verify_torque(k);
  verify_shear_stress(k);
  verify_overfull(k);
  verify_mirrors(k);
  verify_places(k);
  verify_crowding(k);
}

int verify_all(const char *name) {
  static const struct {
    const char *name;
    uint32_t dim, precision;
    void (*verify)(kind *k);
  } parts[5] = {{"2d-f32", 2, PBF_FLOAT32, verify_kind},
                {"2d-f64", 2, PBF_FLOAT64, verify_kind},
                {"3d-f32", 3, PBF_FLOAT32, verify_kind},
                {"3d-f64", 3, PBF_FLOAT64, verify_kind},
                {"large", 3, PBF_FLOAT32, verify_large}};
  kind k = {.only = name};
  for (int part = 0; name && part < 5; ++part)
    if (strcmp(name, parts[part].name) == 0) k.only = NULL;
  for (int part = 0; part < 5; ++part) {
    if (name && !k.only && strcmp(name, parts[part].name) != 0) continue;
    k.dim = parts[part].dim;
    k.precision = parts[part].precision;
    parts[part].verify(&k);
  }
  if (k.verified) return k.failures;
  fprintf(stderr, "gpu_check: there is no scene or part %s\n", name);
  return 1;
}
