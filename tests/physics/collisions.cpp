/* Walls and colliders: where a point goes, and where the shapes are at a time. */
#include "solids.h"

/* A particle on its way from `from` to x past one surface. */
static pbf_vec slide_past(const pbf_surface &s, pbf_vec from, pbf_vec x) {
  return pbf_resolve_collisions(between(wide_domain(), 1, &s), 0, from, x);
}

/* One that starts there. */
static pbf_vec push_out(const pbf_surface &s, pbf_vec x) { return slide_past(s, x, x); }

static void walls_move_as_said(void **state) {
  (void)state;
  pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
  for (int k = 0; k < 3; ++k) p.domain_max[k] = 10;
  p.wall_velocity[PBF_WALL_Y_MIN] = 0.5;
  p.wall_amplitude[PBF_WALL_X_MAX] = 2;
  p.wall_frequency[PBF_WALL_X_MAX] = PBF_PI;
  p.wall_phase[PBF_WALL_X_MAX] = PBF_PI / 2;
  pbf_domain w = pbf_domain_at(&p, 2.0);
  assert_at(w.lower, 0, 1, 0);
  assert_at(w.upper, 12, 10, 10);
  assert_at(pbf_keep_in_domain(&w, point(-3, 0.2, 4)), 0, 1, 4);
  assert_at(pbf_keep_in_domain(&w, point(13, 11, 11)), 12, 10, 10);
  assert_at(pbf_keep_in_domain(&w, point(NAN, 5, 5)), 0, 5, 5); /* at either wall, but at one */
  p.solver = PBF_SOLVER_CHEBYSHEV;
  w = pbf_domain_at(&p, 2.0);
  assert_at(pbf_keep_in_domain(&w, point(NAN, 5, 5)), 12, 5, 5);
}

/* From far behind a corner, where the accelerated solve's walls keep apart what the paper's lay
 * into one point. */
static void what_lands_behind_a_corner_stays_apart(void **state) {
  (void)state;
  pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
  for (int k = 0; k < 3; ++k) p.domain_max[k] = 10;
  p.solver = PBF_SOLVER_CHEBYSHEV;
  pbf_domain w = pbf_domain_at(&p, 0);
  const double far = 0.49 * 0.5 * p.smoothing_radius; /* and a hundredth of the depth */
  assert_at(pbf_keep_in_domain(&w, point(-3, 12, -1)), far + 0.03, 10 - far - 0.02, far + 0.01);
  assert_at(pbf_keep_in_domain(&w, point(-2, 11, -4)), far + 0.02, 10 - far - 0.01, far + 0.04);
  assert_at(pbf_keep_in_domain(&w, point(-0.1, 10.2, -0.3)), 0.05, 9.9, 0.15);
  assert_at(pbf_keep_in_domain(&w, point(0, 5, 10)), 0, 5, 10);
  assert_at(pbf_keep_in_domain(&w, point(-1e9, 1e9, 5)), 0, 0,
            5); /* held, however far it was thrown */
  p.solver = PBF_SOLVER_JACOBI;
  w = pbf_domain_at(&p, 0);
  assert_at(pbf_keep_in_domain(&w, point(-3, 12, -1)), 0, 10, 0);
}

static void plane(void **state) {
  (void)state;
  pbf_collider c = collider(PBF_COLLIDER_PLANE);
  c.axis[0] = c.axis[1] = 3; /* any length */
  c.position[0] = 1;
  pbf_surface s = surface_at(&c, 0, 0);
  assert_at(push_out(s, point(0, 0, 1)), 0.5, 0.5, 1);
  assert_at(push_out(s, point(2, 2, 1)), 2, 2, 1);
  c.inverted = 1;
  s = surface_at(&c, 0, 0);
  assert_at(push_out(s, point(0, 0, 1)), 0, 0, 1);
  assert_at(push_out(s, point(2, 1, 1)), 1, 0, 1);
}

