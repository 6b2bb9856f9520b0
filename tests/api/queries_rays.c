/* Rays that meet a flat surface, and levels. */
#include "query_scene.h"

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

/* Levels below a particle that flew so high that a walk through each cell between would take
 * minutes for all of them: a test's time is over before it. */
static void check_far_above(uint32_t dimension, uint32_t precision) {
  enum { MANY = 8000 };
  const double height = 8000;
  static double x[MANY * 3], levels[MANY];
  const pool p = pool_of(dimension, precision, still, 1);
  float far32[3] = {(float)(6 * d), (float)(height - 1), (float)(6 * d)};
  double far64[3] = {6 * d, height - 1, 6 * d};
  pbf_params params = {.struct_size = sizeof params};
  uint32_t seed = 7;
  assert_ok(pbf_get_params(p.solver, &params));
  params.domain_max[1] = height;
  params.periodic = dimension == 2 ? PBF_PERIODIC_X : 0;
  assert_ok(pbf_set_params(p.solver, &params));
  const void *far = precision == PBF_FLOAT32 ? (const void *)far32 : far64;
  assert_ok(pbf_add_particles(p.solver, 1, far, NULL, NULL));
  for (uint32_t i = 0; i < MANY * dimension; ++i) x[i] = random_in(&seed, 6 * d, 8 * d);
  assert_ok(pbf_get_levels(p.solver, MANY, x, levels));
  for (uint32_t i = 0; i < MANY; ++i)
    if (!(fabs(levels[i] - level) < 0.25 * d)) fail_msg("level %u is %.9g", i, levels[i]);
  pbf_destroy(p.solver);
}

static void levels_below_what_flew_away(void **state) {
  (void)state;
  test_for_long_kinds(check_far_above);
}

/* The image of a block, behind a face, is what a way through empty cells leads to. */
static void levels_of_an_image(void **state) {
  (void)state;
  enum { BLOCK_SIDE = 4, BLOCK = BLOCK_SIDE * BLOCK_SIDE };
  const double width = 80 * d, bottom = 10 * d, top = bottom + BLOCK_SIDE * d;
  const double place[2] = {0, 0};
  double x[2 * (BLOCK + 1)] = {0, top + 180 * d}, at;
  const pbf_desc desc = test_desc(2, PBF_FLOAT64, BLOCK + 1);
  pbf_params params = test_params();
  if (!test_has_kind(2, PBF_FLOAT64)) test_skip("no 2D in float64");
  params.domain_max[0] = width;
  params.domain_max[1] = 1000;
  params.periodic = PBF_PERIODIC_X;
  for (int i = 0; i < BLOCK; ++i) {
    x[2 * i + 2] = width - (i % BLOCK_SIDE + 0.05) * d;
    x[2 * i + 3] = bottom + (i / BLOCK_SIDE + 0.5) * d;
  }
  pbf_solver *s = test_create(&desc, &params);
  assert_ok(pbf_add_particles(s, BLOCK + 1, x, NULL, NULL));
  assert_ok(pbf_get_levels(s, 1, place, &at));
  if (!(fabs(at - top) < 0.5 * d)) fail_msg("the level is %.9g, not %.9g", at, top);
  pbf_destroy(s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(rays_at_a_flat_pool), cmocka_unit_test(rays_past_nothing),
      cmocka_unit_test(levels_of_a_pool),    cmocka_unit_test(levels_below_what_flew_away),
      cmocka_unit_test(levels_of_an_image),
  };
  return TEST_RUN(tests);
}
