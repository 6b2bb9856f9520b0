/* Save, load, hash. */
#include "support.h"

/* Offsets in the header of a saved state, to forge with. */
enum {
  AT_VERSION = 8,
  AT_COLLIDERS = 32,
  AT_COUNT = 36,
  AT_HAS_IDS = 40,
  AT_RESERVED = 52,
  AT_NEXT_ID = 56
};

static pbf_solver *busy_solver(uint32_t dimension, uint32_t precision) {
  pbf_solver *s = test_filled(dimension, precision, 30, 40);
  pbf_collider collider;
  assert_ok(pbf_collider_init(&collider, sizeof collider, PBF_COLLIDER_SPHERE));
  collider.position[0] = 0.9;
  collider.radius = 0.05;
  collider.velocity[1] = 0.25;
  assert_ok(pbf_step(s, 2));
  assert_ok(pbf_set_colliders(s, 1, &collider));
  assert_ok(pbf_remove_particles(s, 3, (const uint32_t[]){0, 7, 29}));
  assert_ok(pbf_step(s, 3));
  return s;
}

/* A loaded solver and the one that was saved go on with the same bits. */
static void continues(uint32_t dimension, uint32_t precision) {
  uint64_t size;
  pbf_solver *a = busy_solver(dimension, precision);
  pbf_solver *b = test_filled(dimension, precision, 5, 40);
  void *state = test_save(a, &size);
  assert_ok(pbf_load(b, state, size));
  assert_int_equal(test_hash(a), test_hash(b));
  pbf_info one = {.struct_size = sizeof one}, two = {.struct_size = sizeof two};
  assert_ok(pbf_get_info(b, &two));
  assert_ok(pbf_get_info(a, &one));
  assert_int_equal(two.step, 5);
  assert_true(one.time == two.time);
  pbf_collider here = {.struct_size = sizeof here}, there = {.struct_size = sizeof there};
  assert_ok(pbf_get_collider(a, 0, &here));
  assert_ok(pbf_get_collider(b, 0, &there));
  assert_memory_equal(&here, &there, sizeof here);
  pbf_params pa = {.struct_size = sizeof pa}, pb = {.struct_size = sizeof pb};
  assert_ok(pbf_get_params(a, &pa));
  assert_ok(pbf_get_params(b, &pb));
  assert_memory_equal(&pa, &pb, sizeof pa);
  for (int i = 0; i < 4; ++i) {
    assert_ok(pbf_step(a, 5));
    assert_ok(pbf_step(b, 5));
    assert_int_equal(test_hash(a), test_hash(b));
  }
  void *lattice = test_lattice(dimension, precision, 1);
  uint32_t first = 0;
  assert_ok(pbf_add_particles(b, 1, lattice, NULL, &first));
  assert_int_equal(first, 30);
  free(lattice);
  free(state);
  pbf_destroy(a);
  pbf_destroy(b);
}

static void continuation(void **state) {
  (void)state;
  test_for_each_kind(continues);
}

static void saving_twice_gives_the_same(void **state) {
  (void)state;
  uint64_t size, again;
  pbf_solver *a = busy_solver(3, PBF_FLOAT32), *b = test_solver(3, PBF_FLOAT32, 40);
  void *one = test_save(a, &size);
  assert_ok(pbf_load(b, one, size));
  void *two = test_save(b, &again);
  assert_int_equal(size, again);
  assert_memory_equal(one, two, size);
  free(one);
  free(two);
  pbf_destroy(a);
  pbf_destroy(b);
}

static void an_empty_solver(void **state) {
  (void)state;
  uint64_t size;
  pbf_solver *empty = test_solver(2, PBF_FLOAT64, 8), *full = test_filled(2, PBF_FLOAT64, 3, 8);
  void *saved = test_save(empty, &size);
  assert_ok(pbf_load(full, saved, size));
  assert_int_equal(test_hash(full), test_hash(empty));
  free(saved);
  pbf_destroy(empty);
  pbf_destroy(full);
}

