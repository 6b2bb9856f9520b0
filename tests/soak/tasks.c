#include "tasks.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>

#include "record.h"

enum { MOST_JOBS = 32, MOST_WORKERS = 4 };

typedef struct job {
  pbf_task_fn run;
  void *task;
  uint32_t items, range, next, done; /* items handed out, and run */
  int there, late;                   /* late: workers leave it to tasks_finish */
} job;

static struct {
  pthread_mutex_t lock;
  pthread_cond_t come;
  job jobs[MOST_JOBS];
  pthread_t threads[MOST_WORKERS];
  uint32_t count, ways;
  int over;
} all = {.lock = PTHREAD_MUTEX_INITIALIZER, .come = PTHREAD_COND_INITIALIZER};

/* With the lock held, which it opens for the while; 0: nothing is left to begin. */
static int run_a_range(job *j) {
  if (j->next >= j->items) return 0;
  const uint32_t first = j->next;
  const uint32_t last = j->items - first < j->range ? j->items : first + j->range;
  j->next = last;
  pthread_mutex_unlock(&all.lock);
  j->run(j->task, first, last);
  pthread_mutex_lock(&all.lock);
  j->done += last - first;
  return 1;
}

static job *job_to_do(void) {
  for (int k = 0; k < MOST_JOBS; ++k) {
    job *j = &all.jobs[k];
    if (j->there && !j->late && j->next < j->items) return j;
  }
  return NULL;
}

static void *work(void *unused) {
  (void)unused;
  pthread_mutex_lock(&all.lock);
  while (!all.over) {
    job *j = job_to_do();
    if (j)
      run_a_range(j);
    else
      pthread_cond_wait(&all.come, &all.lock);
  }
  pthread_mutex_unlock(&all.lock);
  return NULL;
}

uint32_t tasks_begin(uint32_t threads) {
  all.over = 0;
  for (all.count = 0; all.count < threads && all.count < MOST_WORKERS; ++all.count)
    if (pthread_create(&all.threads[all.count], NULL, work, NULL) != 0) break;
  return all.count;
}

void tasks_end(void) {
  pthread_mutex_lock(&all.lock);
  all.over = 1;
  pthread_cond_broadcast(&all.come);
  pthread_mutex_unlock(&all.lock);
  for (uint32_t k = 0; k < all.count; ++k) pthread_join(all.threads[k], NULL);
  all.count = 0;
}

void tasks_after_fork(void) {
  pthread_mutex_init(&all.lock, NULL);
  pthread_cond_init(&all.come, NULL);
  for (int k = 0; k < MOST_JOBS; ++k) all.jobs[k].there = 0;
  all.count = 0;
}

/* With the lock held. */
static job *put_job(const job *made) {
  for (int k = 0; k < MOST_JOBS; ++k) {
    if (all.jobs[k].there) continue;
    all.jobs[k] = *made;
    pthread_cond_broadcast(&all.come);
    return &all.jobs[k];
  }
  return NULL;
}

static void run_backwards(pbf_task_fn run, void *task, uint32_t items) {
  for (uint32_t i = items; i-- > 0;) run(task, i, i + 1);
}

void *tasks_enqueue(void *user, pbf_task_fn run, void *task, uint32_t items, uint32_t min_range) {
  (void)user;
  count_fault(FAULT_TASKS);
  pthread_mutex_lock(&all.lock);
  const uint32_t way = all.ways++ % 5;
  const job made = {run, task, items, min_range, 0, 0, 1, way == 2};
  job *j = way < 3 ? put_job(&made) : NULL;
  pthread_mutex_unlock(&all.lock);
  if (j) return j;
  if (way == 3 && min_range == 1)
    run_backwards(run, task, items);
  else
    run(task, 0, items);
  return NULL;
}

void tasks_finish(void *user, void *handle) {
  job *j = handle;
  (void)user;
  pthread_mutex_lock(&all.lock);
  while (run_a_range(j)) {
  }
  while (j->done < j->items) {
    pthread_mutex_unlock(&all.lock);
    sched_yield();
    pthread_mutex_lock(&all.lock);
  }
  j->there = 0;
  pthread_mutex_unlock(&all.lock);
}
