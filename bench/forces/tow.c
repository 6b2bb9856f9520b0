/* A ball towed through water, deep below its surface: the coefficient of its drag. Walls let fluid
 * slip, so that its boundary layer is none; in water that of a smooth ball is 0.4 to 0.5 at
 * Reynolds numbers of 10³ to 2 10⁵ (Clift, Grace & Weber, Bubbles, Drops, and Particles, 1978). */
#include <math.h>
#include <stdio.h>

#include "cases.h"

static const double tank[3] = {2.4, 0.8, 0.8}, radius = 0.1, speed = 1;

static int is_outside(const double x[3], const void *context) {
  const double *at = context;
  double r2 = 0;
  for (int k = 0; k < 3; ++k) r2 += (x[k] - at[k]) * (x[k] - at[k]);
  return sqrt(r2) > radius;
}

int run_tow(double spacing) {
  const double domain[3] = {tank[0], 1.2, tank[2]}, at[3] = {0.4, tank[1] / 2, tank[2] / 2};
  pbf_params params = params_of(spacing, domain, 2 * speed);
  pbf_solver *fluid = water_of(&params, tank, is_outside, at);
  pbf_collider ball;
  pbf_collider_load load = {.struct_size = sizeof load};
  const uint32_t moves = (uint32_t)(0.4 / params.time_step);
  check(pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SPHERE));
  ball.radius = radius;
  for (int k = 0; k < 3; ++k) ball.position[k] = at[k];
  ball.velocity[0] = speed;
  check(pbf_set_colliders(fluid, 1, &ball));
  check(pbf_step(fluid, moves)); /* it gets going */
  check(pbf_get_collider_loads(fluid, 1, &load));
  check(pbf_step(fluid, 2 * moves));
  check(pbf_get_collider_loads(fluid, 1, &load));
  pbf_destroy(fluid);
  const double pressure = 0.5 * speed * speed, area = acos(-1) * radius * radius;
  const double drag = -load.impulse_sum[0] / load.time_sum / (pressure * area);
  return forces_report("tow", "coefficient of drag", drag, 0.45, 0.1);
}
