/* Each preset on the same dam, a second long: what it costs, and how wrong it is. Fails where a
 * preset does not keep what docs/presets.md says of it. */
#include "presets.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

enum { NX = 16, NY = 16, NZ = 8, COUNT = NX * NY * NZ };
static const double d = 0.05, height = 0.8;

typedef struct outcome {
  uint32_t steps;
  double ms, error, error_max, fastest, front, seconds;
} outcome;

static int fail(const char *name) {
  fprintf(stderr, "%s: %s\n", name, pbf_last_error());
  return 0;
}

/* Processor time: that of other programs does not count. */
static double now(void) { return (double)clock() / CLOCKS_PER_SEC; }

static int run(const char *name, const pbf_desc *desc, pbf_params *params, outcome *out) {
  static float positions[COUNT][3];
  params->domain_max[0] = 2, params->domain_max[1] = 1, params->domain_max[2] = NZ * d;
  for (int i = 0; i < COUNT; ++i) {
    positions[i][0] = (float)(d * (i % NX + 0.5));
    positions[i][1] = (float)(d * (i / NX % NY + 0.5));
    positions[i][2] = (float)(d * (i / NX / NY + 0.5));
  }
  pbf_solver *fluid = NULL;
  if (pbf_create(desc, params, &fluid) != PBF_OK) return fail(name);
  int good = pbf_add_particles(fluid, COUNT, positions, NULL, NULL) == PBF_OK;
  memset(out, 0, sizeof *out);
  for (int tenth = 1; good && tenth <= 10; ++tenth) {
    const uint32_t steps = (uint32_t)(0.1 * tenth / params->time_step + 0.5) - out->steps;
    const double start = now();
    good = pbf_step(fluid, steps) == PBF_OK && pbf_synchronize(fluid) == PBF_OK;
    out->seconds += now() - start;
    out->steps += steps;
    pbf_stats stats = {.struct_size = sizeof stats};
    good = good && pbf_get_stats(fluid, &stats) == PBF_OK;
    out->error += 0.1 * stats.density_error_mean;
    out->error_max = fmax(out->error_max, stats.density_error_max);
    out->fastest = fmax(out->fastest, stats.speed_max);
    out->front = fmax(out->front, stats.position_max[0]);
  }
  out->ms = 1e3 * out->seconds / out->steps;
  if (!good) fail(name);
  pbf_destroy(fluid);
  return good;
}

/* `error`: the mean compression that docs/presets.md promises. Nothing is faster than twice a fall
 * by the dam's height; NaN is not. The front has come to the far wall. */
static int judge(const char *name, const pbf_desc *desc, pbf_params *params, double error,
                 double front) {
  outcome out;
  if (!run(name, desc, params, &out)) return 0;
  printf("| %s | %.3g | %u | %.1f | %.2f | %.1f %% | %.2f %% | %.1f |\n", name,
         params->smoothing_radius / d, out.steps, out.ms, out.seconds, 100 * out.error_max,
         100 * out.error, out.fastest);
  const int good =
      out.error <= error && out.fastest < 2 * sqrt(2 * 9.81 * height) && out.front >= front;
  if (!good)
    fprintf(stderr, "%s: not as promised: error %g, at most %g; front at %g, at least %g\n", name,
            out.error, error, out.front, front);
  return good;
}

int main(void) {
  pbf_desc desc;
  pbf_params params;
  pbf_desc_init(&desc, sizeof desc);
  desc.capacity = COUNT;
  desc.threads = 1;
  printf(
      "| preset | h/d | steps | ms a step | for 1 s, s | most compressed | mean | fastest, m/s "
      "|\n");
  printf("| --- | --: | --: | --: | --: | --: | --: | --: |\n");
  preset_begin(&params, d, height);
  int good = judge("begin", &desc, &params, 0.02, 1.9);
  preset_game(&params, d, height);
  good &= judge("game", &desc, &params, 0.02, 1.9);
  preset_film(&params, d, height);
  good &= judge("film", &desc, &params, 0.005, 1.9);
  preset_research(&params, d, height);
  good &= judge("research", &desc, &params, 0.002, 1.9);
  preset_thick(&params, d, height);
  good &= judge("thick", &desc, &params, 0.011, 0.85);
  preset_replay(&desc, &params, d, height);
  desc.capacity = COUNT;
  desc.threads = 1;
  desc.isa = "scalar"; /* what every build has */
  good &= judge("replay", &desc, &params, 0.02, 1.9);
  return good ? 0 : 1;
}
