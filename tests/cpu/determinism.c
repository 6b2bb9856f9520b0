/* pbf_desc.determinism: bits of this machine's own, which are still the same for any number of
 * threads, any capacity and all sets with fused multiply-add, and as near to the reference. */
#include "cpu_support.h"

static const char *const fused_sets[] = {"neon", "avx2", "avx512"};

static void moving(pbf_params *params) {
  params->viscosity = 0.05;
  params->time_step = 4e-3;
}

typedef struct choice {
  const char *backend, *isa;
  uint32_t threads, spare; /* room beyond the particles */
  uint32_t determinism;
} choice;

/* Null where the machine or the build lacks the set. */
static pbf_solver *run(const cpu_block *block, uint32_t precision, choice of) {
  pbf_desc desc =
      cpu_desc(of.backend, block->dimension, precision, block->count + of.spare, of.threads);
  pbf_params params = cpu_block_params();
  pbf_solver *solver = NULL;
  moving(&params);
  desc.isa = of.isa;
  desc.determinism = of.determinism;
  if (pbf_create(&desc, &params, &solver) != PBF_OK) {
    assert_non_null(of.isa);
    return NULL;
  }
  cpu_add(solver, precision, block->dimension, block->count, block->x, block->v);
  assert_ok(pbf_step(solver, 10));
  return solver;
}

static uint64_t hash_of(pbf_solver *solver) {
  uint64_t hash;
  assert_ok(pbf_hash(solver, &hash));
  return hash;
}

/* 0 where there is no solver. */
static uint64_t hash_with(const cpu_block *block, uint32_t precision, choice of, int *is_fused) {
  pbf_solver *solver = run(block, precision, of);
  if (!solver) return 0;
  pbf_plan plan = {.struct_size = sizeof plan};
  pbf_info info = {.struct_size = sizeof info};
  assert_ok(pbf_get_plan(solver, &plan));
  assert_ok(pbf_get_info(solver, &info));
  *is_fused = strstr(plan.variant, "-fused") != NULL;
  assert_true(*is_fused == (strstr(info.device_name, "-fused)") != NULL));
  const uint64_t hash = hash_of(solver);
  pbf_destroy(solver);
  return hash;
}

static void compare(uint32_t dimension, uint32_t precision) {
  enum { ACROSS = PBF_DETERMINISM_ACROSS_MACHINES, PER = PBF_DETERMINISM_PER_MACHINE };
  cpu_block block = cpu_make_block(dimension);
  int is_fused;
  const uint64_t across =
      hash_with(&block, precision, (choice){"serial", NULL, 1, 0, ACROSS}, &is_fused);
  assert_false(is_fused);
  const uint64_t scalar =
      hash_with(&block, precision, (choice){"serial", "scalar", 1, 0, PER}, &is_fused);
  if (scalar) assert_false(is_fused);
  if (scalar) assert_true(scalar == across);
  for (size_t k = 0; k < sizeof fused_sets / sizeof fused_sets[0]; ++k) {
    const char *set = fused_sets[k];
    const uint64_t first =
        hash_with(&block, precision, (choice){"serial", set, 1, 0, PER}, &is_fused);
    if (!first) continue;
    assert_true(is_fused == (precision == PBF_FLOAT32));
    assert_true((first != across) == is_fused);
    const choice others[] = {{"serial", NULL, 1, 7, PER},
                             {"threads", set, 2, 1000, PER},
                             {"openmp", set, 3, 1, PER},
                             {"serial", set, 1, 0, PER}};
    for (size_t n = 0; n < sizeof others / sizeof others[0]; ++n) {
      const uint64_t other = hash_with(&block, precision, others[n], &is_fused);
      assert_true(other == first);
    }
  }
  cpu_free_block(&block);
}

static void a_machine_has_bits_of_its_own(void **state) {
  (void)state;
  test_for_each_kind(compare);
}

/* Rounding less often is not further from what float64 makes of it. */
static void it_is_as_near_to_the_reference(void **state) {
  (void)state;
  for (uint32_t dimension = 2; dimension <= 3; ++dimension) {
    if (!test_has_reference(dimension, PBF_FLOAT64)) continue;
    cpu_block block = cpu_make_block(dimension);
    double off[2];
    pbf_solver *exact = run(&block, PBF_FLOAT64, (choice){"reference", NULL, 1, 0, 0});
    for (uint32_t k = 0; k < 2; ++k) {
      pbf_solver *solver = run(&block, PBF_FLOAT32, (choice){"serial", NULL, 1, 0, k});
      off[k] = cpu_difference(exact, solver, PBF_FIELD_POSITION);
      pbf_destroy(solver);
    }
    if (off[1] > 1.5 * off[0])
      fail_msg("%uD: off by %.3g, and %.3g across machines", dimension, off[1], off[0]);
    pbf_destroy(exact);
    cpu_free_block(&block);
  }
}

static void an_unknown_choice_is_refused(void **state) {
  (void)state;
  pbf_solver *solver = NULL;
  pbf_desc desc = cpu_desc("serial", 3, PBF_FLOAT32, 10, 1);
  desc.determinism = 2;
  assert_fails(pbf_create(&desc, NULL, &solver), PBF_ERROR_INVALID_ARGUMENT,
               "desc.determinism is 2");
  desc.determinism = 0;
  desc.reserved = 1;
  assert_fails(pbf_create(&desc, NULL, &solver), PBF_ERROR_INVALID_ARGUMENT, "desc.reserved is 1");
  assert_null(solver);
}

/* A description from before there was a choice is of all machines. */
static void an_older_description_has_no_choice(void **state) {
  (void)state;
  pbf_desc desc = cpu_desc("serial", 3, PBF_FLOAT32, 10, 1);
  pbf_plan plan = {.struct_size = sizeof plan};
  pbf_solver *solver = NULL;
  desc.struct_size = offsetof(pbf_desc, determinism);
  desc.determinism = PBF_DETERMINISM_PER_MACHINE;
  assert_ok(pbf_create(&desc, NULL, &solver));
  assert_ok(pbf_get_plan(solver, &plan));
  assert_null(strstr(plan.variant, "fused"));
  pbf_destroy(solver);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_machine_has_bits_of_its_own),
      cmocka_unit_test(it_is_as_near_to_the_reference),
      cmocka_unit_test(an_unknown_choice_is_refused),
      cmocka_unit_test(an_older_description_has_no_choice),
  };
  return TEST_RUN(tests);
}
