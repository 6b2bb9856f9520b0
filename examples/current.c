/* A current tank, in 2D: water comes in along the floor at one end, and what stands above the level
 * leaves over a weir at the other. The level stays.
 *
 *   current [backend] */
#include <pbf/emit.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tutorial/tank.h"

enum { COLUMNS = 40, LAYERS = 10 };

static const double spacing = 0.05;

static void fill(pbf_solver *fluid) {
  float x[COLUMNS * LAYERS][2];
  for (int i = 0; i < COLUMNS * LAYERS; ++i) {
    x[i][0] = (float)(spacing * (i % COLUMNS + 0.5));
    x[i][1] = (float)(spacing * (i / COLUMNS + 0.5));
  }
  check(pbf_add_particles(fluid, COLUMNS * LAYERS, x, NULL, NULL));
}

static void set_current(pbf_solver *fluid) {
  /* code: inlet */
  pbf_emitter inlet;
  pbf_volume weir;
  check(pbf_emitter_init(&inlet, sizeof inlet, PBF_EMITTER_RECTANGLE));
  inlet.position[0] = 0.025; /* at the left wall, 0.2 high; in 2D a line */
  inlet.position[1] = 0.15;
  inlet.half_width = 0.1;
  inlet.velocity[0] = 0.5;
  inlet.velocity[1] = 0; /* rate 0: as much as the opening carries, here 0.1 a second */
  check(pbf_set_emitters(fluid, 1, &inlet));
  check(pbf_volume_init(&weir, sizeof weir, PBF_VOLUME_BOX));
  weir.position[0] = 1.9; /* from 1.8 to the end of the tank, above the level */
  weir.position[1] = 0.75;
  weir.half_extents[0] = 0.1;
  weir.half_extents[1] = 0.25 + spacing / 2; /* a particle is a spacing wide */
  check(pbf_set_drains(fluid, 1, &weir));
  /* end */
}

int main(int argc, char **argv) {
  pbf_desc desc;
  pbf_params params = tank_params();
  pbf_solver *fluid = NULL;
  pbf_in_out in_out = {.struct_size = sizeof in_out};
  check(pbf_desc_init(&desc, sizeof desc));
  desc.dimension = 2;
  desc.capacity = 2000;
  if (argc > 1) desc.backend = argv[1];
  params.domain_max[0] = 2;
  params.domain_max[1] = 1;
  check(pbf_create(&desc, &params, &fluid));
  fill(fluid);
  set_current(fluid);
  for (int second = 2; second <= 10; second += 2) {
    const double at[3][2] = {{0.4, 0}, {0.8, 0}, {1.2, 0}};
    double levels[3];
    check(pbf_step(fluid, 240));
    check(pbf_get_levels(fluid, 3, at[0], levels));
    check(pbf_get_in_out(fluid, &in_out));
    printf("%2d s: level %.2f %.2f %.2f m, %u in, %u out\n", second, levels[0], levels[1],
           levels[2], (unsigned)in_out.emitted, (unsigned)in_out.drained);
  }
  pbf_destroy(fluid);
  return 0;
}
