/* Stage 1: a dam breaks. With a file's name it writes the state there when the wave is on its way.
 */
#include "tank.h"

int main(int argc, char **argv) {
  /* code: create */
  pbf_desc desc;
  check(pbf_desc_init(&desc, sizeof desc)); /* 3D, float32, the fastest backend */
  desc.capacity = 4000;                     /* the most particles there will be */
  pbf_solver *fluid = create_tank(&desc);
  add_block(fluid, 0.05, (const double[3]){0, 0, 0}, 20, 16, 12); /* 1 x 0.8 x 0.6 m */
  /* end */

  /* code: steps */
  for (int tenth = 1; tenth <= 20; ++tenth) {
    pbf_stats stats = {.struct_size = sizeof stats};
    check(pbf_step(fluid, 12));
    check(pbf_get_stats(fluid, &stats));
    printf("%.1f s: front at %.2f m, fastest %.1f m/s, compressed by %.1f %%\n", 0.1 * tenth,
           stats.position_max[0], stats.speed_max, 100 * stats.density_error_mean);
    if (tenth == 5 && argc > 1) save(fluid, argv[1]);
  }
  pbf_destroy(fluid);
  /* end */
  return 0;
}
