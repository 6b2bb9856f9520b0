/* Fields in the caller's own layout, against what the plain calls give, and positions between the
 * last two steps, against those that were read there. */
#include "support.h"

enum { COUNT = 60, CAPACITY = 80, STEPS = 4 };

typedef struct scene {
  pbf_solver *solver;
  uint32_t dimension, precision, count;
} scene;

static scene scene_of(uint32_t dimension, uint32_t precision) {
  scene s = {test_filled(dimension, precision, COUNT, CAPACITY), dimension, precision, COUNT};
  return s;
}

static const uint32_t gone[] = {0, 7, 30, 31, 59};

static void drop_some(scene *s) {
  const uint32_t count = sizeof gone / sizeof gone[0];
  assert_ok(pbf_remove_particles(s->solver, count, gone));
  s->count -= count;
}

/* What the plain calls give, as float64. */
static void get_plainly(const scene *s, uint32_t field, double *numbers) {
  double raw[3 * CAPACITY];
  const uint32_t components = field <= PBF_FIELD_VELOCITY ? s->dimension : 1;
  if (field == PBF_FIELD_POSITION) assert_ok(pbf_get_positions(s->solver, 0, s->count, raw));
  if (field == PBF_FIELD_VELOCITY) assert_ok(pbf_get_velocities(s->solver, 0, s->count, raw));
  if (field == PBF_FIELD_DENSITY) assert_ok(pbf_get_densities(s->solver, 0, s->count, raw));
  if (field == PBF_FIELD_PRESSURE) assert_ok(pbf_get_pressures(s->solver, 0, s->count, raw));
  for (uint32_t i = 0; i < s->count * components; ++i)
    numbers[i] = test_value(raw, i, s->precision);
}

/* ---- Layouts --------------------------------------------------------------------------------- */

enum { ROOM = 64, GUARD = 0x5b };

static unsigned char room[CAPACITY * ROOM];

static double number_in(const unsigned char *at, uint32_t type, uint32_t k) {
  float single;
  double number;
  memcpy(&single, at + k * sizeof single, sizeof single);
  memcpy(&number, at + k * sizeof number, sizeof number);
  return type == PBF_TYPE_FLOAT32 ? (double)single : number;
}

/* Rows in the order in which they were written. */
static void find_rows(const scene *s, const pbf_read_desc *read, uint32_t *rows) {
  uint32_t ids[CAPACITY], all[CAPACITY];
  pbf_read_desc of_ids = {.struct_size = sizeof of_ids,
                          .field = PBF_FIELD_ID,
                          .first = read->first,
                          .count = read->count,
                          .order = read->order,
                          .data = ids};
  assert_ok(pbf_read(s->solver, &of_ids));
  assert_ok(pbf_get_ids(s->solver, 0, s->count, all));
  for (uint32_t i = 0; i < read->count; ++i)
    for (rows[i] = 0; rows[i] < s->count && all[rows[i]] != ids[i];) ++rows[i];
}

static double w_expected(const scene *s, const pbf_read_desc *read, uint32_t row) {
  double numbers[3 * CAPACITY] = {0}, sum = 0;
  if (read->w == PBF_W_CONSTANT) return read->w_value;
  get_plainly(s,
              read->w == PBF_W_SPEED     ? PBF_FIELD_VELOCITY
              : read->w == PBF_W_DENSITY ? PBF_FIELD_DENSITY
                                         : PBF_FIELD_PRESSURE,
              numbers);
  if (read->w != PBF_W_SPEED) return numbers[row];
  for (uint32_t k = 0; k < s->dimension; ++k) sum += pow(numbers[row * s->dimension + k], 2);
  return sqrt(sum);
}

static void check_number(const pbf_read_desc *read, uint32_t type, const unsigned char *at,
                         uint32_t k, double expected) {
  const double found = number_in(at, type, k);
  const double rounded = type == PBF_TYPE_FLOAT32 ? (double)(float)expected : expected;
  if (found < rounded || found > rounded)
    fail_msg("field %u, order %u, w %u: number %u is %.17g, not %.17g", read->field, read->order,
             read->w, k, found, rounded);
}

