/* Threads of the library's own, on which no signal of the program is handled. */
#ifndef PBF_COMMON_SIGNALLESS_THREAD_H
#define PBF_COMMON_SIGNALLESS_THREAD_H

#include <pthread.h>
#include <signal.h>
#include <stddef.h>

/* 1 once it runs. `stack_bytes` 0: the system's default. */
static inline int pbf_start_signalless(pthread_t *thread, size_t stack_bytes, void *(*run)(void *),
                                       void *user) {
  sigset_t all, before;
  pthread_attr_t attributes;
  if (pthread_attr_init(&attributes) != 0) return 0;
  if (stack_bytes) pthread_attr_setstacksize(&attributes, stack_bytes);
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before); /* which a thread has from the one that starts it */
  const int failed = pthread_create(thread, &attributes, run, user);
  pthread_sigmask(SIG_SETMASK, &before, NULL);
  pthread_attr_destroy(&attributes);
  return !failed;
}

#endif
