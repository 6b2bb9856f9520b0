/* What holds of spray, foam and bubbles however they move: the same bits, memory, refusals. */
#include "diffuse_scene.h"

/* ---- The same bits --------------------------------------------------------------------------- */

static pbf_solver *splash(uint32_t dimension, uint32_t precision, int is_on) {
  pbf_solver *s = box_of(dimension, precision, 9.81, 1.5);
  add_block(s, dimension, precision, (double[3]){0.4, 0.4, 0.4}, (int[3]){12, 14, 12}, NULL);
  pbf_diffuse_desc desc = desc_of(s);
  desc.energy_min = 0.05;
  desc.capacity = 300;
  desc.seed = 7;
  if (is_on) assert_ok(pbf_set_diffuse(s, &desc));
  return s;
}

static void assert_alike(pbf_solver *a, pbf_solver *b) {
  static one all[2][300];
  const uint32_t count = read_all(a, all[0], 300);
  assert_int_equal(read_all(b, all[1], 300), count);
  assert_memory_equal(all[0], all[1], sizeof all[0]);
  const pbf_diffuse_info left = info_of(a), right = info_of(b);
  assert_memory_equal(&left, &right, sizeof left);
}

/* Steps in one call and in many, a save and a load between them: not a bit is another one, of them
 * or of the fluid, which is that of a solver without. */
static void check_bits(uint32_t dimension, uint32_t precision) {
  pbf_solver *at_once = splash(dimension, precision, 1),
             *in_parts = splash(dimension, precision, 1);
  pbf_solver *without = splash(dimension, precision, 0), *loaded = splash(dimension, precision, 0);
  uint64_t size;
  assert_ok(pbf_step(at_once, 90));
  assert_ok(pbf_step(without, 90));
  for (int i = 0; i < 60; ++i) assert_ok(pbf_step(in_parts, 1));
  void *saved = test_save(in_parts, &size);
  assert_ok(pbf_step(in_parts, 13));
  assert_ok(pbf_begin_step(in_parts, 17));
  assert_ok(pbf_end_step(in_parts));
  assert_ok(pbf_load(loaded, saved, size));
  assert_ok(pbf_step(loaded, 30));
  const pbf_diffuse_info info = info_of(at_once);
  /* There is something to compare; the stub's particles do not meet. */
  assert_true(test_is_stub() || (info.recycled > 100 && info.count == 300));
  assert_alike(at_once, in_parts);
  assert_alike(at_once, loaded);
  assert_int_equal(test_hash(at_once), test_hash(without));
  assert_int_equal(test_hash(loaded), test_hash(without));
  free(saved);
  pbf_destroy(at_once);
  pbf_destroy(in_parts);
  pbf_destroy(without);
  pbf_destroy(loaded);
}

static void bits_do_not_depend_on_calls(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_bits);
}

/* Every fourth step has a quarter of the looks, and goes by the time that has passed. */
static void check_interval(uint32_t dimension, uint32_t precision) {
  pbf_solver *s[2];
  for (int i = 0; i < 2; ++i) {
    s[i] = splash(dimension, precision, 1);
    pbf_diffuse_desc desc = {.struct_size = sizeof desc};
    assert_ok(pbf_get_diffuse(s[i], &desc));
    desc.interval = 4;
    assert_ok(pbf_set_diffuse(s[i], &desc));
  }
  assert_ok(pbf_step(s[0], 90));
  for (int i = 0; i < 90; i += 3) assert_ok(pbf_step(s[1], 3));
  assert_alike(s[0], s[1]);
  assert_near(info_of(s[0]).time, 88 * dt, 1e-12, "their time");
  add_one(s[0], dimension, precision, (double[3]){0.75, 1.25, 0.75}, (double[3]){0, 1, 0}, 9);
  static one all[300];
  assert_ok(pbf_step(s[0], 2)); /* to 92: one of four steps, since their time */
  const uint32_t count = read_all(s[0], all, 300);
  for (uint32_t i = 0; i < count; ++i)
    if (all[i].life > 8.5)
      assert_near(all[i].x[1], 1.25 + 4 * dt - 0.5 * 9.81 * pow(4 * dt, 2), 1e-9, "its place");
  pbf_destroy(s[0]);
  pbf_destroy(s[1]);
}

static void an_interval_goes_by_time(void **state) {
  (void)state;
  test_for_long_kinds(check_interval);
}