/* Of a reading that begins at room[ROOM]. */
static void check_read(const scene *s, pbf_read_desc read) {
  double plain[3 * CAPACITY] = {0};
  uint32_t rows[CAPACITY];
  const uint32_t type = read.element_type ? read.element_type : s->precision, size = type;
  const uint32_t own = read.field <= PBF_FIELD_VELOCITY ? s->dimension : 1;
  const uint32_t written = read.components ? read.components : own;
  const uint64_t stride = read.stride ? read.stride : written * size;
  memset(room, GUARD, sizeof room);
  read.struct_size = sizeof read;
  read.data = room + ROOM;
  assert_ok(pbf_read(s->solver, &read));
  get_plainly(s, read.field, plain);
  find_rows(s, &read, rows);
  for (uint32_t i = 0; i < read.count; ++i) {
    const unsigned char *at = room + ROOM + i * stride;
    assert_true(rows[i] - read.first < read.count);
    if (read.order == PBF_ORDER_ADDED) assert_int_equal(rows[i], read.first + i);
    for (uint32_t k = 0; k < written; ++k)
      check_number(&read, type, at, k,
                   k < own  ? plain[rows[i] * own + k]
                   : k == 3 ? w_expected(s, &read, rows[i])
                            : 0);
    for (uint64_t b = written * size; b < stride; ++b) assert_int_equal(at[b], GUARD);
  }
  for (uint32_t b = 0; b < ROOM; ++b) assert_int_equal(room[b], GUARD);
  assert_int_equal(room[ROOM + read.count * stride], GUARD);
}

static void check_vectors(const scene *s, uint32_t field, uint32_t order, uint32_t type) {
  const uint32_t size = type ? type : s->precision;
  pbf_read_desc read = {.field = field, .count = s->count, .order = order, .element_type = type};
  check_read(s, read);
  for (read.components = s->dimension; read.components <= 4; ++read.components) {
    read.w_value = 0.25;
    read.stride = 0;
    check_read(s, read);
    read.stride = 5 * size;
    check_read(s, read);
  }
}

static void check_w(const scene *s, uint32_t order, uint32_t type) {
  pbf_read_desc read = {.field = PBF_FIELD_POSITION,
                        .count = s->count,
                        .order = order,
                        .element_type = type,
                        .components = 4};
  const uint32_t last = test_is_stub() ? PBF_W_DENSITY : PBF_W_PRESSURE;
  for (read.w = PBF_W_SPEED; read.w <= last; ++read.w) check_read(s, read);
}

static void check_scalars(const scene *s, uint32_t type) {
  pbf_read_desc read = {.field = PBF_FIELD_DENSITY, .count = s->count, .element_type = type};
  check_read(s, read);
  read.stride = 3 * (type ? type : s->precision);
  check_read(s, read);
  if (!test_is_stub()) read.field = PBF_FIELD_PRESSURE;
  check_read(s, read);
}

static void check_all_layouts(const scene *s) {
  static const uint32_t types[] = {0, PBF_TYPE_FLOAT32, PBF_TYPE_FLOAT64};
  for (int t = 0; t < 3; ++t) {
    for (uint32_t order = PBF_ORDER_ADDED; order <= PBF_ORDER_STORED; ++order) {
      check_vectors(s, PBF_FIELD_POSITION, order, types[t]);
      check_vectors(s, PBF_FIELD_VELOCITY, order, types[t]);
      check_w(s, order, types[t]);
    }
    check_scalars(s, types[t]);
    check_read(s, (pbf_read_desc){.field = PBF_FIELD_VELOCITY,
                                  .first = 9,
                                  .count = 20,
                                  .components = 4,
                                  .w = PBF_W_DENSITY,
                                  .element_type = types[t]});
  }
}

static void check_layouts(uint32_t dimension, uint32_t precision) {
  scene s = scene_of(dimension, precision);
  assert_ok(pbf_step(s.solver, STEPS));
  check_all_layouts(&s);
  drop_some(&s);
  assert_ok(pbf_step(s.solver, 1));
  check_all_layouts(&s);
  pbf_destroy(s.solver);
}

