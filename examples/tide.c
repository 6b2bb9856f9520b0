/* A tide, in 2D: the sea at one end of a basin rises and falls, and the basin with it. No particle
 * is there at the start.
 *
 *   tide [backend] */
#include <math.h>
#include <pbf/emit.h>
#include <stdio.h>

#include "tutorial/tank.h"

static void set_sea(pbf_solver *fluid, double level) {
  /* code: sea */
  pbf_reservoir sea;
  check(pbf_reservoir_init(&sea, sizeof sea));
  sea.position[0] = 1.8; /* the last 0.4 of a basin 2 long and 1 high */
  sea.position[1] = 0.5;
  sea.half_extents[0] = 0.2;
  sea.half_extents[1] = 0.5;
  sea.depth = level; /* set anew in each frame */
  check(pbf_set_reservoirs(fluid, 1, &sea));
  /* end */
}

int main(int argc, char **argv) {
  const double pi = 3.14159265358979323846, at[2] = {0.6, 0};
  pbf_desc desc;
  pbf_params params = tank_params();
  pbf_solver *fluid = NULL;
  check(pbf_desc_init(&desc, sizeof desc));
  desc.dimension = 2;
  desc.capacity = 1000;
  if (argc > 1) desc.backend = argv[1];
  params.domain_max[0] = 2;
  params.domain_max[1] = 1;
  params.smoothing_radius = 0.15; /* three spacings, in 2D */
  check(pbf_create(&desc, &params, &fluid));
  for (int frame = 1; frame <= 2400; ++frame) { /* 20 s: a tide of 10 s, twice */
    double basin;
    const double level = 0.4 + 0.1 * sin(2 * pi * frame / 1200);
    set_sea(fluid, level);
    check(pbf_step(fluid, 1));
    if (frame % 300) continue;
    check(pbf_get_levels(fluid, 1, at, &basin));
    printf("%4.1f s: sea %.2f, basin %.2f m\n", frame / 120.0, level, basin);
  }
  pbf_destroy(fluid);
  return 0;
}