static void threads_change_nothing(void **state) {
  (void)state;
  pbf_solver *s[2];
  for (uint32_t i = 0; i < 2; ++i) {
    pbf_desc desc = test_desc(3, PBF_FLOAT32, CAPACITY);
    const pbf_params params = params_of(9.81, 1.5);
    desc.threads = 1 + 2 * i;
    s[i] = test_create(&desc, &params);
    add_block(s[i], 3, PBF_FLOAT32, (double[3]){0.4, 0.4, 0.4}, (int[3]){12, 14, 12}, NULL);
    pbf_diffuse_desc wanted = desc_of(s[i]);
    wanted.energy_min = 0.05;
    wanted.capacity = 300;
    assert_ok(pbf_set_diffuse(s[i], &wanted));
    assert_ok(pbf_step(s[i], 60));
  }
  assert_true(test_is_stub() || info_of(s[0]).generated > 300);
  assert_alike(s[0], s[1]);
  pbf_destroy(s[0]);
  pbf_destroy(s[1]);
}

/* ---- Memory ---------------------------------------------------------------------------------- */

/* Where an allocation fails, a step is not done, and then goes on as if it had not. */
static void no_memory_leaves_all_as_it_was(void **state) {
  (void)state;
  pbf_solver *right = splash(3, PBF_FLOAT32, 1);
  assert_ok(pbf_step(right, 40));
  for (uint64_t n = 1, failed = 1; failed; ++n) {
    pbf_solver *s = splash(3, PBF_FLOAT32, 1);
    uint64_t size, size_after;
    assert_ok(pbf_step(s, 30));
    assert_ok(pbf_end_queries(s)); /* so that a step wants memory */
    void *before = test_save(s, &size);
    test_count.failing_call = test_count.calls + n;
    const pbf_status status = pbf_step(s, 1);
    failed = test_count.calls >= test_count.failing_call;
    test_count.failing_call = 0;
    assert_int_equal(status, failed ? PBF_ERROR_OUT_OF_MEMORY : PBF_OK);
    if (failed) {
      void *after = test_save(s, &size_after);
      assert_int_equal(size_after, size);
      assert_memory_equal(before, after, size);
      free(after);
    }
    assert_true(n > 1 || failed);
    assert_ok(pbf_step(s, failed ? 10 : 9));
    assert_alike(s, right);
    free(before);
    pbf_destroy(s);
  }
  pbf_destroy(right);
  assert_int_equal(test_count.live_blocks, 0);
}

static void setting_fails_whole(void **state) {
  (void)state;
  for (uint64_t n = 1, failed = 1; failed; ++n) {
    pbf_solver *s = splash(3, PBF_FLOAT32, n % 2 == 0);
    uint64_t size, size_after;
    pbf_diffuse_desc desc = desc_of(s);
    void *before = test_save(s, &size);
    test_count.failing_call = test_count.calls + (n + 1) / 2;
    const pbf_status status = pbf_set_diffuse(s, &desc);
    failed = test_count.calls >= test_count.failing_call;
    test_count.failing_call = 0;
    assert_int_equal(status, failed ? PBF_ERROR_OUT_OF_MEMORY : PBF_OK);
    void *after = test_save(s, &size_after);
    if (failed) assert_int_equal(size_after, size);
    if (failed) assert_memory_equal(before, after, size);
    free(before);
    free(after);
    pbf_destroy(s);
  }
  assert_int_equal(test_count.live_blocks, 0);
}

/* ---- What is refused ------------------------------------------------------------------------- */

typedef struct fault {
  size_t offset;
  double value;
  const char *words;
} fault;

#define FAULT(member, value, words) \
  { offsetof(pbf_diffuse_desc, member), value, words }

