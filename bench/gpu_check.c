/* Checks and times one backend (default "cuda") through the public API alone, for machines that
 * have a GPU and little else:
 *
 *   gpu_check verify [SCENE]      distance to the float64 reference, every kind of scene
 *   gpu_check same                the same bits in two runs, and after saving and loading
 *   gpu_check exercise            every call and stage once, small, for compute-sanitizer
 *   gpu_check time SCENE N [H/D]  report-30k or shallow-dam-break: time, error, plan, stages
 *
 * Prints one JSON object a line. Exit code 1 when a check failed, 2 when there is no device. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <pbf/pbf.h>

static const char *backend = "cuda";
static int failures;

static void must(pbf_status status, const char *what) {
  if (status == PBF_OK) return;
  fprintf(stderr, "%s: %s: %s\n", what, pbf_status_string(status), pbf_last_error());
  exit(status == PBF_ERROR_UNAVAILABLE ? 2 : 1);
}

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

typedef struct scene {
  const char *name;
  uint32_t dimension;
  pbf_params params;
  uint32_t counts[3];
  double first[3], spacing;
  uint32_t collider_count;
  pbf_collider colliders[PBF_MAX_COLLIDERS];
  double jitter;     /* of the lattice, in spacings */
  const char *extra; /* what is timed beside the defaults */
  int all_pairs;     /* no neighbour comes or goes in a step's iterations, or no lists are there */
} scene;

