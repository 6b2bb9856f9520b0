/* Mutexes and conditions where the system has threads wait while a word has a value: by Linux's
 * call futex, and by the instructions of WebAssembly. */
#if defined(__linux__) || defined(__wasm_atomics__)
#define _GNU_SOURCE /* syscall */
#include "common/system.h"

#if defined(__linux__)
#include <errno.h>
#include <linux/futex.h>
#include <sched.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#if !defined(SYS_futex)
#define SYS_futex SYS_futex_time64 /* without a time the same */
#endif

/* ---- By Linux. The C library's end the process where a sandbox denies the call, which it may do
 * at any time, also while threads wait. These then look again and again, and let other threads run
 * in between. */

static long call_kernel(uint32_t *word, int operation, uint32_t value) {
  return syscall(SYS_futex, word, operation | FUTEX_PRIVATE_FLAG, value, NULL, NULL, 0);
}

static void wait_by_turns(void) {
  const struct timespec nap = {0, 50000};
  sched_yield();
  nanosleep(&nap, NULL);
}

/* Unless the word has another value. May return for no reason. */
static void wait_while_it_is(uint32_t *word, uint32_t value) {
  const int before = errno;
  if (call_kernel(word, FUTEX_WAIT, value) != 0 && errno != EAGAIN && errno != EINTR)
    wait_by_turns();
  errno = before;
}

static void wake(uint32_t *word, int threads) {
  const int before = errno;
  call_kernel(word, FUTEX_WAKE, (uint32_t)threads);
  errno = before;
}

int pbf_can_wait(void) {
  uint32_t unused = 0;
  const int before = errno;
  const int can = call_kernel(&unused, FUTEX_WAKE, 1) == 0;
  errno = before;
  return can;
}

#else

/* ---- By WebAssembly ------------------------------------------------------------------------- */

static void wait_while_it_is(uint32_t *word, uint32_t value) { pbf_wasm_wait(word, value); }

static void wake(uint32_t *word, int threads) {
  __builtin_wasm_memory_atomic_notify((int *)word, (unsigned)threads);
}

int pbf_can_wait(void) { return 1; }

#endif

enum { FREE, HELD, HELD_AND_WANTED };

/* ---- Mutexes -------------------------------------------------------------------------------- */

void pbf_mutex_init(pbf_mutex *mutex) { mutex->state = FREE; }
void pbf_mutex_destroy(pbf_mutex *mutex) { (void)mutex; }

int pbf_mutex_try(pbf_mutex *mutex) {
  uint32_t expected = FREE;
  return __atomic_compare_exchange_n(&mutex->state, &expected, HELD, 0, __ATOMIC_ACQUIRE,
                                     __ATOMIC_RELAXED);
}

/* Others may want it, too, and the last one that gets it does not know that it is the last. */
static void lock_as_wanted(pbf_mutex *mutex) {
  while (__atomic_exchange_n(&mutex->state, HELD_AND_WANTED, __ATOMIC_ACQUIRE) != FREE)
    wait_while_it_is(&mutex->state, HELD_AND_WANTED);
}

void pbf_mutex_lock(pbf_mutex *mutex) {
  if (!pbf_mutex_try(mutex)) lock_as_wanted(mutex);
}

void pbf_mutex_unlock(pbf_mutex *mutex) {
  if (__atomic_exchange_n(&mutex->state, FREE, __ATOMIC_RELEASE) == HELD_AND_WANTED)
    wake(&mutex->state, 1);
}

/* ---- Conditions ----------------------------------------------------------------------------- */

void pbf_condition_init(pbf_condition *condition) { *condition = (pbf_condition){0, 0}; }
void pbf_condition_destroy(pbf_condition *condition) { (void)condition; }

/* Both numbers change under the mutex alone, but for signals after it has been opened. */
void pbf_condition_wait(pbf_condition *condition, pbf_mutex *mutex) {
  const uint32_t seen = __atomic_load_n(&condition->signals, __ATOMIC_RELAXED);
  __atomic_fetch_add(&condition->waiting, 1, __ATOMIC_SEQ_CST);
  pbf_mutex_unlock(mutex);
  wait_while_it_is(&condition->signals, seen);
  lock_as_wanted(mutex);
  __atomic_fetch_sub(&condition->waiting, 1, __ATOMIC_SEQ_CST);
}

static void signal_to(pbf_condition *condition, int threads) {
  __atomic_fetch_add(&condition->signals, 1, __ATOMIC_SEQ_CST);
  if (__atomic_load_n(&condition->waiting, __ATOMIC_SEQ_CST)) wake(&condition->signals, threads);
}

void pbf_condition_signal(pbf_condition *condition) { signal_to(condition, 1); }
void pbf_condition_broadcast(pbf_condition *condition) { signal_to(condition, 0x7fffffff); }

#else
typedef int pbf_waits_are_those_of_posix;
#endif
