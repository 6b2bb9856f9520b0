/* Columns of water at rest: how far they settle, tremble, and miss the pressure of their depth. 3D,
 * h = 2d, 4 iterations, 1/120 s; the lattice, or every coordinate off by up to JITTER spacings.
 *
 *   cc -O2 -Iinclude bench/tools/columns.c -o columns -Lbuild/release/lib -lpbf -lm
 * -Wl,-rpath,build/release/lib
 *   ./columns BACKEND WIDE LAYERS JITTER SECONDS PRESSURE_GRID
 *
 * prints one object in JSON: the height by the centre of mass over that of the lattice less 1, the
 * mean density error, the largest RMS speed of the last second over sqrt(g d), the largest error of
 * the pressure over that on the floor, and where the line through the pressures begins, in layers
 * above the lattice's surface. LD_LIBRARY_PATH and PBF_BACKEND_PATH choose another build. */
#include <pbf/pbf.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double spacing = 0.05, gravity = 9.81, time_step = 1.0 / 120;

static void must(pbf_status status) {
  if (status == PBF_OK) return;
  fprintf(stderr, "%s\n", pbf_last_error());
  exit(1);
}

static pbf_solver *column(const char *backend, int wide, int layers, double jitter, double grid) {
  pbf_desc desc;
  pbf_params params;
  pbf_solver *solver;
  unsigned seed = 1;
  must(pbf_desc_init(&desc, sizeof desc));
  must(pbf_params_init(&params, sizeof params));
  desc.backend = backend;
  desc.capacity = (uint32_t)(wide * wide * layers);
  params.spacing = spacing;
  params.smoothing_radius = 2 * spacing;
  params.time_step = time_step;
  params.pressure_grid = grid;
  for (int k = 0; k < 3; ++k) params.domain_max[k] = (k == 1 ? 1.5 * layers : wide) * spacing;
  must(pbf_create(&desc, &params, &solver));
  float *x = malloc(3 * sizeof *x * desc.capacity);
  for (uint32_t i = 0; i < desc.capacity; ++i) {
    const int at[3] = {(int)i % wide, (int)i / wide / wide, (int)i / wide % wide};
    for (int k = 0; k < 3; ++k) {
      seed = seed * 1664525u + 1013904223u;
      x[3 * i + k] = (float)(spacing * (at[k] + 0.5 + jitter * (seed / 2147483648.0 - 1)));
    }
  }
  must(pbf_add_particles(solver, desc.capacity, x, NULL, NULL));
  free(x);
  return solver;
}

static double speed_of(pbf_solver *solver) {
  pbf_stats stats = {.struct_size = sizeof stats};
  must(pbf_get_stats(solver, &stats));
  return sqrt(2 * stats.kinetic_energy / (gravity * spacing));
}

/* Where the line through them begins, and the largest error of all but the single particles above.
 */
static double pressure_of(pbf_solver *solver, uint32_t count, double depth, double *worst) {
  float *x = malloc(3 * sizeof *x * count), *p = malloc(sizeof *p * count);
  double y1 = 0, y2 = 0, p1 = 0, yp = 0;
  must(pbf_get_positions(solver, 0, count, x));
  must(pbf_get_pressures(solver, 0, count, p));
  *worst = 0;
  for (uint32_t i = 0; i < count; ++i) {
    double y = x[3 * i + 1], rest = gravity * fmax(depth - y, 0);
    y1 += y;
    y2 += y * y;
    p1 += p[i];
    yp += y * p[i];
    *worst = fmax(*worst, fabs(p[i] - rest) / (gravity * depth));
  }
  free(x);
  free(p);
  return (y1 - p1 * (count * y2 - y1 * y1) / (count * yp - y1 * p1)) / count;
}

int main(int argc, char **argv) {
  if (argc != 7)
    return fprintf(stderr, "usage: columns BACKEND WIDE LAYERS JITTER SECONDS PRESSURE_GRID\n"), 2;
  const int wide = atoi(argv[2]), layers = atoi(argv[3]);
  const double jitter = atof(argv[4]), seconds = atof(argv[5]), grid = atof(argv[6]);
  const double depth = layers * spacing;
  pbf_solver *solver = column(argv[1], wide, layers, jitter, grid);
  double speed = 0, worst;
  must(pbf_step(solver, (uint32_t)((seconds - 1) / time_step)));
  for (int k = 0; k < 10; ++k) {
    must(pbf_step(solver, 12));
    speed = fmax(speed, speed_of(solver));
  }
  pbf_stats stats = {.struct_size = sizeof stats};
  must(pbf_get_stats(solver, &stats));
  double begins = pressure_of(solver, (uint32_t)(wide * wide * layers), depth, &worst);
  printf(
      "{\"backend\": \"%s\", \"wide\": %d, \"layers\": %d, \"jitter\": %g, \"seconds\": %g, "
      "\"pressure_grid\": %g, \"height\": %.5f, \"density_error\": %.5f, \"speed\": %.4f, "
      "\"pressure_error\": %.4f, \"pressure_begins\": %.2f}\n",
      argv[1], wide, layers, jitter, seconds, grid, 2 * stats.center_of_mass[1] / depth - 1,
      stats.density_error_mean, speed, worst, begins / spacing - layers);
  pbf_destroy(solver);
  return 0;
}
