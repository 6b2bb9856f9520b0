/* What the pressure of a pressure grid does to solids, against the integral of that pressure over
 * their surfaces, where it is known: water at rest. */
#include "solids.h"

#include "physics/grid_loads.h"
#include "physics/pressure_grid/particles.h"

enum { WALLS = PBF_WALLS };

static const double spacing = 0.05, width = 16 * 0.05, high = 24 * 0.05, gravity = 9.81;

/* Of every solid, over the reference density and a time of one. `open` is what a pressure of one
 * does to it, as an area. */
typedef struct all_loads {
  double force[WALLS + 1][PBF_DIM], open[WALLS + 1][PBF_DIM];
} all_loads;

static pbf_pressure_grid grid_between(const pbf_params *params, const pbf_domain *domain) {
  return pbf_pressure_grid_between(params, domain, 0, 1 << 20);
}

/* Lambda of water up to a level, which goes on above it, at the nodes of a grid. */
static double *lambda_of_water(const pbf_pressure_grid *c, double level) {
  double *lambda = static_cast<double *>(calloc(c->nodes, sizeof *lambda));
  assert_non_null(lambda);
  for (uint32_t node = 0; node < c->nodes; ++node) {
    int i[PBF_DIM];
    pbf_pressure_grid_place(c, node, i);
    lambda[node] = gravity * (c->lower[1] + (i[1] - 1) * c->width - level) / (c->width * c->width);
  }
  return lambda;
}

/* In a tank twice as high. */
static all_loads loads_of(double level, int count, const pbf_surface *surfaces) {
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
  const pbf_grid_load_cubes cubes = grid_load_cubes_of(&s, &c);
  all_loads all = {{{0}}, {{0}}};
  const pbf_pressure_grid_topology whole = {};
  double *lambda = lambda_of_water(&c, level);
  const auto pressure_of_water = [&](pbf_vec x, double slope[]) {
    double at[PBF_DIM];
    const uint32_t cell = pbf_pressure_grid_cell(&c, x, at);
    const double p =
        -pbf_pressure_grid_lambda_sloped(&c, &whole, lambda, cell, at, cubes.part, slope);
    for (int k = 0; k < PBF_DIM; ++k) slope[k] = -slope[k];
    return p;
  };
  for (uint32_t cell = 0; cell < c.nodes; ++cell) {
    int i[PBF_DIM], inside = 1;
    pbf_pressure_grid_place(&c, cell, i);
    for (int k = 0; k < PBF_DIM; ++k) inside = inside && i[k] > 0 && i[k] <= c.n[k];
    if (!inside) continue;
    each_grid_load_point(&c, cubes.points, i, [&](pbf_vec x) {
      share_grid_pressure_around(
          &s, cubes, o, all_surfaces(), x, pressure_of_water,
          [&](const pbf_load_plane &plane, pbf_vec, const load_share &share) {
            for (int k = 0; k < PBF_DIM; ++k) {
              all.force[plane.solid][k] -= share.change[k];
              all.open[plane.solid][k] -= share.open[k] / spacing;
            }
          });
    });
  }
  free(lambda);
  return all;
}

static double floor_area(void) { return PBF_DIM == 3 ? width * width : width; }

/* To its edges, and wherever the surface is between the points. */
static void a_floor_bears_the_water(void **state) {
  (void)state;
  for (int n = 0; n < 5; ++n) {
    const double level = high + 0.23 * n * spacing;
    const all_loads all = loads_of(level, 0, NULL);
    const double weight = gravity * level * floor_area();
    assert_near(-all.force[2][1], weight, 0.001 * weight);
    const double side = 0.5 * gravity * level * level * (PBF_DIM == 3 ? width : 1);
    assert_near(all.force[1][0], side, 0.01 * side);
    assert_near(all.force[0][0], -side, 0.01 * side);
    assert_near(-all.open[2][1], floor_area(), 0.01 * floor_area());
  }
}

/* A box three spacings deep in the water has the lift of what is below the surface, and one
 * pressure everywhere would lift it by its area: in 3D, by points a spacing apart, on average. */
static void a_box_that_floats_is_lifted(void **state) {
  (void)state;
  const double half = 4 * spacing, area = PBF_DIM == 3 ? 4 * half * half : 2 * half;
  const double lift = gravity * 3 * spacing * area, bar = PBF_DIM == 3 ? 0.12 : 0.01;
  double lifts = 0, opens = 0;
  enum { LEVELS = 10 };
  for (int n = 0; n < LEVELS; ++n) {
    const double level = high + n * spacing / LEVELS;
    pbf_collider box = collider(PBF_COLLIDER_BOX);
    for (int k = 0; k < PBF_DIM; ++k) {
      box.half_extents[k] = half;
      box.position[k] = k == 1 ? level + half - 3 * spacing : 0.5 * width;
    }
    const pbf_surface surface = surface_at(&box, 0, 1);
    const all_loads all = loads_of(level, 1, &surface);
    assert_near(all.force[WALLS][1], lift, bar * lift);
    assert_near(all.open[WALLS][1], area, bar * area);
    lifts += all.force[WALLS][1] / LEVELS;
    opens += all.open[WALLS][1] / LEVELS;
  }
  print_message("a box: %.4f of its lift, %.4f of its area\n", lifts / lift, opens / area);
  assert_near(lifts, lift, 0.01 * lift);
  assert_near(opens, area, 0.01 * area);
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
    const all_loads all = loads_of(high, 1, &surface);
    assert_near(all.force[WALLS][1], lift, (PBF_DIM == 3 ? 0.08 : 0.025) * lift);
    assert_near(all.force[WALLS][0], 0, (PBF_DIM == 3 ? 0.08 : 0.025) * lift);
    assert_near(all.open[WALLS][1], 0, 0.08 * radius * (PBF_DIM == 3 ? radius : 1));
    sum += all.force[WALLS][1];
  }
  assert_near(sum / BALLS, lift, (PBF_DIM == 3 ? 0.02 : 0.01) * lift);
}

