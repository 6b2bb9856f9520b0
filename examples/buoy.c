/* A buoy, and a boat: bodies that the fluid carries without being moved by them. Each step asks how
 * much of a body is below the surface, where the middle of that part is and how it flows; a few
 * lines of rigid-body code do the rest. A boat that moves the water, too, is a collider.
 *
 *   buoy [backend] */
#include <math.h>
#include <pbf/query.h>
#include <stdio.h>

#include "tutorial/tank.h"

/* code: body */
/* Of water with the density 1: `density` 0.5 floats half sunk. */
typedef struct body {
  pbf_volume volume;
  double density;
  double velocity[3];
  double roll; /* about z */
} body;

/* Archimedes: the weight of the water that is displaced, upwards, where the middle of it is; and a
 * drag towards the flow around. Explicit Euler over dt. */
static void float_on(body *b, const pbf_volume_flow *flow, const double gravity[3], double dt) {
  const double drag = 4, inertia = 0.1; /* 1/s; of a turn, length² */
  const double lift = flow->fraction / b->density;
  double lever[2];
  for (int k = 0; k < 3; ++k) {
    const double drift = drag * lift * (flow->velocity[k] - b->velocity[k]);
    b->velocity[k] += dt * (gravity[k] * (1 - lift) + drift);
    b->volume.position[k] += dt * b->velocity[k];
  }
  for (int k = 0; k < 2; ++k) lever[k] = flow->centre[k] - b->volume.position[k];
  b->roll += dt * (lever[0] * -gravity[1] * lift / inertia - drag * lift * b->roll);
  const double angle = 2 * atan2(b->volume.orientation[2], b->volume.orientation[3]) + dt * b->roll;
  b->volume.orientation[2] = sin(angle / 2);
  b->volume.orientation[3] = cos(angle / 2);
}
/* end */

static body body_at(uint32_t shape, double x, double density) {
  body b = {.density = density};
  check(pbf_volume_init(&b.volume, sizeof b.volume, shape));
  b.volume.position[0] = x;
  b.volume.position[1] = 0.9;
  b.volume.position[2] = 0.3;
  return b;
}

int main(int argc, char **argv) {
  pbf_desc desc;
  pbf_params params = tank_params();
  pbf_solver *fluid = NULL;
  body bodies[2] = {body_at(PBF_VOLUME_SPHERE, 0.8, 0.5), body_at(PBF_VOLUME_BOX, 1.9, 0.25)};
  double level;
  check(pbf_desc_init(&desc, sizeof desc));
  if (argc > 1) desc.backend = argv[1];
  params.domain_max[0] = 2.4;
  check(pbf_create(&desc, &params, &fluid));
  add_block(fluid, 0.05, (const double[]){0, 0, 0}, 48, 12, 12);
  bodies[0].volume.radius = 0.2;
  bodies[1].volume.half_extents[0] = 0.4; /* a flat boat, which sets itself upright */
  bodies[1].volume.half_extents[1] = bodies[1].volume.half_extents[2] = 0.1;
  bodies[1].volume.orientation[2] = sin(0.1);
  bodies[1].volume.orientation[3] = cos(0.1);
  for (int step = 0; step < 480; ++step) {
    /* code: ask */
    pbf_volume volumes[2] = {bodies[0].volume, bodies[1].volume};
    pbf_volume_flow flows[2] = {{.struct_size = sizeof *flows}, {.struct_size = sizeof *flows}};
    check(pbf_measure_volumes(fluid, 2, volumes, flows));
    for (int i = 0; i < 2; ++i) float_on(&bodies[i], &flows[i], params.gravity, params.time_step);
    check(pbf_step(fluid, 1));
    /* end */
    if (step % 120 == 119)
      printf("%.0f s: the buoy is at %.2f m, %2.0f %% sunk; the boat at %.2f m, %2.0f %%\n",
             (step + 1) * params.time_step, bodies[0].volume.position[1], 100 * flows[0].fraction,
             bodies[1].volume.position[1], 100 * flows[1].fraction);
  }
  check(pbf_get_levels(fluid, 1, (const double[]){1.2, 0, 0.3}, &level));
  printf("the water stands at %.2f m, and the boat leans by %.3f\n", level,
         2 * atan2(bodies[1].volume.orientation[2], bodies[1].volume.orientation[3]));
  pbf_destroy(fluid);
  return 0;
}
