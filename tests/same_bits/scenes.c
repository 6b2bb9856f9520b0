/* scenes [PINNED VARIANT...]
 *
 * Prints a hash of the state after some steps for each of 80 scenes, which together run every
 * stage: two builds that print the same lines compute the same bits. `run` compares two builds; the
 * backend comes from PBF_TEST_BACKEND, the instruction set from PBF_ISA.
 *
 * With a file of such lines it runs the small scenes of these variants ("3d-f32"), and fails where
 * a hash is not that of the file; 77 where the machine has not got the instruction set. */
#include <math.h>
#include <pbf/pbf.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct scene {
  const char *name;
  uint32_t dimension, precision;
  uint32_t steps;
  double spacing;
  uint32_t block[3]; /* lattice of particles along each axis */
  double at[3];      /* its lower corner */
  double jitter;     /* of each coordinate, in spacings */
  uint32_t collider_count;
  pbf_params params;
  pbf_collider colliders[2];
} scene;

/* The file's text; null: nothing is compared. */
static char *pinned;
static int differing;

/* Of each solver. */
static uint32_t threads = 2;

static void check(pbf_status status) {
  if (status == PBF_OK) return;
  if (status == PBF_ERROR_UNAVAILABLE && strstr(pbf_last_error(), "this machine")) exit(77);
  fprintf(stderr, "same_bits: %s: %s\n", pbf_status_string(status), pbf_last_error());
  exit(1);
}

static double drawn(uint64_t *state) {
  *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  return (double)(*state >> 11) / 9007199254740992.0;
}

static void add_block(pbf_solver *solver, const scene *s) {
  const uint32_t layers = s->dimension == 3 ? s->block[2] : 1;
  const uint32_t count = s->block[0] * s->block[1] * layers;
  float *single = malloc((size_t)count * 3 * sizeof *single);
  double *values = malloc((size_t)count * 3 * sizeof *values);
  uint64_t state = 1;
  uint32_t n = 0;
  for (uint32_t z = 0; z < layers; ++z)
    for (uint32_t y = 0; y < s->block[1]; ++y)
      for (uint32_t x = 0; x < s->block[0]; ++x) {
        const uint32_t cell[3] = {x, y, z};
        for (uint32_t k = 0; k < s->dimension; ++k, ++n)
          values[n] = s->at[k] + s->spacing * (cell[k] + 0.5 + s->jitter * (drawn(&state) - 0.5));
      }
  for (uint32_t k = 0; k < n; ++k) single[k] = (float)values[k];
  check(pbf_add_particles(solver, count, s->precision == PBF_FLOAT32 ? (void *)single : values,
                          NULL, NULL));
  free(single);
  free(values);
}

static void run_scene(const scene *s, const char *backend) {
  pbf_solver *solver;
  pbf_desc desc;
  uint64_t hash;
  check(pbf_desc_init(&desc, sizeof desc));
  desc.dimension = s->dimension;
  desc.precision = s->precision;
  desc.capacity = s->block[0] * s->block[1] * (s->dimension == 3 ? s->block[2] : 1);
  desc.backend = backend;
  desc.strict = 1;
  desc.threads = threads;
  check(pbf_create(&desc, &s->params, &solver));
  add_block(solver, s);
  if (s->collider_count) check(pbf_set_colliders(solver, s->collider_count, s->colliders));
  check(pbf_step(solver, s->steps));
  check(pbf_hash(solver, &hash));
  pbf_destroy(solver);
  char line[96];
  snprintf(line, sizeof line, "%ud-f%u %-24s %016llx\n", s->dimension, 8 * s->precision, s->name,
           (unsigned long long)hash);
  const int differs = pinned && !strstr(pinned, line);
  differing += differs;
  printf("%s%s", differs ? "other bits than pinned: " : "", line);
  fflush(stdout);
}

/* A block of fluid at one side of a small tank, in units of its spacing 0.05. */
static scene tank(const char *name, uint32_t dimension, uint32_t precision) {
  scene s;
  memset(&s, 0, sizeof s);
  s.name = name;
  s.dimension = dimension;
  s.precision = precision;
  s.steps = 20;
  s.spacing = 0.05;
  s.jitter = 0.1;
  s.block[0] = dimension == 3 ? 9 : 16;
  s.block[1] = dimension == 3 ? 12 : 24;
  s.block[2] = 7;
  check(pbf_params_init(&s.params, sizeof s.params));
  s.params.spacing = s.spacing;
  s.params.domain_max[0] = dimension == 3 ? 0.8 : 1.6;
  s.params.domain_max[1] = 1.6;
  s.params.domain_max[2] = 0.4;
  return s;
}

