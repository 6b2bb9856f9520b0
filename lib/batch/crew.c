#define _GNU_SOURCE /* sched_getaffinity */
#include "crew.h"

#include <sched.h>
#include <stdatomic.h>
#include <string.h>
#include <unistd.h>

#include "common/signalless_thread.h"
#include "memory.h"

/* What a call into a solver needs, many times over. */
enum { STACK_BYTES = 1 << 20 };

/* On the stack of the thread that runs it. */
struct pbf_crew_job {
  pbf_item_fn item;
  void *context;
  uint32_t items;
  _Atomic uint32_t next; /* first item that no thread has taken */
  uint32_t places;       /* for threads of the crew that may still come */
  uint32_t inside;       /* threads of the crew that are at it */
};

uint32_t pbf_crew_size(uint32_t wanted, uint32_t items) {
  cpu_set_t set;
  if (!wanted && sched_getaffinity(0, sizeof set, &set) == 0) wanted = (uint32_t)CPU_COUNT(&set);
  if (!wanted) wanted = 1;
  if (wanted > PBF_MAX_CREW) wanted = PBF_MAX_CREW;
  return wanted < items ? wanted : items;
}

static void work_on(pbf_crew_job *job) {
  for (;;) {
    const uint32_t k = atomic_fetch_add_explicit(&job->next, 1, memory_order_relaxed);
    if (k >= job->items) return;
    job->item(job->context, k);
  }
}

/* ---- Its own threads ------------------------------------------------------------------------ */

/* A job stays where it is until all that are inside have left, and none comes once it is closed. */
static void *work(void *user) {
  pbf_crew *crew = user;
  pthread_mutex_lock(&crew->mutex);
  while (!crew->quit) {
    pbf_crew_job *job = crew->job;
    if (!job || job->places == 0) {
      pthread_cond_wait(&crew->begun, &crew->mutex);
      continue;
    }
    --job->places;
    ++job->inside;
    pthread_mutex_unlock(&crew->mutex);
    work_on(job);
    pthread_mutex_lock(&crew->mutex);
    if (--job->inside == 0) pthread_cond_signal(&crew->ended);
  }
  pthread_mutex_unlock(&crew->mutex);
  return NULL;
}

/* In the child of a fork there is none of the threads; the memory for their names stays. */
static void begin_here(pbf_crew *crew) {
  if (crew->process == getpid()) return;
  pthread_mutex_init(&crew->mutex, NULL);
  pthread_cond_init(&crew->begun, NULL);
  pthread_cond_init(&crew->ended, NULL);
  crew->process = getpid();
  crew->started = crew->refused = crew->quit = 0;
  crew->job = NULL;
}

static void take_room(pbf_crew *crew, const pbf_allocator *allocator) {
  const uint32_t wanted = crew->size - 1;
  if (crew->room >= wanted) return;
  void *memory = allocator->allocate(allocator->user, wanted * sizeof *crew->threads, 64);
  if (!memory) return;
  crew->threads = memory;
  crew->room = wanted;
}

static int start_thread(pbf_crew *crew) {
  const int runs = pbf_start_signalless(&crew->threads[crew->started], STACK_BYTES, work, crew);
  crew->started += runs;
  return runs;
}

static void start_threads(pbf_crew *crew, const pbf_allocator *allocator) {
  begin_here(crew);
  take_room(crew, allocator);
  while (crew->started < crew->room && !crew->refused) crew->refused = !start_thread(crew);
}

static void open_job(pbf_crew *crew, pbf_crew_job *job) {
  pthread_mutex_lock(&crew->mutex);
  crew->job = job;
  pthread_cond_broadcast(&crew->begun);
  pthread_mutex_unlock(&crew->mutex);
}

/* Where a callback has forked, the child has no thread to wait for. */
static void close_job(pbf_crew *crew, const pbf_crew_job *job) {
  if (crew->process != getpid()) return;
  pthread_mutex_lock(&crew->mutex);
  crew->job = NULL;
  while (job->inside > 0) pthread_cond_wait(&crew->ended, &crew->mutex);
  pthread_mutex_unlock(&crew->mutex);
}

static void run_in_threads(pbf_crew *crew, const pbf_allocator *allocator, pbf_crew_job *job) {
  start_threads(crew, allocator);
  open_job(crew, job);
  work_on(job);
  close_job(crew, job);
}

/* ---- A task system of the caller's ---------------------------------------------------------- */

static void run_task(void *task, uint32_t first, uint32_t last) {
  (void)first, (void)last; /* which thread it is does not matter */
  work_on(task);
}

/* What comes late finds nothing to take. */
static void run_as_task(const pbf_crew *crew, pbf_crew_job *job) {
  void *handle = crew->enqueue_task(crew->task_user, run_task, job, job->places, 1);
  work_on(job);
  if (handle) crew->finish_task(crew->task_user, handle);
}

/* ---- Runs ----------------------------------------------------------------------------------- */

void pbf_crew_run(pbf_crew *crew, const pbf_allocator *allocator, uint32_t items, pbf_item_fn item,
                  void *context) {
  const uint32_t threads = crew->size < items ? crew->size : items;
  pbf_crew_job job = {.item = item, .context = context, .items = items};
  atomic_init(&job.next, 0);
  job.places = threads > 0 ? threads - 1 : 0;
  if (job.places == 0)
    work_on(&job);
  else if (crew->enqueue_task)
    run_as_task(crew, &job);
  else
    run_in_threads(crew, allocator, &job);
}

void pbf_crew_free(pbf_crew *crew, const pbf_allocator *allocator) {
  if (crew->process == getpid()) {
    pthread_mutex_lock(&crew->mutex);
    crew->quit = 1;
    pthread_cond_broadcast(&crew->begun);
    pthread_mutex_unlock(&crew->mutex);
    for (uint32_t k = 0; k < crew->started; ++k) pthread_join(crew->threads[k], NULL);
    pthread_cond_destroy(&crew->ended);
    pthread_cond_destroy(&crew->begun);
    pthread_mutex_destroy(&crew->mutex);
  }
  if (crew->threads)
    allocator->release(allocator->user, crew->threads, crew->room * sizeof *crew->threads, 64);
}
