#include "thread_pool.h"

#include <stdatomic.h>

#include "common/fp_environment.h"
#include "common/open_tasks.h"
#include "lock.h"
#include "memory.h"
#include "os.h"

/* What a call into a solver needs, many times over. */
enum { STACK_BYTES = 1 << 20 };

/* On the stack of the thread that runs it. */
struct pbf_thread_pool_job {
  pbf_item_fn item;
  void *context;
  uint32_t items;
  _Atomic uint32_t next; /* first item that no thread has taken */
  uint32_t places;       /* for threads of the pool that may still join */
  uint32_t inside;       /* threads beside the caller's that work on it */

  /* As a task of a task system's. */
  uintptr_t task; /* its number */
  uint32_t process;
};

uint32_t pbf_thread_pool_size(uint32_t wanted, uint32_t items) {
  if (!wanted) wanted = pbf_processors();
  if (wanted > PBF_MAX_POOL_THREADS) wanted = PBF_MAX_POOL_THREADS;
  return wanted < items ? wanted : items;
}

static void work_on(pbf_thread_pool_job *job) {
  for (;;) {
    const uint32_t k = atomic_fetch_add_explicit(&job->next, 1, memory_order_relaxed);
    if (k >= job->items) return;
    job->item(job->context, k);
  }
}

/* ---- Its own threads ------------------------------------------------------------------------ */

/* A job stays where it is until all that are inside have left, and none comes once it is closed. */
static void *work(void *user) {
  pbf_thread_pool *pool = user;
  pbf_mutex_lock(&pool->mutex);
  while (!pool->quit) {
    pbf_thread_pool_job *job = pool->job;
    if (!job || job->places == 0) {
      pbf_condition_wait(&pool->begun, &pool->mutex);
      continue;
    }
    --job->places;
    ++job->inside;
    pbf_mutex_unlock(&pool->mutex);
    work_on(job);
    pbf_mutex_lock(&pool->mutex);
    if (--job->inside == 0) pbf_condition_signal(&pool->ended);
  }
  pbf_mutex_unlock(&pool->mutex);
  return NULL;
}

/* In the child of a fork there is none of the threads; the memory for their names stays. */
static void begin_here(pbf_thread_pool *pool) {
  if (pool->process == pbf_process()) return;
  pbf_mutex_init(&pool->mutex);
  pbf_condition_init(&pool->begun);
  pbf_condition_init(&pool->ended);
  pool->process = pbf_process();
  pool->started = pool->refused = pool->quit = 0;
  pool->job = NULL;
}

static void take_room(pbf_thread_pool *pool, const pbf_allocator *allocator) {
  const uint32_t wanted = pool->size - 1;
  if (pool->room >= wanted) return;
  void *memory = pbf_memory_try(allocator, wanted * sizeof *pool->threads);
  if (!memory) return;
  pool->threads = memory;
  pool->room = wanted;
}

static int start_thread(pbf_thread_pool *pool) {
  const int runs = pbf_thread_start(&pool->threads[pool->started], PBF_THREAD_OF_CALLBACKS,
                                    STACK_BYTES, work, pool);
  pool->started += runs;
  return runs;
}

static void start_threads(pbf_thread_pool *pool, const pbf_allocator *allocator) {
  begin_here(pool);
  take_room(pool, allocator);
  while (pool->started < pool->room && !pool->refused) pool->refused = !start_thread(pool);
}

static void open_job(pbf_thread_pool *pool, pbf_thread_pool_job *job) {
  pbf_mutex_lock(&pool->mutex);
  pool->job = job;
  pbf_condition_broadcast(&pool->begun);
  pbf_mutex_unlock(&pool->mutex);
}

/* Where a callback has forked, the child has no thread to wait for. */
static void close_job(pbf_thread_pool *pool, const pbf_thread_pool_job *job) {
  if (pool->process != pbf_process()) return;
  pbf_mutex_lock(&pool->mutex);
  pool->job = NULL;
  while (job->inside > 0) pbf_condition_wait(&pool->ended, &pool->mutex);
  pbf_mutex_unlock(&pool->mutex);
}

