/* Walls as mirrors: a lattice between them goes on without end, as far as kernels can tell. */
#include "physics/ghosts.h"
#include "support.h"

static pbf_params wide_params(double support, double wide) {
  pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
  p.wall_density = 1;
  p.smoothing_radius = support * p.spacing;
  for (int k = 0; k < 3; ++k) p.domain_min[k] = 0, p.domain_max[k] = wide * p.spacing;
  return p;
}

static pbf_vec same(double a) {
  pbf_vec x;
  for (int k = 0; k < PBF_DIM; ++k) x.c[k] = a;
  return x;
}

static pbf_ghost_walls ghost_walls_at(const pbf_domain *domain, pbf_vec x) {
  return pbf_ghost_walls_near(domain, x, x);
}

static void wide_kernels_alone_have_mirrors(void **state) {
  (void)state;
  pbf_params p = wide_params(2.5, 100);
  assert_true(pbf_domain_at(&p, 0).ghost_reach == 0);
  p = wide_params(2.6, 100);
  assert_near(pbf_domain_at(&p, 0).ghost_reach, p.smoothing_radius, 1e-12);
  p.wall_density = 0;
  assert_true(pbf_domain_at(&p, 0).ghost_reach == 0);
  p = wide_params(3, 3.01);
  assert_true(pbf_domain_at(&p, 0).ghost_reach > 0);
  p = wide_params(3, 2.99); /* images of images are in reach */
  assert_true(pbf_domain_at(&p, 0).ghost_reach == 0);
}

static void as_many_images_as_walls_are_near(void **state) {
  (void)state;
  pbf_params p = wide_params(3, 100);
  const double d = p.spacing;
  const pbf_domain domain = pbf_domain_at(&p, 0);
  pbf_vec x = same(50 * d);
  assert_int_equal(ghost_walls_at(&domain, x).count, 0);
  x.c[1] = 97.5 * d;
  assert_int_equal(ghost_walls_at(&domain, x).count, 1);
  assert_int_equal(ghost_walls_at(&domain, x).walls[0], PBF_UPPER_WALL(1));
  x.c[0] = 0.5 * d;
  assert_int_equal(ghost_walls_at(&domain, x).count, 3);
  assert_int_equal(ghost_walls_at(&domain, same(0.5 * d)).count, PBF_DIM == 3 ? 7 : 3);
  /* The walls are near, their edge is not. */
  x.c[0] = 2.5 * d, x.c[1] = 97.5 * d;
  assert_int_equal(ghost_walls_at(&domain, x).count, 2);
  p = wide_params(3, 4); /* opposite walls are near, and edges; corners in 3D are not */
  const pbf_domain close = pbf_domain_at(&p, 0);
  assert_int_equal(ghost_walls_at(&close, same(2 * d)).count, PBF_DIM == 3 ? 18 : 8);
}

/* rho/rho0, and the gradient of the density, of the particle at x[i] of a lattice that fills the
 * corner between lower (or upper) walls. */
static double density_in_corner(const pbf_constants *c, const pbf_domain *domain, double d,
                                int upper, pbf_vec x, pbf_vec *gradient) {
  enum { FAR = 8 };
  const pbf_ghost_walls mirrors = ghost_walls_at(domain, x);
  double density = 0, twice[2][PBF_DIM];
  *gradient = same(0);
  for (int k = 0; k < PBF_DIM; ++k) {
    twice[0][k] = 2 * (x.c[k] - domain->lower.c[k]);
    twice[1][k] = 2 * (x.c[k] - domain->upper.c[k]);
  }
  for (int j = 0; j < (PBF_DIM == 3 ? FAR * FAR * FAR : FAR * FAR); ++j) {
    const int at[3] = {j % FAR, j / FAR % FAR, j / FAR / FAR};
    pbf_vec x_ij;
    double value, slope;
    for (int k = 0; k < PBF_DIM; ++k)
      x_ij.c[k] = x.c[k] - (upper ? domain->upper.c[k] - d * (at[k] + 0.5) : d * (at[k] + 0.5));
    for (int m = -1; m < mirrors.count; ++m) {
      auto ghost = lanes_of(x_ij);
      double r2 =
          m < 0 ? pbf_dot(x_ij, x_ij) : ghost_in(mirrors.walls[m], twice, lanes_of(x_ij), &ghost);
      kernel_and_slope(0, c, r2, &value, &slope);
      density += value;
      *gradient = pbf_add_scaled(*gradient, slope, vec_of(ghost));
    }
  }
  return density;
}

static void a_lattice_in_a_corner_knows_of_no_wall(void **state) {
  (void)state;
  for (double support = 3; support <= 4; support += 0.5)
    for (int upper = 0; upper < 2; ++upper)
      for (int layer = 0; layer < 3; ++layer) {
        pbf_params p = wide_params(support, 100);
        const double d = p.spacing;
        const pbf_domain domain = pbf_domain_at(&p, 0);
        const pbf_constants c = pbf_constants_of(&p);
        pbf_vec x = same(upper ? (99.5 - layer) * d : (layer + 0.5) * d), gradient;
        x.c[1] = upper ? 99.5 * d : 0.5 * d;
        assert_near(density_in_corner(&c, &domain, d, upper, x, &gradient), 1, 1e-9);
        for (int k = 0; k < PBF_DIM; ++k) assert_near(gradient.c[k] * d, 0, 1e-9);
        /* By the law of the distance they lend nothing beside. */
        pbf_real lent = 0;
        pbf_add_boundary_at(&c, between(domain), x, &lent, &gradient);
        assert_true(lent == 0);
      }
}

/* Own image and neighbours' alike, from wherever it is. */
static void images_push_inwards(void **state) {
  (void)state;
  const double d = 0.1;
  for (int upper = 0; upper < 2; ++upper)
    for (double behind = -0.5; behind < 0.6; behind += 0.25) {
      lane_vector<pbf_real> image;
      pbf_real twice[2][PBF_DIM] = {{2 * behind * d}, {-2 * behind * d}};
      pbf_real r2 =
          ghost_in(upper ? PBF_UPPER_WALL(0) : PBF_LOWER_WALL(0), twice, lanes_of(same(0)), &image);
      assert_near(r2, 4 * behind * behind * d * d, 1e-12);
      assert_true(upper ? image.c[0] <= 0 : image.c[0] >= 0);
      assert_near(image.c[1], 0, 1e-12);
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(wide_kernels_alone_have_mirrors),
      cmocka_unit_test(as_many_images_as_walls_are_near),
      cmocka_unit_test(a_lattice_in_a_corner_knows_of_no_wall),
      cmocka_unit_test(images_push_inwards),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
