/* What containers leave to the fluid within the walls: the volumes are those of geometry. */
#include "support.h"

#include "physics/containers.h"

namespace {

/* A domain of 10 in each direction, out of which nothing reaches beyond the centres that touch it.
 */
pbf_params params_of() {
  pbf_params params;
  memset(&params, 0, sizeof params);
  for (int k = 0; k < 3; ++k) params.domain_max[k] = 10;
  params.spacing = 0.1;
  params.wall_density = 1;
  params.gravity[1] = -1;
  return params;
}

pbf_collider container(uint32_t shape, double x, double y, double z) {
  const double at[3] = {x, y, z};
  pbf_collider c;
  memset(&c, 0, sizeof c);
  c.shape = shape;
  c.inverted = 1;
  c.orientation[3] = 1;
  for (int k = 0; k < 3; ++k) c.position[k] = at[k];
  return c;
}

pbf_collider box(double x, double y, double z, double half_x, double half_y, double half_z) {
  pbf_collider c = container(PBF_COLLIDER_BOX, x, y, z);
  c.half_extents[0] = half_x;
  c.half_extents[1] = half_y;
  c.half_extents[2] = half_z;
  return c;
}

pbf_collider ball(double x, double y, double radius) {
  pbf_collider c = container(PBF_COLLIDER_SPHERE, x, y, 5);
  c.radius = radius;
  return c;
}

double volume(const pbf_collider &c) {
  const pbf_params params = params_of();
  return pbf_containers_volume(&params, 1, &c);
}

double depth(const pbf_collider &c, double fluid) {
  const pbf_params params = params_of();
  return pbf_containers_depth(&params, 1, &c, 1, fluid);
}

constexpr double thick = PBF_DIM == 3 ? 10 : 1; /* of a prism along z through the domain */
constexpr double exact = 1e-12, sampled = 0.01; /* of the value */

void expect(double value, double right, double error) {
  if (!(fabs(value - right) <= error * right)) fail_msg("%g is not %g", value, right);
}

void in_the_domain(void **) {
  expect(volume(ball(5, 5, 2)), PBF_DIM == 3 ? 32 * PBF_PI / 3 : 4 * PBF_PI, exact);
  expect(volume(ball(2, 5, 2)), PBF_DIM == 3 ? 32 * PBF_PI / 3 : 4 * PBF_PI, exact);
  expect(depth(box(5, 5, 5, 1, 2, 5), 4 * thick), 2, exact);
}

/* Its ends stand out of the walls at z, as those of what makes a vessel in a thin slab do; or its
 * floor lies below the domain's. */
void out_of_the_walls(void **) {
  expect(volume(box(5, 5, 5, 1, 2, 100)), 8 * thick, exact);
  expect(depth(box(5, 5, 5, 1, 2, 100), 4 * thick), 2, exact);
  expect(depth(box(5, 0, 5, 1, 4, 100), 4 * thick), 2, exact);
  expect(volume(box(9, 9, 5, 2, 2, 5)), 9 * thick, exact);
  expect(volume(box(5, 5, 5, 100, 100, 100)), 100 * thick, exact);
}

void turned(void **) {
  pbf_collider c = box(5, 5, 5, 1, 2, 100);
  c.orientation[2] = sin(0.3);
  c.orientation[3] = cos(0.3);
  expect(volume(c), 8 * thick, sampled);
}

void cut_aslant(void **) {
  expect(volume(ball(0, 5, 2)), PBF_DIM == 3 ? 16 * PBF_PI / 3 : 2 * PBF_PI, sampled);
  expect(volume(ball(0, 0, 2)), PBF_DIM == 3 ? 8 * PBF_PI / 3 : PBF_PI, sampled);
  /* The cap of height 1: π h² (3 r - h) / 3, and r² acos(1/2) - √3 / 4 r². */
  expect(volume(ball(-1, 5, 2)), PBF_DIM == 3 ? 5 * PBF_PI / 3 : 4 * PBF_PI / 3 - sqrt(3.0),
         sampled);
}

/* Fluid that has lost its container to the world outside is left what that holds. */
void out_of_the_domain(void **) { expect(volume(box(20, 5, 5, 1, 1, 5)), 4 * thick, exact); }

}  // namespace

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(in_the_domain),
      cmocka_unit_test(out_of_the_walls),
      cmocka_unit_test(turned),
      cmocka_unit_test(cut_aslant),
      cmocka_unit_test(out_of_the_domain),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