static void layouts(void **state) {
  (void)state;
  test_for_each_kind(check_layouts);
}

/* Ids so far apart that they are searched for. */
static void ids_may_be_far_apart(void **state) {
  (void)state;
  scene s = scene_of(3, PBF_FLOAT32);
  void *x = test_lattice(3, PBF_FLOAT32, 20);
  for (int k = 0; k < 100; ++k) {
    uint32_t ids[20], first;
    assert_ok(pbf_add_particles(s.solver, 20, x, NULL, &first));
    for (uint32_t i = 0; i < 20; ++i) ids[i] = first + i;
    if (k < 99) assert_ok(pbf_remove_particles(s.solver, 20, ids));
  }
  s.count += 20;
  check_all_layouts(&s);
  free(x);
  pbf_destroy(s.solver);
}

/* ---- Between two steps ----------------------------------------------------------------------- */

static void check_between(const scene *s, const double *before, double behind) {
  double now[3 * CAPACITY] = {0}, read_as[4 * CAPACITY];
  get_plainly(s, PBF_FIELD_POSITION, now);
  for (uint32_t components = s->dimension; components <= 4; ++components) {
    const pbf_read_desc read = {.struct_size = sizeof read,
                                .field = PBF_FIELD_POSITION,
                                .count = s->count,
                                .element_type = PBF_TYPE_FLOAT64,
                                .components = components,
                                .behind = behind,
                                .data = read_as};
    assert_ok(pbf_read(s->solver, &read));
    for (uint32_t i = 0; i < s->count; ++i)
      for (uint32_t k = 0; k < s->dimension; ++k) {
        const uint32_t at = i * s->dimension + k;
        const double expected = (1 - behind) * now[at] + behind * before[at];
        if (!(fabs(read_as[i * components + k] - expected) < 1e-12))
          fail_msg("%g behind: %.17g, not %.17g", behind, read_as[i * components + k], expected);
      }
  }
}

static void check_all_between(const scene *s, const double *before) {
  check_between(s, before, 0);
  check_between(s, before, 0.25);
  check_between(s, before, 1);
}

/* The same as a solver that keeps nothing, which is asked before its last step. */
static void check_behind(uint32_t dimension, uint32_t precision) {
  scene s = scene_of(dimension, precision), other = scene_of(dimension, precision);
  double before[3 * CAPACITY] = {0}, now[3 * CAPACITY] = {0};
  assert_ok(pbf_keep_previous(s.solver, 1));
  get_plainly(&s, PBF_FIELD_POSITION, before);
  check_all_between(&s, before); /* no step was made */
  assert_ok(pbf_step(other.solver, STEPS - 1));
  get_plainly(&other, PBF_FIELD_POSITION, before);
  assert_ok(pbf_step(other.solver, 1));
  assert_ok(pbf_step(s.solver, STEPS));
  assert_true(test_hash(s.solver) == test_hash(other.solver));
  check_all_between(&s, before);
  get_plainly(&s, PBF_FIELD_POSITION, before);
  assert_ok(pbf_step(s.solver, 1));
  check_all_between(&s, before);
  get_plainly(&s, PBF_FIELD_POSITION, now);
  assert_true(memcmp(now, before, sizeof(double) * dimension * s.count) != 0);
  pbf_destroy(other.solver);
  pbf_destroy(s.solver);
}

static void positions_between_steps(void **state) {
  (void)state;
  test_for_each_kind(check_behind);
}

