/* What a solver on ranks answers, and what it does when it is told, is what one solver answers and
 * does: queries, readings, snapshots, states, changes of all kinds, on each rank. */
#include <math.h>
#include <pbf/diffuse.h>
#include <pbf/emit.h>
#include <pbf/query.h>
#include <stdio.h>

#include "scenes.h"

enum { ROOM = 1 << 21, POINTS = 12, MANY = SCENE_COUNT + 400 };

/* All answers, one after another, with where each begins. */
typedef struct answers {
  uint64_t bytes, count;
  uint64_t begins[64];
  const char *of[64];
  unsigned char all[ROOM];
} answers;

static void note(answers *a, const char *of, const void *data, uint64_t bytes) {
  if (!EXPECT(a->bytes + bytes <= ROOM && a->count < 64)) return;
  a->of[a->count] = of;
  a->begins[a->count++] = a->bytes;
  memcpy(a->all + a->bytes, data, bytes);
  a->bytes += bytes;
}

/* Inside of the fluid, at its surface, and in the air. */
static void points_of(uint32_t d, double points[POINTS][3], double *packed) {
  for (uint32_t i = 0; i < POINTS; ++i)
    for (uint32_t k = 0; k < d; ++k)
      packed[i * d + k] = points[i][k] = 0.1 + 0.07 * (double)((i * (k + 2)) % 11);
}

/* ---- Questions ----------------------------------------------------------------------------- */

static void ask_at_points(uint32_t d, pbf_solver *s, answers *a) {
  double points[POINTS][3], at[3 * POINTS], ways[3 * POINTS], numbers[3 * POINTS] = {0};
  double more[3 * POINTS] = {0}, pressures[POINTS];
  uint8_t wet[POINTS];
  points_of(d, points, at);
  EXPECT_OK(pbf_sample(s, &(pbf_samples){.struct_size = sizeof(pbf_samples),
                                         .count = POINTS,
                                         .points = at,
                                         .densities = more,
                                         .velocities = numbers,
                                         .pressures = pressures,
                                         .wet = wet}));
  note(a, "densities", more, sizeof more);
  note(a, "velocities", numbers, sizeof numbers);
  note(a, "pressures", pressures, sizeof pressures);
  note(a, "wet", wet, sizeof wet);
  EXPECT_OK(pbf_get_levels(s, POINTS, at, numbers));
  note(a, "levels", numbers, POINTS * sizeof *numbers);
  for (uint32_t k = 0; k < d * POINTS; ++k) ways[k] = k % d == 1 ? -1 : 0.1;
  for (uint32_t k = 0; k < POINTS; ++k) at[k * d + 1] = 0.98;
  memset(more, 0, sizeof more);
  EXPECT_OK(pbf_cast_rays(s, POINTS, at, ways, INFINITY, numbers, more));
  note(a, "distances", numbers, POINTS * sizeof *numbers);
  note(a, "normals", more, sizeof more);
}

static void ask_in_volumes(pbf_solver *s, answers *a) {
  uint32_t mine[MANY];
  const double lower[3] = {0.2, 0.1, 0.1}, upper[3] = {0.5, 0.3, 0.5};
  uint32_t count = 0;
  pbf_volume ball;
  pbf_volume_flow flow = {.struct_size = sizeof flow};
  EXPECT_OK(pbf_volume_init(&ball, sizeof ball, PBF_VOLUME_SPHERE));
  for (int k = 0; k < 3; ++k) ball.position[k] = 0.35;
  ball.radius = 0.3;
  EXPECT_OK(pbf_find_in_volume(s, &ball, MANY, mine, &count));
  note(a, "in a ball", mine, count * sizeof *mine);
  EXPECT_OK(pbf_find_in_box(s, lower, upper, MANY, mine, &count));
  note(a, "in a box", mine, count * sizeof *mine);
  EXPECT_OK(pbf_measure_volumes(s, 1, &ball, &flow));
  note(a, "flow", &flow, sizeof flow);
}

