/* mpi_scene same|staged|differ|stall: scenes on the ranks of MPI_COMM_WORLD, of the backend that
 * PBF_TEST_BACKEND names. Prints "good" from rank 0, or what is wrong, for the tests ranks.mpi.*.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <pbf/mpi.h>
#include <pbf/phases.h>

enum { COUNT = 8000, SIDE = 20, STEPS = 20 };

static int rank, size;
static int staged; /* what GPUs exchange goes through hosts, though they reach each other */

static void fail(const char *what) {
  printf("rank %d of %d: %s: %s\n", rank, size, what, pbf_last_error());
  fflush(stdout);
  MPI_Abort(MPI_COMM_WORLD, 1);
}

#define TRY(call)                      \
  do {                                 \
    if ((call) != PBF_OK) fail(#call); \
  } while (0)

static pbf_params params_of(void) {
  pbf_params params;
  TRY(pbf_params_init(&params, sizeof params));
  params.smoothing_radius = 0.1;
  params.pressure_grid = 0;
  params.viscosity = 0.001;
  params.drag = 0.1; /* one launch of all steps, of which sums have another order, has none */
  params.domain_max[0] = 3;
  params.domain_max[1] = 2;
  return params;
}

static void set_up(pbf_solver *s) {
  pbf_collider ball;
  float *x = calloc((size_t)COUNT * 3, sizeof *x);
  if (!x) fail("calloc");
  for (int i = 0; i < COUNT; ++i) {
    const int at[3] = {i % SIDE, i / SIDE / SIDE, i / SIDE % SIDE};
    for (int k = 0; k < 3; ++k)
      x[3 * i + k] = 0.05f * ((float)at[k] + 0.3f) + (float)(i * 13 % 17) * 1e-3f;
  }
  TRY(pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SPHERE));
  ball.position[0] = 1.2;
  ball.position[1] = ball.position[2] = 0.4;
  ball.radius = 0.2;
  ball.velocity[0] = -0.5;
  TRY(pbf_set_colliders(s, 1, &ball));
  TRY(pbf_add_particles(s, COUNT, x, NULL, NULL));
  free(x);
}

static pbf_desc desc_of(void) {
  pbf_desc desc;
  TRY(pbf_desc_init(&desc, sizeof desc));
  desc.capacity = COUNT;
  desc.backend = getenv("PBF_TEST_BACKEND") ? getenv("PBF_TEST_BACKEND") : "serial";
  return desc;
}

static pbf_solver *create(const pbf_params *params, double timeout) {
  const char *devices = getenv("PBF_RANKS_DEVICES");
  pbf_desc desc = desc_of();
  pbf_mpi_options options;
  pbf_solver *s;
  TRY(pbf_mpi_options_init(&options, sizeof options));
  options.timeout = timeout;
  options.host_staged = staged != 0;
  if (devices) desc.device = rank % atoi(devices);
  if (pbf_mpi_create(MPI_COMM_WORLD, &options, &desc, params, &s) != PBF_OK)
    fail(pbf_mpi_last_error());
  return s;
}

/* Scenes, and what one solver makes of them. */
enum { PLAIN, DEEP, FLUIDS, PERIODIC, SCENES };

static pbf_params params_of_scene(int scene) {
  pbf_params params = params_of();
  if (scene == DEEP) params.pressure_grid = 2, params.loads = 1, params.wall_friction = 0.3;
  if (scene == PERIODIC) params.periodic = PBF_PERIODIC_X, params.gravity[0] = 10;
  return params;
}

typedef struct outcome {
  uint64_t hash;
  pbf_collider_load ball;
} outcome;

static outcome run(int scene, const pbf_params *params, pbf_solver *s) {
  outcome o = {.ball.struct_size = sizeof o.ball};
  pbf_phase oil;
  set_up(s);
  TRY(pbf_phase_init(&oil, sizeof oil));
  oil.rest_density = 0.7;
  if (scene == FLUIDS) TRY(pbf_set_phases(s, 1, &oil));
  TRY(pbf_step(s, STEPS));
  TRY(pbf_hash(s, &o.hash));
  if (params->loads) TRY(pbf_get_collider_loads(s, 1, &o.ball));
  pbf_destroy(s);
  return o;
}

static void same(int scene) {
  const pbf_params params = params_of_scene(scene);
  const pbf_desc desc = desc_of();
  pbf_solver *alone;
  const outcome on_ranks = run(scene, &params, create(&params, 60));
  TRY(pbf_create(&desc, &params, &alone));
  const outcome by_one = run(scene, &params, alone);
  if (on_ranks.hash != by_one.hash) fail("other bits than those of one solver");
  if (memcmp(&on_ranks.ball, &by_one.ball, sizeof by_one.ball) != 0) fail("other loads");
  if (params.loads && !by_one.ball.contacts) fail("the ball is dry");
}

/* Added on all alike, the particles are the first that all must agree on. */
static void differ(void) {
  pbf_params params = params_of();
  if (rank == size - 1) params.time_step = 0.001;
  pbf_solver *s = create(&params, 60);
  float x[3] = {0.5f, 0.5f, 0.5f};
  if (pbf_add_particles(s, 1, x, NULL, NULL) != PBF_ERROR_INVALID_ARGUMENT ||
      !strstr(pbf_last_error(), "params.time_step: 0.00833333333 and 0.001"))
    fail("the difference was not named");
  pbf_destroy(s);
}

/* The last rank stops for longer than the others wait. None can then end as it should. */
static void stall(void) {
  const pbf_params params = params_of();
  pbf_solver *s = create(&params, 1);
  set_up(s);
  if (rank == size - 1) {
    sleep(20);
    _exit(0);
  }
  const double before = MPI_Wtime();
  const pbf_status status = pbf_step(s, 1);
  const double took = MPI_Wtime() - before;
  if (status != PBF_ERROR_UNAVAILABLE || took > 10 || !strstr(pbf_last_error(), "has not answered"))
    fail("a rank that stands still was not noticed");
  if (pbf_step(s, 1) != PBF_ERROR_STATE) fail("a step after that");
  pbf_destroy(s);
  if (rank == 0) printf("good\n");
  fflush(stdout);
  sleep(1);
  MPI_Abort(MPI_COMM_WORLD, 0);
}

int main(int count, char **words) {
  const char *what = count > 1 ? words[1] : "same";
  MPI_Init(&count, &words);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  if (!strcmp(what, "stall")) stall();
  if (!strcmp(what, "differ")) differ();
  staged = !strcmp(what, "staged");
  for (int scene = 0; scene < SCENES && (staged || !strcmp(what, "same")); ++scene) same(scene);
  MPI_Barrier(MPI_COMM_WORLD);
  if (rank == 0) printf("good\n");
  MPI_Finalize();
  return 0;
}