static void room_for_saving(void **state) {
  (void)state;
  uint64_t size, room;
  pbf_solver *s = busy_solver(3, PBF_FLOAT32);
  assert_ok(pbf_save(s, NULL, &size));
  unsigned char *buffer = malloc(size + 9);
  room = size - 1;
  assert_fails(pbf_save(s, buffer, &room), PBF_ERROR_INVALID_ARGUMENT, "the state needs");
  assert_int_equal(room, size - 1);
  memset(buffer, 0xee, size + 9);
  room = size + 7;
  assert_ok(pbf_save(s, buffer + 1, &room)); /* the buffer may begin anywhere */
  assert_int_equal(room, size);
  assert_int_equal(buffer[0], 0xee);
  assert_int_equal(buffer[size + 1], 0xee);
  void *saved = test_save(s, &size); /* gaps between what is saved are 0 */
  assert_memory_equal(saved, buffer + 1, size);
  memset(saved, 0xee, size);
  assert_ok(pbf_save(s, saved, &size));
  assert_memory_equal(saved, buffer + 1, size);
  assert_ok(pbf_load(s, buffer + 1, size));
  free(saved);
  free(buffer);
  pbf_destroy(s);
}

static void cut_at_every_length(void **state) {
  (void)state;
  uint64_t size;
  pbf_solver *a = busy_solver(2, PBF_FLOAT64), *b = test_filled(2, PBF_FLOAT64, 3, 40);
  void *saved = test_save(a, &size);
  uint64_t before = test_hash(b);
  for (uint64_t length = 0; length < size; ++length) {
    unsigned char *cut = malloc(length + !length); /* so that a look beyond the end is seen */
    memcpy(cut, saved, length);
    assert_fails(pbf_load(b, cut, length), PBF_ERROR_DATA, "the saved state");
    /* Sealed anew, so that the checks behind the checksum are reached. */
    if (length > 128) test_seal(cut, length);
    assert_fails(pbf_load(b, cut, length), PBF_ERROR_DATA, "the saved state");
    free(cut);
  }
  assert_int_equal(test_hash(b), before);
  free(saved);
  pbf_destroy(a);
  pbf_destroy(b);
}

static void every_byte_flipped(void **state) {
  (void)state;
  uint64_t size;
  pbf_solver *a = busy_solver(2, PBF_FLOAT64), *b = test_filled(2, PBF_FLOAT64, 3, 40);
  unsigned char *saved = test_save(a, &size);
  uint64_t before = test_hash(b);
  for (uint64_t i = 0; i < size; ++i) {
    saved[i] ^= 0x41;
    assert_fails(pbf_load(b, saved, size), PBF_ERROR_DATA, "the saved state");
    saved[i] ^= 0x41;
  }
  /* So are two signs, of the last velocity and of one before it. */
  for (uint64_t last = size - 1 - 8 - (test_is_stub() ? 0 : 2 * 27 * 8), i = 1; i <= 8; ++i) {
    saved[last] ^= 0x80, saved[last - 8 * i] ^= 0x80;
    assert_fails(pbf_load(b, saved, size), PBF_ERROR_DATA, "its checksum");
    saved[last] ^= 0x80, saved[last - 8 * i] ^= 0x80;
  }
  assert_int_equal(test_hash(b), before);
  assert_ok(pbf_load(b, saved, size));
  free(saved);
  pbf_destroy(a);
  pbf_destroy(b);
}

/* A forger can write a checksum: whatever is inside must be looked at, too. With the wrong byte in
 * a place where any byte will do (a position's digits), the load may succeed. */
static void every_byte_forged(void **state) {
  (void)state;
  uint64_t size;
  pbf_solver *a = busy_solver(2, PBF_FLOAT64);
  unsigned char *saved = test_save(a, &size);
  for (uint64_t i = 0; i + 8 < size; ++i) {
    pbf_solver *b = test_filled(2, PBF_FLOAT64, 3, 40);
    uint64_t before = test_hash(b);
    unsigned char kept = saved[i];
    saved[i] = 0xff;
    test_seal(saved, size);
    pbf_status status = pbf_load(b, saved, size);
    if (status == PBF_OK) {
      assert_ok(pbf_save(b, NULL, &(uint64_t){0}));
    } else {
      assert_true(status == PBF_ERROR_DATA || status == PBF_ERROR_CAPACITY ||
                  status == PBF_ERROR_OUT_OF_MEMORY);
      assert_int_equal(test_hash(b), before);
    }
    saved[i] = kept;
    pbf_destroy(b);
  }
  free(saved);
  pbf_destroy(a);
}

