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

/* A surface that pushes out at once. */
static pbf_surface surface_at(const pbf_collider *c, double elapsed, double time_step) {
  pbf_surface s = pbf_surface_at(c, elapsed, time_step);
  s.prediction_push = s.iteration_push = INFINITY;
  return s;
}

static pbf_domain wide_domain(void) {
  pbf_domain domain = {.lower = point(-1000, -1000, -1000), .upper = point(1000, 1000, 1000)};
  return domain;
}

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
  pbf_collider boxes[2] = {collider(PBF_COLLIDER_BOX), collider(PBF_COLLIDER_BOX)};
  boxes[0].position[1] = -2; /* a floor with its top at 0, … */
  boxes[1].position[1] = 2;  /* … and a wall on it, from x = 0 on */
  boxes[1].position[0] = 1;
  boxes[0].half_extents[0] = 5;
  pbf_place_obstacles(&p, 2, boxes, 0, 0, &o);
  for (double depth = -1e-6; depth < 2e-6; depth += 1e-7) {
    const pbf_vec x = pbf_resolve_collisions(o, 0, point(-0.5, 0, 0), point(1, -depth, 0));
    assert_true(x.c[0] < 0 && x.c[1] > 0);
  }
}

static pbf_constants wall_constants(uint32_t kernel) {
  pbf_params p = test_params(kernel);
  p.wall_density = 1;
  return pbf_constants_of(&p);
}

static void add_wall(const pbf_constants *c, double distance, pbf_vec normal, double *density,
                     pbf_vec *gradient) {
  double slope, value = pbf_wall_density(c, distance, &slope);
  pbf_boundary boundary = {0};
  pbf_accumulate_wall(c, value, slope, normal, &boundary);
  *density += boundary.overlapping + boundary.additive;
  *gradient = pbf_add_scaled(*gradient, 1, pbf_boundary_gradient(&boundary));
}

/* Half the kernel lies beyond a plane through its centre; of Wendland C2 in 3D, with u = 1 - t,
 * 3.5 u⁶ - 4.5 u⁷ + 1.5 u⁸ lies beyond the distance t h. */
static void half_space_density(void **state) {
  (void)state;
  for (uint32_t kernel = 0; kernel < 2; ++kernel)
    assert_near(pbf_half_space(kernel, PBF_DIM, 0), 0.5, 2e-4);
  for (double t = 0; PBF_DIM == 3 && t < 1.2; t += 0.05) {
    double u = fmax(1 - t, 0);
    assert_near(pbf_half_space(PBF_KERNEL_WENDLAND_C2, 3, t),
                pow(u, 6) * (3.5 - 4.5 * u + 1.5 * u * u), 3e-4);
  }
}

/* What a wall lends changes by, a length. */
static double wall_rate(const pbf_constants *c, double distance) {
  const double e = 1e-6;
  double slope;
  return (pbf_wall_density(c, distance + e, &slope) - pbf_wall_density(c, distance - e, &slope)) /
         (2 * e);
}

/* Of its push, over what its density alone would give. */
static double wall_gradient_scale(const pbf_constants *c, double distance) {
  double slope;
  pbf_wall_density(c, distance, &slope);
  return slope / wall_rate(c, distance);
}

/* The same up to the first layer, and from the second on. */
static void walls_push_in_proportion_to_the_derivative(void **state) {
  (void)state;
  for (uint32_t kernel = 0; kernel < 2; ++kernel) {
    pbf_constants c = wall_constants(kernel);
    const double d = test_params(kernel).spacing;
    double last = wall_gradient_scale(&c, 0.0625), far = wall_gradient_scale(&c, 1.5 * d);
    pbf_vec normal = {{0}};
    normal.c[1] = 1;
    assert_true(last > 0.9 && last < 2 && far > 0.999 * last && far < 4);
    for (double x = 0.011; x < c.h; x += 0.037) {
      pbf_vec gradient = {{0}};
      double here = 0, rate = wall_rate(&c, x);
      add_wall(&c, x, normal, &here, &gradient);
      if (x < 0.5 * d) assert_near(gradient.c[1], last * rate, 1e-4);
      if (x > 1.5 * d) assert_near(gradient.c[1], far * rate, 1e-4);
      assert_true(gradient.c[1] <= last * rate + 1e-4 && gradient.c[1] >= far * rate - 1e-4);
      assert_near(gradient.c[0], 0, 0);
    }
  }
}

