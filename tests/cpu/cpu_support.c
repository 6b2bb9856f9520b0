#include "cpu_support.h"

#include <dirent.h>

pbf_desc cpu_desc(const char *backend, uint32_t dimension, uint32_t precision, uint32_t capacity,
                  uint32_t threads) {
  pbf_desc desc = test_desc(dimension, precision, capacity);
  desc.backend = backend;
  desc.threads = threads;
  desc.allocator = NULL;
  return desc;
}

static void *convert(uint32_t precision, uint64_t values, const double *from) {
  void *to = calloc(values + 1, precision);
  assert_non_null(to);
  for (uint64_t i = 0; from && i < values; ++i) test_put(to, i, precision, from[i]);
  return to;
}

void cpu_add(pbf_solver *solver, uint32_t precision, uint32_t dimension, uint32_t count,
             const double *x, const double *v) {
  void *positions = convert(precision, (uint64_t)count * dimension, x);
  void *velocities = convert(precision, (uint64_t)count * dimension, v);
  assert_ok(pbf_add_particles(solver, count, positions, velocities, NULL));
  free(positions);
  free(velocities);
}

static pbf_info info_of(pbf_solver *solver) {
  pbf_info info = {.struct_size = sizeof info};
  assert_ok(pbf_get_info(solver, &info));
  return info;
}

void cpu_add_column(pbf_solver *solver, uint32_t count) {
  double(*x)[3] = calloc(count, sizeof *x);
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t place[3] = {i % 10, i / 10 % 10, i / 100};
    for (int k = 0; k < 3; ++k) x[i][k] = 0.03 + 0.047 * place[k];
  }
  cpu_add(solver, PBF_FLOAT32, 3, count, &x[0][0], NULL);
  free(x);
}

double *cpu_get(pbf_solver *solver, uint32_t field) {
  pbf_info info = info_of(solver);
  uint32_t count;
  assert_ok(pbf_get_count(solver, &count));
  uint64_t values = (uint64_t)count * (field == PBF_FIELD_DENSITY ? 1 : info.dimension);
  void *raw = calloc(values + 1, info.precision);
  double *out = calloc(values + 1, sizeof *out);
  if (field == PBF_FIELD_POSITION) assert_ok(pbf_get_positions(solver, 0, count, raw));
  if (field == PBF_FIELD_VELOCITY) assert_ok(pbf_get_velocities(solver, 0, count, raw));
  if (field == PBF_FIELD_DENSITY) assert_ok(pbf_get_densities(solver, 0, count, raw));
  for (uint64_t i = 0; i < values; ++i) out[i] = test_value(raw, i, info.precision);
  free(raw);
  return out;
}

double cpu_difference(pbf_solver *a, pbf_solver *b, uint32_t field) {
  uint32_t count;
  assert_ok(pbf_get_count(a, &count));
  uint64_t values = (uint64_t)count * (field == PBF_FIELD_DENSITY ? 1 : info_of(a).dimension);
  double *in_a = cpu_get(a, field), *in_b = cpu_get(b, field), most = 0;
  for (uint64_t i = 0; i < values; ++i) {
    double difference = fabs(in_a[i] - in_b[i]);
    if (!(difference <= most)) most = difference; /* NaN is a difference too */
  }
  free(in_a);
  free(in_b);
  return most;
}

double cpu_random(uint64_t *state) {
  *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  return (double)(*state >> 11) / 9007199254740992.0;
}

cpu_block cpu_make_block(uint32_t dimension) {
  const uint32_t side = dimension == 2 ? 20 : 8;
  const double spacing = 0.02;
  cpu_block b = {.dimension = dimension,
                 .count = dimension == 2 ? side * side : side * side * side};
  uint64_t seed = 7;
  b.x = calloc((size_t)b.count * dimension, sizeof *b.x);
  b.v = calloc((size_t)b.count * dimension, sizeof *b.v);
  for (uint32_t i = 0; i < b.count; ++i) {
    uint32_t rest = i;
    for (uint32_t k = 0; k < dimension; ++k, rest /= side)
      b.x[i * dimension + k] = 0.03 + spacing * (rest % side + 0.04 * (cpu_random(&seed) - 0.5));
    b.v[i * dimension] = 0.3 * b.x[i * dimension + 1];
    b.v[i * dimension + 1] = 0.2 * sin(9 * b.x[i * dimension]);
  }
  return b;
}

void cpu_free_block(cpu_block *block) {
  free(block->x);
  free(block->v);
}

pbf_params cpu_block_params(void) {
  pbf_params params = test_params();
  params.spacing = 0.02;
  params.smoothing_radius = 2.12 * params.spacing;
  params.time_step = 2e-4;
  params.iterations = 3;
  params.over_relaxation = 0.003;
  return params;
}

int cpu_threads_now(void) {
  int count = 0;
  DIR *tasks = opendir("/proc/self/task");
  assert_non_null(tasks);
  for (const struct dirent *entry; (entry = readdir(tasks));) count += entry->d_name[0] != '.';
  closedir(tasks);
  return count;
}
