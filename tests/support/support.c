#include "support.h"

#include <stdio.h>

#if defined(_WIN32)
#include <windows.h>
#else
#include <dlfcn.h>
#endif

void test_assert_status(pbf_status status, pbf_status expected, const char *words, const char *call,
                        const char *file, int line) {
  int says_why = expected == PBF_OK || strstr(pbf_last_error(), words) != NULL;
  if (status == expected && says_why) return;
  print_error("%s: %s (\"%s\"), expected %s with \"%s\"\n", call, pbf_status_string(status),
              pbf_last_error(), pbf_status_string(expected), words);
  _fail(file, line);
}

static const char stub_path[] = PBF_STUB_DIR "/ballistic.so";

const char *test_backend(void) {
  const char *name = getenv("PBF_TEST_BACKEND");
  if (!name || !name[0]) name = "ballistic";
  if (strcmp(name, "ballistic") == 0) assert_ok(pbf_load_backend(stub_path));
  return name;
}

int test_is_stub(void) { return strcmp(test_backend(), "ballistic") == 0; }

/* Whether the backend under test was built without it; `info` then says so. */
static int lacks_kind(uint32_t dimension, uint32_t precision, pbf_backend_info *info) {
  pbf_desc desc;
  *info = (pbf_backend_info){.struct_size = sizeof *info};
  assert_ok(pbf_desc_init(&desc, sizeof desc));
  desc.dimension = dimension;
  desc.precision = precision;
  for (uint32_t i = 0; pbf_get_backend_info(&desc, i, info) == PBF_OK; ++i)
    if (strcmp(info->name, test_backend()) == 0 && strstr(info->reason, "built without ")) return 1;
  return 0;
}

/* Only a device may be missing: a CPU backend that was built and can't serve is a failure. */
static int lacks_device(void) {
  pbf_backend_info unused;
  if (lacks_kind(3, PBF_FLOAT32, &unused)) return 0;
  pbf_desc desc = test_desc(3, PBF_FLOAT32, 1000);
  pbf_solver *solver = NULL;
  desc.allocator = NULL;
  pbf_status status = pbf_create(&desc, NULL, &solver);
  pbf_destroy(solver);
  return status == PBF_ERROR_UNAVAILABLE && strcmp(desc.backend, "cuda") == 0;
}

int test_run(const char *name, const struct CMUnitTest *tests, size_t count) {
  if (!test_is_stub() && lacks_device()) {
    printf("skipped: %s\n", pbf_last_error());
    return TEST_SKIPPED;
  }
  return _cmocka_run_group_tests(name, tests, count, NULL, NULL);
}

/* Of the stub, which is loaded. */
static void *stub_symbol(const char *name) {
#if defined(_WIN32)
  return (void *)(uintptr_t)GetProcAddress(GetModuleHandleA(stub_path), name);
#else
  void *library = dlopen(stub_path, RTLD_NOW | RTLD_NOLOAD);
  assert_non_null(library);
  void *symbol = dlsym(library, name);
  dlclose(library);
  return symbol;
#endif
}

ballistic_control *test_stub_control(void) {
  static ballistic_control *control;
  if (!control) {
    test_backend();
    control = stub_symbol("stub_control");
    assert_non_null(control);
  }
  *control = (ballistic_control){.lie = BALLISTIC_HONEST};
  return control;
}

int test_has_stage(pbf_solver *solver, const char *name) {
  int found = 0;
  pbf_plan plan = {.struct_size = sizeof plan};
  assert_ok(pbf_get_plan(solver, &plan));
  for (uint32_t k = 0; k < plan.stage_count; ++k) found |= !strcmp(plan.stages[k].name, name);
  return found;
}

void test_skip(const char *why) {
  print_message("skipped: %s\n", why);
  skip();
}

int test_has_reference(uint32_t dimension, uint32_t precision) {
  const pbf_desc desc = test_desc(dimension, precision, 1);
  pbf_backend_info info = {.struct_size = sizeof info};
  for (uint32_t i = 0; pbf_get_backend_info(&desc, i, &info) == PBF_OK; ++i)
    if (strcmp(info.name, "reference") == 0 && info.available) return 1;
  return 0;
}

void test_skip_if_watched(void) {
  if (TEST_INSTRUMENTED && !test_is_long()) test_skip("it follows a fluid for long");
}

void test_steps_without_memory(pbf_solver *s, pbf_solver *other, int steps) {
  uint32_t failed = 0;
  for (int step = 0; step < steps; ++step) {
    assert_ok(pbf_step(other, 1));
    for (uint64_t n = 1;; ++n) {
      test_count.failing_call = test_count.calls + n;
      const pbf_status status = pbf_step(s, 1);
      test_count.failing_call = 0;
      if (status == PBF_OK) break;
      assert_int_equal(status, PBF_ERROR_OUT_OF_MEMORY);
      ++failed;
    }
  }
  assert_true(failed > 10 && test_hash(s) == test_hash(other));
}

pbf_desc test_desc(uint32_t dimension, uint32_t precision, uint32_t capacity) {
  pbf_desc desc;
  pbf_backend_info info;
  if (lacks_kind(dimension, precision, &info)) test_skip(info.reason);
  assert_ok(pbf_desc_init(&desc, sizeof desc));
  desc.dimension = dimension;
  desc.precision = precision;
  desc.capacity = capacity;
  desc.backend = test_backend();
  desc.strict = 1;
  desc.threads = 2;
  desc.allocator = &test_allocator;
  return desc;
}

pbf_params test_params(void) {
  pbf_params params;
  assert_ok(pbf_params_init(&params, sizeof params));
  return params;
}

