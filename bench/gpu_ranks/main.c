/* Checks and times one scene on ranks of the backend "cuda": threads of this program, of which rank
 * r has device r, modulo those that there are.
 *
 *   gpu_ranks same [RANKS]             bits of one solver, stage by stage
 *   gpu_ranks time N RANKS [f64|grid]  a shallow dam break of about N particles, h = 2 d; with a
 *                                      pressure grid of cells of 2 h
 *
 * RANKS 0 of `time` is a solver without ranks. With PBF_RANKS_PROCESSES ranks are processes, with
 * PBF_RANKS_STAGED what they exchange goes through the host's memory, as between hosts, with
 * PBF_RANKS_BRIEF the default stages alone are checked. Prints one JSON object a line. Exit code 1
 * when a check failed, 2 when there is no device. */
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "../../tests/ranks/thread_ranks.h"
#include "../gpu_check/scenes.h"
#include "../gpu_check/solver.h"
#include "process_ranks.h"

static uint32_t devices;
static int in_processes; /* ranks are */
static int staged;       /* what they exchange is */

/* Devices are numbered without a gap. */
static uint32_t count_devices(void) {
  const char *told = getenv("PBF_RANKS_DEVICES");
  uint32_t count = 0;
  pbf_solver *s;
  if (told) return (uint32_t)strtoul(told, NULL, 10);
  for (pbf_status status = PBF_OK; status == PBF_OK && count < MAX_THREAD_RANKS;) {
    pbf_desc desc;
    pbf_params params;
    must(pbf_desc_init(&desc, sizeof desc), "pbf_desc_init");
    must(pbf_params_init(&params, sizeof params), "pbf_params_init");
    desc.backend = "cuda";
    desc.strict = 1;
    desc.capacity = 64;
    desc.device = (int32_t)count;
    status = pbf_create(&desc, &params, &s);
    if (status == PBF_OK) ++count, pbf_destroy(s);
  }
  if (!count) must(PBF_ERROR_UNAVAILABLE, "no device");
  return count;
}

/* What each rank is doing, to be told when a rank waits too long. */
static const char *volatile doing[MAX_THREAD_RANKS];

static void give_up(int signal) {
  (void)signal;
  for (uint32_t r = 0; r < MAX_THREAD_RANKS; ++r)
    if (doing[r]) {
      (void)!write(2, doing[r], strlen(doing[r]));
      (void)!write(2, "\n", 1);
    }
  _exit(3);
}

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* All particles go through the host to be hashed, on each rank: of more it would take minutes. */
enum { MOST_HASHED = 70000000 };

/* A scene, and what is found out about it. */
typedef struct job {
  scene s;
  uint32_t precision, ranks;
  uint32_t lead_in, steps, runs;
  uint32_t local_capacity;
  double ms[9];
  uint64_t bytes[MAX_THREAD_RANKS], exchanged[MAX_THREAD_RANKS];
  uint64_t hash[MAX_THREAD_RANKS];
  pbf_stats stats[MAX_THREAD_RANKS];
  double density[MAX_THREAD_RANKS]; /* a sum, in the order of the particles */
  char name[96];
} job;

static pbf_solver *create(const job *j, const pbf_ranks *ranks) {
  pbf_desc desc;
  pbf_solver *solver;
  if (in_processes && !devices) devices = count_devices();
  must(pbf_desc_init(&desc, sizeof desc), "pbf_desc_init");
  desc.backend = "cuda";
  desc.strict = 1;
  desc.dimension = j->s.dimension;
  desc.precision = j->precision;
  desc.capacity = scene_count(&j->s);
  desc.device = ranks ? (int32_t)(ranks->rank % devices) : 0;
  if (ranks)
    must(pbf_create_on_ranks(&desc, &j->s.params, ranks, &solver), "pbf_create_on_ranks");
  else
    must(pbf_create(&desc, &j->s.params, &solver), "pbf_create");
  return solver;
}

/* Waits for all ranks. */
static void meet(const pbf_ranks *ranks) {
  uint32_t mine = 0, all[MAX_THREAD_RANKS];
  if (ranks) must(ranks->all_gather(ranks->user, &mine, all, sizeof mine), "all_gather");
}

