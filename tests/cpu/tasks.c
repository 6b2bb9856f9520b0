/* `threads` on a caller's task system: the same bits, no thread of its own, and no way to hang,
 * however the system runs its items. */
#include <fenv.h>
#include <pthread.h>
#include <stdio.h>
#include <unistd.h>

#include "cpu_support.h"

enum { COUNT = TEST_INSTRUMENTED ? 500 : 2000, STEPS = 6, MOST_WORKERS = 3, MEMBERS = 4 };

/* ---- A small task system ------------------------------------------------------------------- */

typedef struct task {
  pbf_task_fn run;
  void *context;
  uint32_t items, begun, done;
  struct task *next;
} task;

/* How it goes about its items. */
typedef enum habit {
  BY_WORKERS,        /* workers take them, and the thread that waits does nothing */
  BY_WORKERS_TOO,    /* the thread that waits takes them, too */
  WHILE_WAITING,     /* none is taken before a thread waits, which then takes them */
  INLINE,            /* all while they are enqueued, without a handle */
  INLINE_WITH_HANDLE /* the same, with one */
} habit;

typedef struct task_system {
  habit habit;
  uint32_t workers;
  pthread_mutex_t lock;
  pthread_cond_t changed;
  pthread_t threads[MOST_WORKERS];
  task *queue;
  int stop, rounding;
  uint32_t enqueued, handles, finished;
  uint32_t items_run;
} task_system;

/* With the lock held, which it opens for the while. Items are run in twos, if there are so many. */
static int run_some(task_system *s, task *t) {
  if (t->begun == t->items) return 0;
  uint32_t first = t->begun, last = first + 2 < t->items ? first + 2 : t->items;
  t->begun = last;
  pthread_mutex_unlock(&s->lock);
  t->run(t->context, first, last);
  assert_int_equal(fegetround(), s->rounding);
  pthread_mutex_lock(&s->lock);
  t->done += last - first;
  s->items_run += last - first;
  pthread_cond_broadcast(&s->changed);
  return 1;
}

static void *work(void *user) {
  task_system *s = user;
  fesetround(s->rounding);
  pthread_mutex_lock(&s->lock);
  while (!s->stop) {
    task *t = s->queue;
    while (t && t->begun == t->items) t = t->next;
    if (t)
      run_some(s, t);
    else
      pthread_cond_wait(&s->changed, &s->lock);
  }
  pthread_mutex_unlock(&s->lock);
  return NULL;
}

static void *enqueue(void *user, pbf_task_fn run, void *context, uint32_t items,
                     uint32_t min_range) {
  task_system *s = user;
  assert_true(items >= 1 && items < MEMBERS && min_range >= 1 && min_range <= items);
  ++s->enqueued;
  if (s->habit == INLINE) {
    run(context, 0, items);
    s->items_run += items;
    return NULL;
  }
  task *t = calloc(1, sizeof *t);
  *t = (task){.run = run, .context = context, .items = items};
  pthread_mutex_lock(&s->lock);
  ++s->handles;
  t->next = s->queue;
  s->queue = t;
  while (s->habit == INLINE_WITH_HANDLE && run_some(s, t)) continue;
  pthread_cond_broadcast(&s->changed);
  pthread_mutex_unlock(&s->lock);
  return t;
}

static void finish(void *user, void *handle) {
  task_system *s = user;
  task *t = handle;
  pthread_mutex_lock(&s->lock);
  ++s->finished;
  while (t->done < t->items) {
    int helps = s->habit == WHILE_WAITING || s->habit == BY_WORKERS_TOO;
    if (!helps || !run_some(s, t)) pthread_cond_wait(&s->changed, &s->lock);
  }
  task **link = &s->queue;
  while (*link != t) link = &(*link)->next;
  *link = t->next;
  pthread_mutex_unlock(&s->lock);
  free(t);
}

static void start(task_system *s, habit how, uint32_t workers) {
  memset(s, 0, sizeof *s);
  s->habit = how;
  s->workers = workers;
  s->rounding = FE_TONEAREST;
  pthread_mutex_init(&s->lock, NULL);
  pthread_cond_init(&s->changed, NULL);
  for (uint32_t k = 0; k < workers; ++k)
    assert_int_equal(pthread_create(&s->threads[k], NULL, work, s), 0);
}

