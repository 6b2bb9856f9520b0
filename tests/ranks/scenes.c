#include "scenes.h"

#include <pbf/emit.h>
#include <pbf/phases.h>
#include <pbf/query.h>
#include <stdio.h>

static pbf_params params_of(uint32_t dimension) {
  pbf_params params = test_params();
  params.pressure_grid = 0;
  params.smoothing_radius = 0.1;
  for (uint32_t k = 0; k < 3; ++k) params.domain_max[k] = k == 0 ? 3 : 1;
  if (dimension == 2) params.domain_max[0] = 6, params.domain_max[1] = 5;
  return params;
}

void scene_fill(const scene *c, pbf_solver *s, uint32_t count, double shift) {
  const uint32_t d = c->dimension, wide = d == 3 ? 14 : 40;
  void *x = calloc((size_t)count * d, c->precision), *v = calloc((size_t)count * d, c->precision);
  EXPECT(x);
  EXPECT(v);
  uint32_t seed = 7;
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t at[3] = {i % wide, i / wide % (d == 3 ? wide : count), i / wide / wide};
    for (uint32_t k = 0; k < d; ++k) {
      seed = seed * 1664525u + 1013904223u;
      const double off = 0.4 * (seed / 4294967296.0);
      test_put(x, (uint64_t)i * d + k, c->precision, shift + 0.05 * (0.3 + at[k] + off));
      test_put(v, (uint64_t)i * d + k, c->precision, k == 0 ? 2 * off : -off);
    }
  }
  EXPECT_OK(pbf_add_particles(s, count, x, v, NULL));
  free(x);
  free(v);
}

void scene_colliders(pbf_collider list[SCENE_COLLIDERS]) {
  EXPECT_OK(pbf_collider_init(&list[0], sizeof list[0], PBF_COLLIDER_SPHERE));
  EXPECT_OK(pbf_collider_init(&list[1], sizeof list[1], PBF_COLLIDER_BOX));
  list[0].position[0] = 0.9;
  list[0].position[1] = 0.3;
  list[0].position[2] = 0.4;
  list[0].radius = 0.15;
  list[0].velocity[0] = -0.8;
  for (int k = 0; k < 3; ++k) list[1].position[k] = 0.3, list[1].half_extents[k] = 0.08;
  list[1].angular_velocity[2] = 3;
  list[1].no_slip = 0.5;
  list[1].adhesion = 0.7; /* where there is a tension */
}

void scene_accelerate(const scene *c, pbf_solver *s) {
  const uint32_t d = c->dimension, count = c->count / 2;
  void *a = calloc((size_t)count * d, c->precision);
  EXPECT(a);
  EXPECT_OK(pbf_get_positions(s, 0, count, a));
  for (uint32_t i = 1; i < count; i += 2)
    memset((char *)a + i * d * c->precision, 0, d * c->precision);
  EXPECT_OK(pbf_set_accelerations(s, 0, count, a));
  free(a);
}

static void ask(pbf_solver *s, double asked[4]) {
  const double x[3] = {0.35, 0.3, 0.35};
  double v[3];
  uint32_t count = 0;
  pbf_volume ball;
  EXPECT_OK(pbf_sample(
      s, &(pbf_samples){
             .struct_size = sizeof(pbf_samples), .count = 1, .points = x, .velocities = v}));
  EXPECT_OK(pbf_get_levels(s, 1, x, &asked[2]));
  EXPECT_OK(pbf_volume_init(&ball, sizeof ball, PBF_VOLUME_SPHERE));
  EXPECT_OK(pbf_find_in_volume(s, &ball, 0, NULL, &count));
  asked[0] = v[0];
  asked[1] = v[1];
  asked[3] = count;
}

static void set_particle_phases(const scene *c, pbf_solver *s) {
  uint32_t *phases = calloc(c->count, sizeof *phases);
  if (!EXPECT(phases)) return;
  for (uint32_t i = 0; i < c->count; ++i) phases[i] = i / 7 % c->phases;
  EXPECT_OK(pbf_set_particle_phases(s, 0, c->count, phases));
  free(phases);
}

static void run_scene(const scene *c, pbf_solver *s) {
  pbf_collider list[SCENE_COLLIDERS];
  scene_colliders(list);
  if (c->colliders) EXPECT_OK(pbf_set_colliders(s, c->colliders, list));
  if (c->set_up) c->set_up(c, s);
  scene_fill(c, s, c->count, 0);
  if (c->phases) set_particle_phases(c, s);
  EXPECT_OK(pbf_step(s, SCENE_STEPS / 2));
  if (c->change) c->change(c, s);
  EXPECT_OK(pbf_step(s, SCENE_STEPS - SCENE_STEPS / 2));
}