/* Water on both sides of a box presses as much on the one as on the other, however narrow the gap
 * to a wall is on one side: from five spacings to one, as far as the points of 3D are apart. */
static void a_box_beside_a_wall_is_not_pushed_aside(void **state) {
  (void)state;
  double farthest = 0;
  for (int n = 0; n < 32; ++n) {
    const double half = (3 + 0.125 * n) * spacing, off = 0.07 * (n % 5) * spacing;
    pbf_collider box = collider(PBF_COLLIDER_BOX);
    for (int k = 0; k < PBF_DIM; ++k) {
      box.half_extents[k] = half;
      box.position[k] = 0.5 * (k == 1 ? high : width) + (k == 0 ? off : 0);
    }
    const pbf_surface surface = surface_at(&box, 0, 1);
    const all_loads all = loads_of(high, 1, &surface);
    const double side = 0.5 * gravity * high * pow(2 * half, PBF_DIM - 1);
    farthest = fmax(farthest, fabs(all.force[WALLS][0]) / side);
    assert_near(all.force[WALLS][1], gravity * pow(2 * half, PBF_DIM),
                (PBF_DIM == 3 ? 0.06 : 0.01) * gravity * pow(2 * half, PBF_DIM));
  }
  print_message("pushed aside by up to %.4f of what presses on a side\n", farthest);
  assert_near(farthest, 0, PBF_DIM == 3 ? 0.12 : 0.015);
}

/* Of a box, at the nodes of a grid that goes on for three cells around it, as those of meshes do.
 * The values are the caller's to free. */
static pbf_shape box_of_distances(double half, double cell) {
  pbf_shape shape = {};
  const uint32_t nodes = (uint32_t)ceil(2 * half / cell) + 7;
  uint32_t count = 1;
  for (int k = 0; k < 3; ++k) {
    shape.nodes[k] = k < PBF_DIM ? nodes : 1;
    shape.origin[k] = -0.5 * cell * (nodes - 1);
    shape.lower[k] = -half, shape.upper[k] = half;
    count *= shape.nodes[k];
  }
  shape.cell = cell;
  shape.bound = sqrt(PBF_DIM) * half;
  shape.steepest = 1;
  float *values = static_cast<float *>(calloc(count, sizeof *values));
  assert_non_null(values);
  for (uint32_t n = 0; n < count; ++n) {
    const uint32_t at[3] = {n % nodes, n / nodes % nodes, n / nodes / nodes};
    double inside = -half, out2 = 0;
    for (int k = 0; k < PBF_DIM; ++k) {
      const double beyond = fabs(shape.origin[k] + cell * at[k]) - half;
      inside = fmax(inside, beyond);
      out2 += beyond > 0 ? beyond * beyond : 0;
    }
    values[n] = (float)(inside > 0 ? sqrt(out2) : inside);
  }
  shape.values = values;
  return shape;
}

/* Also where the pressure is looked at past the grid that its distances are on, a cell and a half
 * to three spacings wide around it. */
static void a_shape_is_lifted_by_its_volume(void **state) {
  (void)state;
  const double half = 4 * spacing, volume = pow(2 * half, PBF_DIM),
               bar = PBF_DIM == 3 ? 0.06 : 0.02;
  for (int n = 1; n <= 4; ++n) {
    pbf_shape distances = box_of_distances(half, 0.25 * n * spacing);
    pbf_collider box = collider(PBF_COLLIDER_SHAPE);
    box.geometry = &distances;
    box.scale = 1;
    for (int k = 0; k < PBF_DIM; ++k)
      box.position[k] = 0.5 * (k == 1 ? high : width) + 0.3 * spacing;
    const pbf_surface surface = surface_at(&box, 0, 1);
    const all_loads all = loads_of(high, 1, &surface);
    free(const_cast<float *>(distances.values));
    print_message("cells of %g spacings: %.4f of its lift\n", 0.25 * n,
                  all.force[WALLS][1] / (gravity * volume));
    assert_near(all.force[WALLS][1], gravity * volume, bar * gravity * volume);
    assert_near(all.force[WALLS][0], 0, bar * gravity * volume);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_floor_bears_the_water),
                                     cmocka_unit_test(a_box_that_floats_is_lifted),
                                     cmocka_unit_test(a_ball_is_lifted_by_its_volume),
                                     cmocka_unit_test(a_box_beside_a_wall_is_not_pushed_aside),
                                     cmocka_unit_test(a_shape_is_lifted_by_its_volume)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
