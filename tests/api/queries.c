/* Questions to the fluid, against closed forms of lattices, and sums by hand. */
#include <pbf/query.h>

#include "support.h"

static const double d = 0.05; /* the spacing */

enum { SIDE = 14, LAYERS = 12, MOST = SIDE * SIDE * LAYERS };

/* ---- A pool: a lattice whose lowest layer is half a spacing above the floor, y = 0 -------------
 */

/* v = flow + slope x, by components. */
static const double flow[3] = {0.3, -0.2, 0.5};
static const double slope[3][3] = {{1, 0.5, -0.3}, {-0.7, 0.2, 0.9}, {0.4, -1.1, -0.6}};
static const double still[3][3] = {{0}};

static double linear(uint32_t k, const double *x, uint32_t dimension, const double s[3][3]) {
  double v = flow[k];
  for (uint32_t l = 0; l < dimension; ++l) v += s[k][l] * x[l];
  return v;
}

typedef struct pool {
  pbf_solver *solver;
  uint32_t dimension, precision, count;
} pool;

static pool pool_of(uint32_t dimension, uint32_t precision, const double s[3][3], uint32_t order) {
  const uint32_t across = dimension == 3 ? SIDE * SIDE : SIDE, count = across * LAYERS;
  const pbf_desc desc = test_desc(dimension, precision, MOST + 8);
  pbf_params params = test_params();
  params.domain_max[0] = params.domain_max[2] = SIDE * d;
  params.domain_max[1] = 1000;
  pool p = {test_create(&desc, &params), dimension, precision, count};
  double *x = calloc((size_t)count * dimension, sizeof *x),
         *v = calloc((size_t)count * dimension, sizeof *v);
  assert_true(x && v);
  for (uint32_t row = 0; row < count; ++row) {
    const uint32_t i = (uint32_t)((uint64_t)row * order % count); /* of another order of adding */
    const uint32_t at[3] = {i % SIDE, i / across, i / SIDE % SIDE};
    const double place[3] = {d * (at[0] + 0.5), d * (at[1] + 0.5), d * (at[2] + 0.5)};
    for (uint32_t k = 0; k < dimension; ++k) {
      test_put(x, (uint64_t)row * dimension + k, precision, place[k]);
      test_put(v, (uint64_t)row * dimension + k, precision, linear(k, place, dimension, s));
    }
  }
  assert_ok(pbf_add_particles(p.solver, count, x, v, NULL));
  free(x);
  free(v);
  return p;
}

static const double level = LAYERS * d;

static double random_in(uint32_t *state, double lower, double upper) {
  *state = *state * 1664525u + 1013904223u;
  return lower + (upper - lower) * (*state >> 8) / (1 << 24);
}

/* ---- Points ---------------------------------------------------------------------------------- */

enum { POINTS = 200 };

/* From the floor to a spacing above the surface: fields go on as they are, density is 1 inside. */
static void check_points(uint32_t dimension, uint32_t precision) {
  const pool p = pool_of(dimension, precision, slope, 1);
  double x[POINTS * 3], density[POINTS], v[POINTS * 3];
  uint8_t wet[POINTS];
  uint32_t seed = 7;
  for (uint32_t i = 0; i < POINTS * dimension; ++i)
    x[i] =
        i % dimension == 1 ? random_in(&seed, 0, level + 0.5 * d) : random_in(&seed, 0, SIDE * d);
  const pbf_samples samples = {.struct_size = sizeof samples,
                               .count = POINTS,
                               .points = x,
                               .densities = density,
                               .velocities = v,
                               .wet = wet};
  assert_ok(pbf_sample(p.solver, &samples));
  for (uint32_t i = 0; i < POINTS; ++i) {
    double inside = INFINITY; /* how far from where the lattice ends */
    for (uint32_t k = 0; k < dimension; ++k) {
      const double end = k == 1 ? level : SIDE * d, at = x[i * dimension + k];
      inside = fmin(inside, fmin(at, end - at));
      const double right = linear(k, x + i * dimension, dimension, slope);
      if (!(fabs(v[i * dimension + k] - right) < (precision == PBF_FLOAT64 ? 1e-9 : 1e-4)))
        fail_msg("velocity %u[%u] is %.9g, not %.9g", i, k, v[i * dimension + k], right);
    }
    if (inside >= 3 * d && !(fabs(density[i] - 1) < 0.01))
      fail_msg("density %u is %.9g, not 1", i, density[i]);
    assert_int_equal(wet[i], density[i] >= 0.5);
  }
  pbf_destroy(p.solver);
}