static void sphere(void **state) {
  (void)state;
  pbf_collider c = collider(PBF_COLLIDER_SPHERE);
  c.position[0] = 1;
  c.position[1] = 1;
  pbf_surface s = surface_at(&c, 0, 0);
  assert_at(push_out(s, point(1.25, 1, 0)), 1.5, 1, 0);
  assert_at(push_out(s, point(1, 2, 0)), 1, 2, 0);
  pbf_vec out = push_out(s, point(1, 1, 0)); /* from the very centre: out, somewhere */
  pbf_vec r = pbf_sub(out, point(1, 1, 0));
  assert_near(pbf_dot(r, r), 0.25, 1e-12);
  c.inverted = 1;
  s = surface_at(&c, 0, 0);
  assert_at(push_out(s, point(1, 4, 0)), 1, 1.5, 0);
  assert_at(push_out(s, point(1.1, 1, 0)), 1.1, 1, 0);
}

static void capsule(void **state) {
  (void)state;
  pbf_collider c = collider(PBF_COLLIDER_CAPSULE); /* from (0,-1,0) to (0,1,0), radius 0.5 */
  pbf_surface s = surface_at(&c, 0, 0);
  assert_at(push_out(s, point(0.2, 0.7, 0)), 0.5, 0.7, 0);
  assert_at(push_out(s, point(0, 1.2, 0)), 0, 1.5, 0);
  assert_at(push_out(s, point(0, 1.6, 0)), 0, 1.6, 0);
  pbf_vec out = push_out(s, point(0, 0.3, 0)); /* on the axis: out, across it */
  assert_near(out.c[1], 0.3, 1e-12);
  assert_near(pbf_dot(out, out), 0.25 + 0.09, 1e-12);
}

static void box(void **state) {
  (void)state;
  pbf_collider c = collider(PBF_COLLIDER_BOX); /* 2 × 4 (× 6) */
  pbf_surface s = surface_at(&c, 0, 0);
  assert_at(push_out(s, point(0.9, 0.3, 1)), 1, 0.3, 1);
  assert_at(push_out(s, point(-0.5, -1.9, 1)), -0.5, -2, 1);
  assert_at(push_out(s, point(1.2, 0, 0)), 1.2, 0, 0);
  c.inverted = 1;
  s = surface_at(&c, 0, 0);
  assert_at(push_out(s, point(4, 7, 1)), 1, 2, 1);
  assert_at(push_out(s, point(0, 0, 0)), 0, 0, 0);
}

/* Turned by 90 degrees about z, the long side lies along x. */
static void a_box_turns_and_travels(void **state) {
  (void)state;
  pbf_collider c = collider(PBF_COLLIDER_BOX);
  c.velocity[0] = 2;
  c.angular_velocity[2] = PBF_PI / 4;
  pbf_surface s = surface_at(&c, 2, 0);
  assert_at(s.center, 4, 0, 0);
  assert_at(push_out(s, point(4, 0.8, 0)), 4, 1, 0);
  assert_at(push_out(s, point(5.9, 0.1, 0)), 6, 0.1, 0);
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
  pbf_surface s = surface_at(&c, 0, 0);
  pbf_domain w = pbf_domain_at(&p, 0);
  /* A plane that leaves no room in it lets particles stay, … */
  assert_at(pbf_resolve_collisions(between(w, 1, &s), 0, point(5, 5, 5), point(5, 5, 5)), 5, 5, 5);
  /* … and one that comes over them takes them to its end. */
  s.start_center.c[1] = 1;
  assert_at(pbf_resolve_collisions(between(w, 1, &s), 1, point(5, 5, 5), point(5, 5, 5)), 5, 10, 5);
}

