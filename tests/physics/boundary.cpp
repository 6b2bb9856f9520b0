/* What walls and colliders add to density and its gradient in place of the particles that are not
 * in them. */
#include "solids.h"

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

/* Fluid presses into edges and corners from all sides but theirs, and particles that an impact has
 * thrown there must come out again: deep in a corner every wall pushes as hard as it does alone. */
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

/* What a box contributes within itself does not change with the depth, and so pushes no particle.
 */
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