static void linear_fields_and_density(void **state) {
  (void)state;
  test_for_each_kind(check_points);
}

/* Wendland's C2 of 2D and 3D as its paper has it, summed over two particles and one. */
static void check_sparse(uint32_t dimension, uint32_t precision) {
  const pbf_desc desc = test_desc(dimension, precision, 8);
  pbf_params params = test_params();
  params.domain_max[0] = 8000;
  pbf_solver *s = test_create(&desc, &params);
  double raw[9] = {0}, density[4], v[12], raw_v[9] = {0};
  const double places[3][3] = {{0.5, 0.5, 0.5}, {0.5625, 0.5, 0.5}, {4096, 0.5, 0.5}};
  for (uint32_t i = 0; i < 3 * dimension; ++i) {
    test_put(raw, i, precision, places[i / dimension][i % dimension]);
    test_put(raw_v, i, precision, i / dimension + 1);
  }
  assert_ok(pbf_add_particles(s, 3, raw, raw_v, NULL));
  const double points[4][3] = {
      {0.53125, 0.5, 0.5}, {4096, 0.53125, 0.5}, {0.7, 0.7, 0.5}, {3000, 0.5, 0.5}};
  double x[12];
  for (uint32_t i = 0; i < 4 * dimension; ++i) x[i] = points[i / dimension][i % dimension];
  assert_ok(pbf_sample(s, &(pbf_samples){.struct_size = sizeof(pbf_samples),
                                         .count = 4,
                                         .points = x,
                                         .densities = density,
                                         .velocities = v}));
  const double pi = acos(-1.0), r = 3 * d, q = 0.03125 / r;
  const double norm = dimension == 3 ? 21 / (2 * pi * r * r * r) : 7 / (pi * r * r);
  const double w = pow(d, dimension) * norm * pow(1 - q, 4) * (1 + 4 * q);
  assert_true(fabs(density[0] - 2 * w) < 1e-9 && fabs(density[1] - w) < 1e-9);
  assert_true(density[2] == 0 && density[3] == 0);
  assert_true(fabs(v[0] - 1.5) < 1e-9 && fabs(v[dimension] - 3) < 1e-9);
  assert_true(v[2 * dimension] == 0 && v[3 * dimension] == 0);
  pbf_destroy(s);
}

static void few_and_far(void **state) {
  (void)state;
  test_for_each_kind(check_sparse);
}

/* The same numbers as at the same points given one by one. */
static void check_grid(uint32_t dimension, uint32_t precision) {
  enum { N0 = 5, N1 = 6, N2 = 4 };
  const pool p = pool_of(dimension, precision, slope, 1);
  const pbf_sample_grid grid = {
      sizeof grid, {N0, N1, dimension == 3 ? N2 : 77}, {0.1, 0.2, 0.15}, {0.1, 0.075, 0.05}};
  const uint32_t depth = dimension == 3 ? N2 : 1, count = N0 * N1 * depth;
  double x[N0 * N1 * N2 * 3], density[2][N0 * N1 * N2], v[2][N0 * N1 * N2 * 3];
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t at[3] = {i / depth / N1, i / depth % N1, i % depth};
    for (uint32_t k = 0; k < dimension; ++k)
      x[i * dimension + k] = grid.origin[k] + at[k] * grid.step[k];
  }
  pbf_samples samples = {.struct_size = sizeof samples,
                         .count = count,
                         .points = x,
                         .densities = density[0],
                         .velocities = v[0]};
  assert_ok(pbf_sample(p.solver, &samples));
  samples.points = NULL;
  samples.densities = density[1];
  samples.velocities = v[1];
  assert_ok(pbf_sample_on_grid(p.solver, &grid, &samples));
  assert_memory_equal(density[0], density[1], count * sizeof **density);
  assert_memory_equal(v[0], v[1], count * dimension * sizeof **v);
  pbf_destroy(p.solver);
}

static void grids(void **state) {
  (void)state;
  test_for_each_kind(check_grid);
}

/* ---- Rays and levels ------------------------------------------------------------------------- */

enum { RAYS = 50 };