static void set_kernel(pbf_params *params, int kind) {
  params->kernel = kind & 1 ? PBF_KERNEL_POLY6_SPIKY : PBF_KERNEL_WENDLAND_C2;
  if (kind & 2) params->scorr_k = 1e-5;
}

static void add_moving_box(scene *s) {
  check(pbf_collider_init(&s->colliders[0], sizeof *s->colliders, PBF_COLLIDER_BOX));
  check(pbf_collider_init(&s->colliders[1], sizeof *s->colliders, PBF_COLLIDER_SPHERE));
  s->collider_count = 2;
  for (int k = 0; k < 3; ++k) s->colliders[0].half_extents[k] = 0.1;
  s->colliders[0].position[0] = 0.5;
  s->colliders[0].position[1] = 0.2;
  s->colliders[0].velocity[0] = -0.5;
  s->colliders[0].angular_velocity[2] = 1;
  s->colliders[1].radius = 0.12;
  s->colliders[1].position[1] = 0.7;
}

/* Each kernel: Jacobi without anything, everything that acts on velocities, wide kernels with
 * images and both corrections. */
static void run_kernels(uint32_t dimension, uint32_t precision, const char *backend) {
  static const char *const names[4] = {"wendland", "poly6", "wendland-scorr", "poly6-scorr"};
  char name[64];
  for (int kind = 0; kind < 4; ++kind) {
    scene s = tank(name, dimension, precision);
    snprintf(name, sizeof name, "jacobi %s", names[kind]);
    set_kernel(&s.params, kind);
    s.params.solver = PBF_SOLVER_JACOBI;
    s.params.wall_density = 0;
    run_scene(&s, backend);

    s = tank(name, dimension, precision);
    snprintf(name, sizeof name, "velocities %s", names[kind]);
    set_kernel(&s.params, kind);
    add_moving_box(&s);
    s.params.vorticity = 0.002;
    s.params.viscosity = 0.05;
    if (kind > 0) { /* fluid sticks */
      s.params.wall_no_slip = 0.5;
      s.colliders[0].no_slip = 1;
    }
    s.params.wall_amplitude[PBF_WALL_X_MAX] = 0.05;
    s.params.wall_frequency[PBF_WALL_X_MAX] = 9;
    run_scene(&s, backend);

    s = tank(name, dimension, precision);
    snprintf(name, sizeof name, "images %s", names[kind]);
    set_kernel(&s.params, kind);
    s.params.smoothing_radius = 3 * s.spacing;
    s.params.damping_compensation = 1;
    s.params.angular_momentum_correction = 1;
    run_scene(&s, backend);
  }
}

static void run_others(uint32_t dimension, uint32_t precision, const char *backend) {
  scene s = tank("short steps", dimension, precision);
  s.params.time_step = 1e-4;
  s.params.iterations = 2;
  run_scene(&s, backend);

  s = tank("tolerance and sleep", dimension, precision);
  s.params.tolerance = 2e-3;
  s.params.iterations = 12;
  s.params.sleep_speed = 0.2;
  s.params.sleep_time = 0.05;
  s.jitter = 0.02;
  s.block[0] = dimension == 3 ? 16 : 32;
  s.block[1] = 6;
  s.steps = 60;
  run_scene(&s, backend);

  s = tank("deep", dimension, precision);
  s.params.iterations = 3;
  s.block[1] = dimension == 3 ? 30 : 60;
  s.params.domain_max[1] = 4;
  s.params.pressure_grid = 2;
  add_moving_box(&s);
  run_scene(&s, backend);

  s = tank("attraction", dimension, precision);
  s.params.gravity[1] = 0;
  s.params.attraction = 30;
  s.params.collide = PBF_COLLIDE_AFTER_SOLVE;
  s.params.damping_compensation = 1;
  for (int k = 0; k < 3; ++k) {
    s.params.attraction_center[k] = 1.5;
    s.params.domain_max[k] = 3;
    s.at[k] = 1.2;
  }
  run_scene(&s, backend);

  s = tank("surface tension", dimension, precision);
  s.params.surface_tension = 0.002;
  s.params.sleep_speed = 0.2;
  s.params.sleep_time = 0.05;
  add_moving_box(&s);
  run_scene(&s, backend);

  s = tank("adhesion", dimension, precision);
  s.params.surface_tension = 0.002;
  s.params.wall_adhesion = 0.4;
  add_moving_box(&s);
  for (int k = 0; k < 2; ++k) s.colliders[k].adhesion = 0.7;
  run_scene(&s, backend);
}