static void run_in_threads(pbf_thread_pool *pool, const pbf_allocator *allocator,
                           pbf_thread_pool_job *job) {
  start_threads(pool, allocator);
  open_job(pool, job);
  work_on(job);
  close_job(pool, job);
}

/* ---- A task system of the caller's ---------------------------------------------------------- */

/* The tasks that are open, and threads inside of one, are changed under the lock of tasks. */
static pbf_open_tasks tasks;

static int open_task(pbf_thread_pool_job *job) {
  pbf_lock_take(PBF_LOCK_TASKS);
  job->process = pbf_process();
  job->task = pbf_open_tasks_add(&tasks, job);
  pbf_lock_release(PBF_LOCK_TASKS);
  return job->task != 0;
}

static pbf_thread_pool_job *enter_task(uintptr_t number) {
  pbf_lock_take(PBF_LOCK_TASKS);
  pbf_thread_pool_job *job = pbf_open_tasks_of(&tasks, number);
  if (job) ++job->inside;
  pbf_lock_release(PBF_LOCK_TASKS);
  return job;
}

static void leave_task(pbf_thread_pool_job *job) {
  pbf_lock_take(PBF_LOCK_TASKS);
  --job->inside;
  pbf_lock_release(PBF_LOCK_TASKS);
}

static int others_are_inside(const pbf_thread_pool_job *job) {
  pbf_lock_take(PBF_LOCK_TASKS);
  const int are = job->inside > 0;
  pbf_lock_release(PBF_LOCK_TASKS);
  return are;
}

/* A system that has waited for all items leaves nothing to wait for here. Where a callback has
 * forked, the child has none of the threads. */
static void close_task(pbf_thread_pool_job *job) {
  enum { PAUSE = 50 /* microseconds */ };
  pbf_lock_take(PBF_LOCK_TASKS);
  pbf_open_tasks_remove(&tasks, job->task);
  pbf_lock_release(PBF_LOCK_TASKS);
  while (job->process == pbf_process() && others_are_inside(job)) pbf_os_sleep(PAUSE);
}

/* Which item it is, and so which thread runs it, does not matter. */
static void run_item(void *number, uint32_t first, uint32_t last) {
  (void)first, (void)last;
  pbf_thread_pool_job *job = enter_task((uintptr_t)number);
  if (!job) return;
  work_on(job);
  leave_task(job);
}

static void run_as_task(const pbf_thread_pool *pool, pbf_thread_pool_job *job) {
  const pbf_fp_environment ours = pbf_fp_now();
  void *handle = pool->enqueue_task(pool->task_user, run_item, (void *)job->task, job->places, 1);
  work_on(job);
  if (handle) pool->finish_task(pool->task_user, handle);
  close_task(job);
  pbf_fp_end(ours); /* a caller's function may have left another one */
}

/* ---- Runs ----------------------------------------------------------------------------------- */

void pbf_thread_pool_run(pbf_thread_pool *pool, const pbf_allocator *allocator, uint32_t items,
                         pbf_item_fn item, void *context) {
  const uint32_t threads = pool->size < items ? pool->size : items;
  pbf_thread_pool_job job = {.item = item, .context = context, .items = items};
  atomic_init(&job.next, 0);
  job.places = threads > 0 ? threads - 1 : 0;
  if (job.places > 0 && !pool->enqueue_task)
    run_in_threads(pool, allocator, &job);
  else if (job.places > 0 && open_task(&job))
    run_as_task(pool, &job);
  else
    work_on(&job);
}

void pbf_thread_pool_free(pbf_thread_pool *pool, const pbf_allocator *allocator) {
  if (pool->process == pbf_process()) {
    if (pool->started && !pbf_can_wait()) return; /* they sleep in this memory for good */
    pbf_mutex_lock(&pool->mutex);
    pool->quit = 1;
    pbf_condition_broadcast(&pool->begun);
    pbf_mutex_unlock(&pool->mutex);
    for (uint32_t k = 0; k < pool->started; ++k) pbf_thread_join(&pool->threads[k]);
    pbf_condition_destroy(&pool->ended);
    pbf_condition_destroy(&pool->begun);
    pbf_mutex_destroy(&pool->mutex);
  }
  pbf_memory_free(allocator, pool->threads, pool->room * sizeof *pool->threads);
}