static void check_rays(uint32_t dimension, uint32_t precision) {
  const pool p = pool_of(dimension, precision, still, 1);
  double from[RAYS * 3] = {0}, to[RAYS * 3] = {0}, distance[RAYS], normal[RAYS * 3];
  uint32_t seed = 3;
  for (uint32_t i = 0; i < RAYS; ++i) { /* the middle's surface, from above and below, aslant */
    const double side = i % 2 ? -1 : 1;
    for (uint32_t k = 0; k < dimension; ++k) {
      from[i * dimension + k] = k == 1 ? level + side * 4 * d : random_in(&seed, 6 * d, 8 * d);
      to[i * dimension + k] = k == 1 ? -side * 2.5 : random_in(&seed, -1, 1);
    }
  }
  assert_ok(pbf_cast_rays(p.solver, RAYS, from, to, INFINITY, distance, normal));
  for (uint32_t i = 0; i < RAYS; ++i) {
    double length = 0;
    for (uint32_t k = 0; k < dimension; ++k) length += pow(to[i * dimension + k], 2);
    const double y = from[i * dimension + 1] + distance[i] * to[i * dimension + 1] / sqrt(length);
    if (!(fabs(y - level) < 0.25 * d)) fail_msg("ray %u meets %.9g, not %.9g", i, y, level);
    if (!(normal[i * dimension + 1] > cos(0.05)))
      fail_msg("normal %u has the y %.9g", i, normal[i * dimension + 1]);
  }
  assert_ok(pbf_cast_rays(p.solver, RAYS, from, to, 2 * d, distance, NULL)); /* too short */
  for (uint32_t i = 0; i < RAYS; ++i) assert_true(isinf(distance[i]));
  for (uint32_t i = 0; i < RAYS * dimension; ++i) to[i] = i % dimension == 1;
  assert_ok(pbf_cast_rays(p.solver, 1, from, to, INFINITY, distance, normal)); /* away */
  assert_true(isinf(distance[0]) && normal[1] == 0);
  pbf_destroy(p.solver);
}

static void rays_at_a_flat_pool(void **state) {
  (void)state;
  test_for_each_kind(check_rays);
}

/* Two blocks so far apart that cells are not counted between them: a ray from beside one meets the
 * other's face, or passes both. */
static void check_far_apart(uint32_t dimension, uint32_t precision) {
  enum { ALONG = 6 };
  if (precision == PBF_FLOAT32) return; /* such domains are refused */
  const double far = 2e8, middle = 0.5 * ALONG * d;
  const pbf_desc desc = test_desc(dimension, precision, 2 * ALONG * ALONG * ALONG);
  pbf_params params = test_params();
  for (uint32_t k = 0; k < 3; ++k) params.domain_min[k] = -1e9, params.domain_max[k] = 1e9;
  pbf_solver *s = test_create(&desc, &params);
  double x[2 * ALONG * ALONG * ALONG * 3], from[2 * 3], to[2 * 3] = {0}, distance[2];
  const uint32_t count = dimension == 3 ? ALONG * ALONG * ALONG : ALONG * ALONG;
  for (uint32_t i = 0; i < 2 * count; ++i) {
    const uint32_t at[3] = {i % ALONG, i / ALONG % ALONG, i % count / (ALONG * ALONG)};
    for (uint32_t k = 0; k < dimension; ++k)
      x[i * dimension + k] = (i < count ? 0 : far) + d * (at[k] + 0.5);
  }
  assert_ok(pbf_add_particles(s, 2 * count, x, NULL, NULL));
  for (uint32_t k = 0; k < dimension; ++k) {
    from[k] = k == 0 ? far : middle;
    from[dimension + k] = k == 0 ? far - 1 : far + middle;
  }
  to[0] = to[dimension] = -1;
  assert_ok(pbf_cast_rays(s, 2, from, to, INFINITY, distance, NULL));
  const double face = far - distance[0];
  if (!(fabs(face - ALONG * d) < 0.25 * d)) fail_msg("the face is at %.9g", face);
  assert_true(isinf(distance[1]));
  pbf_destroy(s);
}

static void rays_past_nothing(void **state) {
  (void)state;
  test_for_each_kind(check_far_apart);
}