/* Row by row: those that are removed, added and set elsewhere. */
static void check_changed(uint32_t dimension, uint32_t precision) {
  scene s = scene_of(dimension, precision);
  double before[3 * CAPACITY] = {0}, now[3 * CAPACITY] = {0}, set[3 * 4];
  uint32_t kept = 0, next = 0;
  void *x = test_lattice(dimension, precision, 4);
  assert_ok(pbf_keep_previous(s.solver, 1));
  get_plainly(&s, PBF_FIELD_POSITION, before);
  assert_ok(pbf_step(s.solver, 1));
  drop_some(&s);
  for (uint32_t row = 0; row < COUNT; ++row) {
    if (next < COUNT - s.count && gone[next] == row) {
      ++next;
      continue;
    }
    memmove(before + kept++ * dimension, before + row * dimension, dimension * sizeof *before);
  }
  check_all_between(&s, before);
  assert_ok(pbf_set_positions(s.solver, 2, 4, x));
  for (uint32_t i = 0; i < 4 * dimension; ++i) set[i] = test_value(x, i, precision);
  memcpy(before + 2 * dimension, set, 4 * dimension * sizeof *before);
  check_all_between(&s, before);
  assert_ok(pbf_add_particles(s.solver, 4, x, NULL, NULL));
  s.count += 4;
  get_plainly(&s, PBF_FIELD_POSITION, now);
  memcpy(before + kept * dimension, now + kept * dimension, 4 * dimension * sizeof *before);
  check_all_between(&s, before);
  assert_ok(pbf_set_positions(s.solver, s.count - 2, 2, x)); /* that were not there before */
  get_plainly(&s, PBF_FIELD_POSITION, now);
  memcpy(before + kept * dimension, now + kept * dimension, 4 * dimension * sizeof *before);
  check_all_between(&s, before);
  free(x);
  pbf_destroy(s.solver);
}

static void what_is_changed_has_been_there(void **state) {
  (void)state;
  test_for_each_kind(check_changed);
}

static void a_load_has_no_step_before(void **state) {
  (void)state;
  scene s = scene_of(3, PBF_FLOAT32);
  double now[3 * CAPACITY] = {0};
  uint64_t size;
  assert_ok(pbf_keep_previous(s.solver, 1));
  assert_ok(pbf_step(s.solver, 2));
  void *saved = test_save(s.solver, &size);
  assert_ok(pbf_step(s.solver, 2));
  assert_ok(pbf_load(s.solver, saved, size));
  get_plainly(&s, PBF_FIELD_POSITION, now);
  check_all_between(&s, now);
  free(saved);
  pbf_destroy(s.solver);
}

/* Without being asked for, nothing is held or read. */
static void kept_on_request_only(void **state) {
  (void)state;
  scene s = scene_of(3, PBF_FLOAT32);
  pbf_plan plan = {.struct_size = sizeof plan};
  assert_ok(pbf_step(s.solver, 1));
  const uint64_t bytes = test_count.live_bytes;
  assert_ok(pbf_keep_previous(s.solver, 1));
  assert_ok(pbf_keep_previous(s.solver, 1));
  assert_int_equal(test_count.live_bytes - bytes, CAPACITY * 3 * sizeof(float));
  assert_ok(pbf_get_plan(s.solver, &plan));
  assert_string_equal(plan.arrays[plan.array_count - 1].name, "previous position (host)");
  assert_int_equal(plan.arrays[plan.array_count - 1].bytes, CAPACITY * 3 * sizeof(float));
  const uint64_t calls = test_count.calls;
  assert_ok(pbf_step(s.solver, 3));
  assert_int_equal(test_count.calls, calls);
  assert_ok(pbf_keep_previous(s.solver, 0));
  assert_int_equal(test_count.live_bytes, bytes);
  pbf_destroy(s.solver);
}

/* ---- Refusals -------------------------------------------------------------------------------- */

#define REFUSED(member, value, words)                                            \
  do {                                                                           \
    pbf_read_desc wrong = good;                                                  \
    wrong.member = value;                                                        \
    assert_fails(pbf_read(s.solver, &wrong), PBF_ERROR_INVALID_ARGUMENT, words); \
  } while (0)