static double density_sum(const job *j, pbf_solver *solver) {
  const uint32_t count = scene_count(&j->s);
  void *densities = malloc((size_t)count * j->precision);
  double sum = 0;
  must(pbf_get_densities(solver, 0, count, densities), "pbf_get_densities");
  for (uint32_t i = 0; i < count; ++i)
    sum += j->precision == PBF_FLOAT32 ? (double)((float *)densities)[i] : ((double *)densities)[i];
  free(densities);
  return sum;
}

static void look(job *j, pbf_solver *solver, uint32_t r) {
  pbf_plan plan = {.struct_size = sizeof plan};
  must(pbf_get_plan(solver, &plan), "pbf_get_plan");
  j->bytes[r] = plan.bytes;
  for (uint32_t k = 0; k < plan.array_count; ++k)
    if (!strcmp(plan.arrays[k].name, "exchanged with ranks"))
      j->exchanged[r] = plan.arrays[k].bytes;
  j->stats[r] = stats_of(solver);
}

static void check_job(const pbf_ranks *ranks, void *context) {
  job *j = context;
  const uint32_t r = ranks ? ranks->rank : 0;
  doing[r] = "create";
  pbf_solver *solver = create(j, ranks);
  doing[r] = "add";
  fill(&j->s, solver, j->precision);
  doing[r] = "the first steps";
  must(pbf_step(solver, j->steps / 2), "pbf_step");
  doing[r] = "the other steps";
  must(pbf_step(solver, j->steps - j->steps / 2), "pbf_step");
  doing[r] = "hash";
  j->hash[r] = hash_of(solver);
  doing[r] = "densities";
  j->density[r] = density_sum(j, solver);
  doing[r] = "statistics";
  look(j, solver, r);
  doing[r] = "destroy";
  pbf_destroy(solver);
  doing[r] = NULL;
}

static void time_job(const pbf_ranks *ranks, void *context) {
  job *j = context;
  const uint32_t r = ranks ? ranks->rank : 0;
  pbf_solver *solver = create(j, ranks);
  doing[r] = "add";
  fill(&j->s, solver, j->precision);
  doing[r] = "the first steps";
  must(pbf_step(solver, j->lead_in), "pbf_step");
  doing[r] = "the other steps";
  for (uint32_t run = 0; run < j->runs; ++run) {
    must(pbf_synchronize(solver), "pbf_synchronize");
    meet(ranks);
    const double begin = now();
    must(pbf_step(solver, j->steps), "pbf_step");
    must(pbf_synchronize(solver), "pbf_synchronize");
    meet(ranks);
    if (r == 0) j->ms[run] = 1e3 * (now() - begin) / j->steps;
  }
  look(j, solver, r);
  if (scene_count(&j->s) <= MOST_HASHED) j->hash[r] = hash_of(solver);
  if (r == 0) {
    pbf_info info = {.struct_size = sizeof info};
    must(pbf_get_info(solver, &info), "pbf_get_info");
    snprintf(j->name, sizeof j->name, "%s", info.device_name);
  }
  pbf_destroy(solver);
}

static void run_in_processes(job *j, thread_rank_fn function) {
  job *shared = process_shared(sizeof *shared);
  *shared = *j;
  if (process_ranks_run(j->ranks, j->local_capacity, function, shared)) exit(1);
  *j = *shared;
}

static void run(job *j, thread_rank_fn function) {
  if (in_processes)
    run_in_processes(j, function);
  else if (j->ranks)
    thread_ranks_run(j->ranks, j->local_capacity, NULL, NULL, function, j);
  else
    function(NULL, j);
}

/* ---- The same bits ------------------------------------------------------------------------- */

