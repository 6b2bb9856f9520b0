/* What the host keeps of a batch. */
#ifndef PBF_LIB_BATCH_BATCH_H
#define PBF_LIB_BATCH_BATCH_H

#include <pbf/batch.h>
#include <pbf/pbf_backend.h>
#include <stdatomic.h>

#include "check.h"
#include "thread_pool.h"

/* The longest sentence that a world keeps. */
enum { PBF_SENTENCE_SIZE = 480 };

/* A saved state that worlds go back to. */
typedef struct pbf_start {
  _Atomic uint32_t worlds; /* that have it */
  uint64_t size;
  unsigned char state[];
} pbf_start;

typedef struct pbf_world {
  pbf_solver *solver;
  pbf_start *start; /* null: it has none */
  uint32_t entered; /* by a call that has to do with all worlds at once */
  pbf_status status;
  char sentence[PBF_SENTENCE_SIZE];
} pbf_world;

struct pbf_batch {
  /* Guarded by the lock of solvers. */
  pbf_batch *next_live;
  uint32_t references; /* the handle, a running call */
  uint32_t in_call;    /* 1: a call is running, … */
  uintptr_t thread;    /* … in this thread, … */
  int cancellation;    /* … which gets that back */
  uint32_t left;       /* 1: in the child of a fork, where the thread of its call is not */

  /* Belongs to the running call. */
  pbf_allocator allocator;
  pbf_check_kind kind;
  uint32_t device_type;
  const pbf_backend_worlds *together; /* of a backend that steps worlds together, else null, … */
  pbf_backend_solver **handles;       /* … and room for theirs */
  uint32_t world_count;
  pbf_world *worlds;
  pbf_thread_pool pool;
};

#endif
