/* A call is not left halfway by pthread_cancel, which would take a lock or a solver with it: the
 * thread is cancelled after the call, at its next cancellation point. */
#ifndef PBF_UNCANCELLED_H
#define PBF_UNCANCELLED_H

#include <pthread.h>

/* Returns what to give back at the end. */
static inline int pbf_uncancelled_begin(void) {
  int before = PTHREAD_CANCEL_ENABLE;
  pthread_setcancelstate(PTHREAD_CANCEL_DISABLE, &before);
  return before;
}

static inline void pbf_uncancelled_end(int before) { pthread_setcancelstate(before, NULL); }

#endif