pbf_solver *test_create(const pbf_desc *desc, const pbf_params *params) {
  pbf_solver *solver = NULL;
  assert_ok(pbf_create(desc, params, &solver));
  assert_non_null(solver);
  return solver;
}

pbf_solver *test_solver(uint32_t dimension, uint32_t precision, uint32_t capacity) {
  pbf_desc desc = test_desc(dimension, precision, capacity);
  return test_create(&desc, NULL);
}

int test_has_kind(uint32_t dimension, uint32_t precision) {
  pbf_backend_info unused;
  return !lacks_kind(dimension, precision, &unused);
}

static void with_kind(void (*function)(uint32_t, uint32_t), uint32_t dimension,
                      uint32_t precision) {
  if (test_has_kind(dimension, precision)) function(dimension, precision);
}

void test_for_each_kind(void (*function)(uint32_t dimension, uint32_t precision)) {
  for (uint32_t dimension = 2; dimension <= 3; ++dimension) {
    with_kind(function, dimension, PBF_FLOAT32);
    with_kind(function, dimension, PBF_FLOAT64);
  }
}

static int has_all_kinds_at_length(const char *backend) {
  if (strcmp(backend, "reference") == 0 || strcmp(backend, "threads") == 0) return 0;
  return strcmp(backend, "cuda") == 0 || (test_is_long() && !TEST_INSTRUMENTED);
}

void test_for_long_kinds(void (*function)(uint32_t dimension, uint32_t precision)) {
  if (has_all_kinds_at_length(test_backend())) {
    test_for_each_kind(function);
    return;
  }
  const int is_watched = TEST_INSTRUMENTED && !test_is_long();
  with_kind(function, 2, PBF_FLOAT64);
  if (strcmp(test_backend(), "reference") != 0 && !is_watched) with_kind(function, 3, PBF_FLOAT32);
}

double test_value(const void *values, uint64_t index, uint32_t precision) {
  return precision == PBF_FLOAT32 ? (double)((const float *)values)[index]
                                  : ((const double *)values)[index];
}

void test_put(void *values, uint64_t index, uint32_t precision, double value) {
  if (precision == PBF_FLOAT32) {
    ((float *)values)[index] = (float)value;
  } else {
    ((double *)values)[index] = value;
  }
}

void test_read(pbf_solver *solver, uint32_t dimension, uint32_t precision, uint32_t count,
               double *x, double *v) {
  const size_t numbers = (size_t)count * dimension;
  void *raw = calloc(numbers, precision);
  assert_non_null(raw);
  assert_ok(pbf_get_positions(solver, 0, count, raw));
  for (size_t i = 0; i < numbers; ++i) x[i] = test_value(raw, i, precision);
  assert_ok(pbf_get_velocities(solver, 0, count, raw));
  for (size_t i = 0; i < numbers; ++i) v[i] = test_value(raw, i, precision);
  free(raw);
}

void test_add_momenta(double sums[6], uint32_t dimension, double mass, const double *x,
                      const double *v) {
  double place[3] = {0}, way[3] = {0};
  memcpy(place, x, dimension * sizeof *x);
  memcpy(way, v, dimension * sizeof *v);
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3, last = (k + 2) % 3;
    sums[k] += mass * way[k];
    sums[3 + k] += mass * (place[next] * way[last] - place[last] * way[next]);
  }
}

void *test_lattice(uint32_t dimension, uint32_t precision, uint32_t count) {
  enum { SIDE = 8 };
  void *positions = calloc((size_t)count * dimension + 1, precision);
  assert_non_null(positions);
  for (uint32_t i = 0; i < count; ++i) {
    uint32_t rest = i;
    for (uint32_t axis = 0; axis < dimension; ++axis) {
      uint32_t place = axis + 1 < dimension ? rest % SIDE : rest;
      test_put(positions, (uint64_t)i * dimension + axis, precision, 0.25 + 0.05 * place);
      rest /= SIDE;
    }
  }
  return positions;
}

pbf_solver *test_filled(uint32_t dimension, uint32_t precision, uint32_t count, uint32_t capacity) {
  pbf_solver *solver = test_solver(dimension, precision, capacity);
  void *positions = test_lattice(dimension, precision, count);
  void *velocities = calloc((size_t)count * dimension + 1, precision);
  for (uint32_t i = 0; i < count; ++i)
    test_put(velocities, (uint64_t)i * dimension, precision, (i + 1) / 8.0);
  assert_ok(pbf_add_particles(solver, count, positions, velocities, NULL));
  free(positions);
  free(velocities);
  return solver;
}

uint64_t test_hash(pbf_solver *solver) {
  uint64_t hash = 0;
  assert_ok(pbf_hash(solver, &hash));
  return hash;
}

void *test_save(pbf_solver *solver, uint64_t *size) {
  assert_ok(pbf_save(solver, NULL, size));
  void *state = malloc(*size);
  assert_non_null(state);
  assert_ok(pbf_save(solver, state, size));
  return state;
}

static uint64_t with_word(uint64_t sum, uint64_t word) {
  sum = (sum ^ word) * UINT64_C(0x9e3779b97f4a7c15);
  return sum ^ sum >> 32;
}

void test_seal(void *state, uint64_t size) {
  uint64_t sums[4] = {1, 2, 3, 4};
  const unsigned char *bytes = state;
  for (uint64_t i = 0; i + 8 < size; i += 8) {
    uint64_t word = 0;
    memcpy(&word, bytes + i, size - 8 - i < 8 ? size - 8 - i : 8);
    sums[i / 8 % 4] = with_word(sums[i / 8 % 4], word);
  }
  for (int k = 1; k < 4; ++k) sums[0] = with_word(sums[0], sums[k]);
  memcpy((unsigned char *)state + size - 8, &sums[0], sizeof sums[0]);
}