/* High above, the surface is met through cells without particles, however many. */
static void check_levels(uint32_t dimension, uint32_t precision) {
  pool p = pool_of(dimension, precision, still, 1);
  double x[3 * 3] = {0}, levels[3], lone[3] = {0};
  for (uint32_t i = 0; i < 3 * dimension; ++i) x[i] = i == dimension + 1 ? 900 : 7.25 * d;
  x[2 * dimension] = SIDE * d + 1; /* beside the pool */
  const double place[3] = {7.25 * d, 990, 7.25 * d};
  for (uint32_t k = 0; k < dimension; ++k) test_put(lone, k, precision, place[k]);
  assert_ok(pbf_add_particles(p.solver, 1, lone, NULL, NULL)); /* a drop, which is no surface */
  assert_ok(pbf_get_levels(p.solver, 3, x, levels));
  assert_true(fabs(levels[0] - level) < 0.25 * d && levels[1] == levels[0]);
  assert_true(isnan(levels[2]));
  pbf_params params = {.struct_size = sizeof params};
  assert_ok(pbf_get_params(p.solver, &params));
  memset(params.gravity, 0, sizeof params.gravity);
  params.gravity[0] = 9.81; /* what was a wall is the surface now, its level against x */
  assert_ok(pbf_set_params(p.solver, &params));
  for (uint32_t k = 0; k < dimension; ++k) x[k] = 6 * d;
  assert_ok(pbf_get_levels(p.solver, 1, x, levels));
  assert_true(fabs(levels[0]) < 0.25 * d);
  params.gravity[0] = 0;
  assert_ok(pbf_set_params(p.solver, &params));
  assert_fails(pbf_get_levels(p.solver, 1, x, levels), PBF_ERROR_STATE, "gravity is 0");
  pbf_destroy(p.solver);
}

static void levels_of_a_pool(void **state) {
  (void)state;
  test_for_each_kind(check_levels);
}

/* ---- Volumes --------------------------------------------------------------------------------- */

static pbf_volume volume_of(uint32_t shape) {
  pbf_volume volume;
  assert_ok(pbf_volume_init(&volume, sizeof volume, shape));
  volume.position[0] = volume.position[2] = 0.5 * SIDE * d;
  volume.position[1] = level;
  return volume;
}

static pbf_volume_flow measure(const pool *p, const pbf_volume *volume) {
  pbf_volume_flow found = {.struct_size = sizeof found};
  assert_ok(pbf_measure_volumes(p->solver, 1, volume, &found));
  return found;
}

static void assert_near(double found, double right, double most, const char *what) {
  if (!(fabs(found - right) <= most)) fail_msg("%s is %.9g, not %.9g", what, found, right);
}

/* Half sunk: half of it, with the centre of half a disc or ball, and the stream's velocity. */
static void check_sunk(uint32_t dimension, uint32_t precision) {
  const pool p = pool_of(dimension, precision, still, 1);
  const double pi = acos(-1.0), r = 3.3 * d, half = dimension == 3 ? 3 * r / 8 : 4 * r / (3 * pi);
  pbf_volume ball = volume_of(PBF_VOLUME_SPHERE), box = volume_of(PBF_VOLUME_BOX);
  ball.radius = r;
  pbf_volume_flow found = measure(&p, &ball);
  assert_near(found.fraction, 0.5, 0.01, "the fraction of a ball");
  assert_near(found.volume, dimension == 3 ? 4 * pi * r * r * r / 3 : pi * r * r, 1e-12, "volume");
  assert_near(found.centre[0], ball.position[0], 0.05 * d, "its centre's x");
  assert_near(found.centre[1], level - half, 0.05 * d, "its centre's y");
  for (uint32_t k = 0; k < dimension; ++k)
    assert_near(found.velocity[k], flow[k], 1e-6, "velocity");
  /* Turned by an eighth about z, a third of its height above the surface: known by triangles. */
  box.half_extents[0] = box.half_extents[1] = r / sqrt(2);
  box.half_extents[2] = 2 * d;
  box.orientation[2] = sin(pi / 8);
  box.orientation[3] = cos(pi / 8);
  box.position[1] = level - 0.5 * r; /* above is a triangle half as high as the upper half */
  assert_near(measure(&p, &box).fraction, 1 - 0.25 / 2, 0.01, "the fraction of a box");
  ball.position[1] = level + r + d;
  found = measure(&p, &ball);
  assert_near(found.fraction, 0, 0, "the fraction in air");
  assert_near(found.centre[1], ball.position[1], 0, "the centre of nothing");
  ball.position[1] = level / 2;
  assert_near(measure(&p, &ball).fraction, 1, 0, "the fraction under water");
  pbf_destroy(p.solver);
}

