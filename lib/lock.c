#include "lock.h"

#include <stdatomic.h>
#include <stdint.h>

#include "compiler.h"
#include "error.h"
#include "os.h"

/* The thread that holds each, 0: none. A mutex that is taken first and says by whom after it has a
 * moment between, in which a signal handler would wait for its own thread; thread-local memory
 * is allocated where it is first looked at, which a signal handler must not do. */
static _Atomic uintptr_t holders[PBF_LOCK_COUNT];

static int is_held_here(int lock) {
  return atomic_load_explicit(&holders[lock], memory_order_relaxed) == pbf_this_thread();
}

pbf_status pbf_lock_check(void) {
  for (int lock = 0; lock < PBF_LOCK_COUNT; ++lock) {
    if (!is_held_here(lock)) continue;
    return pbf_fail(PBF_ERROR_BUSY,
                    "the call comes from a signal handler that has interrupted another one of this "
                    "thread; after that has returned it would do");
  }
  return PBF_OK;
}

/* Most calls hold one for nanoseconds, and a search for backends for milliseconds. */
static void wait_a_little(unsigned looks) {
  enum { LOOKS_BEFORE_SLEEP = 100, PAUSE = 50 /* microseconds */ };
  if (looks < LOOKS_BEFORE_SLEEP) {
    pbf_yield();
  } else {
    const int cancellation = pbf_uncancelled_begin();
    pbf_os_sleep(PAUSE);
    pbf_uncancelled_end(cancellation);
  }
}

void pbf_lock_take(pbf_lock lock) {
  uintptr_t none = 0;
  for (unsigned looks = 0; !atomic_compare_exchange_strong_explicit(
           &holders[lock], &none, pbf_this_thread(), memory_order_acquire, memory_order_relaxed);
       ++looks) {
    wait_a_little(looks);
    none = 0;
  }
}

void pbf_lock_release(pbf_lock lock) {
  atomic_store_explicit(&holders[lock], 0, memory_order_release);
}

/* ---- A process that forks ------------------------------------------------------------------ */

/* The child has the thread alone that forks. What others hold at this moment would be held there
 * for ever, and be half done: so no search for backends is, while a process forks, nor a change of
 * the lists of shapes and of tasks; nothing allocates while these are locked. The lock of solvers
 * is not waited for: a signal handler may be, in a thread that has been interrupted within malloc,
 * and the C library takes its locks next. handles.c mends what it guards.
 *
 * Written with the lock held. */
static int taken_to_fork[PBF_LOCK_COUNT];
static const pbf_lock waited_for[] = {PBF_LOCK_BACKENDS, PBF_LOCK_SHAPES, PBF_LOCK_TASKS};
enum { WAITED_FOR = sizeof waited_for / sizeof *waited_for };

static void before_fork(void) {
  for (int k = 0; k < WAITED_FOR; ++k) {
    const pbf_lock lock = waited_for[k];
    if (is_held_here(lock)) continue; /* in a plugin that is being loaded */
    pbf_lock_take(lock);
    taken_to_fork[lock] = 1;
  }
}

static void after_fork(void) {
  for (int k = 0; k < WAITED_FOR; ++k) {
    const pbf_lock lock = waited_for[k];
    if (!is_held_here(lock) || !taken_to_fork[lock]) continue;
    taken_to_fork[lock] = 0;
    pbf_lock_release(lock);
  }
}

int pbf_lock_forget_others(pbf_lock lock) {
  if (atomic_load(&holders[lock]) == 0 || is_held_here(lock)) return 0;
  pbf_lock_release(lock);
  return 1;
}

PBF_AT_LOAD(prepare_for_forks) { pbf_at_fork(before_fork, after_fork, after_fork); }
