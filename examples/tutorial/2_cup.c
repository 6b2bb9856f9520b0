/* Stage 2: a cup of water above the tank is carried, and tipped. */
#include "cup.h"
#include "tank.h"

int main(int argc, char **argv) {
  pbf_desc desc;
  check(pbf_desc_init(&desc, sizeof desc));
  desc.capacity = 5000;
  pbf_solver *fluid = create_tank(&desc);
  add_block(fluid, 0.05, (const double[3]){0, 0, 0}, 20, 16, 12);

  /* code: fill */
  pbf_collider parts[CUP_PARTS];
  cup_at(0, parts);
  check(pbf_set_colliders(fluid, CUP_PARTS, parts));
  const double corner[3] = {2.4 - cup_inside, 1.05 - cup_inside, 0.3 - cup_inside};
  add_block(fluid, 0.05, corner, 9, 8, 9); /* after the dam's 3,840: ids from 3840 on */
  /* end */

  /* code: frames */
  const double frame = 1.0 / 60;
  for (int i = 1; i <= 180; ++i) {
    cup_at(i * frame, parts); /* where it is to be at the frame's end */
    check(pbf_move_colliders(fluid, CUP_PARTS, parts, frame));
    check(pbf_step(fluid, 2)); /* two steps of 1/120 s */
    /* end */
    if (i == 90 || i == 180) {
      const double lower[3] = {-INFINITY, 0.75, -INFINITY},
                   upper[3] = {INFINITY, INFINITY, INFINITY};
      uint32_t ids[5000], high = 0, poured = 0;
      check(pbf_find_in_box(fluid, lower, upper, 5000, ids, &high));
      for (uint32_t k = 0; k < high; ++k) poured += ids[k] >= 3840; /* the dam may splash so high */
      printf("%.1f s: %u particles are in the cup\n", i * frame, poured);
    }
    if (i == 135 && argc > 1) save(fluid, argv[1]);
  }
  pbf_destroy(fluid);
  return 0;
}