static void ask_for_shapes(uint32_t d, uint32_t precision, pbf_solver *s, answers *a) {
  enum { SOME = 100 };
  double places[3 * SOME] = {0}, stretches[9 * SOME] = {0};
  EXPECT_OK(
      pbf_get_anisotropies(s, &(pbf_anisotropy_desc){.struct_size = sizeof(pbf_anisotropy_desc),
                                                     .first = 40,
                                                     .count = SOME,
                                                     .smoothing = 0.9,
                                                     .positions = places,
                                                     .stretches = stretches}));
  note(a, "smoothed positions", places, (uint64_t)SOME * d * precision);
  note(a, "stretches", stretches, (uint64_t)SOME * d * d * precision);
}

static void read_all(uint32_t field, double behind, uint32_t w, pbf_solver *s, answers *a) {
  uint32_t count = 0;
  EXPECT_OK(pbf_get_count(s, &count));
  double *numbers = calloc((size_t)count * 4, sizeof *numbers);
  if (!EXPECT(numbers)) return;
  EXPECT_OK(pbf_read(s, &(pbf_read_desc){.struct_size = sizeof(pbf_read_desc),
                                         .field = field,
                                         .count = count,
                                         .element_type = PBF_TYPE_FLOAT64,
                                         .components = w ? 4 : 0,
                                         .w = w,
                                         .behind = behind,
                                         .data = numbers}));
  note(a, "a reading", numbers, (uint64_t)count * 4 * sizeof *numbers);
  free(numbers);
}

/* The row of a particle, whose ids ascend. */
static uint32_t row_of(const uint32_t *ids, uint32_t count, uint32_t id) {
  uint32_t row = 0;
  for (uint32_t step = count; step > 0; step /= 2)
    while (row + step < count && ids[row + step] <= id) row += step;
  return row;
}

/* A solver alone shows them in an order of its own: by their ids they are what readings give. */
static void look_at(uint32_t field, const scene *c, pbf_solver *s) {
  const uint32_t d = field == PBF_FIELD_PRESSURE ? 1 : c->dimension;
  pbf_view view = {.struct_size = sizeof view};
  uint32_t count = 0, other = 0;
  EXPECT_OK(pbf_get_count(s, &count));
  if (!EXPECT_OK(pbf_map(s, field, &view)) || !EXPECT(view.count == count)) return;
  uint32_t *ids = calloc(count, sizeof *ids);
  char *right = calloc(count, (size_t)d * c->precision);
  if (!EXPECT(ids && right)) return;
  EXPECT_OK(pbf_get_ids(s, 0, count, ids));
  EXPECT_OK(field == PBF_FIELD_POSITION   ? pbf_get_positions(s, 0, count, right)
            : field == PBF_FIELD_VELOCITY ? pbf_get_velocities(s, 0, count, right)
                                          : pbf_get_pressures(s, 0, count, right));
  for (uint32_t i = 0; i < count; ++i)
    for (uint32_t k = 0; k < d; ++k)
      other +=
          memcmp((const char *)view.data + i * view.particle_stride + k * view.component_stride,
                 right + ((size_t)row_of(ids, count, view.ids[i]) * d + k) * c->precision,
                 c->precision) != 0;
  EXPECT(other == 0);
  EXPECT_FAILS(pbf_step(s, 1), PBF_ERROR_STATE, "mapped");
  EXPECT_OK(pbf_unmap(s, field));
  free(ids);
  free(right);
}

/* All that moves at all makes some. */
static void make_spray(pbf_solver *s) {
  pbf_diffuse_desc desc;
  EXPECT_OK(pbf_diffuse_init(s, &desc, sizeof desc));
  desc.capacity = 500;
  desc.energy_min = desc.trapped_air_min = desc.wave_crest_min = 0;
  desc.energy_max = desc.trapped_air_max = desc.wave_crest_max = 1e-3;
  desc.trapped_air_rate = desc.wave_crest_rate = 10;
  EXPECT_OK(pbf_set_diffuse(s, &desc));
}