/* Density that the image of a lattice behind a wall lends one of its first layer, which has moved
 * alone, and its own image with it. */
static double lent_by_image(const pbf_constants *c, double d, double distance) {
  int n = (int)ceil(c->h / d) + 1, nz = PBF_DIM == 3 ? n : 0;
  double sum = 0;
  for (int k = -nz; k <= nz; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = -n; i <= n; ++i) {
        int own = i == 0 && j == 0 && k == 0;
        double away = distance + (own ? distance : (j + 0.5) * d);
        sum += kernel_value<pbf_real>(0, c, away * away + d * d * (i * i + k * k));
      }
  return sum;
}

/* A lattice that fills the half-space from the wall on is at rest in its first layer, and nearly so
 * in the others. */
static void a_lattice_on_a_wall_is_at_rest(void **state) {
  (void)state;
  pbf_constants c = wall_constants(PBF_KERNEL_WENDLAND_C2);
  double d = test_params(PBF_KERNEL_WENDLAND_C2).spacing;
  int n = (int)ceil(c.h / d), nz = PBF_DIM == 3 ? n : 0;
  for (int layer = 0; layer < 3; ++layer) {
    double density = 0, lent = 0, force = 0;
    pbf_vec gradient = {{0}}, normal = {{0}};
    normal.c[1] = 1;
    for (int k = -nz; k <= nz; ++k)
      for (int j = -layer; j <= n; ++j)
        for (int i = -n; i <= n; ++i) {
          double value, slope;
          kernel_and_slope(0, &c, d * d * (i * i + j * j + k * k), &value, &slope);
          density += value;
          force += 2 * slope * -j * d;
        }
    add_wall(&c, (layer + 0.5) * d, normal, &lent, &gradient);
    assert_near(density + lent, 1, layer == 0 ? 1e-4 : 0.015);
    if (layer > 0) continue;
    /* As fast as its image's. */
    double e = 1e-6, up = lent_by_image(&c, d, 0.5 * d + e),
           down = lent_by_image(&c, d, 0.5 * d - e);
    assert_near(lent, lent_by_image(&c, d, 0.5 * d), 1e-4);
    assert_near(wall_rate(&c, 0.5 * d) / ((up - down) / (2 * e)), 1, 0.01);
    /* Under an even pressure: lambda_i + lambda_j from each, lambda_i from the wall, which leaves a
     * thirtieth, and does not get much steeper up to contact. */
    assert_true(force > 0);
    assert_near(gradient.c[1] / force, -0.965, 0.01);
    double at_contact = 0;
    add_wall(&c, 0, normal, &at_contact, &gradient);
    assert_true(at_contact > lent + 0.49 * d * force && at_contact < 1);
  }
}

/* What the upper walls lend is what the lower ones do, the other way round. */
static void opposite_walls_lend_alike(void **state) {
  (void)state;
  pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
  p.wall_density = 1;
  for (int a = 0; a < 3; ++a) p.domain_min[a] = 0, p.domain_max[a] = 8;
  pbf_constants c = pbf_constants_of(&p);
  pbf_domain domain = pbf_domain_at(&p, 0);
  for (int axis = 0; axis < PBF_DIM; ++axis) {
    pbf_vec low = point(4, 4, 4), high = low, low_gradient = {{0}}, high_gradient = {{0}};
    double low_density = 0, high_density = 0;
    low.c[axis] = 0.0625, high.c[axis] = 8 - 0.0625;
    pbf_add_boundary_at(&c, between(domain), low, &low_density, &low_gradient);
    pbf_add_boundary_at(&c, between(domain), high, &high_density, &high_gradient);
    assert_true(low_density > 0.05);
    assert_near(high_density, low_density, 1e-12);
    assert_near(high_gradient.c[axis], -low_gradient.c[axis], 1e-12);
  }
}

/* A lattice that fills a corner of the box is nearly at rest there: where two or three walls meet,
 * what lies beyond more than one of them counts once. */
