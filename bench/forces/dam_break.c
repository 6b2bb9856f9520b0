/* A column of water falls over and runs against the far wall of a tank, in 2D. What walls get in
 * all is the momentum that the fluid loses, at any time; in the end each carries what rests on it.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "cases.h"

static const double length = 1.2, column = 0.4, high = 0.6, gravity = 9.81;

static int everywhere(const double x[3], const void *context) {
  (void)x;
  (void)context;
  return 1;
}

/* Over rest density. */
static double momentum_along(pbf_solver *fluid, double mass) {
  pbf_stats stats = {.struct_size = sizeof stats};
  check(pbf_get_stats(fluid, &stats));
  return stats.momentum[0] * stats.count * mass;
}

static void read_walls(pbf_solver *fluid, pbf_collider_load walls[4]) {
  for (int k = 0; k < 4; ++k) walls[k].struct_size = sizeof walls[k];
  check(pbf_get_wall_loads(fluid, 4, walls));
}

int run_dam_break(double spacing) {
  const double domain[3] = {length, 1.2, 0}, size[3] = {column, high, 0};
  const double level = column * high / length;
  pbf_params params = params_of(spacing, domain, sqrt(2 * gravity * high));
  pbf_solver *fluid = water_of(&params, size, everywhere, NULL);
  pbf_collider_load walls[4];
  const double mass = spacing * spacing;
  const uint32_t steps = (uint32_t)ceil(0.01 / params.time_step);
  double given = 0, largest = 0, peak = 0, far = 0, floor_force = 0, time = 0;
  int missed = 0;
  for (int k = 0; k < 1200; ++k) {
    check(pbf_step(fluid, steps));
    read_walls(fluid, walls);
    given += walls[0].impulse_sum[0] + walls[1].impulse_sum[0];
    largest = fmax(largest, fabs(given + momentum_along(fluid, mass)));
    peak = fmax(peak, walls[1].impulse_sum[0] / walls[1].time_sum);
    if (k < 1000) continue;
    far += walls[1].impulse_sum[0];
    floor_force -= walls[2].impulse_sum[1];
    time += walls[1].time_sum;
  }
  pbf_destroy(fluid);
  const double rest = 0.5 * gravity * level * level;
  missed +=
      forces_report("dam-break", "momentum of fluid and walls, over that of the column at √(2gH)",
                    largest / (column * high * sqrt(2 * gravity * high)), 0, 1e-4);
  forces_report("dam-break", "largest force on the far wall in 10 ms, over that at rest",
                peak / rest, 0, 0);
  missed += forces_report("dam-break", "force on the far wall at rest, N/m over ρ0", far / time,
                          rest, 0.05);
  missed += forces_report("dam-break", "weight on the floor at rest, N/m over ρ0",
                          floor_force / time, gravity * column * high, 0.01);
  return missed;
}