static void refusals(void **state) {
  (void)state;
  scene s = scene_of(3, PBF_FLOAT32);
  float x[4 * COUNT];
  pbf_read_desc good = {.struct_size = sizeof good,
                        .field = PBF_FIELD_POSITION,
                        .count = COUNT,
                        .components = 4,
                        .data = x};
  assert_ok(pbf_read(s.solver, &good));
  assert_fails(pbf_read(s.solver, NULL), PBF_ERROR_INVALID_ARGUMENT, "read is null");
  assert_fails(pbf_read(NULL, &good), PBF_ERROR_INVALID_ARGUMENT, "solver is null");
  REFUSED(field, 0, "read.field is 0");
  REFUSED(field, 6, "read.field is 6");
  REFUSED(first, 1, "first is 1 and count 60");
  REFUSED(count, COUNT + 1, "holds 60 particles");
  REFUSED(element_type, PBF_TYPE_UINT32, "read.element_type is 12");
  REFUSED(components, 2, "read.components is 2; it must be 3, 4 or 0");
  REFUSED(components, 5, "read.components is 5");
  REFUSED(w, 4, "read.w is 4");
  REFUSED(order, 2, "read.order is 2");
  REFUSED(stride, 12, "read.stride is 12; it must be a multiple of 4 from 16");
  REFUSED(stride, 18, "read.stride is 18");
  REFUSED(data, NULL, "read.data is null");
  REFUSED(data, (char *)x + 1, "aligned to 4 bytes");
  REFUSED(behind, 1.5, "read.behind is 1.5");
  REFUSED(behind, -0.5, "read.behind is -0.5");
  REFUSED(behind, NAN, "read.behind is NaN");
  REFUSED(w_value, INFINITY, "read.w_value is");
  good.behind = 0.5;
  assert_fails(pbf_read(s.solver, &good), PBF_ERROR_STATE, "pbf_keep_previous(solver, 1)");
  assert_ok(pbf_keep_previous(s.solver, 1));
  assert_ok(pbf_read(s.solver, &good));
  REFUSED(field, PBF_FIELD_VELOCITY, "but for positions");
  good.behind = 0;
  good.count = COUNT - 1;
  REFUSED(order, PBF_ORDER_STORED, "all particles are read, 0 and 60");
  good.components = 3;
  REFUSED(field, PBF_FIELD_DENSITY, "the field is a number");
  good.components = 0;
  good.element_type = PBF_TYPE_FLOAT32;
  REFUSED(field, PBF_FIELD_ID, "read.element_type is 4; it must be 12");
  good.count = 0;
  good.data = NULL;
  assert_ok(pbf_read(s.solver, &good));
  good.struct_size = 8;
  assert_fails(pbf_read(s.solver, &good), PBF_ERROR_STRUCT_SIZE, "pbf_read_desc");
  assert_fails(pbf_keep_previous(s.solver, 2), PBF_ERROR_INVALID_ARGUMENT, "enabled is 2");
  pbf_destroy(s.solver);
}

static void pressures_want_their_solver(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub keeps no pressures");
  scene s = scene_of(3, PBF_FLOAT32);
  float x[4 * COUNT];
  pbf_params params = test_params();
  params.solver = PBF_SOLVER_JACOBI;
  assert_ok(pbf_set_params(s.solver, &params));
  pbf_read_desc read = {.struct_size = sizeof read,
                        .field = PBF_FIELD_POSITION,
                        .count = COUNT,
                        .components = 4,
                        .w = PBF_W_PRESSURE,
                        .data = x};
  assert_fails(pbf_read(s.solver, &read), PBF_ERROR_UNSUPPORTED, "PBF_SOLVER_JACOBI");
  read.components = 0;
  read.field = PBF_FIELD_PRESSURE;
  assert_fails(pbf_read(s.solver, &read), PBF_ERROR_UNSUPPORTED, "PBF_SOLVER_JACOBI");
  pbf_destroy(s.solver);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(layouts),
      cmocka_unit_test(ids_may_be_far_apart),
      cmocka_unit_test(positions_between_steps),
      cmocka_unit_test(what_is_changed_has_been_there),
      cmocka_unit_test(a_load_has_no_step_before),
      cmocka_unit_test(kept_on_request_only),
      cmocka_unit_test(refusals),
      cmocka_unit_test(pressures_want_their_solver),
  };
  return TEST_RUN(tests);
}
