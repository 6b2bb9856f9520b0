/* The locks of the library. They are held for moments only, and by no thread that waits for
 * another call. */
#ifndef PBF_LIB_LOCK_H
#define PBF_LIB_LOCK_H

#include <pbf/pbf.h>

typedef enum pbf_lock {
  PBF_LOCK_BACKENDS, /* the list of backends, and the search for them */
  PBF_LOCK_SOLVERS,  /* which solvers there are, and where calls run */
  PBF_LOCK_SHAPES,   /* which shapes there are, and what holds them */
  PBF_LOCK_TASKS,    /* which tasks batches have in task systems, and the threads inside them */
  PBF_LOCK_COUNT
} pbf_lock;

/* Fails with PBF_ERROR_BUSY in a signal handler that has interrupted this thread while it holds a
 * lock: it would wait for itself. Every call that takes a lock begins with it. */
pbf_status pbf_lock_check(void);

void pbf_lock_take(pbf_lock lock);
void pbf_lock_release(pbf_lock lock);

/* In the child of a fork: opens it if another thread, which is not there, holds it. Returns 1 for
 * that: what it guards may be half done. */
int pbf_lock_forget_others(pbf_lock lock);

#endif