static int same(const char *what, const scene *s, uint32_t precision, uint32_t steps,
                uint32_t ranks) {
  job alone = {.s = *s, .precision = precision, .steps = steps}, many = alone;
  many.ranks = ranks;
  run(&alone, check_job);
  run(&many, check_job);
  int good = 1;
  for (uint32_t r = 0; r < ranks; ++r)
    good &= many.hash[r] == alone.hash[0] && many.density[r] == alone.density[0] &&
            many.stats[r].neighbors_max == alone.stats[0].neighbors_max &&
            many.stats[r].speed_max == alone.stats[0].speed_max &&
            many.stats[r].count == alone.stats[0].count;
  printf(
      "{\"same\": \"%s\", \"staged\": %s, \"dimension\": %u, \"precision\": %u, \"particles\": %u, "
      "\"ranks\": %u, "
      "\"devices\": %u, \"steps\": %u, \"hash\": \"%016llx\", \"of_ranks\": \"%016llx\", "
      "\"density_sum\": [%.17g, %.17g], \"neighbors_max\": [%u, %u], \"good\": %s}\n",
      what, staged ? "true" : "false", s->dimension, 8 * precision, scene_count(s), ranks, devices,
      steps, (unsigned long long)alone.hash[0], (unsigned long long)many.hash[0], alone.density[0],
      many.density[0], alone.stats[0].neighbors_max, many.stats[0].neighbors_max,
      good ? "true" : "false");
  fflush(stdout);
  return good;
}

/* Past what one launch serves, whose sums have another order (docs/notes/cuda.md): drag is a stage
 * that it does not have. */
static scene checked(uint32_t dimension) {
  scene s = small_scene(dimension);
  pbf_params fresh;
  must(pbf_params_init(&fresh, sizeof fresh), "pbf_params_init");
  memcpy(fresh.domain_max, s.params.domain_max, sizeof fresh.domain_max);
  s.params = fresh;
  s.params.pressure_grid = 0;
  s.params.spacing = s.spacing;
  s.params.drag = 0.1;
  return s;
}

static int same_stages(const char *what, uint32_t dimension, uint32_t precision, uint32_t ranks,
                       const char *const *names) {
  scene s = checked(dimension);
  for (; *names; ++names)
    if (!add_optional(&s, *names)) return 0;
  return same(what, &s, precision, 20, ranks);
}

static int same_of_kind(uint32_t dimension, uint32_t precision, uint32_t ranks) {
  static const char *const stages[][5] = {
      {NULL},
      {"damping_compensation", "angular_momentum_correction", NULL},
      {"shear_stress_correction", NULL},
      {"viscosity", "wall_no_slip", NULL},
      {"surface_tension", "wall_adhesion", NULL},
      {"vorticity", NULL},
  };
  const size_t all = sizeof stages / sizeof stages[0];
  const size_t count = getenv("PBF_RANKS_BRIEF") ? 1 : all;
  int good = 1;
  for (size_t k = 0; k < count; ++k)
    good &= same_stages(stages[k][0] ? stages[k][0] : "default", dimension, precision, ranks,
                        stages[k]);
  if (count < all) return good;
  scene s = checked(dimension);
  add_mirrors(&s);
  s.params.pressure_grid = 0;
  good &= same("walls that mirror", &s, precision, 12, ranks);
  s = checked(dimension);
  add_colliders(&s);
  good &= same("colliders", &s, precision, 20, ranks);
  s.params.pressure_grid = 2;
  good &= same("a pressure grid and colliders", &s, precision, 20, ranks);
  s = checked(dimension);
  s.params.solver = PBF_SOLVER_JACOBI;
  s.params.viscosity = 0.01;
  good &= same("jacobi", &s, precision, 20, ranks);
  s = checked(dimension);
  for (uint32_t k = 0; k < dimension; ++k) s.params.domain_max[k] = 300;
  good &= same("a wrapped grid", &s, precision, 20, ranks);
  s = checked(dimension);
  s.params.time_step = 1.0 / 4000;
  good &= same("short steps", &s, precision, 20, ranks);
  return good;
}

/* A build may have one variant, which PBF_RANKS_KIND names. */
static int is_asked(uint32_t dimension, uint32_t precision) {
  const char *asked = getenv("PBF_RANKS_KIND");
  char kind[16];
  snprintf(kind, sizeof kind, "%ud-f%u", dimension, 8 * precision);
  return !asked || strcmp(asked, kind) == 0;
}