static void a_lattice_in_a_corner_is_at_rest(void **state) {
  (void)state;
  pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
  p.wall_density = 1;
  for (int a = 0; a < 3; ++a) p.domain_min[a] = 0, p.domain_max[a] = 100;
  pbf_constants c = pbf_constants_of(&p);
  pbf_domain domain = pbf_domain_at(&p, 0);
  double d = p.spacing, density = 0, e = 1e-6;
  int n = (int)ceil(c.h / d), nz = PBF_DIM == 3 ? n : 0;
  for (int k = 0; k <= nz; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i)
        density += kernel_value<pbf_real>(0, &c, d * d * (i * i + j * j + k * k));
  pbf_vec x, gradient = {{0}}, unused = {{0}};
  for (int a = 0; a < PBF_DIM; ++a) x.c[a] = 0.5 * d;
  double lent = 0, up = 0, down = 0;
  pbf_add_boundary_at(&c, between(domain), x, &lent, &gradient);
  assert_near(density + lent, 1, 0.02);
  x.c[1] += e;
  pbf_add_boundary_at(&c, between(domain), x, &up, &unused);
  x.c[1] -= 2 * e;
  pbf_add_boundary_at(&c, between(domain), x, &down, &unused);
  assert_near(gradient.c[1], wall_gradient_scale(&c, x.c[0]) * (up - down) / (2 * e), 1e-4);
}

/* Fluid presses into edges and corners from all sides but theirs, and whom an impact has thrown
 * there must come out again: deep in a corner every wall pushes as hard as it does alone. */
static void walls_of_a_corner_push_each_for_itself(void **state) {
  (void)state;
  for (double support = 2; support <= 3; support += 0.5) {
    pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
    p.wall_density = 1;
    p.smoothing_radius = support * p.spacing;
    for (int a = 0; a < 3; ++a) p.domain_min[a] = 0, p.domain_max[a] = 100;
    pbf_constants c = pbf_constants_of(&p);
    pbf_domain domain = pbf_domain_at(&p, 0);
    domain.ghost_reach = 0; /* no mirrors */
    for (double depth = 0; depth < 0.25; depth += 0.1) {
      double slope, lent = 0, value = pbf_wall_density(&c, depth * p.spacing, &slope),
                    e = 1e-6 * p.spacing;
      pbf_vec x, gradient = {{0}}, unused = {{0}};
      for (int a = 0; a < PBF_DIM; ++a) x.c[a] = depth * p.spacing + e;
      pbf_add_boundary_at(&c, between(domain), x, &lent, &gradient);
      assert_true(lent > value);
      for (int a = 0; a < PBF_DIM; ++a) {
        double up = 0, down = 0;
        assert_true(gradient.c[a] < (support > 2 ? 0.25 : 0.7) * slope);
        pbf_vec above = x, below = x;
        above.c[a] += e, below.c[a] -= e;
        pbf_add_boundary_at(&c, between(domain), above, &up, &unused);
        pbf_add_boundary_at(&c, between(domain), below, &down, &unused);
        assert_near(gradient.c[a] / ((up - down) / (2 * e)),
                    wall_gradient_scale(&c, depth * p.spacing + e), 1e-3);
      }
    }
  }
}

/* What a layer of a lattice lacks of its fellows behind a wall: density, and the force that holds
 * it under an even pressure. */
static void lacks(const pbf_constants *c, double d, int layer, double *density, double *force) {
  int n = (int)ceil(c->h / d), nz = PBF_DIM == 3 ? n : 0;
  *density = *force = 0;
  for (int k = -nz; k <= nz; ++k)
    for (int j = layer; j <= n; ++j)
      for (int i = -n; i <= n; ++i) {
        double value, slope;
        kernel_and_slope(0, c, d * d * (i * i + j * j + k * k), &value, &slope);
        *density += value;
        *force += 2 * slope * j * d;
      }
}

static void a_lattice_of_any_support_is_at_rest_on_a_wall(void **state) {
  (void)state;
  for (double support = 2; support <= 4; support += 0.5) {
    pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
    p.wall_density = 1;
    p.smoothing_radius = support * p.spacing;
    pbf_constants c = pbf_constants_of(&p);
    for (int layer = 1; layer <= (support > 2 ? 2 : 1); ++layer) {
      double density, force, push, lent = pbf_wall_density(&c, (layer - 0.5) * p.spacing, &push);
      lacks(&c, p.spacing, layer, &density, &force);
      assert_near(lent, density, 1e-3);
      assert_near(push / force, 0.965, layer == 1 ? 0.01 : 0.05);
    }
  }
}

/* With a pressure that grows along it, the neighbours of a particle next to a wall do for the
 * images that they would have in it what PBF_TANGENTIAL_FRACTION says. */
