#define _GNU_SOURCE
/* mpi_speed SIDE STEPS [BACKEND|ranks] [deep|loads]: times of a tank of SIDE³ particles on the
 * ranks of MPI_COMM_WORLD, or with a backend, of a solver without ranks; deep: with what deep water
 * has by default; loads: and with loads on its walls. Prints a line: particles, ranks, milliseconds
 * a step, those that the processor worked on the busiest rank, MiB of the largest rank, bytes that
 * ranks sent in a step, the least of them: the fields of particles within h of each plane between
 * shares, each way; and the bytes that each rank has added up with the others in a step.
 */
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <pbf/mpi.h>

static int rank, size;
static uint64_t bytes_sent, bytes_summed;

/* The profiling interface of MPI: what pbf_mpi sends goes through here. */
int MPI_Isend(const void *data, int count, MPI_Datatype type, int to, int tag, MPI_Comm comm,
              MPI_Request *request) {
  bytes_sent += (uint64_t)count;
  return PMPI_Isend(data, count, type, to, tag, comm, request);
}

int MPI_Iallreduce(const void *mine, void *all, int count, MPI_Datatype type, MPI_Op op,
                   MPI_Comm comm, MPI_Request *request) {
  bytes_summed += (uint64_t)count * sizeof(uint32_t); /* which is what pbf_mpi sums up */
  return PMPI_Iallreduce(mine, all, count, type, op, comm, request);
}

static void check(pbf_status status, const char *what) {
  if (status == PBF_OK) return;
  fprintf(stderr, "%s: %s %s\n", what, pbf_last_error(), pbf_mpi_last_error());
  MPI_Abort(MPI_COMM_WORLD, 1);
}

static double waited; /* seconds of the processor's time */

static double processor_seconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* And it waits for others in here. */
int MPI_Testall(int count, MPI_Request *requests, int *done, MPI_Status *statuses) {
  const double begin = processor_seconds();
  const int code = PMPI_Testall(count, requests, done, statuses);
  waited += processor_seconds() - begin;
  return code;
}

__attribute__((visibility("default"))) int sched_yield(void) {
  const double begin = processor_seconds();
  const int code = (int)syscall(SYS_sched_yield);
  waited += processor_seconds() - begin;
  return code;
}

static pbf_params params_of(uint32_t side, const char *kind) {
  pbf_params params;
  check(pbf_params_init(&params, sizeof params), "pbf_params_init");
  params.smoothing_radius = 0.1;
  params.pressure_grid = *kind ? -1 : 0;
  params.loads = !strcmp(kind, "loads");
  params.prestabilization = 0;
  for (int k = 0; k < 3; ++k) params.domain_max[k] = 0.05 * side * (k == 1 ? 1.5 : 1);
  return params;
}

static void fill(pbf_solver *s, uint32_t side) {
  const uint32_t count = side * side * side;
  float *x = malloc((size_t)count * 3 * sizeof *x);
  if (!x) MPI_Abort(MPI_COMM_WORLD, 1);
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t at[3] = {i % side, i / side / side, i / side % side};
    for (uint32_t k = 0; k < 3; ++k)
      x[3 * (size_t)i + k] = 0.05f * ((float)at[k] + 0.45f) + (float)(i * 13 % 17) * 3e-4f;
  }
  check(pbf_add_particles(s, count, x, NULL, NULL), "pbf_add_particles");
  free(x);
}

static pbf_solver *create(const pbf_params *params, uint32_t side, const char *backend) {
  pbf_desc desc;
  pbf_solver *s;
  check(pbf_desc_init(&desc, sizeof desc), "pbf_desc_init");
  desc.capacity = side * side * side;
  desc.backend = backend;
  desc.strict = 1;
  if (backend)
    check(pbf_create(&desc, params, &s), "pbf_create");
  else
    check(pbf_mpi_create(MPI_COMM_WORLD, NULL, &desc, params, &s), "pbf_mpi_create");
  return s;
}

/* Of a step: id, prediction and its velocity with the sort; then in each iteration a number and a
 * position. What stages after the solve read is not in it, so a scene with these sends more. */
static double least_bytes(uint32_t side, const pbf_params *params) {
  const double within_h = 2.0 * side * side, sort = 4 + 2 * 12, iteration = 4 + 12;
  return 2 * (size - 1) * within_h * (sort + params->iterations * iteration);
}

int main(int count, char **words) {
  MPI_Init(&count, &words);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  const uint32_t side = count > 1 ? (uint32_t)atoi(words[1]) : 40;
  const uint32_t steps = count > 2 ? (uint32_t)atoi(words[2]) : 10;
  const char *backend = count > 3 && strcmp(words[3], "ranks") ? words[3] : NULL;
  const pbf_params params = params_of(side, count > 4 ? words[4] : "");
  pbf_solver *s = create(&params, side, backend);
  pbf_plan plan = {.struct_size = sizeof plan};
  fill(s, side);
  check(pbf_step(s, 5), "pbf_step");
  bytes_sent = bytes_summed = 0;
  waited = 0;
  MPI_Barrier(MPI_COMM_WORLD);
  double best = 1e30, worked = processor_seconds(), most = 0;
  for (uint32_t k = 0; k < steps; ++k) {
    const double begin = MPI_Wtime();
    check(pbf_step(s, 1), "pbf_step");
    const double took = MPI_Wtime() - begin;
    best = took < best ? took : best;
  }
  worked = (processor_seconds() - worked - waited) / steps;
  check(pbf_get_plan(s, &plan), "pbf_get_plan");
  uint64_t sent = 0, largest = 0;
  MPI_Reduce(&bytes_sent, &sent, 1, MPI_UINT64_T, MPI_SUM, 0, MPI_COMM_WORLD);
  MPI_Reduce(&plan.bytes, &largest, 1, MPI_UINT64_T, MPI_MAX, 0, MPI_COMM_WORLD);
  MPI_Reduce(&worked, &most, 1, MPI_DOUBLE, MPI_MAX, 0, MPI_COMM_WORLD);
  if (rank == 0)
    printf(
        "%u particles, %s, %d ranks: %.2f ms a step, %.2f of work, %.1f MiB a rank, "
        "%.0f bytes a step, least %.0f, %.0f summed\n",
        side * side * side, backend ? backend : "serial", size, 1e3 * best, 1e3 * most,
        (double)largest / (1 << 20), (double)sent / steps, least_bytes(side, &params),
        (double)bytes_summed / steps);
  pbf_destroy(s);
  MPI_Finalize();
  return 0;
}