static void stop(task_system *s) {
  pthread_mutex_lock(&s->lock);
  s->stop = 1;
  pthread_cond_broadcast(&s->changed);
  pthread_mutex_unlock(&s->lock);
  for (uint32_t k = 0; k < s->workers; ++k) pthread_join(s->threads[k], NULL);
  pthread_cond_destroy(&s->changed);
  pthread_mutex_destroy(&s->lock);
}

/* ---- Solvers ------------------------------------------------------------------------------- */

static pbf_solver *make(const char *backend, uint32_t threads, task_system *system) {
  pbf_desc desc = cpu_desc(backend, 3, PBF_FLOAT32, COUNT, threads);
  pbf_params params = test_params();
  if (system) {
    desc.enqueue_task = enqueue;
    desc.finish_task = finish;
    desc.task_user = system;
  }
  pbf_solver *solver = test_create(&desc, &params);
  cpu_add_column(solver, COUNT);
  return solver;
}

static uint64_t hash_after(pbf_solver *solver) {
  pbf_stats stats = {.struct_size = sizeof stats};
  for (uint32_t k = 0; k < STEPS; ++k) assert_ok(pbf_step(solver, 1 + k % 2));
  assert_ok(pbf_get_stats(solver, &stats));
  return test_hash(solver);
}

static uint64_t expected_hash(void) {
  static uint64_t hash;
  if (hash) return hash;
  pbf_solver *solver = make("serial", 1, NULL);
  hash = hash_after(solver);
  pbf_destroy(solver);
  return hash;
}

static void assert_works(task_system *s) {
  const int before = cpu_threads_now();
  pbf_solver *solver = make("threads", MEMBERS, s);
  assert_true(hash_after(solver) == expected_hash());
  assert_true(cpu_threads_now() <= before);
  pbf_destroy(solver);
  assert_true(s->enqueued > STEPS);
  assert_int_equal(s->finished, s->handles);
  assert_int_equal(s->handles, s->habit == INLINE ? 0 : s->enqueued);
  assert_int_equal(s->items_run, s->enqueued * (MEMBERS - 1));
}

static void check(habit how, uint32_t workers) {
  task_system s;
  start(&s, how, workers);
  assert_works(&s);
  stop(&s);
}

static void a_pool_of_workers(void **state) {
  (void)state;
  check(BY_WORKERS, MOST_WORKERS);
  check(BY_WORKERS_TOO, MOST_WORKERS);
}

static void one_worker(void **state) {
  (void)state;
  check(BY_WORKERS, 1);
  check(BY_WORKERS_TOO, 1);
}

static void no_worker_but_the_caller(void **state) {
  (void)state;
  check(WHILE_WAITING, 0);
}

static void items_run_where_they_are_enqueued(void **state) {
  (void)state;
  check(INLINE, 0);
  check(INLINE_WITH_HANDLE, 0);
}

static void workers_round_as_they_like(void **state) {
  (void)state;
  task_system s;
  start(&s, BY_WORKERS, 0);
  s.rounding = FE_DOWNWARD;
  s.workers = MOST_WORKERS;
  for (uint32_t k = 0; k < s.workers; ++k)
    assert_int_equal(pthread_create(&s.threads[k], NULL, work, &s), 0);
  assert_works(&s);
  stop(&s);
}

/* The only worker steps the solver, as a task of its own. */
static void step_as_task(void *context, uint32_t first, uint32_t last) {
  (void)first, (void)last;
  assert_works(context);
}

static void the_caller_is_the_only_worker(void **state) {
  (void)state;
  task_system engine, inside;
  expected_hash();
  start(&engine, BY_WORKERS, 1);
  start(&inside, WHILE_WAITING, 0);
  void *handle = enqueue(&engine, step_as_task, &inside, 1, 1);
  finish(&engine, handle);
  stop(&inside);
  stop(&engine);
}

static void solvers_at_once(void **state) {
  (void)state;
  enum { SOLVERS = 3 };
  task_system systems[SOLVERS], engine;
  void *handles[SOLVERS];
  expected_hash();
  start(&engine, BY_WORKERS, SOLVERS);
  for (int k = 0; k < SOLVERS; ++k) start(&systems[k], k == 1 ? BY_WORKERS : WHILE_WAITING, 1);
  for (int k = 0; k < SOLVERS; ++k) handles[k] = enqueue(&engine, step_as_task, &systems[k], 1, 1);
  for (int k = 0; k < SOLVERS; ++k) finish(&engine, handles[k]);
  for (int k = 0; k < SOLVERS; ++k) stop(&systems[k]);
  stop(&engine);
}

