/* Fields of force that the caller computes of positions: a whirl around an axis, a point that
 * attracts, a wind over the surface. Each step the accelerations of all particles are set anew
 * (pbf_set_accelerations); where a field has none they are 0.
 *
 *   fields [backend] */
#include <math.h>

#include "tutorial/tank.h"

enum { NX = 24, NY = 10, NZ = 24, COUNT = NX * NY * NZ };

static const double spacing = 0.05, width = 1.2;
static float x[COUNT][3], v[COUNT][3], a[COUNT][3];

/* code: fields */
/* Towards the velocity of a whirl of this many turns of 2 pi a time unit around the tank's middle,
 * in the water within a radius of it. */
static void add_whirl(double turns, double radius) {
  const double rate = 4, omega = 6.283185307179586 * turns; /* 1/s */
  for (int i = 0; i < COUNT; ++i) {
    const double rx = x[i][0] - width / 2, rz = x[i][2] - width / 2;
    if (rx * rx + rz * rz > radius * radius) continue;
    a[i][0] += (float)(rate * (omega * rz - v[i][0]));
    a[i][2] += (float)(rate * (-omega * rx - v[i][2]));
  }
}

/* Newton's attraction by a mass at a point, without its singularity. */
static void add_point(const double at[3], double mass) {
  for (int i = 0; i < COUNT; ++i) {
    double way[3], r2 = spacing * spacing;
    for (int k = 0; k < 3; ++k) way[k] = at[k] - x[i][k];
    for (int k = 0; k < 3; ++k) r2 += way[k] * way[k];
    for (int k = 0; k < 3; ++k) a[i][k] += (float)(mass * way[k] / (r2 * sqrt(r2)));
  }
}

/* A wind along x drags at what is above a height. */
static void add_wind(double speed, double above) {
  const double rate = 2; /* 1/s */
  for (int i = 0; i < COUNT; ++i)
    if (x[i][1] > above) a[i][0] += (float)(rate * (speed - v[i][0]));
}
/* end */

static void begin_fields(pbf_solver *fluid) {
  check(pbf_get_positions(fluid, 0, COUNT, x));
  check(pbf_get_velocities(fluid, 0, COUNT, v));
  for (int i = 0; i < COUNT; ++i)
    for (int k = 0; k < 3; ++k) a[i][k] = 0;
}

/* Of the water within a radius: how fast it turns around the middle, 1/s. */
static double turning(double radius) {
  double angular = 0, inertia = 0;
  for (int i = 0; i < COUNT; ++i) {
    const double rx = x[i][0] - width / 2, rz = x[i][2] - width / 2, r2 = rx * rx + rz * rz;
    if (r2 > radius * radius) continue;
    angular += rz * v[i][0] - rx * v[i][2];
    inertia += r2;
  }
  return angular / inertia;
}

static double mean(int k, double above, float of[COUNT][3]) {
  double sum = 0, count = 0;
  for (int i = 0; i < COUNT; ++i)
    if (x[i][1] > above) {
      sum += of[i][k];
      ++count;
    }
  return count > 0 ? sum / count : 0;
}

int main(int argc, char **argv) {
  const double point[3] = {0.9, 0.6, 0.6};
  pbf_desc desc;
  pbf_params params = tank_params();
  pbf_solver *fluid = NULL;
  check(pbf_desc_init(&desc, sizeof desc));
  if (argc > 1) desc.backend = argv[1];
  params.domain_max[0] = params.domain_max[2] = width;
  check(pbf_create(&desc, &params, &fluid));
  add_block(fluid, spacing, (const double[]){0, 0, 0}, NX, NY, NZ);
  for (int step = 0; step < 480; ++step) {
    /* code: use */
    begin_fields(fluid); /* reads positions and velocities; all accelerations 0 */
    if (step < 180) add_whirl(0.5, 0.4);
    if (step >= 180 && step < 300) add_wind(3, 0.45);
    if (step >= 300) add_point(point, 2);
    check(pbf_set_accelerations(fluid, 0, COUNT, a));
    check(pbf_step(fluid, 1));
    /* end */
    if (step == 179) printf("the whirl turns by %.2f 1/s\n", turning(0.3));
    if (step == 299) printf("the wind takes the surface along at %.2f m/s\n", mean(0, 0.45, v));
    if (step == 479) printf("the point has drawn the water to x = %.2f m\n", mean(0, -1, x));
  }
  check(pbf_set_accelerations(fluid, 0, 0, NULL));
  pbf_destroy(fluid);
  return 0;
}