static int same_all(uint32_t ranks) {
  int good = 1;
  for (uint32_t dimension = 3; dimension >= 2; --dimension)
    for (uint32_t precision = PBF_FLOAT32; precision <= PBF_FLOAT64; precision *= 2)
      if (is_asked(dimension, precision)) good &= same_of_kind(dimension, precision, ranks);
  if (!is_asked(3, PBF_FLOAT32)) return good;
  scene s = shallow_dam_break(100000, 2);
  s.params.pressure_grid = 0;
  good &= same("shallow-dam-break", &s, PBF_FLOAT32, 60, ranks);
  return good;
}

/* ---- Times --------------------------------------------------------------------------------- */

static int ascending(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static void time_scene(uint32_t particles, uint32_t ranks, uint32_t precision, int has_grid) {
  const int large = particles > 5000000, huge = particles > 100000000;
  job j = {.s = shallow_dam_break(particles, 2),
           .precision = precision,
           .ranks = ranks,
           .lead_in = large ? 30 : 150,
           .steps = huge    ? 10
                    : large ? 20
                            : 100,
           .runs = huge ? 3 : 5};
  j.s.params.pressure_grid = has_grid ? 2 : 0;
  const uint32_t count = scene_count(&j.s);
  /* Its share, and what is within a cell of its ends: two layers of the lattice and a row, which
   * waves press together. */
  const uint32_t ends = ranks > 2 ? 2 : 1, section = j.s.counts[0] * j.s.counts[1];
  if (ranks > 1) j.local_capacity = count / ranks + ends * 3 * section + 2048;
  run(&j, time_job);
  qsort(j.ms, j.runs, sizeof *j.ms, ascending);
  uint64_t bytes = 0, exchanged = 0;
  int agree = 1; /* ranks, on the number of particles and the hash of all */
  for (uint32_t r = 0; r < (ranks ? ranks : 1); ++r) {
    agree &= j.hash[r] == j.hash[0] && j.stats[r].count == count;
    bytes += j.bytes[r];
    exchanged += j.exchanged[r];
  }
  char hash[24] = "null";
  if (count <= MOST_HASHED)
    snprintf(hash, sizeof hash, "\"%016llx\"", (unsigned long long)j.hash[0]);
  printf(
      "{\"time\": \"shallow-dam-break%s\", \"staged\": %s, \"device\": \"%s\", \"devices\": %u, "
      "\"ranks\": %u, "
      "\"particles\": %u, \"precision\": %u, \"steps\": %u, \"ms_per_step\": %.5f, \"min\": %.5f, "
      "\"max\": %.5f, \"bytes\": %llu, \"bytes_of_rooms\": %llu, \"section\": %u, "
      "\"neighbors_mean\": %.3f, \"density_error_mean\": %.5f, \"hash\": %s, \"good\": %s}\n",
      has_grid ? ", pressure grid" : "", staged ? "true" : "false", j.name, devices, ranks, count,
      8 * precision, j.steps, j.ms[j.runs / 2], j.ms[0], j.ms[j.runs - 1],
      (unsigned long long)bytes, (unsigned long long)exchanged, j.s.counts[0] * j.s.counts[1],
      j.stats[0].neighbors_mean, j.stats[0].density_error_mean, hash, agree ? "true" : "false");
  fflush(stdout);
}

static int usage(void) {
  fprintf(stderr, "usage: gpu_ranks same [RANKS] | time N RANKS [f64|grid]\n");
  return 2;
}

int main(int argc, char **argv) {
  const char *command = argc > 1 ? argv[1] : "";
  signal(SIGTERM, give_up);
  in_processes = getenv("PBF_RANKS_PROCESSES") != NULL;
  staged = process_ranks_staged = getenv("PBF_RANKS_STAGED") != NULL;
  if (staged) thread_ranks_staged_from = 0;
  if (!in_processes) devices = count_devices();
  if (strcmp(command, "same") == 0) {
    return !same_all(argc > 2 ? (uint32_t)strtoul(argv[2], NULL, 10) : 2);
  } else if (strcmp(command, "time") == 0 && argc > 3) {
    const uint32_t precision = argc > 4 && strcmp(argv[4], "f64") == 0 ? PBF_FLOAT64 : PBF_FLOAT32;
    time_scene((uint32_t)strtoul(argv[2], NULL, 10), (uint32_t)strtoul(argv[3], NULL, 10),
               precision, argc > 4 && strcmp(argv[4], "grid") == 0);
    return 0;
  }
  return usage();
}
