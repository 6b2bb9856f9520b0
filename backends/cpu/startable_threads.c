#define _GNU_SOURCE /* syscall */
#include "cpu/startable_threads.h"

#if defined(_WIN32) /* how many there may be is not asked there */

long thread_number(void) { return 0; }
int thread_is_there(long number) { return number == 0; }
int thread_has_ended(long number, double seconds) { return (void)number, (void)seconds, 0; }
uint32_t startable_threads(uint32_t wanted, size_t stack_bytes) {
  return (void)stack_bytes, wanted;
}

#else

#include <errno.h>
#include <sched.h>
#include <signal.h>
#include <unistd.h>

#if defined(__linux__)
#include <sys/syscall.h>
#endif

#include "common/system.h"

enum { MAX_PROBES = 256 };

typedef struct probe {
  pbf_thread thread;
  pbf_mutex *gate; /* closed until all are there */
  long number;     /* as the kernel has it */
} probe;

#if defined(__linux__)

long thread_number(void) { return syscall(SYS_gettid); }

typedef enum presence { GONE, THERE, UNTOLD /* a sandbox does not let one ask */ } presence;

static presence presence_of(long number) {
  if (syscall(SYS_tgkill, getpid(), number, 0) == 0) return THERE;
  return errno == ESRCH ? GONE : UNTOLD;
}

int thread_is_there(long number) { return presence_of(number) != GONE; }

int thread_has_ended(long number, double seconds) {
  const double begin = pbf_seconds();
  presence now = THERE;
  while ((now = presence_of(number)) == THERE && pbf_seconds() - begin < seconds) sched_yield();
  return now == GONE;
}

#else

long thread_number(void) { return 0; }
int thread_is_there(long number) { return number == 0; }
int thread_has_ended(long number, double seconds) { return (void)seconds, number != 0; }

#endif

static void *wait_at_gate(void *user) {
  probe *own = (probe *)user;
  own->number = thread_number();
  pbf_mutex_lock(own->gate);
  pbf_mutex_unlock(own->gate);
  return NULL;
}

uint32_t startable_threads(uint32_t wanted, size_t stack_bytes) {
  probe probes[MAX_PROBES];
  pbf_mutex gate = PBF_MUTEX_INITIALIZER;
  uint32_t here = 0;
  if (wanted > MAX_PROBES) wanted = MAX_PROBES;
  pbf_mutex_lock(&gate);
  while (here < wanted) {
    probes[here].gate = &gate;
    if (!pbf_thread_start(&probes[here].thread, PBF_THREAD_OWN, stack_bytes, wait_at_gate,
                          &probes[here]))
      break;
    ++here;
  }
  pbf_mutex_unlock(&gate);
  for (uint32_t k = 0; k < here; ++k) pbf_thread_join(&probes[k].thread);
  /* A thread counts until the kernel has forgotten it, a little after it can be joined. */
  for (uint32_t k = 0; k < here; ++k)
    if (!thread_has_ended(probes[k].number, 1)) break;
  return here;
}

#endif
