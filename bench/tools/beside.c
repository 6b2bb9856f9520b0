/* Water at rest between walls: how fast the layer next to them rises or sinks, and how fast all of
 * it moves. A square tank WIDE by LAYERS spacings, from a lattice, 4 iterations, 1/120 s, float32.
 *
 *   cc -O2 -Iinclude bench/tools/beside.c -o beside -Lbuild/release/lib -lpbf -lm
 * -Wl,-rpath,build/release/lib
 *   ./beside BACKEND DIMENSION SUPPORT WIDE LAYERS STEPS
 *
 * prints one object in JSON: the mean vertical velocity of the particles within a spacing of a side
 * wall at middle heights, and the RMS velocity of all, over sqrt(g d) and the last half of the
 * steps. LD_LIBRARY_PATH and PBF_BACKEND_PATH choose another build. */
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

typedef struct tank {
  uint32_t dimension, wide, layers, count;
  float *x, *v;
  pbf_solver *solver;
} tank;

static tank tank_of(const char *backend, uint32_t dimension, double support, uint32_t wide,
                    uint32_t layers) {
  const uint32_t thick = dimension == 3 ? wide : 1, count = wide * layers * thick;
  tank t = {dimension, wide, layers, count, NULL, NULL, NULL};
  pbf_desc desc;
  pbf_params params;
  must(pbf_desc_init(&desc, sizeof desc));
  must(pbf_params_init(&params, sizeof params));
  desc.backend = backend;
  desc.dimension = dimension;
  desc.capacity = count;
  params.spacing = spacing;
  params.smoothing_radius = support * spacing;
  params.time_step = time_step;
  for (int k = 0; k < 3; ++k) params.domain_max[k] = spacing * (k == 1 ? 2 * layers : wide);
  must(pbf_create(&desc, &params, &t.solver));
  t.x = malloc(sizeof *t.x * dimension * count);
  t.v = calloc((size_t)dimension * count, sizeof *t.v);
  if (!t.x || !t.v) exit(1);
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t at[3] = {i % wide, i / wide % layers, i / wide / layers};
    for (uint32_t k = 0; k < dimension; ++k)
      t.x[i * dimension + k] = (float)(spacing * (at[k] + 0.5));
  }
  must(pbf_add_particles(t.solver, count, t.x, t.v, NULL));
  return t;
}

static double from_walls(const tank *t, const float *x) {
  double least = t->wide;
  for (uint32_t k = 0; k < t->dimension; k += 2)
    least = fmin(least, fmin(x[k], t->wide * spacing - x[k]) / spacing);
  return least;
}

typedef struct sums {
  double rises, beside, squares, all;
} sums;

static void look(const tank *t, sums *s) {
  must(pbf_get_positions(t->solver, 0, t->count, t->x));
  must(pbf_get_velocities(t->solver, 0, t->count, t->v));
  for (uint32_t i = 0; i < t->count; ++i) {
    const float *x = t->x + i * t->dimension, *v = t->v + i * t->dimension;
    const double height = x[1] / (spacing * t->layers);
    for (uint32_t k = 0; k < t->dimension; ++k) s->squares += v[k] * v[k];
    ++s->all;
    if (height < 0.15 || height > 0.85 || from_walls(t, x) > 1) continue;
    s->rises += v[1];
    ++s->beside;
  }
}

int main(int argc, char **argv) {
  if (argc != 7) {
    fprintf(stderr, "usage: %s BACKEND DIMENSION SUPPORT WIDE LAYERS STEPS\n", argv[0]);
    return 2;
  }
  const double support = atof(argv[3]), unit = sqrt(gravity * spacing);
  tank t = tank_of(argv[1], (uint32_t)atoi(argv[2]), support, (uint32_t)atoi(argv[4]),
                   (uint32_t)atoi(argv[5]));
  const int steps = atoi(argv[6]);
  sums s = {0, 0, 0, 0};
  for (int step = 1; step <= steps; ++step) {
    must(pbf_step(t.solver, 1));
    if (step > steps / 2) look(&t, &s);
  }
  printf(
      "{\"backend\": \"%s\", \"dimension\": %u, \"support\": %g, \"wide\": %u, \"layers\": %u, "
      "\"steps\": %d, \"rises_beside_walls\": %.4f, \"speed\": %.4f}\n",
      argv[1], t.dimension, support, t.wide, t.layers, steps, s.rises / s.beside / unit,
      sqrt(s.squares / s.all) / unit);
  pbf_destroy(t.solver);
  return 0;
}