/* A plate 0.01 thin, and ways that end far behind it, on the way out, and beside it. */
static void nothing_goes_through_a_thin_plate(void **state) {
  (void)state;
  pbf_collider c = collider(PBF_COLLIDER_BOX);
  c.half_extents[0] = 0.005;
  c.half_extents[1] = c.half_extents[2] = 2;
  pbf_surface s = surface_at(&c, 0, 0);
  assert_at(slide_past(s, point(-3, 0.5, 0), point(40, 0.7, 0)), -0.005, 0.7, 0);
  assert_at(slide_past(s, point(3, -1, 0), point(-1, -1.5, 0)), 0.005, -1.5, 0);
  assert_at(slide_past(s, point(-0.005, 0, 0), point(0.001, 0.1, 0)), -0.005, 0.1, 0);
  assert_at(slide_past(s, point(-0.005, 0, 0), point(-0.5, 0.1, 0)), -0.5, 0.1, 0);
  assert_at(slide_past(s, point(-3, 2.5, 0), point(40, 2.5, 0)), 40, 2.5, 0);
  assert_at(slide_past(s, point(-0.004, 0, 0), point(0.004, 0, 0)), -0.005, 0, 0);
  c = collider(PBF_COLLIDER_SPHERE);
  c.radius = 0.01;
  s = surface_at(&c, 0, 0);
  assert_at(slide_past(s, point(-3, 0, 0), point(5, 0, 0)), -0.01, 0, 0);
  assert_at(slide_past(s, point(-3, 1, 0), point(5, 1, 0)), 5, 1, 0);
}

/* From its very surface a way leads through the plate, whole: an end that is outside again is no
 * leave to go. */
static void nothing_goes_through_from_the_surface(void **state) {
  (void)state;
  pbf_collider c = collider(PBF_COLLIDER_BOX);
  c.half_extents[0] = 0.005;
  c.half_extents[1] = c.half_extents[2] = 2;
  pbf_surface s = surface_at(&c, 0, 0);
  assert_at(slide_past(s, point(-0.005, 0, 0), point(0.5, 0.1, 0)), -0.005, 0.1, 0);
  assert_at(slide_past(s, point(0.005, 1, 0), point(-40, 0.1, 0)), 0.005, 0.1, 0);
  assert_at(slide_past(s, point(-0.004, 0, 0), point(9, 1, 0)), -0.005, 1, 0);
  assert_at(slide_past(s, point(-0.005, 1, 0), point(-0.005, 1.5, 0)), -0.005, 1.5, 0);
}

/* At so small an angle that stepping on by the distance does not reach it. */
static void a_grazing_way_stays_on_its_side(void **state) {
  (void)state;
  pbf_collider c = collider(PBF_COLLIDER_BOX);
  c.half_extents[0] = 0.005;
  c.half_extents[1] = c.half_extents[2] = 2;
  pbf_surface s = surface_at(&c, 0, 0);
  for (int k = 1; k <= 20; ++k) {
    pbf_vec out = slide_past(s, point(-0.1, -1.9, 0), point(-0.1 + 0.011 * k, 1.9, 0));
    assert_true(out.c[0] <= -0.005 + 1e-9);
  }
}

/* Whether the way from a to b leads through the inside of a box at the origin, by the slabs. */
static int leads_through(pbf_vec a, pbf_vec b, const double half[3]) {
  double enters = 0, leaves = 1;
  for (int k = 0; k < PBF_DIM; ++k) {
    double inner = half[k] * (1 - 1e-6), way = b.c[k] - a.c[k];
    double t = (-inner - a.c[k]) / way, u = (inner - a.c[k]) / way;
    if (way == 0 && fabs(a.c[k]) >= inner) return 0;
    if (way == 0) continue;
    enters = fmax(enters, fmin(t, u)), leaves = fmin(leaves, fmax(t, u));
  }
  return enters < leaves;
}

/* A point as a box sees it. */
static pbf_vec in_frame(const pbf_surface &s, pbf_vec x) {
  pbf_vec local;
  for (int row = 0; row < PBF_DIM; ++row)
    local.c[row] = pbf_dot(pbf_sub(x, s.center), s.frame[row]);
  return local;
}

