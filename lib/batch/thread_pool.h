/* Threads that share out items: each takes the next one when it has done with another. */
#ifndef PBF_LIB_BATCH_THREAD_POOL_H
#define PBF_LIB_BATCH_THREAD_POOL_H

#include <pbf/pbf.h>

#include "common/system.h"

/* More threads than that gain nothing. */
enum { PBF_MAX_POOL_THREADS = 1024 };

typedef void (*pbf_item_fn)(void *context, uint32_t item);

typedef struct pbf_thread_pool_job pbf_thread_pool_job;

/* A batch's own threads; they start when first wanted, and sleep between runs. */
typedef struct pbf_thread_pool {
  uint32_t size;                    /* threads at work, the caller's included */
  pbf_enqueue_task_fn enqueue_task; /* the caller's task system instead, or null */
  pbf_finish_task_fn finish_task;
  void *task_user;

  pbf_mutex mutex;
  pbf_condition begun, ended;
  uint32_t process; /* that the threads run in; 0: none have started */
  uint32_t started; /* threads, … */
  uint32_t room;    /* … and for how many `threads` has room */
  uint32_t refused; /* 1: the system has refused to start another one */
  pbf_thread *threads;
  pbf_thread_pool_job *job; /* the job that threads may join; null: none */
  uint32_t quit;
} pbf_thread_pool;

/* How many threads `wanted` (0: as many as there are CPUs) and so many items make. */
uint32_t pbf_thread_pool_size(uint32_t wanted, uint32_t items);

/* Calls item(context, k) for k = 0 … items - 1, in any of the threads, and returns when all are
 * done. Threads that can't be started are done without. */
void pbf_thread_pool_run(pbf_thread_pool *pool, const pbf_allocator *allocator, uint32_t items,
                         pbf_item_fn item, void *context);

void pbf_thread_pool_free(pbf_thread_pool *pool, const pbf_allocator *allocator);

#endif
