/* Standing waves in deep water in two dimensions, against linear theory: how long the first two
 * halves of a period take, and how high the wave still is after each. Potential flow starts them
 * from a flat lattice, half a wavelength long and a quarter deep; h = 3d, 1/120 s, 4 iterations.
 *
 *   cc -O2 -Iinclude bench/tools/waves.c -o waves -Lbuild/release/lib -lpbf -lm
 * -Wl,-rpath,build/release/lib
 *   ./waves BACKEND LAYERS HEIGHT PRESSURE_GRID
 *
 * prints one object in JSON; HEIGHT is in spacings. LD_LIBRARY_PATH and PBF_BACKEND_PATH choose
 * another build. */
#include <pbf/pbf.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double pi = 3.141592653589793, spacing = 0.05, gravity = 9.81, time_step = 1.0 / 120;

static void must(pbf_status status) {
  if (status == PBF_OK) return;
  fprintf(stderr, "%s\n", pbf_last_error());
  exit(1);
}

static pbf_solver *tank(const char *backend, int wide, int layers, double grid) {
  pbf_desc desc;
  pbf_params params;
  pbf_solver *solver;
  must(pbf_desc_init(&desc, sizeof desc));
  must(pbf_params_init(&params, sizeof params));
  desc.backend = backend;
  desc.dimension = 2;
  desc.capacity = (uint32_t)(wide * layers);
  params.spacing = spacing;
  params.smoothing_radius = 3 * spacing;
  params.time_step = time_step;
  params.pressure_grid = grid;
  params.domain_max[0] = wide * spacing;
  params.domain_max[1] = 1.5 * layers * spacing;
  must(pbf_create(&desc, &params, &solver));
  return solver;
}

int main(int argc, char **argv) {
  if (argc != 5) return fprintf(stderr, "usage: waves BACKEND LAYERS HEIGHT PRESSURE_GRID\n"), 2;
  const int layers = atoi(argv[2]), wide = 2 * layers, count = wide * layers;
  const double height = atof(argv[3]), grid = atof(argv[4]);
  const double k = pi / (wide * spacing), depth = layers * spacing;
  const double omega = sqrt(gravity * k * tanh(k * depth)), half = pi / omega;
  pbf_solver *solver = tank(argv[1], wide, layers, grid);
  float *x = malloc(2 * sizeof *x * (size_t)count), *v = malloc(2 * sizeof *v * (size_t)count);
  double scale = height * spacing * omega / sinh(k * depth), last = 0, crossed = 0, most = 0;
  for (int i = 0; i < count; ++i) {
    double along = spacing * (i % wide + 0.5), up = spacing * (i / wide + 0.5);
    x[2 * i] = (float)along;
    x[2 * i + 1] = (float)up;
    v[2 * i] = (float)(-scale * cosh(k * up) * sin(k * along));
    v[2 * i + 1] = (float)(scale * sinh(k * up) * cos(k * along));
  }
  must(pbf_add_particles(solver, (uint32_t)count, x, v, NULL));
  printf(
      "{\"backend\": \"%s\", \"layers\": %d, \"height\": %g, \"pressure_grid\": %g, \"halves\": [",
      argv[1], layers, height, grid);
  for (int step = 1, halves = 0; halves < 2 && step * time_step < 6 * half; ++step) {
    double now = 0;
    must(pbf_step(solver, 1));
    must(pbf_get_positions(solver, 0, (uint32_t)count, x));
    for (int i = 0; i < count; ++i) now += 2 * cos(k * x[2 * i]) / wide;
    most = fmax(most, fabs(now));
    if (step > 2 && (now < 0) != (last < 0)) {
      double at = (step - 1 + last / (last - now)) * time_step;
      printf("%s{\"time\": %.3f, \"height\": %.2f}", halves++ ? ", " : "", (at - crossed) / half,
             most);
      crossed = at;
      most = 0;
    }
    last = now;
  }
  printf("]}\n");
  pbf_destroy(solver);
  free(x);
  free(v);
  return 0;
}