static void bad_descs_are_refused(void **state) {
  (void)state;
  static const fault faults[] = {
      FAULT(trapped_air_min, NAN, "desc.trapped_air_min is"),
      FAULT(trapped_air_max, 0, "desc.trapped_air_max is 0; it must be above trapped_air_min"),
      FAULT(wave_crest_min, -1, "desc.wave_crest_min is"),
      FAULT(wave_crest_max, 0.01, "must be above wave_crest_min"),
      FAULT(energy_min, 1e30, "must be above energy_min"),
      FAULT(energy_max, INFINITY, "desc.energy_max is"),
      FAULT(trapped_air_rate, -1, "desc.trapped_air_rate is -1"),
      FAULT(wave_crest_rate, NAN, "desc.wave_crest_rate is"),
      FAULT(lifetime_min, 1e30, "must be at least lifetime_min"),
      FAULT(lifetime_max, -1, "desc.lifetime_max is -1"),
      FAULT(buoyancy, -0.5, "desc.buoyancy is -0.5"),
      FAULT(bubble_drag, NAN, "desc.bubble_drag is"),
      FAULT(spray_drag, -2, "desc.spray_drag is -2"),
      FAULT(scatter, -1, "desc.scatter is -1"),
  };
  pbf_solver *s = splash(3, PBF_FLOAT32, 0);
  const pbf_diffuse_desc good = desc_of(s);
  pbf_diffuse_desc bad;
  for (size_t i = 0; i < sizeof faults / sizeof faults[0]; ++i) {
    bad = good;
    memcpy((char *)&bad + faults[i].offset, &faults[i].value, sizeof faults[i].value);
    assert_fails(pbf_set_diffuse(s, &bad), PBF_ERROR_INVALID_ARGUMENT, faults[i].words);
  }
  bad = good, bad.capacity = 0;
  assert_fails(pbf_set_diffuse(s, &bad), PBF_ERROR_INVALID_ARGUMENT, "desc.capacity is 0");
  bad = good, bad.capacity = PBF_MAX_DIFFUSE + 1;
  assert_fails(pbf_set_diffuse(s, &bad), PBF_ERROR_INVALID_ARGUMENT, "desc.capacity is 4194304");
  bad = good, bad.interval = 0;
  assert_fails(pbf_set_diffuse(s, &bad), PBF_ERROR_INVALID_ARGUMENT, "desc.interval is 0");
  bad = good, bad.bubble_neighbors = 3;
  assert_fails(pbf_set_diffuse(s, &bad), PBF_ERROR_INVALID_ARGUMENT,
               "desc.bubble_neighbors is 3; it must be at least foam_neighbors, 7");
  bad = good, bad.struct_size = 7;
  assert_fails(pbf_set_diffuse(s, &bad), PBF_ERROR_STRUCT_SIZE, "pbf_diffuse_desc.struct_size");
  assert_fails(pbf_diffuse_init(s, NULL, sizeof good), PBF_ERROR_INVALID_ARGUMENT, "desc is null");
  assert_fails(pbf_diffuse_init(s, &bad, 12), PBF_ERROR_STRUCT_SIZE, "struct_size is 12");
  assert_int_equal(info_of(s).capacity, 0); /* none of them has begun anything */
  pbf_destroy(s);
}

static void bad_calls_are_refused(void **state) {
  (void)state;
  pbf_solver *s = splash(3, PBF_FLOAT32, 0);
  pbf_diffuse_desc desc = {.struct_size = sizeof desc};
  const float x[6] = {1, 1, 1, 1, 1, 1}, nan[3] = {1, NAN, 1}, lives[2] = {1, 0};
  float to[6];
  assert_fails(pbf_get_diffuse(s, &desc), PBF_ERROR_STATE, "pbf_set_diffuse");
  assert_fails(pbf_add_diffuse(s, 1, x, NULL, lives), PBF_ERROR_STATE, "pbf_set_diffuse");
  desc = desc_of(s);
  desc.capacity = 2;
  assert_ok(pbf_set_diffuse(s, &desc));
  assert_fails(pbf_add_diffuse(s, 3, x, NULL, lives), PBF_ERROR_CAPACITY, "count is 3");
  assert_fails(pbf_add_diffuse(s, 1, NULL, NULL, lives), PBF_ERROR_INVALID_ARGUMENT, "positions");
  assert_fails(pbf_add_diffuse(s, 1, nan, NULL, lives), PBF_ERROR_INVALID_ARGUMENT,
               "positions[0][1]");
  assert_fails(pbf_add_diffuse(s, 1, x, nan, lives), PBF_ERROR_INVALID_ARGUMENT,
               "velocities[0][1]");
  assert_fails(pbf_add_diffuse(s, 2, x, NULL, lives), PBF_ERROR_INVALID_ARGUMENT,
               "lives[1] is 0; it must be above 0");
  assert_fails(pbf_add_diffuse(s, 1, x, NULL, NULL), PBF_ERROR_INVALID_ARGUMENT, "lives");
  assert_int_equal(info_of(s).count, 0);
  assert_ok(pbf_add_diffuse(s, 1, x, NULL, lives));
  pbf_diffuse_read read = {.struct_size = sizeof read, .count = 2, .positions = to};
  assert_fails(pbf_read_diffuse(s, &read), PBF_ERROR_NOT_FOUND, "there are 1 diffuse particles");
  read.count = 1, read.components = 2;
  assert_fails(pbf_read_diffuse(s, &read), PBF_ERROR_INVALID_ARGUMENT, "read.components is 2");
  read.components = 0, read.element_type = 5;
  assert_fails(pbf_read_diffuse(s, &read), PBF_ERROR_INVALID_ARGUMENT, "read.element_type is 5");
  read.element_type = 0, read.stride = 8;
  assert_fails(pbf_read_diffuse(s, &read), PBF_ERROR_INVALID_ARGUMENT, "read.stride is 8");
  read.stride = 0, read.positions = NULL;
  assert_fails(pbf_read_diffuse(s, &read), PBF_ERROR_INVALID_ARGUMENT, "are null");
  assert_fails(pbf_read_diffuse(s, NULL), PBF_ERROR_INVALID_ARGUMENT, "read is null");
  assert_fails(pbf_shift_diffuse(s, NULL), PBF_ERROR_INVALID_ARGUMENT, "way is null");
  assert_fails(pbf_shift_diffuse(s, (double[3]){0, NAN, 0}), PBF_ERROR_INVALID_ARGUMENT, "way[1]");
  assert_ok(pbf_shift_diffuse(s, (double[3]){0.25, -0.5, 0}));
  const one p = read_one(s);
  assert_true(p.x[0] == 1.25 && p.x[1] == 0.5 && p.x[2] == 1);
  pbf_destroy(s);
}

