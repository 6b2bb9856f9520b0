/* Walls and colliders: where a point goes, and where the shapes are at a time. */
#include "support.h"

static pbf_vec point(double x, double y, double z) {
  double full[3] = {x, y, z};
  pbf_vec p;
  for (int k = 0; k < PBF_DIM; ++k) p.c[k] = full[k];
  return p;
}

static void assert_at(pbf_vec p, double x, double y, double z) {
  double full[3] = {x, y, z};
  for (int k = 0; k < PBF_DIM; ++k) assert_near(p.c[k], full[k], 1e-12);
}

static pbf_collider collider(uint32_t shape) {
  pbf_collider c;
  memset(&c, 0, sizeof c);
  c.struct_size = sizeof c;
  c.shape = shape;
  c.orientation[3] = 1;
  c.axis[1] = 1;
  c.half_extents[0] = 1;
  c.half_extents[1] = 2;
  c.half_extents[2] = 3;
  c.radius = 0.5;
  c.half_length = 1;
  return c;
}

static void walls_move_as_said(void **state) {
  (void)state;
  pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
  for (int k = 0; k < 3; ++k) p.domain_max[k] = 10;
  p.wall_velocity[PBF_WALL_Y_MIN] = 0.5;
  p.wall_amplitude[PBF_WALL_X_MAX] = 2;
  p.wall_frequency[PBF_WALL_X_MAX] = PBF_PI;
  p.wall_phase[PBF_WALL_X_MAX] = PBF_PI / 2;
  pbf_walls w = pbf_walls_at(&p, 2.0);
  assert_at(w.lower, 0, 1, 0);
  assert_at(w.upper, 12, 10, 10);
  assert_at(pbf_clamp(&w, point(-3, 0.2, 4)), 0, 1, 4);
  assert_at(pbf_clamp(&w, point(13, 11, 11)), 12, 10, 10);
  assert_at(pbf_clamp(&w, point(NAN, 5, 5)), 12, 5, 5);
}

static void plane(void **state) {
  (void)state;
  pbf_collider c = collider(PBF_COLLIDER_PLANE);
  c.axis[0] = c.axis[1] = 3; /* any length */
  c.position[0] = 1;
  pbf_solid s = pbf_solid_at(&c, 0);
  assert_at(pbf_collide(&s, point(0, 0, 1)), 0.5, 0.5, 1);
  assert_at(pbf_collide(&s, point(2, 2, 1)), 2, 2, 1);
  c.inverted = 1;
  s = pbf_solid_at(&c, 0);
  assert_at(pbf_collide(&s, point(0, 0, 1)), 0, 0, 1);
  assert_at(pbf_collide(&s, point(2, 1, 1)), 1, 0, 1);
}

static void sphere(void **state) {
  (void)state;
  pbf_collider c = collider(PBF_COLLIDER_SPHERE);
  c.position[0] = 1;
  c.position[1] = 1;
  pbf_solid s = pbf_solid_at(&c, 0);
  assert_at(pbf_collide(&s, point(1.25, 1, 0)), 1.5, 1, 0);
  assert_at(pbf_collide(&s, point(1, 2, 0)), 1, 2, 0);
  pbf_vec out = pbf_collide(&s, point(1, 1, 0)); /* from the very centre: out, somewhere */
  pbf_vec r = pbf_sub(out, point(1, 1, 0));
  assert_near(pbf_dot(r, r), 0.25, 1e-12);
  c.inverted = 1;
  s = pbf_solid_at(&c, 0);
  assert_at(pbf_collide(&s, point(1, 4, 0)), 1, 1.5, 0);
  assert_at(pbf_collide(&s, point(1.1, 1, 0)), 1.1, 1, 0);
}

static void capsule(void **state) {
  (void)state;
  pbf_collider c = collider(PBF_COLLIDER_CAPSULE); /* from (0,-1,0) to (0,1,0), radius 0.5 */
  pbf_solid s = pbf_solid_at(&c, 0);
  assert_at(pbf_collide(&s, point(0.2, 0.7, 0)), 0.5, 0.7, 0);
  assert_at(pbf_collide(&s, point(0, 1.2, 0)), 0, 1.5, 0);
  assert_at(pbf_collide(&s, point(0, 1.6, 0)), 0, 1.6, 0);
  pbf_vec out = pbf_collide(&s, point(0, 0.3, 0)); /* on the axis: out, across it */
  assert_near(out.c[1], 0.3, 1e-12);
  assert_near(pbf_dot(out, out), 0.25 + 0.09, 1e-12);
}

static void box(void **state) {
  (void)state;
  pbf_collider c = collider(PBF_COLLIDER_BOX); /* 2 × 4 (× 6) */
  pbf_solid s = pbf_solid_at(&c, 0);
  assert_at(pbf_collide(&s, point(0.9, 0.3, 1)), 1, 0.3, 1);
  assert_at(pbf_collide(&s, point(-0.5, -1.9, 1)), -0.5, -2, 1);
  assert_at(pbf_collide(&s, point(1.2, 0, 0)), 1.2, 0, 0);
  c.inverted = 1;
  s = pbf_solid_at(&c, 0);
  assert_at(pbf_collide(&s, point(4, 7, 1)), 1, 2, 1);
  assert_at(pbf_collide(&s, point(0, 0, 0)), 0, 0, 0);
}

/* Turned by 90 degrees about z, the long side lies along x. */
static void a_box_turns_and_travels(void **state) {
  (void)state;
  pbf_collider c = collider(PBF_COLLIDER_BOX);
  c.velocity[0] = 2;
  c.angular_velocity[2] = PBF_PI / 4;
  pbf_solid s = pbf_solid_at(&c, 2);
  assert_at(s.center, 4, 0, 0);
  assert_at(pbf_collide(&s, point(4, 0.8, 0)), 4, 1, 0);
  assert_at(pbf_collide(&s, point(5.9, 0.1, 0)), 6, 0.1, 0);
  pbf_collider now;
  pbf_motion_collider(&c, 2, &now);
  assert_near(now.orientation[2], sin(PBF_PI / 4), 1e-15);
  assert_near(now.orientation[3], cos(PBF_PI / 4), 1e-15);
}

static void the_domain_has_the_last_word(void **state) {
  (void)state;
  pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
  for (int k = 0; k < 3; ++k) p.domain_max[k] = 10;
  pbf_collider c = collider(PBF_COLLIDER_PLANE);
  c.position[1] = 20;
  pbf_solid s = pbf_solid_at(&c, 0);
  pbf_walls w = pbf_walls_at(&p, 0);
  assert_at(pbf_resolve(&w, 1, &s, point(5, 5, 5)), 5, 10, 5);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(walls_move_as_said),
      cmocka_unit_test(plane),
      cmocka_unit_test(sphere),
      cmocka_unit_test(capsule),
      cmocka_unit_test(box),
      cmocka_unit_test(a_box_turns_and_travels),
      cmocka_unit_test(the_domain_has_the_last_word),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
