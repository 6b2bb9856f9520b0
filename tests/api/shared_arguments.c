/* Arrays that another thread writes to while a call reads them, as those of NumPy, which others see
 * while a call runs: what is taken is what was checked, and nothing beyond them is looked at. */
#include <pthread.h>
#include <stdatomic.h>

#include <pbf/emit.h>
#include <pbf/phases.h>

#include "child.h"
#include "support.h"

enum { COUNT = 40, CALLS = TEST_INSTRUMENTED ? 2000 : 20000 };

/* ---- Phases of particles --------------------------------------------------------------------- */

static uint32_t *written; /* to by each allocation, unless null */

static void *allocate(void *user, uint64_t size, uint64_t alignment) {
  if (written) written[COUNT / 2] = 200;
  return test_allocator.allocate(user, size, alignment);
}

static void phases_are_those_that_were_checked(void **state) {
  (void)state;
  uint32_t phases[COUNT] = {0}, now[COUNT];
  pbf_phase of[2];
  pbf_desc desc = test_desc(2, PBF_FLOAT32, COUNT);
  pbf_allocator memory = test_allocator;
  const pbf_params params = test_params();
  memory.allocate = allocate;
  desc.allocator = &memory;
  pbf_solver *s = test_create(&desc, &params);
  float *x = test_lattice(2, PBF_FLOAT32, COUNT);
  assert_ok(pbf_add_particles(s, COUNT, x, NULL, NULL));
  for (int i = 0; i < 2; ++i) assert_ok(pbf_phase_init(&of[i], sizeof of[i]));
  assert_ok(pbf_set_phases(s, 2, of));
  written = phases;
  const pbf_status status = pbf_set_particle_phases(s, 0, COUNT, phases);
  written = NULL;
  assert_true(status == PBF_OK || status == PBF_ERROR_INVALID_ARGUMENT);
  assert_ok(pbf_get_particle_phases(s, 0, COUNT, now));
  for (int i = 0; i < COUNT; ++i) assert_true(now[i] < 2);
  free(x);
  pbf_destroy(s);
}

/* ---- Sizes of structs ------------------------------------------------------------------------ */

typedef struct shared {
  uint32_t *size; /* of the first struct of an array */
  uint32_t right;
  atomic_int stop;
} shared;

static void *write_sizes(void *user) {
  shared *s = user;
  volatile uint32_t *size = s->size;
  while (!atomic_load_explicit(&s->stop, memory_order_relaxed)) {
    *size = 0x7fffffff; /* a second one of that size lies far beyond all arrays */
    *size = s->right;
  }
  return NULL;
}

typedef struct setting {
  pbf_status (*set)(pbf_solver *solver, void *array);
  void *array;
  uint32_t size; /* of a struct */
} setting;

static pbf_status set_emitters(pbf_solver *solver, void *array) {
  return pbf_set_emitters(solver, PBF_MAX_EMITTERS, array);
}

static pbf_status set_drains(pbf_solver *solver, void *array) {
  return pbf_set_drains(solver, PBF_MAX_DRAINS, array);
}

static pbf_status set_reservoirs(pbf_solver *solver, void *array) {
  return pbf_set_reservoirs(solver, PBF_MAX_RESERVOIRS, array);
}

/* Ends the process where a call looks beyond the array. */
static int set_often(void *context) {
  const setting *of = context;
  pbf_solver *s = test_solver(2, PBF_FLOAT32, 4000);
  shared others = {of->array, of->size, 0};
  pthread_t thread;
  int failed = 0;
  if (pthread_create(&thread, NULL, write_sizes, &others) != 0) return 4;
  for (int k = 0; k < CALLS && !failed; ++k) {
    const pbf_status status = of->set(s, of->array);
    if (status != PBF_OK && status != PBF_ERROR_STRUCT_SIZE) failed = 5;
  }
  atomic_store(&others.stop, 1);
  pthread_join(thread, NULL);
  pbf_destroy(s);
  return failed;
}

static void sizes_are_read_once(void **state) {
  (void)state;
  pbf_emitter emitters[PBF_MAX_EMITTERS];
  pbf_volume drains[PBF_MAX_DRAINS];
  pbf_reservoir reservoirs[PBF_MAX_RESERVOIRS];
  for (int i = 0; i < (int)PBF_MAX_EMITTERS; ++i) {
    assert_ok(pbf_emitter_init(&emitters[i], sizeof *emitters, PBF_EMITTER_RECTANGLE));
    assert_ok(pbf_volume_init(&drains[i], sizeof *drains, PBF_VOLUME_BOX));
    assert_ok(pbf_reservoir_init(&reservoirs[i], sizeof *reservoirs));
    emitters[i].half_width = drains[i].half_extents[0] = 0.1;
    for (int k = 0; k < 2; ++k) {
      emitters[i].position[k] = reservoirs[i].position[k] = 0.5;
      reservoirs[i].half_extents[k] = reservoirs[i].depth = 0.2;
    }
  }
  setting settings[] = {{set_emitters, emitters, sizeof *emitters},
                        {set_drains, drains, sizeof *drains},
                        {set_reservoirs, reservoirs, sizeof *reservoirs}};
  for (size_t k = 0; k < sizeof settings / sizeof settings[0]; ++k)
    assert_int_equal(test_status_of_child(set_often, &settings[k]), 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(phases_are_those_that_were_checked),
      cmocka_unit_test(sizes_are_read_once),
  };
  return TEST_RUN(tests);
}