static void forge(unsigned char *saved, uint64_t size, uint64_t at, uint64_t value, int bytes) {
  memcpy(saved + at, &value, (size_t)bytes);
  test_seal(saved, size);
}

static void forged_headers(void **state) {
  (void)state;
  uint64_t size;
  pbf_solver *a = busy_solver(2, PBF_FLOAT64);
  unsigned char *saved = test_save(a, &size);
  static const struct {
    int at, bytes;
    uint64_t value;
  } forgeries[] = {
      {AT_VERSION, 4, 1},          {AT_COUNT, 4, 26},          {AT_COUNT, 4, 0xffffffffu},
      {AT_COLLIDERS, 4, 0},        {AT_COLLIDERS, 4, 4000000}, {AT_HAS_IDS, 4, 0},
      {AT_HAS_IDS, 4, 2},          {AT_NEXT_ID, 8, 5},         {AT_NEXT_ID, 8, 28},
      {AT_NEXT_ID, 8, UINT64_MAX}, {AT_VERSION, 4, 11},        {AT_VERSION, 4, 13},
      {AT_RESERVED, 4, 1},
  };
  for (size_t i = 0; i < sizeof forgeries / sizeof forgeries[0]; ++i) {
    unsigned char *forged = malloc(size);
    memcpy(forged, saved, size);
    forge(forged, size, (uint64_t)forgeries[i].at, forgeries[i].value, forgeries[i].bytes);
    assert_fails(pbf_load(a, forged, size), PBF_ERROR_DATA, "the saved state");
    free(forged);
  }
  free(saved);
  pbf_destroy(a);
}

/* 27 ids, padded to 112 bytes, before 27 positions, velocities, numbers of the overlap (a sphere
 * has been placed) and pressures, and the checksum. */
static void forged_ids(void **state) {
  (void)state;
  uint64_t size;
  pbf_solver *a = busy_solver(2, PBF_FLOAT64);
  unsigned char *saved = test_save(a, &size);
  uint64_t ids = size - 8 - (test_is_stub() ? 0 : 2 * 27 * 8) - 2 * 27 * 2 * 8 - 112;
  forge(saved, size, ids + 4, 1, 4); /* 1, 1, 3, … */
  assert_fails(pbf_load(a, saved, size), PBF_ERROR_DATA, "ids that do not ascend");
  forge(saved, size, ids + 4, 2, 4); /* as it was: 1, 2, 3, … */
  assert_ok(pbf_load(a, saved, size));
  forge(saved, size, ids + 4 * 26, 30, 4); /* the solver has given 0 … 29 */
  assert_fails(pbf_load(a, saved, size), PBF_ERROR_DATA, "ids that were never given");
  free(saved);
  pbf_destroy(a);
}

/* Ids may run out: a solver so old can only be had by forging its state. */
static void ids_run_out(void **state) {
  (void)state;
  uint64_t size;
  double x[4] = {0.5, 0.5, 0.6, 0.5};
  uint32_t first = 0;
  pbf_solver *s = busy_solver(2, PBF_FLOAT64);
  unsigned char *saved = test_save(s, &size);
  forge(saved, size, AT_NEXT_ID, UINT32_MAX, 8);
  assert_ok(pbf_load(s, saved, size));
  assert_fails(pbf_add_particles(s, 2, x, NULL, &first), PBF_ERROR_CAPACITY,
               "the next id would be 4294967295");
  assert_ok(pbf_add_particles(s, 1, x, NULL, &first));
  assert_int_equal(first, UINT32_MAX);
  assert_fails(pbf_add_particles(s, 1, x, NULL, &first), PBF_ERROR_CAPACITY, "4294967296");
  free(saved);
  pbf_destroy(s);
}