/* ---- How many threads are worth it --------------------------------------------------------- */

static void *count_items(void *user, pbf_task_fn run, void *context, uint32_t items,
                         uint32_t min_range) {
  uint32_t *most = user;
  (void)min_range;
  *most = items > *most ? items : *most;
  run(context, 0, items);
  return NULL;
}

static void count_finished(void *user, void *handle) {
  (void)user, (void)handle;
  fail();
}

/* The largest number of workers, the caller included, in a step of so many particles. */
static uint32_t members_for(uint32_t threads, uint32_t particles) {
  enum { SIDE = 16, MOST = TEST_INSTRUMENTED ? 3000 : 30000 };
  static double x[MOST][3];
  uint32_t items = 0;
  pbf_desc desc = cpu_desc("threads", 3, PBF_FLOAT32, MOST, threads);
  pbf_params params = test_params();
  params.spacing = 0.02;
  params.smoothing_radius = 0.04;
  desc.enqueue_task = count_items;
  desc.finish_task = count_finished;
  desc.task_user = &items;
  pbf_solver *solver = test_create(&desc, &params);
  for (uint32_t i = 0; i < particles; ++i) {
    const uint32_t place[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
    for (int k = 0; k < 3; ++k) x[i][k] = 0.02 + 0.008 * (k == 2 ? 1 : 2.5) * place[k];
  }
  cpu_add(solver, PBF_FLOAT32, 3, particles, &x[0][0], NULL);
  items = 0;
  assert_ok(pbf_step(solver, 1));
  pbf_destroy(solver);
  return items + 1;
}

/* A number that is asked for is obeyed; without one, few particles get few threads. */
static void few_particles_get_few_threads(void **state) {
  (void)state;
  assert_int_equal(members_for(7, 100), 7);
  assert_int_equal(members_for(0, 100), 1);
  long cpus = sysconf(_SC_NPROCESSORS_ONLN);
  assert_true(members_for(0, 500) <= 7);
  assert_true(members_for(0, TEST_INSTRUMENTED ? 3000 : 30000) <= (uint32_t)cpus);
}

/* ---- Who takes a task system --------------------------------------------------------------- */

static void one_function_is_refused(void **state) {
  (void)state;
  pbf_desc desc = cpu_desc("threads", 3, PBF_FLOAT32, 10, 2);
  pbf_solver *solver = NULL;
  desc.enqueue_task = enqueue;
  assert_fails(pbf_create(&desc, NULL, &solver), PBF_ERROR_INVALID_ARGUMENT,
               "desc.finish_task is null");
  desc.enqueue_task = NULL;
  desc.finish_task = finish;
  assert_fails(pbf_create(&desc, NULL, &solver), PBF_ERROR_INVALID_ARGUMENT,
               "desc.enqueue_task is null");
  assert_null(solver);
}

static void openmp_refuses(void **state) {
  (void)state;
  task_system s;
  start(&s, INLINE, 0);
  pbf_desc desc = cpu_desc("openmp", 3, PBF_FLOAT32, 10, 2);
  pbf_solver *solver = NULL;
  desc.enqueue_task = enqueue;
  desc.finish_task = finish;
  desc.task_user = &s;
  assert_fails(pbf_create(&desc, NULL, &solver), PBF_ERROR_UNAVAILABLE,
               "openmp: it has threads of its own");
  assert_null(solver);
  stop(&s);
}

static void serial_has_no_use_for_it(void **state) {
  (void)state;
  task_system s;
  start(&s, INLINE, 0);
  pbf_solver *solver = make("serial", MEMBERS, &s);
  assert_true(hash_after(solver) == expected_hash());
  pbf_destroy(solver);
  assert_int_equal(s.enqueued, 0);
  stop(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_pool_of_workers),
      cmocka_unit_test(one_worker),
      cmocka_unit_test(no_worker_but_the_caller),
      cmocka_unit_test(items_run_where_they_are_enqueued),
      cmocka_unit_test(workers_round_as_they_like),
      cmocka_unit_test(the_caller_is_the_only_worker),
      cmocka_unit_test(solvers_at_once),
      cmocka_unit_test(few_particles_get_few_threads),
      cmocka_unit_test(one_function_is_refused),
      cmocka_unit_test(openmp_refuses),
      cmocka_unit_test(serial_has_no_use_for_it),
  };
  return TEST_RUN(tests);
}
