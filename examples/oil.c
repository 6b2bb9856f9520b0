/* Oil begins under water, and comes up. */
#include <stdio.h>
#include <stdlib.h>

#include <pbf/phases.h>

enum { SIDE = 10, LAYERS = 12, COUNT = SIDE * SIDE * LAYERS };

static float x[COUNT][3];
static uint32_t kind[COUNT];

static void check(pbf_status status) {
  if (status == PBF_OK) return;
  fprintf(stderr, "%s\n", pbf_last_error());
  exit(1);
}

/* code: phases */
enum { WATER, OIL };

static void make_two_fluids(pbf_solver *fluid, uint32_t count, const uint32_t *kinds) {
  pbf_phase phases[2];
  check(pbf_phase_init(&phases[WATER], sizeof *phases)); /* rest_density 1, viscosity 1 */
  check(pbf_phase_init(&phases[OIL], sizeof *phases));
  phases[OIL].rest_density = 0.5;
  phases[OIL].user = 0xffc040; /* yours: a colour */
  check(pbf_set_phases(fluid, 2, phases));
  check(
      pbf_set_particle_phases(fluid, 0, count, kinds)); /* a number each, in the order of adding */
}
/* end */

static double mean_height(uint32_t of) {
  double sum = 0;
  int count = 0;
  for (int i = 0; i < COUNT; ++i)
    if (kind[i] == of) sum += (double)x[i][1], ++count;
  return sum / count;
}

int main(void) {
  pbf_desc desc;
  pbf_params params;
  pbf_solver *fluid;
  check(pbf_desc_init(&desc, sizeof desc));
  check(pbf_params_init(&params, sizeof params));
  desc.capacity = COUNT;
  params.smoothing_radius = 0.125; /* 2.5 spacings: what is light leaves the floor */
  params.spacing = 0.05;
  params.domain_max[0] = params.domain_max[2] = 0.5;
  check(pbf_create(&desc, &params, &fluid));
  for (int i = 0; i < COUNT; ++i) {
    const int layer = i / (SIDE * SIDE);
    x[i][0] = 0.05f * ((float)(i % SIDE) + 0.5f);
    x[i][1] = 0.05f * ((float)layer + 0.5f);
    x[i][2] = 0.05f * ((float)(i / SIDE % SIDE) + 0.5f);
    x[i][0] += 0.004f * (float)(i * 7 % 5 - 2); /* even layers would stand on their heads */
    kind[i] = layer < LAYERS / 3 ? OIL : WATER;
  }
  check(pbf_add_particles(fluid, COUNT, x, NULL, NULL));
  make_two_fluids(fluid, COUNT, kind);
  double oil = 0, water = 1;
  for (int second = 0; second <= 6; ++second) {
    check(pbf_get_positions(fluid, 0, COUNT, x));
    oil = mean_height(OIL), water = mean_height(WATER);
    printf("%d s: the oil's middle is at %.2f m, the water's at %.2f m\n", second, oil, water);
    check(pbf_step(fluid, 120));
  }
  pbf_destroy(fluid);
  return oil > water ? 0 : 1;
}
