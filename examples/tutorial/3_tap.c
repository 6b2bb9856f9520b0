/* Stage 3: a tap above one end of the tank, a drain at the other. */
#include <math.h>

#include "tank.h"

/* code: tap */
/* A layer of 5 x 5 particles, which falls by a spacing until the next one comes. */
static void open_tap(pbf_solver *fluid, double spacing, double speed) {
  float positions[25][3], velocities[25][3];
  for (int i = 0; i < 25; ++i) {
    positions[i][0] = (float)(0.2 + spacing * (i % 5));
    positions[i][1] = 1.5f;
    positions[i][2] = (float)(0.2 + spacing * (i / 5));
    velocities[i][0] = velocities[i][2] = 0;
    velocities[i][1] = (float)-speed;
  }
  const pbf_status status = pbf_add_particles(fluid, 25, positions, velocities, NULL);
  if (status != PBF_ERROR_CAPACITY) check(status); /* the tank is full: the tap waits */
}
/* end */

/* code: drain */
/* Takes what has come to the far corner of the floor; gives how many those were. */
static uint32_t open_drain(pbf_solver *fluid) {
  const double lower[3] = {2.7, -INFINITY, -INFINITY}, upper[3] = {INFINITY, 0.1, INFINITY};
  uint32_t taken = 0;
  check(pbf_remove_in_box(fluid, lower, upper, &taken));
  return taken;
}
/* end */

int main(int argc, char **argv) {
  pbf_desc desc;
  check(pbf_desc_init(&desc, sizeof desc));
  desc.capacity = 6000;
  pbf_solver *fluid = create_tank(&desc);
  add_block(fluid, 0.05, (const double[3]){0, 0, 0}, 60, 4, 12); /* a shallow pool */

  /* code: loop */
  uint32_t added = 2880, drained = 0, count = 0;
  for (int i = 1; i <= 120; ++i) { /* 3 s: a layer each three steps, 1/40 s, is 2 m/s */
    open_tap(fluid, 0.05, 2);
    check(pbf_step(fluid, 3));
    drained += open_drain(fluid);
    if (i == 60 && argc > 1) save(fluid, argv[1]);
  }
  check(pbf_get_count(fluid, &count));
  added += 120 * 25;
  /* end */
  printf("%u came, %u went, %u are there%s\n", added, drained, count,
         added == drained + count ? "" : ": some are lost");
  pbf_destroy(fluid);
  return added == drained + count ? 0 : 1;
}