static void half_sunk(void **state) {
  (void)state;
  test_for_each_kind(check_sunk);
}

/* A capsule that lies half in the water, whichever way it is turned within the surface. */
static void check_capsule(uint32_t dimension, uint32_t precision) {
  const pool p = pool_of(dimension, precision, still, 1);
  pbf_volume capsule = volume_of(PBF_VOLUME_CAPSULE);
  capsule.radius = 1.5 * d;
  capsule.half_length = 3 * d;
  capsule.axis[0] = 2;
  capsule.axis[1] = 0;
  assert_near(measure(&p, &capsule).fraction, 0.5, 0.01, "the fraction of a capsule");
  capsule.axis[0] = 0;
  capsule.axis[1] = 2;
  capsule.orientation[2] = capsule.orientation[3] = sqrt(0.5); /* y to -x */
  assert_near(measure(&p, &capsule).fraction, 0.5, 0.01, "the fraction of a turned capsule");
  capsule.orientation[2] = 0;
  capsule.orientation[3] = 1; /* upright, its lower end 4.5 spacings deep */
  capsule.position[1] += 1.5 * d;
  const double pi = acos(-1.0), r = 1.5 * d, l = 6 * d; /* the lower half-ball and 1.5 of the rod */
  const double ball = dimension == 3 ? 4 * pi * r * r * r / 3 : pi * r * r;
  const double area = dimension == 3 ? pi * r * r : 2 * r;
  assert_near(measure(&p, &capsule).fraction, (ball / 2 + 1.5 * d * area) / (ball + l * area), 0.01,
              "the fraction of an upright capsule");
  pbf_destroy(p.solver);
}

static void capsules(void **state) {
  (void)state;
  test_for_each_kind(check_capsule);
}

/* Whether a place is inside, by the definition of each shape; orientations turn about z. */
static int is_inside(const pbf_volume *v, const double *x, uint32_t dimension) {
  const double angle = 2 * atan2(v->orientation[2], v->orientation[3]);
  const double way[3] = {x[0] - v->position[0], x[1] - v->position[1],
                         dimension == 3 ? x[2] - v->position[2] : 0};
  const double r[3] = {cos(angle) * way[0] + sin(angle) * way[1],
                       cos(angle) * way[1] - sin(angle) * way[0], way[2]};
  const double y = fmin(fmax(r[1], -v->half_length), v->half_length); /* on the segment */
  const double axial = v->shape == PBF_VOLUME_CAPSULE ? r[1] - y : r[1];
  if (v->shape != PBF_VOLUME_BOX)
    return r[0] * r[0] + axial * axial + r[2] * r[2] <= v->radius * v->radius;
  return fabs(r[0]) <= v->half_extents[0] && fabs(r[1]) <= v->half_extents[1] &&
         fabs(r[2]) <= v->half_extents[2];
}

static void check_found(uint32_t dimension, uint32_t precision) {
  const pool p = pool_of(dimension, precision, slope, 5);
  static double x[MOST * 3];
  static uint32_t ids[MOST + 8], right[MOST + 8];
  assert_ok(pbf_step(p.solver, 2));
  assert_ok(pbf_remove_particles(p.solver, 3, (const uint32_t[]){2, 50, 98}));
  assert_ok(pbf_get_positions(p.solver, 0, p.count - 3, x));
  for (uint32_t shape = PBF_VOLUME_BOX; shape <= PBF_VOLUME_CAPSULE; ++shape) {
    pbf_volume v = volume_of(shape);
    v.position[1] = 0.3;
    v.half_extents[0] = 0.21, v.half_extents[1] = 0.1, v.half_extents[2] = 0.12;
    v.radius = 0.13, v.half_length = 0.1;
    v.orientation[2] = sin(0.4), v.orientation[3] = cos(0.4);
    uint32_t found = 0, count = 77;
    assert_ok(pbf_get_ids(p.solver, 0, p.count - 3, ids));
    for (uint32_t row = 0; row < p.count - 3; ++row) {
      double at[3] = {0};
      for (uint32_t k = 0; k < dimension; ++k)
        at[k] = test_value(x, (uint64_t)row * dimension + k, precision);
      if (is_inside(&v, at, dimension)) right[found++] = ids[row];
    }
    assert_true(found > 10);
    memset(ids, 0xff, sizeof ids);
    assert_ok(pbf_find_in_volume(p.solver, &v, MOST, ids, &count));
    assert_int_equal(count, found);
    assert_memory_equal(ids, right, found * sizeof *ids);
    memset(ids, 0xff, sizeof ids);
    assert_ok(pbf_find_in_volume(p.solver, &v, 4, ids, &count));
    assert_int_equal(count, found);
    assert_memory_equal(ids, right, 4 * sizeof *ids);
    assert_int_equal(ids[4], UINT32_MAX);
  }
  pbf_destroy(p.solver);
}

