#include "cases.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

void check(pbf_status status) {
  if (status == PBF_OK) return;
  fprintf(stderr, "pbf-forces: %s\n", pbf_last_error());
  exit(1);
}

pbf_params params_of(double spacing, const double domain[3], double fastest) {
  pbf_params params;
  check(pbf_params_init(&params, sizeof params));
  params.spacing = spacing;
  params.smoothing_radius = 2 * spacing;
  params.time_step = 0.25 * spacing / fastest;
  params.loads = 1;
  for (int k = 0; k < 3; ++k) params.domain_max[k] = domain[k];
  return params;
}

static void fail(const char *what, double spacing) {
  fprintf(stderr, "pbf-forces: a spacing of %g %s\n", spacing, what);
  exit(1);
}

/* How many particles stand along each axis; returns how many there are in all. */
static uint32_t count_places(const double size[3], double spacing, uint32_t n[3]) {
  double all = 1, along[3];
  for (int k = 0; k < 3; ++k) all *= along[k] = size[k] > 0 ? round(size[k] / spacing) : 1;
  if (all < 1) fail("is too wide for this case", spacing);
  if (!(all <= PBF_MAX_CAPACITY)) fail("makes more particles than a solver holds", spacing);
  for (int k = 0; k < 3; ++k) n[k] = (uint32_t)along[k];
  return (uint32_t)all;
}

pbf_solver *water_of(const pbf_params *params, const double size[3],
                     int (*is_water)(const double x[3], const void *context), const void *context) {
  const uint32_t dimension = size[2] > 0 ? 3 : 2;
  uint32_t n[3], count = 0;
  const uint32_t all = count_places(size, params->spacing, n);
  float *x = malloc((size_t)all * dimension * sizeof *x);
  if (!x) fail("makes more particles than there is memory for", params->spacing);
  for (uint32_t i = 0; i < all; ++i) {
    const uint32_t at[3] = {i % n[0], i / n[0] % n[1], i / n[0] / n[1]};
    double place[3] = {0, 0, 0};
    for (uint32_t k = 0; k < dimension; ++k) place[k] = params->spacing * (at[k] + 0.5);
    if (!is_water(place, context)) continue;
    for (uint32_t k = 0; k < dimension; ++k) x[count * dimension + k] = (float)place[k];
    ++count;
  }
  pbf_desc desc;
  pbf_solver *fluid;
  check(pbf_desc_init(&desc, sizeof desc));
  desc.dimension = dimension;
  if (forces_backend) {
    desc.backend = forces_backend;
    desc.strict = 1;
  }
  desc.capacity = count;
  check(pbf_create(&desc, params, &fluid));
  check(pbf_add_particles(fluid, count, x, NULL, NULL));
  free(x);
  return fluid;
}

static int print_line(const char *name, const char *figure, double is, double right, double bar) {
  const double error = right != 0 ? is / right - 1 : is;
  const int missed = bar > 0 && !(fabs(error) <= bar);
  printf("| %s | %s | %.4g | %.4g | %+.2g | ", name, figure, is, right, error);
  if (bar > 0)
    printf("%g %s |\n", bar, missed ? "missed" : "holds");
  else
    printf(" |\n");
  fflush(stdout);
  return missed;
}

const char *forces_backend;
int (*forces_report)(const char *name, const char *figure, double is, double right,
                     double bar) = print_line;