/* Also where the time is so long that they are nothing beside it. */
static void lives_are_above_0(void **state) {
  (void)state;
  pbf_solver *s = splash(3, PBF_FLOAT64, 0);
  pbf_diffuse_desc desc = desc_of(s);
  const double x[3] = {1, 1, 1}, life = 1e-30;
  double left = 0;
  assert_ok(pbf_set_diffuse(s, &desc));
  assert_ok(pbf_step(s, 3));
  assert_ok(pbf_add_diffuse(s, 1, x, NULL, &life));
  const uint32_t count = info_of(s).count;
  const pbf_diffuse_read read = {
      .struct_size = sizeof read, .first = count - 1, .count = 1, .lives = &left};
  assert_ok(pbf_read_diffuse(s, &read));
  assert_true(left > 0 && left < 1e-9);
  assert_ok(pbf_step(s, 1));
  assert_true(info_of(s).expired > 0);
  pbf_destroy(s);
}

/* As many as make their ids begin anew soon, and then no state of theirs could be loaded. */
static void ids_do_not_end(void **state) {
  (void)state;
  enum { NEXT_ID = 24 }; /* behind count, 4 bytes, a time and a part */
  pbf_solver *s = splash(3, PBF_FLOAT32, 1), *other = splash(3, PBF_FLOAT32, 0);
  const uint64_t last = UINT64_MAX;
  uint64_t size, without;
  assert_ok(pbf_step(s, 3));
  assert_ok(pbf_step(other, 3));
  add_one(s, 3, PBF_FLOAT32, start, throw, 1);
  free(test_save(other, &without));
  unsigned char *saved = test_save(s, &size), *next_id = saved + without - 8 + NEXT_ID;
  assert_true(next_id[0] == read_one(s).id + 1);
  memcpy(next_id, &last, sizeof last);
  test_seal(saved, size);
  assert_fails(pbf_load(other, saved, size), PBF_ERROR_DATA, "diffuse particles");
  free(saved);
  pbf_destroy(s);
  pbf_destroy(other);
}

/* A forged state is none that pbf_save wrote. */
static void forged_states_are_refused(void **state) {
  (void)state;
  pbf_solver *s = splash(3, PBF_FLOAT32, 1), *other = splash(3, PBF_FLOAT32, 0);
  uint64_t size, without;
  assert_ok(pbf_step(s, 40));
  assert_ok(pbf_step(other, 40));
  for (int i = 0; i < 20; ++i) add_one(s, 3, PBF_FLOAT32, start, throw, 1);
  free(test_save(other, &without));
  unsigned char *saved = test_save(s, &size);
  const uint64_t begin = without - 8; /* where there is a checksum without them */
  assert_true(size > without + 1000);
  uint32_t refused = 0;
  const uint64_t step = TEST_INSTRUMENTED ? 84 : 4;
  for (uint64_t at = begin; at + 8 < size; at += step) {
    const uint64_t hash = test_hash(other);
    unsigned char kept[4];
    memcpy(kept, saved + at, 4);
    memset(saved + at, 0xff, 4); /* NaN, or a huge count */
    test_seal(saved, size);
    const pbf_status status = pbf_load(other, saved, size);
    assert_true(status == PBF_OK || status == PBF_ERROR_DATA);
    if (status != PBF_OK) assert_int_equal(test_hash(other), hash);
    refused += status != PBF_OK;
    memcpy(saved + at, kept, 4);
  }
  assert_true(refused > (size - begin) / step / 4);
  free(saved);
  pbf_destroy(s);
  pbf_destroy(other);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(bits_do_not_depend_on_calls),
      cmocka_unit_test(an_interval_goes_by_time),
      cmocka_unit_test(threads_change_nothing),
      cmocka_unit_test(no_memory_leaves_all_as_it_was),
      cmocka_unit_test(setting_fails_whole),
      cmocka_unit_test(bad_descs_are_refused),
      cmocka_unit_test(bad_calls_are_refused),
      cmocka_unit_test(lives_are_above_0),
      cmocka_unit_test(ids_do_not_end),
      cmocka_unit_test(forged_states_are_refused),
  };
  return TEST_RUN(tests);
}
