/* A state in memory that others write to while it is loaded, as a mapped file that another process
 * writes anew: what is loaded is a state or is refused, and no byte beyond it is looked at. */
#define _GNU_SOURCE
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <sys/mman.h>
#include <unistd.h>

#include "child.h"
#include "support.h"

enum {
  LOADS = TEST_INSTRUMENTED ? 2000 : 30000,
  LARGEST = 65536 /* that a struct may say it is */
};

typedef struct shared {
  unsigned char *bytes; /* ends where a page does that can't be read */
  uint64_t size, params;
  atomic_int is_looked_at, stop;
} shared;

static void *allocate(void *user, uint64_t size, uint64_t alignment) {
  shared *s = user;
  if (s->bytes && !atomic_exchange(&s->is_looked_at, 1)) {
    const uint64_t end = s->params + sizeof(pbf_params);
    memset(s->bytes + end, 0, s->size - end);
  }
  return aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
}

static void release(void *user, void *memory, uint64_t size, uint64_t alignment) {
  (void)user, (void)size, (void)alignment;
  free(memory);
}

/* Once the checksum has been looked at the parameters say by turns that they are larger. */
static void *write_sizes(void *user) {
  shared *s = user;
  volatile uint32_t *size = (volatile uint32_t *)(void *)(s->bytes + s->params);
  while (!atomic_load(&s->stop)) {
    if (atomic_load_explicit(&s->is_looked_at, memory_order_relaxed)) *size = LARGEST;
    *size = sizeof(pbf_params);
  }
  return NULL;
}

static unsigned char *save(pbf_solver *solver, double gravity, uint64_t *size) {
  pbf_params params = {.struct_size = sizeof params};
  if (pbf_get_params(solver, &params) != PBF_OK) return NULL;
  params.gravity[1] = gravity;
  if (pbf_set_params(solver, &params) != PBF_OK || pbf_save(solver, NULL, size) != PBF_OK)
    return NULL;
  unsigned char *state = malloc(*size);
  return state && pbf_save(solver, state, size) == PBF_OK ? state : NULL;
}

/* Where the parameters lie in a state: two states differ first where they do. */
static uint64_t place_of_params(const unsigned char *a, const unsigned char *b) {
  uint64_t k = 0;
  while (a[k] == b[k]) ++k;
  return k - offsetof(pbf_params, gravity[1]);
}

static int load_often(pbf_solver *solver, shared *s, const unsigned char *state) {
  for (int k = 0; k < LOADS; ++k) {
    atomic_store(&s->is_looked_at, 1);
    memcpy(s->bytes, state, s->size);
    atomic_store(&s->is_looked_at, 0);
    const pbf_status status = pbf_load(solver, s->bytes, s->size);
    if (status != PBF_OK && status != PBF_ERROR_DATA) return 5;
  }
  return 0;
}

static int load_what_changes(void *unused) {
  (void)unused;
  static const float at[3] = {0.5f, 0.5f, 0.5f};
  shared s = {0};
  pbf_solver *solver = NULL;
  pthread_t thread;
  pbf_allocator allocator = {sizeof allocator, 0, &s, allocate, release};
  pbf_desc desc = test_desc(3, PBF_FLOAT32, 100);
  desc.allocator = &allocator;
  if (pbf_create(&desc, NULL, &solver) != PBF_OK) return 1;
  if (pbf_add_particles(solver, 1, at, NULL, NULL) != PBF_OK) return 2;
  unsigned char *other = save(solver, nextafter(-9, 0), &s.size),
                *state = save(solver, -9, &s.size);
  if (!other || !state) return 3;
  s.params = place_of_params(other, state);
  const uint64_t page = (uint64_t)sysconf(_SC_PAGESIZE), pages = (s.size + page - 1) / page * page;
  unsigned char *memory =
      mmap(NULL, pages + page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED || mprotect(memory + pages, page, PROT_NONE) != 0) return 4;
  s.bytes = memory + pages - s.size;
  if (pthread_create(&thread, NULL, write_sizes, &s) != 0) return 4;
  const int failed = load_often(solver, &s, state);
  atomic_store(&s.stop, 1);
  pthread_join(thread, NULL);
  pbf_destroy(solver);
  munmap(memory, pages + page);
  free(other);
  free(state);
  return failed;
}

static void a_state_that_changes(void **state) {
  (void)state;
  assert_int_equal(test_status_of_child(load_what_changes, NULL), 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_state_that_changes)};
  return TEST_RUN(tests);
}