static void found_in_volumes(void **state) {
  (void)state;
  test_for_each_kind(check_found);
}

/* ---- A tank that has settled ----------------------------------------------------------------- */

/* rho g depth below the surface, and the height that the volume has over the floor. */
static void check_settled(uint32_t dimension, uint32_t precision) {
  if (test_is_stub()) return; /* without a fluid */
  enum { DEPTHS = 5 };
  const pool p = pool_of(dimension, precision, still, 1);
  pbf_params params = {.struct_size = sizeof params};
  double x[DEPTHS * 3], pressure[DEPTHS], surface;
  assert_ok(pbf_get_params(p.solver, &params));
  params.time_step = 1.0 / 480;
  params.iterations = 8;
  params.viscosity = 0.02;
  params.shear_stress_correction =
      0; /* with it pressures themselves are short by 0.65 d of depth */
  assert_ok(pbf_set_params(p.solver, &params));
  assert_ok(pbf_step(p.solver, 960));
  for (uint32_t i = 0; i < DEPTHS * dimension; ++i)
    x[i] = i % dimension == 1 ? (3.5 + 1.5 * (i / dimension)) * d : (6 + 0.3 * (i / dimension)) * d;
  assert_ok(pbf_get_levels(p.solver, 1, x, &surface));
  assert_near(surface, level, 0.5 * d, "the level");
  assert_ok(pbf_sample(p.solver, &(pbf_samples){.struct_size = sizeof(pbf_samples),
                                                .count = DEPTHS,
                                                .points = x,
                                                .pressures = pressure}));
  for (uint32_t i = 0; i < DEPTHS; ++i)
    assert_near(pressure[i], 9.81 * (level - x[i * dimension + 1]),
                0.02 * 9.81 * (level - x[i * dimension + 1]), "pressure");
  pbf_destroy(p.solver);
}

static void a_settled_tank(void **state) {
  (void)state;
  test_for_long_kinds(check_settled);
}

/* ---- What is kept ---------------------------------------------------------------------------- */

typedef struct answers {
  double density[POINTS], velocity[POINTS * 3], distance[POINTS], level[POINTS];
  pbf_volume_flow flow;
} answers;

static answers ask(const pool *p) {
  answers a;
  double x[POINTS * 3], down[POINTS * 3];
  uint32_t seed = 11;
  pbf_volume box = volume_of(PBF_VOLUME_BOX);
  memset(&a, 0, sizeof a);
  for (uint32_t i = 0; i < POINTS * p->dimension; ++i) {
    x[i] = random_in(&seed, 0, 1.2 * SIDE * d);
    down[i] = random_in(&seed, -1, 1);
  }
  assert_ok(pbf_sample(p->solver, &(pbf_samples){.struct_size = sizeof(pbf_samples),
                                                 .count = POINTS,
                                                 .points = x,
                                                 .densities = a.density,
                                                 .velocities = a.velocity}));
  assert_ok(pbf_cast_rays(p->solver, POINTS, x, down, INFINITY, a.distance, NULL));
  assert_ok(pbf_get_levels(p->solver, POINTS, x, a.level));
  box.half_extents[0] = box.half_extents[1] = box.half_extents[2] = 3 * d;
  a.flow = measure(p, &box);
  return a;
}

static pool copy_of(const pool *p) {
  uint64_t size;
  void *state = test_save(p->solver, &size);
  pool copy = *p;
  copy.solver = test_solver(p->dimension, p->precision, MOST + 8);
  assert_ok(pbf_load(copy.solver, state, size));
  free(state);
  return copy;
}

/* As from a solver that is asked for the first time. */
static void check_fresh(const pool *p) {
  const pool copy = copy_of(p);
  const answers a = ask(p), b = ask(&copy);
  assert_memory_equal(&a, &b, sizeof a);
  pbf_destroy(copy.solver);
}