/* Both corrections between obstacles that lend density, each one alone, and where particles sleep
 * and the solve ends early. */
static void run_corrections(uint32_t dimension, uint32_t precision, const char *backend) {
  static const char *const names[4] = {"both corrections", "damping poly6", "torque scorr",
                                       "corrections asleep"};
  for (int kind = 0; kind < 4; ++kind) {
    scene s = tank(names[kind], dimension, precision);
    set_kernel(&s.params, kind);
    s.params.damping_compensation = kind == 2 ? 0 : 0.8;
    s.params.angular_momentum_correction = kind == 1 ? 0 : 0.9;
    if (kind == 3) {
      s.params.tolerance = 2e-3;
      s.params.iterations = 12;
      s.params.sleep_speed = 0.2;
      s.params.sleep_time = 0.05;
      s.jitter = 0.02;
      s.block[1] = 6;
      s.steps = 60;
    } else {
      add_moving_box(&s);
    }
    run_scene(&s, backend);
  }
}

static scene dam_break(const char *name, uint32_t precision, double h) {
  scene s = tank(name, 3, precision);
  s.block[0] = s.block[1] = 32;
  s.block[2] = 30;
  s.jitter = 0;
  s.params.smoothing_radius = h * s.spacing;
  s.params.domain_max[0] = 3.2;
  s.params.domain_max[1] = 2.4;
  s.params.domain_max[2] = 1.5;
  s.steps = 30;
  return s;
}

static void run_large(const char *backend) {
  scene s = dam_break("30,720 h = 5/3", PBF_FLOAT32, 5.0 / 3);
  s.steps = 60;
  run_scene(&s, backend);
  s = dam_break("30,720 h = 2 viscosity", PBF_FLOAT32, 2);
  s.params.viscosity = 0.05;
  run_scene(&s, backend);
  s = dam_break("30,720 h = 2", PBF_FLOAT64, 2);
  run_scene(&s, backend);
  s = tank("30,000 poly6", 2, PBF_FLOAT32);
  s.block[0] = 200;
  s.block[1] = 150;
  s.steps = 60;
  s.params.kernel = PBF_KERNEL_POLY6_SPIKY;
  s.params.solver = PBF_SOLVER_JACOBI;
  s.params.domain_max[0] = 20;
  s.params.domain_max[1] = 10;
  run_scene(&s, backend);
}

static void run_variant(uint32_t dimension, uint32_t precision, const char *backend) {
  run_kernels(dimension, precision, backend);
  run_others(dimension, precision, backend);
  run_corrections(dimension, precision, backend);
}

static char *text_of(const char *path) {
  static char text[1 << 16];
  FILE *file = fopen(path, "r");
  const size_t size = file ? fread(text, 1, sizeof text - 1, file) : 0;
  if (file) fclose(file);
  if (!size) fprintf(stderr, "same_bits: can't read %s\n", path);
  return size ? text : NULL;
}

static int compare(int count, char **arguments, const char *backend) {
  pinned = text_of(arguments[0]);
  if (!pinned) return 1;
  for (int k = 1; k < count; ++k) {
    unsigned dimension, bits;
    if (sscanf(arguments[k], "%ud-f%u", &dimension, &bits) != 2) return 1;
    run_variant(dimension, bits / 8, backend);
  }
  return differing > 0;
}

int main(int count, char **arguments) {
  const char *backend = getenv("PBF_TEST_BACKEND");
  if (count > 1) return compare(count - 1, arguments + 1, backend);
  for (uint32_t dimension = 2; dimension <= 3; ++dimension)
    for (uint32_t precision = PBF_FLOAT32; precision <= PBF_FLOAT64; precision += 4)
      run_variant(dimension, precision, backend);
  if (backend && strcmp(backend, "reference") != 0) run_large(backend);
  return 0;
}