static void ask_for_spray(pbf_solver *s, answers *a) {
  enum { SOME = 500 };
  double x[3 * SOME] = {0};
  uint64_t ids[SOME] = {0};
  pbf_diffuse_info info = {.struct_size = sizeof info};
  EXPECT_OK(pbf_get_diffuse_info(s, &info));
  EXPECT(info.count > 0);
  EXPECT_OK(pbf_read_diffuse(s, &(pbf_diffuse_read){.struct_size = sizeof(pbf_diffuse_read),
                                                    .count = info.count,
                                                    .positions = x,
                                                    .ids = ids}));
  note(a, "spray, foam and bubbles", &info, sizeof info);
  note(a, "where they are", x, sizeof x);
  note(a, "which they are", ids, sizeof ids);
}

static void ask_for_the_rest(pbf_solver *s, answers *a) {
  double limit = 0;
  pbf_in_out in_out = {.struct_size = sizeof in_out};
  pbf_stats stats = {.struct_size = sizeof stats};
  pbf_snapshot shot = {.struct_size = sizeof shot};
  pbf_collider ball = {.struct_size = sizeof ball};
  uint64_t hash = 0;
  EXPECT_OK(pbf_get_step_limit(s, &limit));
  note(a, "step limit", &limit, sizeof limit);
  EXPECT_OK(pbf_get_in_out(s, &in_out));
  note(a, "in and out", &in_out, sizeof in_out);
  EXPECT_OK(pbf_get_stats(s, &stats));
  note(a, "statistics", &stats, sizeof stats);
  EXPECT_OK(pbf_get_collider(s, 0, &ball));
  note(a, "a collider", &ball, sizeof ball);
  EXPECT_OK(pbf_hash(s, &hash));
  note(a, "hash", &hash, sizeof hash);
  EXPECT_OK(pbf_acquire_snapshot(s, &shot));
  note(a, "ids of a snapshot", shot.ids, shot.count * sizeof *shot.ids);
  note(a, "its positions", shot.positions,
       (uint64_t)shot.count * shot.dimension * (shot.element_type == PBF_TYPE_FLOAT32 ? 4 : 8));
  EXPECT_OK(pbf_release_snapshot(&shot));
}

/* ---- Orders -------------------------------------------------------------------------------- */

static void push_some(const scene *c, pbf_solver *s) {
  enum { SOME = 50 };
  double values[3 * SOME];
  EXPECT_OK(pbf_get_velocities(s, 100, SOME, values));
  EXPECT_OK(pbf_set_velocities(s, 200, SOME, values));
  EXPECT_OK(pbf_get_positions(s, 100, SOME, values));
  for (uint32_t k = 0; k < c->dimension * SOME; ++k)
    test_put(values, k, c->precision, test_value(values, k, c->precision) + 0.004);
  EXPECT_OK(pbf_set_positions(s, 100, SOME, values));
}

static void move_ball(pbf_solver *s) {
  pbf_collider list[SCENE_COLLIDERS];
  scene_colliders(list);
  list[0].position[0] = 0.7;
  list[1].position[1] = 0.4;
  EXPECT_OK(pbf_move_colliders(s, SCENE_COLLIDERS, list, 5 / 120.0));
}

/* What is saved of each particle, once some between others are gone, too. */
static void go_back_and_on(pbf_solver *s, answers *a) {
  const double lower[3] = {0.2, 0, 0}, upper[3] = {0.25, 0.9, 0.9};
  uint64_t size = 0;
  EXPECT_OK(pbf_remove_in_box(s, lower, upper, NULL));
  EXPECT_OK(pbf_save(s, NULL, &size));
  void *bytes = malloc(size);
  if (!EXPECT(bytes)) return;
  EXPECT_OK(pbf_save(s, bytes, &size));
  note(a, "a saved state", bytes, size);
  EXPECT_OK(pbf_step(s, 2));
  EXPECT_OK(pbf_load(s, bytes, size));
  free(bytes);
}

