/* The shear stress that pushes along pairs have, on lattices: none at rest, also next to walls; in
 * sheared ones what the energy of the lattice says. */
#include "support.h"

#include "physics/passes/shear_stress.h"

static const double d = 0.1;

static pbf_params params_of(double spacings) {
  pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
  p.spacing = d;
  p.smoothing_radius = spacings * d;
  p.wall_density = 1;
  return p;
}

/* Of a particle at `at` in a lattice of cells d wide, deformed by x -> stretch x + slope y, y ->
 * y / stretch; its neighbours are from column `first_x` and row `first_y` on. */
static pbf_fabric fabric_in(const pbf_constants *c, double stretch, double slope, int first_x,
                            int first_y) {
  const fabric_pass<int> pass = {c, 0};
  auto sums = pass.begin<pbf_real>();
  const int n = (int)ceil(1.5 * (double)c->h / d), nz = PBF_DIM == 3 ? n : 0;
  for (int i = first_x > -n ? first_x : -n; i <= n; ++i)
    for (int j = first_y > -n ? first_y : -n; j <= n; ++j)
      for (int k = -nz; k <= nz; ++k) {
        const double x[3] = {d * (stretch * i + slope * j), d * j / stretch, d * k};
        neighbor_of<pbf_real> other = {};
        if (i == 0 && j == 0 && k == 0) continue;
        for (int a = 0; a < PBF_DIM; ++a) other.x_ij.c[a] = -x[a];
        other.r2 = pbf_dot(vec_of(other.x_ij), vec_of(other.x_ij));
        if (other.r2 < c->h2) pass.pair(&sums, {}, other);
      }
  pass.end(&sums);
  return fabric_of(sums);
}

static double size_of(pbf_deviator a) {
  double sum = 0;
  for (int k = 0; k < PBF_DEVIATOR_DIM; ++k) sum += a.c[k] * a.c[k];
  return sqrt(sum);
}

static void lattices_have_none(void **state) {
  (void)state;
  for (double spacings = 2; spacings < 3.6; spacings += 0.5) {
    const pbf_params p = params_of(spacings);
    const pbf_constants c = pbf_constants_of(&p);
    const fabric_pass<int> pass = {&c, 0};
    const double size = size_of(pass.finish(fabric_in(&c, 1, 0, -100, -100), 1));
    if (!(size < 1e-12)) fail_msg("at h = %g spacings the deviator is %g", spacings, size);
  }
}

/* Half a spacing off one wall, and in a corner of two, where what lies behind both counts twice. */
static void nor_have_they_at_walls(void **state) {
  (void)state;
  const pbf_params p = params_of(2);
  const pbf_constants c = pbf_constants_of(&p);
  const double bulk = fabric_in(&c, 1, 0, -100, -100).moments[0];
  for (int walls = 1; walls <= 2; ++walls) {
    pbf_obstacles o = {};
    const pbf_vec x = {{0}};
    o.domain = pbf_domain_at(&p, 0);
    for (int k = 0; k < PBF_DIM; ++k) {
      o.domain.lower.c[k] = k < walls ? -d / 2 : -100;
      o.domain.upper.c[k] = 100;
    }
    pbf_fabric fabric = fabric_in(&c, 1, 0, 0, walls == 2 ? 0 : -100);
    assert_true(fabric.moments[0] < 0.8 * bulk);
    add_walls(&c, o.domain, x, &fabric);
    assert_false(colliders_contribute(&c, o, x));
    for (int k = 0; k < 2; ++k) {
      const double part = fabric.moments[pbf_diagonal_entry(k)] / bulk;
      if (!(fabs(part - 1) < (walls == 2 ? 0.1 : 0.01)))
        fail_msg("%d walls, axis %d: %g of the bulk's", walls, k, part);
    }
  }
}

/* V W(r): what a pair contributes to a density. */
static double density_of(const pbf_constants *c, double stretch, double slope) {
  return fabric_in(c, stretch, slope, -100, -100).density;
}

/* A push by lambda = 1 of all does the work of raising densities: what moves a lattice by e y along
 * x changes its density by -M_xy e. */
static void sheared_ones_have_that_of_their_energy(void **state) {
  (void)state;
  const pbf_params p = params_of(2.5);
  const pbf_constants c = pbf_constants_of(&p);
  const fabric_pass<int> pass = {&c, 0};
  const double stretch = 1.03, slope = 0.05, e = 1e-5;
  const pbf_fabric f = fabric_in(&c, stretch, slope, -100, -100);
  const double along = (density_of(&c, stretch, slope + e / stretch) -
                        density_of(&c, stretch, slope - e / stretch)) /
                       (2 * e);
  double mean = 0;
  for (int k = 0; k < PBF_DIM; ++k) mean += f.moments[pbf_diagonal_entry(k)] / PBF_DIM;
  const pbf_deviator D = pass.finish(f, -2);
  assert_true(fabs(along) > 1e-4);
  if (!(fabs(D.c[1] + 2 * along / mean) < 1e-6 * fabs(D.c[1]) + 1e-8))
    fail_msg("xy: %g, by the energy %g", D.c[1], -2 * along / mean);
}

/* The push on one of a pair is that on the other, turned round; so is what they exchange. */
static void pairs_push_alike(void **state) {
  (void)state;
  const pbf_params p = params_of(2);
  const pbf_constants c = pbf_constants_of(&p);
  const shear_push_pass<int> push = {&c, 0};
  const shear_stress_pass<int> exchange = {&c, 0};
  const double first[5] = {0.3, -0.1, 0.2, 0.5, -0.4}, second[5] = {-0.2, 0.25, 0.1, -0.3, 0.6};
  lane_vector<pbf_real> sums[2], exchanged[2];
  for (int side = 0; side < 2; ++side) {
    const double *mine = side ? second : first, *other = side ? first : second;
    neighbor_of<pbf_real> j = {};
    lane_deviator<pbf_real> own;
    lane_vector<pbf_real> own_push;
    for (int k = 0; k < PBF_DEVIATOR_DIM; ++k) own.c[k] = mine[k];
    for (int k = 0; k < PBF_DIM; ++k) {
      own_push.c[k] = mine[k];
      j.vector.c[k] = other[k];
      j.x_ij.c[k] = (side ? -1 : 1) * (0.05 + 0.01 * k);
    }
    j.number = other[PBF_DEVIATOR_DIM - 2];
    j.second = other[PBF_DEVIATOR_DIM - 1];
    j.r2 = pbf_dot(vec_of(j.x_ij), vec_of(j.x_ij));
    auto pushes = push.begin<pbf_real>();
    push.pair(&pushes, {own}, j);
    sums[side] = pushes.push;
    auto exchanges = exchange.begin<pbf_real>();
    exchange.pair(&exchanges, {own_push}, j);
    exchanged[side] = exchanges.exchanged;
  }
  for (int k = 0; k < PBF_DIM; ++k) {
    assert_true(fabs(sums[0].c[k]) > 1e-3 && fabs(sums[0].c[k] + sums[1].c[k]) < 1e-12);
    assert_true(exchanged[0].c[k] != 0 && exchanged[0].c[k] == -exchanged[1].c[k]);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(lattices_have_none),
      cmocka_unit_test(nor_have_they_at_walls),
      cmocka_unit_test(sheared_ones_have_that_of_their_energy),
      cmocka_unit_test(pairs_push_alike),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