static void walls_mirror_what_neighbors_do_along_them(void **state) {
  (void)state;
  pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
  p.wall_density = 1;
  p.smoothing_radius = 3 * p.spacing;
  for (int a = 0; a < 3; ++a) p.domain_min[a] = 0, p.domain_max[a] = 100;
  const pbf_constants c = pbf_constants_of(&p);
  pbf_domain domain = pbf_domain_at(&p, 0);
  domain.ghost_reach = 0; /* no mirrors */
  const double d = p.spacing;
  const int n = (int)ceil(c.h / d), nz = PBF_DIM == 3 ? n : 0;
  double inside = 0, beyond = 0;
  pbf_vec x, sum = {{0}};
  for (int k = -nz; k <= nz; ++k)
    for (int j = -n; j <= n; ++j)
      for (int i = -n; i <= n; ++i) {
        double value, slope;
        kernel_and_slope(0, &c, d * d * (i * i + j * j + k * k), &value, &slope);
        *(j < 0 ? &beyond : &inside) += slope * i * i;
      }
  for (int a = 0; a < PBF_DIM; ++a) x.c[a] = a == 1 ? 0.5 * d : 50;
  sum.c[0] = inside;
  sum.c[1] = 1;
  const pbf_boundary floor = pbf_boundary_at(&c, between(domain), x);
  const pbf_vec beside = pbf_boundary_correction(sum, 0, &floor);
  assert_near(beside.c[0] / inside - 1, PBF_TANGENTIAL_FRACTION * beyond / inside, 0.01);
  assert_near(beside.c[1], 1, 1e-9);
  /* Closer, a lone sheet would gain energy by more. */
  x.c[1] = 0.1 * d;
  const pbf_boundary closer = pbf_boundary_at(&c, between(domain), x);
  assert_near(pbf_boundary_correction(sum, 0, &closer).c[0] / beside.c[0], 1, 1e-4);
  /* Inside nothing, and a plane laid on the floor does nothing more. */
  x.c[1] = 50;
  const pbf_boundary nothing = pbf_boundary_at(&c, between(domain), x);
  assert_near(pbf_boundary_correction(sum, 0, &nothing).c[0], inside, 0);
  x.c[1] = 0.5 * d;
  pbf_collider plane = collider(PBF_COLLIDER_PLANE);
  plane.axis[0] = plane.axis[2] = 0;
  plane.axis[1] = 1;
  const pbf_surface surface = surface_at(&plane, 0, 0);
  const pbf_boundary twice = pbf_boundary_at(&c, between(domain, 1, &surface), x);
  assert_near(pbf_boundary_correction(sum, 0, &twice).c[0], beside.c[0], 1e-6);
  /* Slots between many colliders may lend more than all. */
  const pbf_vec up = point(0, 1, 0);
  for (double resting = 0.8; resting < 2; resting += 0.2)
    assert_near(pbf_boundary_correction(sum, 0, resting, up).c[0] / inside,
                1 + 3 * PBF_TANGENTIAL_FRACTION, 1e-9);
}

/* Planes at these distances from a point, whose normals turn away from +y by these angles. */
static double boundary_of_planes(const pbf_constants *c, int count, const double *distances,
                                 const double *angles, pbf_vec x, pbf_vec *gradient) {
  pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
  for (int a = 0; a < 3; ++a) p.domain_min[a] = -100, p.domain_max[a] = 100;
  const pbf_domain domain = pbf_domain_at(&p, 0);
  pbf_surface surfaces[3];
  double lent = 0;
  for (int k = 0; k < count; ++k) {
    pbf_collider plane = collider(PBF_COLLIDER_PLANE);
    plane.axis[0] = sin(angles[k]);
    plane.axis[1] = cos(angles[k]);
    for (int a = 0; a < 2; ++a) plane.position[a] = -distances[k] * plane.axis[a];
    surfaces[k] = surface_at(&plane, 0, 0);
  }
  *gradient = (pbf_vec){{0}};
  pbf_add_boundary_at(c, between(domain, count, surfaces), x, &lent, gradient);
  return lent;
}