/* What is kept is of the particles as they are now, and the order of adding does not matter but to
 * rounding: ids decide. */
static void check_kept(uint32_t dimension, uint32_t precision) {
  const pool p = pool_of(dimension, precision, slope, 1);
  double raw[3] = {0};
  const uint64_t before = test_hash(p.solver);
  answers first = ask(&p), again = ask(&p);
  assert_memory_equal(&first, &again, sizeof first);
  assert_true(test_hash(p.solver) == before);
  assert_ok(pbf_step(p.solver, 3));
  again = ask(&p);
  assert_memory_not_equal(&first, &again, sizeof first);
  check_fresh(&p);
  for (uint32_t k = 0; k < dimension; ++k) test_put(raw, k, precision, 0.31);
  assert_ok(pbf_set_positions(p.solver, p.count / 2, 1, raw));
  check_fresh(&p);
  assert_ok(pbf_set_velocities(p.solver, p.count / 3, 1, raw));
  check_fresh(&p);
  assert_ok(pbf_remove_particles(p.solver, 3, (const uint32_t[]){5, 60, 97}));
  check_fresh(&p);
  assert_ok(pbf_add_particles(p.solver, 1, raw, NULL, NULL));
  check_fresh(&p);
  pbf_params params = {.struct_size = sizeof params};
  assert_ok(pbf_get_params(p.solver, &params));
  params.smoothing_radius *= 1.25;
  assert_ok(pbf_set_params(p.solver, &params));
  check_fresh(&p);
  assert_ok(pbf_end_queries(p.solver));
  check_fresh(&p);
  pbf_destroy(p.solver);
}

static void answers_follow_changes(void **state) {
  (void)state;
  test_for_each_kind(check_kept);
}

/* All others after the first one, as long as there are not more particles. */
static void nothing_is_allocated(void **state) {
  (void)state;
  const pool p = pool_of(3, PBF_FLOAT32, slope, 1);
  double x[3] = {0.3, 0.3, 0.3}, v[3], surface;
  const pbf_samples samples = {
      .struct_size = sizeof samples, .count = 1, .points = x, .velocities = v};
  assert_ok(pbf_sample(p.solver, &samples));
  assert_ok(pbf_step(p.solver, 1));
  const uint64_t calls = test_count.calls, blocks = test_count.live_blocks;
  const pbf_volume ball = volume_of(PBF_VOLUME_SPHERE);
  for (int i = 0; i < 3; ++i) {
    measure(&p, &ball);
    assert_ok(pbf_sample(p.solver, &samples));
    assert_ok(pbf_get_levels(p.solver, 1, x, &surface));
  }
  if (strcmp(test_backend(), "cuda") != 0) assert_int_equal(test_count.calls, calls);
  assert_ok(pbf_end_queries(p.solver));
  assert_int_equal(test_count.live_blocks, blocks - 2);
  pbf_destroy(p.solver);
  assert_int_equal(test_count.live_blocks, 0);
}

static void no_particles(void **state) {
  (void)state;
  pbf_solver *s = test_solver(3, PBF_FLOAT32, 8);
  const pool p = {s, 3, PBF_FLOAT32, 0};
  const answers a = ask(&p);
  assert_true(a.density[0] == 0 && a.velocity[0] == 0 && isinf(a.distance[0]));
  assert_true(isnan(a.level[0]) && a.flow.fraction == 0);
  pbf_destroy(s);
}

/* ---- Refusals -------------------------------------------------------------------------------- */

static const pbf_status bad = PBF_ERROR_INVALID_ARGUMENT;