/* Of walls, and then of colliders. Returns of how many solids. */
static uint32_t weigh(const scene *c, pbf_solver *s, pbf_collider_load loads[SCENE_SOLIDS]) {
  const uint32_t walls = 2 * c->dimension;
  uint32_t colliders = 0;
  memset(loads, 0, SCENE_SOLIDS * sizeof *loads);
  if (!c->params.loads) return 0;
  EXPECT_OK(pbf_get_collider_count(s, &colliders));
  if (!EXPECT(walls + colliders <= SCENE_SOLIDS)) return 0;
  for (uint32_t k = 0; k < walls + colliders; ++k) loads[k].struct_size = sizeof loads[k];
  EXPECT_OK(pbf_get_wall_loads(s, walls, loads));
  EXPECT_OK(pbf_get_collider_loads(s, colliders, loads + walls));
  return walls + colliders;
}

static pbf_desc desc_of(const scene *c) {
  pbf_desc desc = test_desc(c->dimension, c->precision, c->count + 400);
  desc.threads = 1;
  desc.allocator = NULL; /* the counting one is one thread's */
  if (c->isa) desc.isa = c->isa;
  return desc;
}

static uint32_t count_of(pbf_solver *s) {
  uint32_t count = 0;
  EXPECT_OK(pbf_get_count(s, &count));
  return count;
}

void scene_run_alone(scene *c) {
  const pbf_desc desc = desc_of(c);
  pbf_solver *s = test_create(&desc, &c->params);
  run_scene(c, s);
  assert_int_equal(ranks_failures(), 0);
  const uint32_t count = count_of(s);
  c->hash = test_hash(s);
  if (c->asks) ask(s, c->asked);
  c->solids = weigh(c, s, c->loads);
  c->stats = (pbf_stats){.struct_size = sizeof c->stats};
  assert_ok(pbf_get_stats(s, &c->stats));
  c->densities = calloc(count, c->precision);
  c->pressures = calloc(count, c->precision);
  assert_ok(pbf_get_densities(s, 0, count, c->densities));
  if (c->params.solver == PBF_SOLVER_CHEBYSHEV)
    assert_ok(pbf_get_pressures(s, 0, count, c->pressures));
  pbf_destroy(s);
}

void scene_free(scene *c) {
  free(c->densities);
  free(c->pressures);
}

static void run_on_ranks(const pbf_ranks *ranks, void *context) {
  scene *c = context;
  const pbf_desc desc = desc_of(c);
  pbf_solver *s;
  pbf_stats stats = {.struct_size = sizeof stats};
  if (!EXPECT_OK(pbf_create_on_ranks(&desc, &c->params, ranks, &s))) return;
  run_scene(c, s);
  const uint32_t count = count_of(s);
  void *values = calloc(count, c->precision);
  expect_share(s, c->dimension, c->precision, &c->seen);
  EXPECT_OK(pbf_hash(s, &c->hashes_seen[ranks->rank]));
  EXPECT_OK(pbf_get_stats(s, &stats));
  EXPECT(memcmp(&stats, &c->stats, sizeof stats) == 0);
  double asked[4] = {0};
  if (c->asks) ask(s, asked);
  EXPECT(memcmp(asked, c->asked, sizeof asked) == 0);
  pbf_collider_load loads[SCENE_SOLIDS];
  EXPECT(weigh(c, s, loads) == c->solids);
  EXPECT(memcmp(loads, c->loads, sizeof loads) == 0);
  EXPECT_OK(pbf_get_densities(s, 0, count, values));
  EXPECT(memcmp(values, c->densities, (size_t)count * c->precision) == 0);
  if (c->params.solver == PBF_SOLVER_CHEBYSHEV) {
    EXPECT_OK(pbf_get_pressures(s, 0, count, values));
    EXPECT(memcmp(values, c->pressures, (size_t)count * c->precision) == 0);
  }
  free(values);
  pbf_destroy(s);
}

void scene_expect_same(const char *what, scene *c, uint32_t ranks, const double *shares) {
  memset(c->hashes_seen, 0, sizeof c->hashes_seen);
  memset(&c->seen, 0, sizeof c->seen);
  thread_ranks_run(ranks, 0, shares, NULL, run_on_ranks, c);
  assert_int_equal(ranks_failures(), 0);
  assert_true(each_is_in_one(&c->seen, c->stats.count));
  for (uint32_t r = 0; r < ranks; ++r)
    if (c->hashes_seen[r] != c->hash)
      fail_msg("%s, %uD float%u, rank %u of %u: other bits", what, c->dimension, 8 * c->precision,
               r, ranks);
}

void scene_check(const char *what, scene *c) {
  /* Of three ranks a sanitizer sees neighbours to one side and to both. */
  static const uint32_t counts[] = {3, 2, 1, 8};
  const size_t count = TEST_INSTRUMENTED && !test_is_long() ? 1 : sizeof counts / sizeof counts[0];
  scene_run_alone(c);
  for (size_t k = 0; k < count; ++k) scene_expect_same(what, c, counts[k], NULL);
  scene_free(c);
}

scene scene_plain(uint32_t dimension, uint32_t precision) {
  return (scene){.dimension = dimension,
                 .precision = precision,
                 .count = SCENE_COUNT,
                 .params = params_of(dimension)};
}