/* What a box contributes within itself does not change with the depth, and so pushes nobody. */
static void the_inside_of_a_box_does_not_push(void **state) {
  (void)state;
  pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
  p.wall_density = 1;
  for (int a = 0; a < 3; ++a) p.domain_min[a] = -100, p.domain_max[a] = 100;
  const pbf_constants c = pbf_constants_of(&p);
  const pbf_domain domain = pbf_domain_at(&p, 0);
  pbf_collider box = collider(PBF_COLLIDER_BOX);
  const pbf_surface surface = surface_at(&box, 0, 0);
  double before = 0;
  for (double depth = c.wall_offset + 0.01; depth < 0.5; depth += 0.1) {
    double density = 0;
    pbf_vec gradient = {{0}};
    pbf_add_boundary_at(&c, between(domain, 1, &surface), point(1 - depth, 0, 0), &density,
                        &gradient);
    if (before > 0) assert_near(density, before, 1e-12);
    assert_near(pbf_dot(gradient, gradient), 0, 0);
    assert_true(density > 0.05);
    before = density;
  }
}

/* Half-spaces that face the same way are one, and the nearer counts: a plane laid on a floor, tiles
 * side by side. Those that face each other have nothing in common; at right angles it is the
 * product.
 */
static void planes_lend_by_how_they_face(void **state) {
  (void)state;
  const double right = 1.5707963267948966;
  pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
  p.wall_density = 1;
  pbf_constants c = pbf_constants_of(&p);
  const double d = p.spacing, near = 0.5 * d, far = 0.6 * d;
  const pbf_vec here = {{0}};
  double near_slope, far_slope;
  const double a = pbf_wall_density(&c, near, &near_slope),
               b = pbf_wall_density(&c, far, &far_slope);
  pbf_vec gradient;
  assert_true(a > 0.05 && b > 0.05 && a > b);
  const double distances[2][3] = {{near, near, near}, {near, far, near}};
  for (int k = 0; k < 2; ++k) {
    const double ways[] = {0, 0, 0};
    assert_near(boundary_of_planes(&c, 3, distances[k], ways, here, &gradient), a, 1e-12);
    assert_near(gradient.c[1], near_slope, 1e-10);
  }
  const double facing[] = {0, 2 * right}, crossed[] = {0, right};
  assert_near(boundary_of_planes(&c, 2, distances[1], facing, here, &gradient), a + b, 1e-12);
  assert_near(gradient.c[1], near_slope - far_slope, 1e-10);
  assert_near(boundary_of_planes(&c, 2, distances[1], crossed, here, &gradient), a + b - a * b,
              1e-12);
  assert_near(gradient.c[0], far_slope * (1 - a), 1e-10);
  assert_near(gradient.c[1], near_slope * (1 - b), 1e-10);
}

/* What two planes lend falls as they turn to face the same way, and pushes as it changes. */
static void planes_lend_less_the_more_they_agree(void **state) {
  (void)state;
  pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
  p.wall_density = 1;
  pbf_constants c = pbf_constants_of(&p);
  const double distances[] = {0.4 * p.spacing, 0.5 * p.spacing}, e = 1e-6 * p.spacing;
  double before = 1;
  for (double angle = 3.1; angle > 0; angle -= 0.2) {
    const double angles[] = {0, angle};
    pbf_vec x = {{0}}, gradient, unused;
    const double lent = boundary_of_planes(&c, 2, distances, angles, x, &gradient);
    assert_true(lent < before);
    before = lent;
    for (int k = 0; k < 2; ++k) {
      pbf_vec above = x, below = x;
      above.c[k] += e, below.c[k] -= e;
      const double rise = boundary_of_planes(&c, 2, distances, angles, above, &unused) -
                          boundary_of_planes(&c, 2, distances, angles, below, &unused);
      assert_near(gradient.c[k], wall_gradient_scale(&c, distances[0]) * rise / (2 * e),
                  1e-3 * fabs(gradient.c[k]) + 1e-4);
    }
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
      cmocka_unit_test(walls_of_a_corner_push_each_for_itself),
      cmocka_unit_test(a_lattice_of_any_support_is_at_rest_on_a_wall),
      cmocka_unit_test(walls_mirror_what_neighbors_do_along_them),
      cmocka_unit_test(half_space_density),
      cmocka_unit_test(the_inside_of_a_box_does_not_push),
      cmocka_unit_test(planes_lend_by_how_they_face),
      cmocka_unit_test(planes_lend_less_the_more_they_agree),
      cmocka_unit_test(walls_push_in_proportion_to_the_derivative),
      cmocka_unit_test(a_lattice_on_a_wall_is_at_rest),
      cmocka_unit_test(opposite_walls_lend_alike),
      cmocka_unit_test(a_lattice_in_a_corner_is_at_rest),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