static void refused_by(uint32_t dimension, uint32_t precision) {
  if (dimension == 2 && precision == PBF_FLOAT64) return; /* it has the state's own kind */
  uint64_t size;
  pbf_solver *a = busy_solver(2, PBF_FLOAT64), *other = test_solver(dimension, precision, 40);
  void *saved = test_save(a, &size);
  assert_fails(pbf_load(other, saved, size), PBF_ERROR_DATA, "this solver is");
  free(saved);
  pbf_destroy(a);
  pbf_destroy(other);
}

static void of_another_kind(void **state) {
  (void)state;
  test_for_each_kind(refused_by);
}

static void more_than_there_is_room_for(void **state) {
  (void)state;
  uint64_t size;
  pbf_solver *a = busy_solver(2, PBF_FLOAT64), *small = test_solver(2, PBF_FLOAT64, 26);
  void *saved = test_save(a, &size);
  assert_fails(pbf_load(small, saved, size), PBF_ERROR_CAPACITY, "has 27 particles");
  free(saved);
  pbf_destroy(a);
  pbf_destroy(small);
}

/* FNV-1a by hand over step, count, ids, positions and velocities. */
static uint64_t fnv(uint64_t hash, const void *data, size_t size) {
  const unsigned char *bytes = data;
  for (size_t i = 0; i < size; ++i) hash = (hash ^ bytes[i]) * UINT64_C(0x100000001b3);
  return hash;
}

static void hash_is_the_stated_one(void **state) {
  (void)state;
  pbf_solver *s = busy_solver(2, PBF_FLOAT64);
  uint32_t ids[27], count = 27;
  double x[54], v[54];
  uint64_t step = 5;
  assert_ok(pbf_get_ids(s, 0, 27, ids));
  assert_ok(pbf_get_positions(s, 0, 27, x));
  assert_ok(pbf_get_velocities(s, 0, 27, v));
  uint64_t expected = fnv(UINT64_C(0xcbf29ce484222325), &step, 8);
  expected = fnv(expected, &count, 4);
  expected = fnv(expected, ids, sizeof ids);
  expected = fnv(expected, x, sizeof x);
  expected = fnv(expected, v, sizeof v);
  assert_int_equal(test_hash(s), expected);
  pbf_destroy(s);
}

static void hash_sees_everything(void **state) {
  (void)state;
  pbf_solver *s = test_filled(3, PBF_FLOAT32, 4, 8);
  uint64_t seen[6];
  float v[3] = {0, 0, 1e-30f};
  seen[0] = test_hash(s);
  assert_ok(pbf_set_velocities(s, 3, 1, v));
  seen[1] = test_hash(s);
  assert_ok(pbf_remove_particles(s, 1, (const uint32_t[]){0}));
  seen[2] = test_hash(s);
  assert_ok(pbf_step(s, 1));
  seen[3] = test_hash(s);
  float x[3];
  assert_ok(pbf_get_positions(s, 0, 1, x));
  x[0] = nextafterf(x[0], 0.5f);
  assert_ok(pbf_set_positions(s, 0, 1, x));
  seen[4] = test_hash(s);
  assert_ok(pbf_remove_particles(s, 3, (const uint32_t[]){1, 2, 3}));
  seen[5] = test_hash(s);
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < i; ++j)
      if (seen[i] == seen[j]) fail_msg("changes %d and %d have the same hash", j, i);
  pbf_destroy(s);
}

int main(void) {
  const struct CMUnitTest state[] = {
      cmocka_unit_test(continuation),
      cmocka_unit_test(saving_twice_gives_the_same),
      cmocka_unit_test(an_empty_solver),
      cmocka_unit_test(room_for_saving),
      cmocka_unit_test(cut_at_every_length),
      cmocka_unit_test(every_byte_flipped),
      cmocka_unit_test(every_byte_forged),
      cmocka_unit_test(forged_headers),
      cmocka_unit_test(forged_ids),
      cmocka_unit_test(ids_run_out),
      cmocka_unit_test(of_another_kind),
      cmocka_unit_test(more_than_there_is_room_for),
      cmocka_unit_test(hash_is_the_stated_one),
      cmocka_unit_test(hash_sees_everything),
  };
  return TEST_RUN(state);
}
