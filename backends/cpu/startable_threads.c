#define _GNU_SOURCE /* syscall */
#include "cpu/startable_threads.h"

#if defined(_WIN32) /* how many there may be is not asked there */

long thread_number(void) { return 0; }
int thread_is_there(long number) { return number == 0; }
int thread_has_ended(long number, double seconds) { return (void)number, (void)seconds, 0; }
uint32_t startable_threads(uint32_t wanted) { return wanted; }

#else

#include <errno.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <unistd.h>

#if defined(__linux__)
#include <sys/syscall.h>
#endif

#include "common/system.h"

enum { MAX_PROBES = 256 };

typedef struct probe {
  pthread_t thread;
  pthread_mutex_t *gate; /* closed until all are there */
  long number;           /* as the kernel has it */
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
  pthread_mutex_lock(own->gate);
  pthread_mutex_unlock(own->gate);
  return NULL;
}

static uint32_t start_and_end(uint32_t wanted) {
  probe probes[MAX_PROBES];
  pthread_mutex_t gate = PTHREAD_MUTEX_INITIALIZER;
  uint32_t here = 0;
  pthread_mutex_lock(&gate);
  while (here < wanted) {
    probes[here].gate = &gate;
    if (pthread_create(&probes[here].thread, NULL, wait_at_gate, &probes[here]) != 0) break;
    ++here;
  }
  pthread_mutex_unlock(&gate);
  for (uint32_t k = 0; k < here; ++k) pthread_join(probes[k].thread, NULL);
  /* A thread counts until the kernel has forgotten it, a little after it can be joined. */
  for (uint32_t k = 0; k < here; ++k)
    if (!thread_has_ended(probes[k].number, 1)) break;
  return here;
}

/* The process's signals are not for these threads. */
uint32_t startable_threads(uint32_t wanted) {
  sigset_t all, before;
  sigfillset(&all);
  if (wanted > MAX_PROBES) wanted = MAX_PROBES;
  if (pthread_sigmask(SIG_SETMASK, &all, &before) != 0) return 0;
  uint32_t startable = start_and_end(wanted);
  pthread_sigmask(SIG_SETMASK, &before, NULL);
  return startable;
}

#endif