static uint32_t scene_count(const scene *s) {
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

static double coordinate(const scene *s, uint32_t particle, uint32_t axis) {
  uint32_t at[3] = {particle % s->counts[0], particle / s->counts[0] % s->counts[1],
                    particle / s->counts[0] / s->counts[1]};
  return s->first[axis] +
         s->spacing * (at[axis] + s->jitter * noise(particle * s->dimension + axis));
}

static pbf_solver *solver_for(const scene *s, const char *name, uint32_t precision) {
  pbf_desc desc;
  pbf_solver *solver;
  uint32_t count = scene_count(s), dim = s->dimension;
  must(pbf_desc_init(&desc, sizeof desc), "pbf_desc_init");
  desc.backend = name;
  desc.strict = 1;
  desc.dimension = dim;
  desc.precision = precision;
  desc.capacity = count;
  if (getenv("PBF_CHECK_CAPACITY")) /* a backend may choose its way by the capacity */
    desc.capacity = (uint32_t)strtoul(getenv("PBF_CHECK_CAPACITY"), NULL, 10);
  must(pbf_create(&desc, &s->params, &solver), "pbf_create");
  void *positions = malloc((size_t)count * dim * precision);
  for (uint32_t i = 0; i < count; ++i)
    for (uint32_t k = 0; k < dim; ++k) {
      size_t at = (size_t)i * dim + k;
      if (precision == PBF_FLOAT32)
        ((float *)positions)[at] = (float)coordinate(s, i, k);
      else /* the same numbers as in float32 */
        ((double *)positions)[at] = (float)coordinate(s, i, k);
    }
  must(pbf_add_particles(solver, count, positions, NULL, NULL), "pbf_add_particles");
  free(positions);
  if (s->collider_count)
    must(pbf_set_colliders(solver, s->collider_count, s->colliders), "pbf_set_colliders");
  return solver;
}

static double *positions_of(pbf_solver *solver, uint32_t count, uint32_t dim, uint32_t precision) {
  double *out = malloc(sizeof(double) * count * dim);
  if (precision == PBF_FLOAT64) {
    must(pbf_get_positions(solver, 0, count, out), "pbf_get_positions");
    return out;
  }
  float *read = malloc(sizeof(float) * count * dim);
  must(pbf_get_positions(solver, 0, count, read), "pbf_get_positions");
  for (size_t k = 0; k < (size_t)count * dim; ++k) out[k] = read[k];
  free(read);
  return out;
}

/* ---- Scenes -------------------------------------------------------------------------------- */

static scene report_30k(void) {
  scene s = {.name = "report-30k",
             .dimension = 2,
             .counts = {500, 60},
             .first = {0.25, 0.25},
             .spacing = 0.575};
  must(pbf_params_init(&s.params, sizeof s.params), "pbf_params_init");
  pbf_params *p = &s.params;
  p->kernel = PBF_KERNEL_POLY6_SPIKY;
  p->solver = PBF_SOLVER_JACOBI;
  p->separation = p->min_diagonal = p->wall_density = 0;
  p->smoothing_radius = 1.1;
  p->spacing = 0.575;
  p->particle_volume = 0.5138132684248845;
  p->time_step = 0.05;
  p->iterations = 5;
  p->collide = PBF_COLLIDE_AFTER_PREDICTION | PBF_COLLIDE_AFTER_SOLVE;
  p->gravity[1] = -3;
  p->relaxation = 0.8203125;
  p->epsilon = 17.179038485712607;
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

static scene shallow_dam_break(uint32_t particles, double support) {
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

static scene small_scene(uint32_t dimension) {
  scene s = {.name = "small",
             .dimension = dimension,
             .counts = {14, 16, 13},
             .first = {0.021, 0.017, 0.023},
             .spacing = 0.05,
             .jitter = 0.02};
  if (dimension == 2) s.counts[0] = 40, s.counts[1] = 30;
  must(pbf_params_init(&s.params, sizeof s.params), "pbf_params_init");
  s.params.epsilon = 0.5;
  s.params.solver = PBF_SOLVER_JACOBI;
  s.params.separation = 0.5;
  s.params.min_diagonal = 0.5;
  s.params.wall_density = 0;
  s.params.collide = PBF_COLLIDE_IN_ITERATION | PBF_COLLIDE_AFTER_SOLVE;
  s.params.domain_max[0] = dimension == 2 ? 4 : 1.6;
  s.params.domain_max[1] = 2;
  s.params.domain_max[2] = 0.7;
  return s;
}

static void add_colliders(scene *s) {
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
static void add_turning_floor(scene *s) {
  pbf_collider *floor = &s->colliders[0];
  s->collider_count = 1;
  must(pbf_collider_init(floor, sizeof *floor, PBF_COLLIDER_PLANE), "pbf_collider_init");
  floor->position[1] = 0.001;
  floor->velocity[0] = 0.2;
  floor->angular_velocity[2] = 0.02;
}

/* As many as there may be, in and around the fluid, most of them under way. */
static void add_many_colliders(scene *s) {
  for (uint32_t k = 0; k < PBF_MAX_COLLIDERS; ++k) {
    pbf_collider *c = &s->colliders[k];
    must(pbf_collider_init(c, sizeof *c, k == 0 ? PBF_COLLIDER_PLANE : 1 + k % 3),
         "pbf_collider_init");
    for (uint32_t a = 0; a < s->dimension && k > 0; ++a) {
      double size = s->spacing * s->counts[a];
      c->position[a] = size * (0.5 + 1.2 * noise(11 * k + a));
      c->velocity[a] = noise(11 * k + a + 4);
      c->half_extents[a] = s->spacing * (0.6 + noise(11 * k + a + 8));
    }
    c->radius = c->half_length = s->spacing * (0.7 + noise(977 * k));
    if (k % 4 == 3) c->angular_velocity[2] = 3;
  }
  s->collider_count = PBF_MAX_COLLIDERS;
}

/* Round the whole fluid, which it holds. */
static void add_container(scene *s, uint32_t shape) {
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

/* ---- verify -------------------------------------------------------------------------------- */

static const char *only; /* the scene to verify; null: all */

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

static pbf_stats stats_of(pbf_solver *solver) {
  pbf_stats stats = {.struct_size = sizeof stats};
  must(pbf_get_stats(solver, &stats), "pbf_get_stats");
  return stats;
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

/* What a bound can be set to: distances after few steps of one iteration each. Where a step has
 * several, a backend with neighbour lists need not meet pairs that come near within it (Algorithm 1
 * finds neighbours once a step), one that walks cells does: there distances are reported only,
 * unless the scene says that this makes no difference. */
static int strictly_near(const scene *given, uint32_t precision, int timed, distance *d) {
  scene s = *given;
  if (!s.all_pairs) s.params.iterations = 1;
  /* What one iteration leaves would call for the grid, whose sums are rounded to 2^-20. */
  if (s.params.pressure_grid < 0) s.params.pressure_grid = 0;
  s.params.prestabilization = 0; /* sixteen iterations in one */
  pbf_solver *ours = solver_for(&s, backend, precision);
  pbf_solver *oracle = solver_for(&s, "reference", PBF_FLOAT64);
  if (timed) pbf_set_timing(ours, 1);
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

/* `timed`: with the times of stages on, for which a backend may take another way. */
static void verify_way(const char *name, const scene *s, uint32_t precision, uint32_t steps,
                       int timed) {
  distance strict, first, last;
  int good = strictly_near(s, precision, timed, &strict);
  pbf_solver *ours = solver_for(s, backend, precision);
  pbf_solver *oracle = solver_for(s, "reference", PBF_FLOAT64);
  if (timed) pbf_set_timing(ours, 1);
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
  failures += !good;
  printf(
      "{\"check\": \"verify\", \"scene\": \"%s\", \"dimension\": %u, \"precision\": %u, "
      "\"stage_times\": %d, \"particles\": %u, \"one_iteration_3_steps_max\": %.3g, "
      "\"steps\": %u, \"rms_after_1\": %.3g, \"max_after_1\": %.3g, \"rms_after_all\": %.3g, "
      "\"max_after_all\": %.3g, \"center_of_mass\": %.3g, \"density_error_mean\": [%.5f, %.5f], "
      "\"good\": %s}\n",
      name, s->dimension, 8 * precision, timed, scene_count(s), strict.max, steps, first.rms,
      first.max, last.rms, last.max, away, a.density_error_mean, b.density_error_mean,
      good ? "true" : "false");
  fflush(stdout);
  pbf_destroy(ours);
  pbf_destroy(oracle);
}

static void verify(const char *name, const scene *s, uint32_t precision, uint32_t steps) {
  if (only && strcmp(only, name) != 0) return;
  verify_way(name, s, precision, steps, 0);
  if (precision == PBF_FLOAT32 && scene_count(s) < 5000) verify_way(name, s, precision, steps, 1);
}

/* Pressed a little from the start, with all that differs from iteration to iteration; so slow that
 * neighbours stay neighbours. With `brief` steps a part of the density error is left. */
static scene accelerated_scene(uint32_t dimension, int brief) {
  scene s = small_scene(dimension);
  s.all_pairs = 1;
  s.params.solver = PBF_SOLVER_CHEBYSHEV;
  s.params.separation = s.params.wall_density = 1;
  s.params.scorr_k = 1e-5;
  s.params.iterations = 6;
  for (int a = 0; a < 3; ++a) s.first[a] = 0.0252;
  s.params.time_step = brief ? 2e-4 : 0.01;
  if (!brief) s.params.gravity[1] = 0;
  s.params.smoothing_radius = s.spacing / 0.6; /* between two distances of the lattice */
  s.params.spacing = 1.0003 * s.spacing;
  return s;
}

static void set_kernel(scene *s, int combination) {
  if (combination & 1) {
    s->params.kernel = PBF_KERNEL_POLY6_SPIKY;
    s->params.epsilon = 5;
  }
  if (combination & 2) s->params.scorr_k = 0.001;
}

static void verify_all(void) {
  static const char *const kernels[4] = {"wendland", "poly6", "wendland-scorr", "poly6-scorr"};
  char name[96];
  for (uint32_t dim = 2; dim <= 3; ++dim)
    for (uint32_t precision = PBF_FLOAT32; precision <= PBF_FLOAT64; precision += 4) {
      for (int k = 0; k < 4; ++k) {
        scene s = small_scene(dim);
        set_kernel(&s, k);
        verify(kernels[k], &s, precision, 50);
        s.params.vorticity = 0.05;
        s.params.viscosity = 0.05;
        s.params.scorr_n = 3;
        s.params.iterations = 3;
        snprintf(name, sizeof name, "%s-vorticity-viscosity", kernels[k]);
        verify(name, &s, precision, 50);
      }
      scene s = small_scene(dim);
      add_colliders(&s);
      s.params.collide = PBF_COLLIDE_AFTER_PREDICTION | PBF_COLLIDE_IN_ITERATION;
      s.params.wall_velocity[PBF_WALL_X_MAX] = -0.3;
      s.params.wall_amplitude[PBF_WALL_X_MIN] = 0.05;
      s.params.wall_frequency[PBF_WALL_X_MIN] = 9;
      verify("colliders-and-moving-walls", &s, precision, 50);
      s.params.wall_density = 1;
      s.params.separation = 1;
      s.params.solver = PBF_SOLVER_CHEBYSHEV;
      verify("wall-density-chebyshev-colliders", &s, precision, 50);
      s = small_scene(dim);
      add_many_colliders(&s);
      verify("many-colliders", &s, precision, 50);
      s.params.collide |= PBF_COLLIDE_AFTER_PREDICTION;
      s.params.wall_density = s.params.separation = 1;
      s.params.solver = PBF_SOLVER_CHEBYSHEV;
      verify("many-colliders-wall-density", &s, precision, 50);
      for (uint32_t shape = PBF_COLLIDER_SPHERE; shape <= PBF_COLLIDER_BOX; ++shape) {
        s = small_scene(dim);
        add_container(&s, shape);
        s.params.solver = PBF_SOLVER_CHEBYSHEV;
        s.params.wall_density = s.params.separation = 1;
        s.params.collide |= PBF_COLLIDE_AFTER_PREDICTION;
        snprintf(name, sizeof name, "in-a-turning-%s",
                 shape == PBF_COLLIDER_BOX      ? "box"
                 : shape == PBF_COLLIDER_SPHERE ? "sphere"
                                                : "capsule");
        verify(name, &s, precision, 50);
      }
      s = small_scene(dim);
      s.params.smoothing_radius = 0.2; /* many more neighbours than lists have room for */
      s.params.spacing = 0.15;
      s.params.particle_volume = pow(0.05, dim);
      s.params.relaxation = 0.05;
      verify("lists-overflow", &s, precision, 10);
      s = accelerated_scene(dim, 0);
      s.params.smoothing_radius = 0.1935;
      s.params.spacing = 0.15;
      s.params.particle_volume = pow(0.05, dim);
      s.params.relaxation = 0.05;
      verify("chebyshev-lists-overflow", &s, precision, 10);
      s = accelerated_scene(dim, 0);
      verify("chebyshev-all-iterations", &s, precision, 50);
      s.params.undamping = 1;
      verify("undamping", &s, precision, 50);
      add_turning_floor(&s);
      verify("undamping-over-a-turning-floor", &s, precision, 50);
      s = accelerated_scene(dim, 1);
      verify("chebyshev-short-steps", &s, precision, 50);
      s = small_scene(dim);
      for (int a = 0; a < 3; ++a) s.params.domain_max[a] = precision == PBF_FLOAT32 ? 4e3 : 1e6;
      verify("vast-domain", &s, precision, 50);
      s.counts[0] = dim == 2 ? 400 : 160; /* longer than what the domain is folded to */
      s.counts[1] = s.counts[2] = dim == 2 ? 5 : 4;
      verify("vast-domain-canal", &s, precision, 50);
      s = small_scene(dim);
      s.params.collide = PBF_COLLIDE_AFTER_SOLVE;
      for (int a = 0; a < 3; ++a) s.first[a] -= 700, s.params.domain_min[a] -= 700;
      for (int a = 0; a < 3; ++a) s.params.domain_max[a] -= 700;
      if (precision == PBF_FLOAT64) verify("far-from-origin", &s, precision, 50);
      s = small_scene(dim);
      s.params.gravity[1] = 0;
      s.params.attraction = 3;
      s.params.attraction_center[0] = s.params.attraction_center[1] = 0.5;
      verify("attraction", &s, precision, 50);
      s = small_scene(dim);
      s.spacing = 1e-4; /* all in a cell or two */
      s.params.particle_volume = pow(0.05, dim);
      s.params.relaxation = 1e-4;
      s.params.gravity[1] = 0;
      verify("one-cell", &s, precision, 3);
    }
  scene s = report_30k();
  verify("report-30k", &s, PBF_FLOAT32, 50);
  s = shallow_dam_break(27000, 1 / 0.6);
  verify("shallow-dam-break", &s, PBF_FLOAT32, 50);
  s = shallow_dam_break(27000, 2);
  s.jitter = 0.02; /* on the lattice, whether 2 d is nearer than h = 2 d is a matter of rounding */
  verify("shallow-dam-break-2d", &s, PBF_FLOAT32, 50);
}

/* ---- same ---------------------------------------------------------------------------------- */

static uint64_t hash_of(pbf_solver *solver) {
  uint64_t hash;
  must(pbf_hash(solver, &hash), "pbf_hash");
  return hash;
}

static void *saved(pbf_solver *solver, uint64_t *size) {
  must(pbf_save(solver, NULL, size), "pbf_save");
  void *buffer = malloc(*size);
  must(pbf_save(solver, buffer, size), "pbf_save");
  return buffer;
}

/* Twice the same; and from a saved state, and in single steps, with particles that came and went.
 */
static void same_bits(const char *name, const scene *s, uint32_t precision, uint32_t steps) {
  uint64_t hashes[3], size;
  uint32_t gone[3] = {1, 7, 500};
  void *state = NULL;
  for (int run = 0; run < 3; ++run) {
    pbf_solver *solver = solver_for(s, backend, precision);
    if (run < 2) {
      must(pbf_step(solver, steps), "pbf_step");
      must(pbf_remove_particles(solver, 3, gone), "pbf_remove_particles");
      if (run == 0) state = saved(solver, &size);
    } else {
      must(pbf_load(solver, state, size), "pbf_load");
    }
    if (run == 0)
      must(pbf_step(solver, steps), "pbf_step");
    else
      for (uint32_t k = 0; k < steps; ++k) must(pbf_step(solver, 1), "pbf_step");
    hashes[run] = hash_of(solver);
    pbf_destroy(solver);
  }
  free(state);
  int good = hashes[0] == hashes[1] && hashes[0] == hashes[2];
  failures += !good;
  printf(
      "{\"check\": \"same bits\", \"scene\": \"%s\", \"dimension\": %u, \"precision\": %u, "
      "\"particles\": %u, \"steps\": %u, \"first\": \"%016llx\", \"second\": \"%016llx\", "
      "\"after_load\": \"%016llx\", \"good\": %s}\n",
      name, s->dimension, 8 * precision, scene_count(s), 2 * steps, (unsigned long long)hashes[0],
      (unsigned long long)hashes[1], (unsigned long long)hashes[2], good ? "true" : "false");
  fflush(stdout);
}

static void same_all(void) {
  for (uint32_t precision = PBF_FLOAT32; precision <= PBF_FLOAT64; precision += 4)
    for (uint32_t dim = 2; dim <= 3; ++dim) {
      scene s = small_scene(dim);
      s.params.time_step = 1.0 / 128; /* sums of it are exact, in whatever calls the steps come */
      s.params.vorticity = s.params.viscosity = 0.05;
      add_colliders(&s);
      same_bits("small", &s, precision, 60);
      s.params.solver = PBF_SOLVER_CHEBYSHEV;
      s.params.undamping = s.params.wall_density = 1;
      same_bits("small-undamping", &s, precision, 60);
      s.params.solver = PBF_SOLVER_JACOBI;
      s.params.undamping = s.params.wall_density = 0;
      s.params.vorticity = s.params.viscosity = 0;
      s.collider_count = 0;
      same_bits("small-plain", &s, precision, 60);
    }
  scene s = report_30k();
  same_bits("report-30k", &s, PBF_FLOAT32, 100);
  s = shallow_dam_break(30000, 1 / 0.6);
  same_bits("shallow-dam-break", &s, PBF_FLOAT32, 100);
  s = shallow_dam_break(1000000, 1 / 0.6);
  same_bits("shallow-dam-break", &s, PBF_FLOAT32, 50);
}

/* ---- exercise ------------------------------------------------------------------------------ */

/* Both ways. */
static void look_at_pressures(pbf_solver *solver, uint32_t count, void *room) {
  pbf_view view = {.struct_size = sizeof view};
  must(pbf_get_pressures(solver, 0, count, room), "pbf_get_pressures");
  must(pbf_map(solver, PBF_FIELD_PRESSURE, &view), "pbf_map");
  must(pbf_unmap(solver, PBF_FIELD_PRESSURE), "pbf_unmap");
}

static void exercise(const scene *s, uint32_t precision) {
  pbf_solver *solver = solver_for(s, backend, precision);
  uint32_t count = scene_count(s), gone[3] = {1, 7, 50};
  must(pbf_step(solver, 3), "pbf_step");
  stats_of(solver);
  must(pbf_remove_particles(solver, 3, gone), "pbf_remove_particles");
  uint32_t row = s->dimension * precision;
  char *room = malloc((size_t)count * row);
  must(pbf_get_positions(solver, 0, count - 3, room), "pbf_get_positions");
  must(pbf_set_positions(solver, 0, count - 3, room), "pbf_set_positions");
  must(pbf_get_velocities(solver, 5, 100, room), "pbf_get_velocities");
  must(pbf_set_velocities(solver, 5, 100, room), "pbf_set_velocities");
  must(pbf_get_densities(solver, 0, count - 3, room), "pbf_get_densities");
  int has_pressures = s->params.solver == PBF_SOLVER_CHEBYSHEV;
  if (has_pressures) look_at_pressures(solver, count - 3, room);
  must(pbf_get_positions(solver, 0, 3, room), "pbf_get_positions");
  must(pbf_add_particles(solver, 3, room, NULL, NULL), "pbf_add_particles");
  must(pbf_set_timing(solver, 1), "pbf_set_timing");
  must(pbf_step(solver, 2), "pbf_step");
  must(pbf_set_timing(solver, 0), "pbf_set_timing");
  if (has_pressures) look_at_pressures(solver, count, room);
  printf("{\"check\": \"exercise\", \"dimension\": %u, \"precision\": %u, \"hash\": \"%016llx\"}\n",
         s->dimension, 8 * precision, (unsigned long long)hash_of(solver));
  fflush(stdout);
  free(room);
  pbf_destroy(solver);
}

static void exercise_all(void) {
  for (uint32_t dim = 2; dim <= 3; ++dim)
    for (uint32_t precision = PBF_FLOAT32; precision <= PBF_FLOAT64; precision += 4)
      for (int k = 0; k < 6; ++k) {
        scene s = k < 4 ? small_scene(dim) : accelerated_scene(dim, k == 5);
        s.counts[0] = 9, s.counts[1] = 13;
        double prestabilization = s.params.prestabilization;
        s.params.prestabilization = 0;
        if (k < 4) set_kernel(&s, k);
        if (k > 0 && k < 4) {
          s.params.vorticity = s.params.viscosity = 0.05;
          add_colliders(&s);
        }
        if (k == 1) s.params.vorticity = s.params.viscosity = 0, s.params.wall_density = 1;
        if (k == 2) s.params.solver = PBF_SOLVER_CHEBYSHEV, s.params.undamping = 1;
        if (k == 3) s.params.smoothing_radius = 0.2, s.params.spacing = 0.15; /* lists overflow */
        exercise(&s, precision);
        if (k % 4 == 0) s.spacing = 1e-3; /* cells overflow */
        if (k % 4 == 0) exercise(&s, precision);
        if (k != 2 && k != 5) continue;
        s.params.prestabilization = prestabilization;
        s.spacing *= 0.95; /* a start that is projected */
        exercise(&s, precision);
      }
}

/* ---- time ---------------------------------------------------------------------------------- */

static int ascending(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* One step a call, as a game does it. */
static double time_single_calls(pbf_solver *solver, uint32_t steps) {
  double begin = now();
  for (uint32_t k = 0; k < steps; ++k) must(pbf_step(solver, 1), "pbf_step");
  must(pbf_synchronize(solver), "pbf_synchronize");
  return 1e3 * (now() - begin) / steps;
}

static void print_stages(pbf_solver *solver, uint32_t steps) {
  pbf_timings t = {.struct_size = sizeof t};
  if (pbf_set_timing(solver, 1) != PBF_OK) return; /* this backend takes no times */
  must(pbf_step(solver, steps), "pbf_step");
  must(pbf_get_timings(solver, &t), "pbf_get_timings");
  must(pbf_set_timing(solver, 0), "pbf_set_timing");
  printf("\"stage_us\": {");
  for (uint32_t k = 0; k < t.stage_count; ++k)
    printf("%s\"%s\": %.2f", k ? ", " : "", t.stages[k].name,
           1e3 * t.stages[k].milliseconds / steps);
  printf("}, ");
}

static void time_scene(scene s, uint32_t precision, uint32_t lead_in, uint32_t steps) {
  enum { RUNS = 5 };
  double ms[RUNS];
  pbf_solver *solver = solver_for(&s, backend, precision);
  must(pbf_step(solver, lead_in), "pbf_step");
  must(pbf_synchronize(solver), "pbf_synchronize");
  uint64_t size = 0;
  uint32_t count = scene_count(&s);
  void *state = count <= 5000000 ? saved(solver, &size) : NULL; /* the same steps each time */
  for (int run = 0; run < RUNS; ++run) {
    if (state) must(pbf_load(solver, state, size), "pbf_load");
    must(pbf_synchronize(solver), "pbf_synchronize");
    double begin = now();
    must(pbf_step(solver, steps), "pbf_step");
    must(pbf_synchronize(solver), "pbf_synchronize");
    ms[run] = 1e3 * (now() - begin) / steps;
  }
  if (state) must(pbf_load(solver, state, size), "pbf_load");
  must(pbf_synchronize(solver), "pbf_synchronize");
  double single = time_single_calls(solver, steps);
  qsort(ms, RUNS, sizeof *ms, ascending);
  pbf_stats stats = stats_of(solver);
  pbf_plan plan = {.struct_size = sizeof plan};
  pbf_info info = {.struct_size = sizeof info};
  must(pbf_get_plan(solver, &plan), "pbf_get_plan");
  must(pbf_get_info(solver, &info), "pbf_get_info");
  printf(
      "{\"time\": \"%s\", \"backend\": \"%s\", \"device\": \"%s\", \"build\": \"%s\", "
      "\"variant\": \"%s\", \"particles\": %u, \"support\": %.4f, \"iterations\": %u, "
      "\"extra\": \"%s\", \"lead_in\": %u, \"steps\": %u, \"ms_per_step\": %.5f, \"min\": %.5f, "
      "\"max\": %.5f, "
      "\"ms_per_step_in_single_calls\": %.5f, ",
      s.name, info.backend, info.device_name, info.build_id, plan.variant, count,
      s.params.smoothing_radius / s.spacing, s.params.iterations, s.extra ? s.extra : "", lead_in,
      steps, ms[RUNS / 2], ms[0], ms[RUNS - 1], single);
  print_stages(solver, steps < 20 ? steps : 20);
  printf(
      "\"particle_iterations_per_second\": %.4g, \"neighbors_mean\": %.2f, "
      "\"neighbors_max\": %u, \"density_error_mean\": %.5f, \"density_error_max\": %.4f, "
      "\"center_of_mass\": [%.4f, %.4f, %.4f], \"position_max\": [%.3f, %.3f, %.3f], "
      "\"bytes_per_particle\": %.1f}\n",
      1e3 * count * s.params.iterations / ms[RUNS / 2], stats.neighbors_mean, stats.neighbors_max,
      stats.density_error_mean, stats.density_error_max, stats.center_of_mass[0],
      stats.center_of_mass[1], stats.center_of_mass[2], stats.position_max[0],
      stats.position_max[1], stats.position_max[2], plan.bytes_per_particle);
  fflush(stdout);
  free(state);
  pbf_destroy(solver);
}

int main(int argc, char **argv) {
  const char *command = argc > 1 ? argv[1] : "";
  if (getenv("PBF_CHECK_BACKEND")) backend = getenv("PBF_CHECK_BACKEND");
  if (strcmp(command, "verify") == 0) {
    only = argc > 2 ? argv[2] : NULL;
    verify_all();
  } else if (strcmp(command, "same") == 0) {
    same_all();
  } else if (strcmp(command, "exercise") == 0) {
    exercise_all();
  } else if (strcmp(command, "time") == 0 && argc > 3) {
    uint32_t particles = (uint32_t)strtoul(argv[3], NULL, 10);
    double support = argc > 4 ? strtod(argv[4], NULL) : 1 / 0.6;
    const char *extra = argc > 5 ? argv[5] : "";
    uint32_t precision = strcmp(extra, "f64") == 0 ? PBF_FLOAT64 : PBF_FLOAT32;
    scene s = shallow_dam_break(particles, support);
    s.extra = extra;
    s.params.undamping = strcmp(extra, "undamping") == 0;
    s.params.viscosity = strcmp(extra, "viscosity") == 0 ? 0.01 : 0;
    s.params.vorticity = strcmp(extra, "vorticity") == 0 ? 0.01 : 0;
    if (strcmp(argv[2], "report-30k") == 0)
      time_scene(report_30k(), precision, 0, 100);
    else
      time_scene(s, precision, particles > 5000000 ? 30 : 150, particles > 5000000 ? 20 : 100);
  } else {
    fprintf(stderr,
            "usage: gpu_check verify [SCENE] | same | exercise | time SCENE N [H/D] [f64 | "
            "undamping | viscosity | vorticity]\n");
    return 2;
  }
  return failures != 0;
}