static void no_way_leads_through_a_box(void **state) {
  (void)state;
  uint32_t draws = 1;
  pbf_collider c = collider(PBF_COLLIDER_BOX);
  c.half_extents[0] = 0.005;
  c.half_extents[1] = 0.5, c.half_extents[2] = 0.8;
  pbf_surface s = surface_at(&c, 0, 0);
  for (int k = 0; k < 20000; ++k) {
    pbf_vec at = {{0}}, to = {{0}};
    double far = k % 2 ? 1 : 0.02;
    for (int i = 0; i < PBF_DIM; ++i) {
      at.c[i] = (2 * next_random(&draws) - 1) * (i == 0 ? far : 1);
      to.c[i] = (2 * next_random(&draws) - 1) * (i == 0 ? far : 1);
    }
    at = push_out(s, at);
    for (int step = 0; step < 3; ++step) {
      pbf_vec out = slide_past(s, at, to);
      assert_false(leads_through(at, out, c.half_extents));
      at = out;
    }
  }
}

/* The plate travels and turns over particles that rest: they end before it. */
static void a_moving_plate_takes_along(void **state) {
  (void)state;
  pbf_collider c = collider(PBF_COLLIDER_BOX);
  c.half_extents[0] = 0.005;
  c.half_extents[1] = c.half_extents[2] = 2;
  c.velocity[0] = 10;
  pbf_surface s = surface_at(&c, 1, 1);
  assert_at(pbf_surface_carries(&s, point(3, 1, 0)), 13, 1, 0);
  assert_at(slide_past(s, pbf_surface_carries(&s, point(3, 1, 0)), point(3, 1, 0)), 10.005, 1, 0);
  c.velocity[0] = 0;
  c.angular_velocity[2] = 1;
  s = surface_at(&c, 0.5, 0.5);
  pbf_vec rest = point(-0.2, 1, 0);
  pbf_vec out = slide_past(s, pbf_surface_carries(&s, rest), rest), n = s.frame[0];
  assert_near(pbf_dot(pbf_sub(out, s.center), n), -0.005, 1e-5);
}

/* A thin plate through the origin, turned about z. */
static pbf_surface plate_at(double angle) {
  pbf_collider c = collider(PBF_COLLIDER_BOX);
  c.half_extents[0] = c.half_extents[2] = 2;
  c.half_extents[1] = 0.05;
  c.orientation[2] = sin(angle / 2);
  c.orientation[3] = cos(angle / 2);
  return surface_at(&c, 0, 0);
}

static double depth_in(const pbf_surface *surfaces, int count, pbf_vec x) {
  double deepest = 0;
  for (int k = 0; k < count; ++k) {
    pbf_vec normal;
    deepest = fmax(deepest, -pbf_surface_distance(&surfaces[k], x, &normal));
  }
  return deepest;
}

/* Which of the four rooms between two plates a point is in. */
static int room_of(const pbf_surface *plates, pbf_vec x) {
  return (pbf_dot(plates[0].frame[1], x) > 0) + 2 * (pbf_dot(plates[1].frame[1], x) > 0);
}

/* Two plates that cross: a particle that runs into the edge between them stays in its room, and out
 * of both, however acute the edge. */
static void check_crossing(double angle) {
  pbf_surface plates[2] = {plate_at(0), plate_at(angle)};
  pbf_domain domain = {.lower = point(-10, -10, -10), .upper = point(10, 10, 10)};
  uint32_t seed = 7;
  for (int tried = 0; tried < 4000; ++tried) {
    pbf_vec from, x;
    for (int k = 0; k < PBF_DIM; ++k) {
      from.c[k] = 1.2 * next_random(&seed) - 0.6;
      x.c[k] = 1.2 * next_random(&seed) - 0.6;
    }
    if (depth_in(plates, 2, from) > 0) continue;
    x = pbf_resolve_collisions(between(domain, 2, plates), 0, from, x);
    double depth = depth_in(plates, 2, x);
    if (!(depth <= 1e-9)) fail_msg("%g deep between plates at %g", depth, angle);
    assert_int_equal(room_of(plates, x), room_of(plates, from));
  }
}

