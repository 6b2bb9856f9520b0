/* Threads that a smaller team has no use for have ended before the thread that began it can: GCC's
 * runtime frees what they read when that one ends. Here each allocation has pages of its own, which
 * are gone once it is freed. */
#define _GNU_SOURCE /* MAP_ANONYMOUS */
#include "cpu_support.h"

#if defined(__GLIBC__) && !TEST_INSTRUMENTED

#include <errno.h>
#include <malloc.h>
#include <pthread.h>
#include <sys/mman.h>

#pragma GCC visibility push(default) /* for the C library and those of others */

typedef struct block {
  void *start;
  size_t bytes, size;
} block;

static void *take(size_t size, size_t alignment) {
  enum { PAGE = 4096 };
  const size_t aligned = alignment < 16 ? 16 : alignment;
  const size_t bytes = (size + aligned + sizeof(block) + 2 * PAGE - 1) / PAGE * PAGE;
  char *start = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (start == MAP_FAILED) return NULL;
  const uintptr_t first = (uintptr_t)start + sizeof(block) + aligned - 1;
  char *memory = start + (first / aligned * aligned - (uintptr_t)start);
  ((block *)(void *)memory)[-1] = (block){start, bytes, size};
  return memory;
}

void *malloc(size_t size) { return take(size, 16); }
void *calloc(size_t count, size_t size) { return take(count * size, 16); }
void *aligned_alloc(size_t alignment, size_t size) { return take(size, alignment); }
void *memalign(size_t alignment, size_t size) { return take(size, alignment); }

int posix_memalign(void **memory, size_t alignment, size_t size) {
  *memory = take(size, alignment);
  return *memory ? 0 : ENOMEM;
}

void free(void *memory) {
  if (!memory) return;
  const block there = ((block *)memory)[-1];
  munmap(there.start, there.bytes);
}

void *realloc(void *memory, size_t size) {
  void *moved = take(size, 16);
  if (!memory || !moved) return moved;
  const size_t before = ((block *)memory)[-1].size;
  memcpy(moved, memory, before < size ? before : size);
  free(memory);
  return moved;
}

#pragma GCC visibility pop

static pbf_solver *wide, *narrow;

static pbf_solver *make(uint32_t threads, uint32_t count) {
  pbf_desc desc = cpu_desc("openmp", 3, PBF_FLOAT32, count, threads);
  pbf_solver *solver = test_create(&desc, NULL);
  cpu_add_column(solver, count);
  return solver;
}

static void *step_both(void *failed) {
  if (pbf_step(wide, 1) != PBF_OK || pbf_step(narrow, 1) != PBF_OK) *(int *)failed = 1;
  return NULL;
}

static void threads_of_a_larger_team_end_before_their_own(void **state) {
  (void)state;
  int failed = 0;
  wide = make(8, 1000);
  narrow = make(2, 300);
  for (int k = 0; k < 100; ++k) {
    pthread_t thread;
    assert_int_equal(pthread_create(&thread, NULL, step_both, &failed), 0);
    assert_int_equal(pthread_join(thread, NULL), 0);
  }
  assert_false(failed);
  pbf_destroy(wide);
  pbf_destroy(narrow);
}

#else

static void threads_of_a_larger_team_end_before_their_own(void **state) {
  (void)state;
  test_skip("what looks after memory has an allocator of its own");
}

#endif

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(threads_of_a_larger_team_end_before_their_own),
  };
  return TEST_RUN(tests);
}