static void live(const scene *c, pbf_solver *s, answers *a) {
  const double lower[3] = {0.05, 0.05, 0.05}, upper[3] = {0.15, 0.2, 0.9};
  pbf_collider list[SCENE_COLLIDERS];
  pbf_params params = c->params;
  scene_colliders(list);
  EXPECT_OK(pbf_set_colliders(s, SCENE_COLLIDERS, list));
  scene_fill(c, s, c->count, 0);
  EXPECT_OK(pbf_keep_previous(s, 1));
  EXPECT_OK(pbf_set_snapshots(s, 2));
  EXPECT_OK(pbf_step(s, 3));
  push_some(c, s);
  EXPECT_OK(pbf_remove_in_box(s, lower, upper, NULL));
  move_ball(s);
  EXPECT_OK(pbf_step(s, 3));
  make_spray(s);
  params.pressure_grid = 2;
  params.viscosity = 0.001;
  params.sleep_speed = 0.1;
  params.sleep_time = 0.2;
  EXPECT_OK(pbf_set_params(s, &params));
  EXPECT_OK(pbf_begin_step(s, 3));
  EXPECT_OK(pbf_end_step(s));
  go_back_and_on(s, a);
  EXPECT_OK(pbf_step(s, 2));
  ask_at_points(c->dimension, s, a);
  ask_in_volumes(s, a);
  ask_for_shapes(c->dimension, c->precision, s, a);
  read_all(PBF_FIELD_POSITION, 0.4, PBF_W_SPEED, s, a);
  read_all(PBF_FIELD_VELOCITY, 0, PBF_W_PRESSURE, s, a);
  read_all(PBF_FIELD_DENSITY, 0, 0, s, a);
  look_at(PBF_FIELD_POSITION, c, s);
  look_at(PBF_FIELD_VELOCITY, c, s);
  look_at(PBF_FIELD_PRESSURE, c, s);
  ask_for_spray(s, a);
  ask_for_the_rest(s, a);
  EXPECT_OK(pbf_end_queries(s));
}

/* ---- One solver, and ranks ----------------------------------------------------------------- */

typedef struct trial {
  scene c;
  const answers *right;
} trial;

static pbf_desc desc_of(const scene *c) {
  pbf_desc desc = test_desc(c->dimension, c->precision, MANY);
  desc.threads = 1;
  desc.allocator = NULL; /* the counting one is one thread's */
  return desc;
}

static void live_on_ranks(const pbf_ranks *ranks, void *context) {
  const trial *t = context;
  const answers *right = t->right;
  const pbf_desc desc = desc_of(&t->c);
  answers *own = calloc(1, sizeof *own);
  pbf_solver *s;
  if (!EXPECT(own) || !EXPECT_OK(pbf_create_on_ranks(&desc, &t->c.params, ranks, &s))) return;
  live(&t->c, s, own);
  EXPECT(own->count == right->count && own->bytes == right->bytes);
  for (uint64_t k = 0; k < own->count && k < right->count; ++k) {
    const uint64_t end = k + 1 < right->count ? right->begins[k + 1] : right->bytes;
    if (!EXPECT(own->begins[k] == right->begins[k] &&
                memcmp(own->all + right->begins[k], right->all + right->begins[k],
                       end - right->begins[k]) == 0))
      fprintf(stderr, "rank %u of %u: %s\n", ranks->rank, ranks->count, right->of[k]);
  }
  free(own);
  pbf_destroy(s);
}

static void check(uint32_t dimension, uint32_t precision) {
  trial t = {.c = scene_plain(dimension, precision)};
  const pbf_desc desc = desc_of(&t.c);
  answers *right = calloc(1, sizeof *right);
  assert_non_null(right);
  pbf_solver *s = test_create(&desc, &t.c.params);
  live(&t.c, s, right);
  pbf_destroy(s);
  assert_int_equal(ranks_failures(), 0);
  t.right = right;
  for (uint32_t ranks = 1; ranks <= 4; ++ranks)
    thread_ranks_run(ranks, 0, NULL, NULL, live_on_ranks, &t);
  free(right);
  assert_int_equal(ranks_failures(), 0);
}

static void ranks_answer_as_one_solver_does(void **state) {
  (void)state;
  test_for_long_kinds(check);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(ranks_answer_as_one_solver_does)};
  return TEST_RUN(tests);
}