static void volumes_refused(void **state) {
  (void)state;
  const pool p = pool_of(2, PBF_FLOAT32, slope, 1);
  pbf_volume v = volume_of(PBF_VOLUME_BOX), two[2] = {v, v};
  pbf_volume_flow found = {.struct_size = sizeof found, .volume = 99};
  uint32_t count = 7;
  assert_fails(pbf_volume_init(&v, sizeof v, 3), bad, "shape is 3");
  assert_fails(pbf_volume_init(NULL, sizeof v, 0), bad, "volume is null");
  assert_fails(pbf_find_in_volume(p.solver, NULL, 0, NULL, &count), bad, "volume is null");
  assert_fails(pbf_find_in_volume(p.solver, &v, 1, NULL, &count), bad, "ids is null");
  assert_fails(pbf_find_in_volume(p.solver, &v, 0, NULL, NULL), bad, "count is null");
  v.half_extents[1] = 0;
  assert_fails(pbf_measure_volumes(p.solver, 1, &v, &found), bad, "half_extents[1] is 0");
  v = volume_of(PBF_VOLUME_CAPSULE);
  v.axis[1] = 0;
  assert_fails(pbf_measure_volumes(p.solver, 1, &v, &found), bad, "volumes[0].axis");
  v = volume_of(PBF_VOLUME_SPHERE);
  v.radius = NAN;
  assert_fails(pbf_measure_volumes(p.solver, 1, &v, &found), bad, "radius is NaN");
  v.radius = 1;
  v.orientation[0] = 1;
  v.orientation[3] = 0;
  assert_fails(pbf_measure_volumes(p.solver, 1, &v, &found), bad, "a turn about z");
  two[1].struct_size = sizeof v + 8;
  assert_fails(pbf_measure_volumes(p.solver, 2, two, &found), PBF_ERROR_STRUCT_SIZE, "volumes[1]");
  assert_fails(pbf_measure_volumes(p.solver, 1, two, NULL), bad, "flows is null");
  assert_true(found.volume == 99 && count == 7);
  pbf_destroy(p.solver);
}

static void points_refused(void **state) {
  (void)state;
  const pool p = pool_of(3, PBF_FLOAT32, slope, 1);
  double x[6] = {0.1, 0.1, 0.1, 0.2, NAN, 0.2}, to[6] = {1, 0, 0, 0, 0, 0}, out[6] = {99};
  pbf_samples samples = {.struct_size = sizeof samples, .count = 2, .points = x, .densities = out};
  pbf_sample_grid grid = {sizeof grid, {1, 2, 2}, {0}, {1, 1, 1}};
  assert_fails(pbf_sample(p.solver, &samples), bad, "samples.points[1][1] is NaN");
  samples.points = NULL;
  assert_fails(pbf_sample(p.solver, &samples), bad, "samples.points is null");
  assert_fails(pbf_sample_on_grid(p.solver, &grid, &samples), bad, "the grid has 4 points");
  samples.densities = NULL;
  assert_fails(pbf_sample(p.solver, &samples), bad, "at least one");
  assert_fails(pbf_sample(p.solver, NULL), bad, "samples is null");
  assert_fails(pbf_get_levels(p.solver, 2, x, out), bad, "points[1][1] is NaN");
  x[4] = 0.2;
  assert_fails(pbf_cast_rays(p.solver, 2, x, to, 1, out, NULL), bad,
               "directions[1] has the length 0");
  to[4] = 1;
  assert_fails(pbf_cast_rays(p.solver, 2, x, to, 0, out, NULL), bad, "length is 0");
  assert_fails(pbf_cast_rays(p.solver, 2, x, to, 1, NULL, NULL), bad, "distances is null");
  assert_fails(pbf_sample(NULL, &samples), bad, "null");
  assert_true(out[0] == 99);
  if (!test_is_stub()) {
    pbf_params params = {.struct_size = sizeof params};
    assert_ok(pbf_get_params(p.solver, &params));
    params.solver = PBF_SOLVER_JACOBI;
    params.max_depenetration_speed = 0;
    assert_ok(pbf_set_params(p.solver, &params));
    samples.points = x;
    samples.pressures = out;
    assert_fails(pbf_sample(p.solver, &samples), PBF_ERROR_UNSUPPORTED, "keeps no pressure");
  }
  pbf_destroy(p.solver);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(linear_fields_and_density),
      cmocka_unit_test(few_and_far),
      cmocka_unit_test(grids),
      cmocka_unit_test(rays_at_a_flat_pool),
      cmocka_unit_test(rays_past_nothing),
      cmocka_unit_test(levels_of_a_pool),
      cmocka_unit_test(half_sunk),
      cmocka_unit_test(capsules),
      cmocka_unit_test(found_in_volumes),
      cmocka_unit_test(a_settled_tank),
      cmocka_unit_test(answers_follow_changes),
      cmocka_unit_test(nothing_is_allocated),
      cmocka_unit_test(no_particles),
      cmocka_unit_test(volumes_refused),
      cmocka_unit_test(points_refused),
  };
  return TEST_RUN(tests);
}