static void crossing_plates(void **state) {
  (void)state;
  for (int part = 2; part <= 36; part *= 3) check_crossing(PBF_PI / part);
  check_crossing(2 * PBF_PI / 3);
  check_crossing(PBF_PI / 3);
}

/* Thin plates of any number and position, through each other and side by side: whoever is in none
 * of them gets into none, and through none. */
static void a_heap_of_plates(void **state) {
  (void)state;
  enum { PLATES = 6 };
  const double half[3] = {0.5, 0.005, 0.5};
  uint32_t seed = 5;
  pbf_domain domain = {.lower = point(-1, -1, -1), .upper = point(1, 1, 1)};
  for (int tried = 0; tried < 20000; ++tried) {
    pbf_surface plates[PLATES];
    for (int k = 0; k < PLATES; ++k) {
      pbf_collider c = collider(PBF_COLLIDER_BOX);
      const double angle = PBF_PI * next_random(&seed);
      memcpy(c.half_extents, half, sizeof half);
      for (int a = 0; a < PBF_DIM; ++a) c.position[a] = 0.6 * next_random(&seed) - 0.3;
      c.orientation[2] = sin(angle / 2);
      c.orientation[3] = cos(angle / 2);
      plates[k] = surface_at(&c, 0, 0);
      plates[k].rounding = 1e-9;
    }
    pbf_vec from, x;
    for (int k = 0; k < PBF_DIM; ++k) {
      from.c[k] = next_random(&seed) - 0.5;
      x.c[k] = next_random(&seed) - 0.5;
    }
    if (depth_in(plates, PLATES, from) > 0) continue;
    x = pbf_resolve_collisions(between(domain, PLATES, plates), 0, from, x);
    assert_true(depth_in(plates, PLATES, x) <= 1e-8);
    for (int k = 0; k < PLATES; ++k)
      assert_false(leads_through(in_frame(plates[k], from), in_frame(plates[k], x), half));
  }
}

/* A way along the faces of two boxes that touch, from one box's on to the other's. */
static void no_way_leads_between_flush_boxes(void **state) {
  (void)state;
  pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
  for (int k = 0; k < 3; ++k) p.domain_min[k] = -10, p.domain_max[k] = 10;
  pbf_obstacles o;
  pbf_surface surfaces[2];
  pbf_collider boxes[2] = {collider(PBF_COLLIDER_BOX), collider(PBF_COLLIDER_BOX)};
  boxes[0].position[1] = -2; /* a floor with its top at 0, … */
  boxes[1].position[1] = 2;  /* … and a wall on it, from x = 0 on */
  boxes[1].position[0] = 1;
  boxes[0].half_extents[0] = 5;
  pbf_place_obstacles(&p, 2, boxes, 0, 0, 0, surfaces, &o);
  for (double depth = -1e-6; depth < 2e-6; depth += 1e-7) {
    const pbf_vec x = pbf_resolve_collisions(o, 0, point(-0.5, 0, 0), point(1, -depth, 0));
    assert_true(x.c[0] < 0 && x.c[1] > 0);
  }
}
int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(walls_move_as_said),
      cmocka_unit_test(what_lands_behind_a_corner_stays_apart),
      cmocka_unit_test(plane),
      cmocka_unit_test(sphere),
      cmocka_unit_test(capsule),
      cmocka_unit_test(box),
      cmocka_unit_test(a_box_turns_and_travels),
      cmocka_unit_test(the_domain_has_the_last_word),
      cmocka_unit_test(nothing_goes_through_a_thin_plate),
      cmocka_unit_test(nothing_goes_through_from_the_surface),
      cmocka_unit_test(a_grazing_way_stays_on_its_side),
      cmocka_unit_test(no_way_leads_through_a_box),
      cmocka_unit_test(a_moving_plate_takes_along),
      cmocka_unit_test(crossing_plates),
      cmocka_unit_test(a_heap_of_plates),
      cmocka_unit_test(no_way_leads_between_flush_boxes),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
