/* What the pressure of a pressure grid does to solids, against the integral of that pressure over
 * their surfaces, where it is known: water at rest. */
#include "solids.h"

#include "physics/grid_loads.h"

enum { WALLS = PBF_WALLS };

static const double spacing = 0.05, width = 16 * 0.05, high = 24 * 0.05, gravity = 9.81;

/* Of every solid, over the reference density and a time of one; `along` of walls. */
typedef struct all_loads {
  double force[WALLS + 1][PBF_DIM], along[PBF_DIM];
} all_loads;

static pbf_pressure_grid grid_between(const pbf_params *params, const pbf_domain *domain) {
  return pbf_pressure_grid_between(params, domain, 0, 1 << 20);
}

/* Water up to `high`, with no pressure above. */
static double pressure_of_water(pbf_vec x, double slope[]) {
  for (int k = 0; k < PBF_DIM; ++k) slope[k] = 0;
  if (x.c[1] > high) return 0;
  slope[1] = -gravity;
  return gravity * (high - x.c[1]);
}

/* In a tank twice as high. */
static all_loads loads_of(int count, const pbf_surface *surfaces) {
  const pbf_domain domain = {.lower = point(0, 0, 0), .upper = point(width, 2 * high, width)};
  pbf_params params = test_params(0);
  params.spacing = spacing;
  params.smoothing_radius = 2 * spacing;
  params.pressure_grid = 2;
  for (int k = 0; k < PBF_DIM; ++k) params.domain_max[k] = domain.upper.c[k];
  const pbf_pressure_grid c = grid_between(&params, &domain);
  const test_obstacles o = between(domain, count, surfaces);
  pbf_load_scales s = {};
  s.spacing = spacing;
  s.mass = 1;
  s.time_step = 1;
  all_loads all = {{{0}}, {0}};
  int points = 1;
  for (int k = 0; k < PBF_DIM; ++k) points *= grid_load_points(&c);
  for (uint32_t cell = 0; cell < c.nodes; ++cell) {
    int i[PBF_DIM], inside = 1;
    pbf_pressure_grid_place(&c, cell, i);
    for (int k = 0; k < PBF_DIM; ++k) inside = inside && i[k] > 0 && i[k] <= c.n[k];
    for (int point = 0; inside && point < points; ++point)
      share_grid_pressure_around(
          &s, &c, o, all_surfaces(), grid_load_point(&c, i, point), pressure_of_water,
          [&](const pbf_load_plane &plane, pbf_vec, const load_share &share) {
            for (int k = 0; k < PBF_DIM; ++k) {
              all.force[plane.solid][k] -= share.change[k];
              all.along[k] -= share.along[k];
            }
          });
  }
  return all;
}

static double floor_area(void) { return PBF_DIM == 3 ? width * width : width; }

/* What edges of the floor take from it is told beside: it is what walls have along themselves. */
static void a_floor_bears_the_water(void **state) {
  (void)state;
  const all_loads all = loads_of(0, NULL);
  const double weight = gravity * high * floor_area();
  assert_near(-all.force[2][1] - all.along[1], weight, (PBF_DIM == 3 ? 0.02 : 0.002) * weight);
  const double side = 0.5 * gravity * high * high * (PBF_DIM == 3 ? width : 1);
  assert_near(all.force[1][0], side, 0.03 * side);
  assert_near(all.force[0][0], -side, 0.03 * side);
}

/* Wherever it is between the points: those of 3D, a spacing apart, see a round surface within some
 * hundredths of the pressure on it, and right on average. */
static void a_ball_is_lifted_by_its_volume(void **state) {
  (void)state;
  const double radius = 5 * spacing, pi = acos(-1);
  const double lift = gravity * (PBF_DIM == 3 ? 4 * pi / 3 * pow(radius, 3) : pi * radius * radius);
  uint32_t random = 1;
  double sum = 0;
  enum { BALLS = 12 };
  for (int n = 0; n < BALLS; ++n) {
    pbf_collider ball = collider(PBF_COLLIDER_SPHERE);
    ball.radius = radius;
    for (int k = 0; k < PBF_DIM; ++k)
      ball.position[k] =
          (k == 1 ? 0.5 * high : 0.5 * width) + spacing * (next_random(&random) - 0.5);
    const pbf_surface surface = surface_at(&ball, 0, 1);
    const all_loads all = loads_of(1, &surface);
    assert_near(all.force[WALLS][1], lift, (PBF_DIM == 3 ? 0.08 : 0.025) * lift);
    assert_near(all.force[WALLS][0], 0, (PBF_DIM == 3 ? 0.08 : 0.025) * lift);
    sum += all.force[WALLS][1];
  }
  assert_near(sum / BALLS, lift, (PBF_DIM == 3 ? 0.02 : 0.01) * lift);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_floor_bears_the_water),
                                     cmocka_unit_test(a_ball_is_lifted_by_its_volume)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
