/* Threads of the plugin's own: one pool for all of its solvers, as large as the solver that has
 * asked for most wants beside its caller. It is made when a team first runs, and ends with the last
 * solver.
 *
 * A caller opens a region and begins to work; a thread of the pool that is free comes in. The
 * caller waits for those that have come in alone, at the end, and none can after that: where all
 * cores are busy with other things it does the work itself.
 *
 * On a core that others use a thread may be stopped for milliseconds with a task in hand, which all
 * the others then wait for. A run with much of that makes teams smaller for a while. */
#include <math.h>

#include "common/fp_environment.h"
#include "common/open_tasks.h"
#include "common/system.h"
#include "cpu/atomics.h"
#include "cpu/team_loops.h"

/* Looks at the pool by a thread with nothing to do before it sleeps: some tens of microseconds, as
 * long as it takes a caller to come with its next step. */
enum { LOOKS_BEFORE_SLEEP = 1000 };

/* What the loops and their buffers on the stack need, many times over. */
enum { STACK_BYTES = 1 << 20 };

/* A team that runs: on its caller's stack. */
typedef struct region {
  struct region *next;
  team *all;
  team_function function;
  void *context;
  uint32_t threads, come; /* members there may be, and have been */
  atomic_uint inside;     /* threads of the pool that are */
  int is_waited_for;      /* until none is; both under the pool's lock */
  uintptr_t task;         /* number of the task that it is; 0: it is none */
  /* Of each region one: a signal handler may wait in a thread that it has interrupted in a wait. */
  pbf_condition empty;
} region;

/* How many threads a team may have, since cores were busy. */
typedef struct limit {
  uint32_t threads;       /* 0: as many as it wants */
  double seconds, waited; /* of the last runs, and of them by a thread for others */
  double pause; /* until there may be more, in seconds: longer the sooner it was busy again */
  double more_at;
} limit;

/* All but `opened` is changed under the lock. */
static struct pool {
  pbf_mutex lock;
  pbf_condition wake;   /* threads of the pool that sleep */
  atomic_uint opened;   /* changes with each region that is */
  region *regions;      /* open */
  pbf_open_tasks tasks; /* of regions */
  uint32_t users;       /* solvers */
  uint32_t sleeping;
  atomic_uint size;    /* threads that there are */
  atomic_uint refused; /* 1: no more are to be had */
  uint32_t generation; /* of the present threads: those of another generation end */
  uint32_t forks_are_watched;
  uint32_t process; /* that the threads are in */
  limit limit;
  pbf_thread threads[TEAM_MAX_THREADS];
} pool = {.lock = PBF_MUTEX_INITIALIZER, .wake = PBF_CONDITION_INITIALIZER};

static uint32_t team_size(uint32_t wanted) {
  if (!wanted) wanted = pbf_processors();
  return wanted < TEAM_MAX_THREADS ? wanted : TEAM_MAX_THREADS;
}

/* Without the lock, which the thread may hold that a signal handler asks in. */
static uint32_t team_threads(uint32_t threads) {
  const uint32_t had = atomic_load(&pool.size) + 1;
  return atomic_load(&pool.refused) && had < threads ? had : threads;
}

/* ---- A thread of the pool ------------------------------------------------------------------ */

/* One that lacks members. */
static region *region_to_join(void) {
  region *r = pool.regions;
  while (r && r->come == r->threads) r = r->next;
  return r;
}

/* The lock is open meanwhile. After the count has gone down the region's caller may have returned,
 * and the region with it. */
static void join(region *r) {
  team_thread self = {.api = &cpu_team, .team = r->all, .thread = r->come++, .threads = r->threads};
  atomic_fetch_add(&r->inside, 1);
  pbf_mutex_unlock(&pool.lock);
  r->function(r->context, &self);
  pbf_mutex_lock(&pool.lock);
  if (r->is_waited_for && atomic_load(&r->inside) == 1) pbf_condition_signal(&r->empty);
  atomic_fetch_add(&r->inside, -1u);
}

/* The lock is open meanwhile. */
static void wait_for_region(void) {
  unsigned seen = atomic_load_explicit(&pool.opened, memory_order_relaxed), looks = 0;
  pbf_mutex_unlock(&pool.lock);
  while (looks < LOOKS_BEFORE_SLEEP &&
         atomic_load_explicit(&pool.opened, memory_order_relaxed) == seen)
    wait_a_little(&looks);
  pbf_mutex_lock(&pool.lock);
  if (atomic_load_explicit(&pool.opened, memory_order_relaxed) != seen) return;
  ++pool.sleeping;
  pbf_condition_wait(&pool.wake, &pool.lock);
  --pool.sleeping;
}

/* The pool may be of another generation before the thread begins. */
static void *work(void *generation) {
  pbf_fp_begin();
  pbf_mutex_lock(&pool.lock);
  while (pool.generation == (uintptr_t)generation) {
    region *r = region_to_join();
    if (r)
      join(r);
    else
      wait_for_region();
  }
  pbf_mutex_unlock(&pool.lock);
  return NULL;
}

/* ---- The pool ------------------------------------------------------------------------------ */

/* A child process has none of the threads, and none of the regions that they were in. */
static void before_fork(void) { pbf_mutex_lock(&pool.lock); }
static void in_parent(void) { pbf_mutex_unlock(&pool.lock); }
static void in_child(void) {
  pool.process = pbf_process();
  pbf_mutex_init(&pool.lock);
  pbf_condition_init(&pool.wake);
  pool.regions = NULL;
  pbf_open_tasks_forget(&pool.tasks);
  pool.sleeping = 0;
  pool.size = 0;
  pool.refused = 0;
}

/* A fork by the system call alone, as some runtimes make it, calls none of these. Before the lock
 * is taken, which may be left taken then. */
static void see_process(void) {
  const uint32_t now = pbf_process();
  uint32_t before = __atomic_load_n(&pool.process, __ATOMIC_RELAXED);
  if (before == now || !__atomic_compare_exchange_n(&pool.process, &before, now, 0,
                                                    __ATOMIC_RELAXED, __ATOMIC_RELAXED))
    return;
  if (before) in_child();
}

/* With the lock held. */
static int add_thread(void) {
  const int runs = pbf_thread_start(&pool.threads[pool.size], PBF_THREAD_OWN, STACK_BYTES, work,
                                    (void *)(uintptr_t)pool.generation);
  pool.size += runs;
  return runs;
}

/* With the lock held: up to so many threads, as far as the system gives them. */
static void grow(uint32_t threads) {
  while (pool.size < threads && !pool.refused && pool.forks_are_watched)
    pool.refused = !add_thread();
}

static void team_begin(void) {
  see_process();
  pbf_mutex_lock(&pool.lock);
  if (!pool.forks_are_watched)
    pool.forks_are_watched = pbf_at_fork(before_fork, in_parent, in_child);
  if (pool.users++ == 0) {
    pool.limit = (limit){0};
    pbf_open_tasks_forget(&pool.tasks);
  }
  pool.refused = 0;
  pbf_mutex_unlock(&pool.lock);
}

static void team_end(void) {
  pbf_thread threads[TEAM_MAX_THREADS];
  uint32_t count = 0;
  see_process();
  pbf_mutex_lock(&pool.lock);
  /* Where threads may no longer be woken those that sleep stay, for solvers to come. */
  if (--pool.users == 0 && pbf_can_wait()) {
    for (; count < pool.size; ++count) threads[count] = pool.threads[count];
    pool.size = 0;
    ++pool.generation;
    atomic_fetch_add(&pool.opened, 1);
    pbf_condition_broadcast(&pool.wake);
  }
  pbf_mutex_unlock(&pool.lock);
  while (count) pbf_thread_join(&threads[--count]);
}

/* ---- Busy cores ---------------------------------------------------------------------------- */

static const double min_pause = 0.016, max_pause = 0.5; /* seconds */
static const double most_lost = 0.02, longest = 5;      /* by trying again, of the time; seconds */
static const double much_waiting = 0.25;                /* of the runs' time */
static const double window = 0.008;                     /* seconds: one long wait says nothing */

/* With the lock held. */
static uint32_t limited(uint32_t threads, double now) {
  limit *l = &pool.limit;
  if (l->threads && now >= l->more_at) {
    l->threads *= 2;
    l->more_at = now + l->pause;
  }
  if (l->threads > pool.size) l->threads = 0;
  return l->threads && l->threads < threads ? l->threads : threads;
}

/* With the lock held, after a run of several threads. */
static void note_run(uint32_t threads, double seconds, double waited, double now) {
  limit *l = &pool.limit;
  l->seconds += seconds;
  l->waited += waited;
  if (l->waited > much_waiting * fmax(l->seconds, window)) {
    l->threads = threads / 2;
    const int is_again = l->pause > min_pause;
    l->pause = fmax(l->pause, min_pause);
    l->more_at = now + l->pause;
    if (is_again) l->more_at = now + fmax(l->pause, fmin(l->waited / most_lost, longest));
    l->pause = 2 * l->pause < max_pause ? 2 * l->pause : max_pause;
    l->seconds = l->waited = 0;
  } else {
    l->pause = fmax(l->pause - seconds, min_pause);
    if (l->seconds > window) l->seconds /= 2, l->waited /= 2;
  }
}

/* ---- A caller ------------------------------------------------------------------------------ */

/* Whether it came soon. It does not in a signal handler that has interrupted this thread while it
 * held it, nor where the system has stopped the one that does. */
static int take_lock_soon(void) {
  for (unsigned looks = 0; looks < LOOKS_BEFORE_SLEEP; wait_a_little(&looks))
    if (pbf_mutex_try(&pool.lock)) return 1;
  return 0;
}

/* Returns how many members the team can have: where the lock does not come, the caller alone. */
static uint32_t open_region(region *r, double now) {
  if (!take_lock_soon()) return r->threads = 1;
  if (pool.size < r->threads - 1) grow(r->threads - 1);
  r->threads = limited(r->threads, now);
  if (pool.size < r->threads - 1) r->threads = pool.size + 1;
  if (r->threads > 1) {
    team_reset(r->all, r->threads);
    r->next = pool.regions;
    pool.regions = r;
    atomic_fetch_add(&pool.opened, 1);
    uint32_t wanted = r->threads - 1;
    for (uint32_t k = 0; k < wanted && k < pool.sleeping; ++k) pbf_condition_signal(&pool.wake);
  }
  pbf_mutex_unlock(&pool.lock);
  return r->threads;
}

/* Those that are inside have come to the end, or do so with nothing to wait for. */
static void wait_until_empty(region *r) {
  for (unsigned looks = 0; looks < LOOKS_BEFORE_SLEEP; wait_a_little(&looks))
    if (!atomic_load_explicit(&r->inside, memory_order_acquire)) return;
  pbf_condition_init(&r->empty);
  pbf_mutex_lock(&pool.lock);
  r->is_waited_for = 1;
  while (atomic_load_explicit(&r->inside, memory_order_acquire))
    pbf_condition_wait(&r->empty, &pool.lock);
  pbf_mutex_unlock(&pool.lock);
  pbf_condition_destroy(&r->empty);
}

static void close_region(region *r) {
  pbf_mutex_lock(&pool.lock);
  region **link = &pool.regions;
  while (*link != r) link = &(*link)->next;
  *link = r->next;
  pbf_mutex_unlock(&pool.lock);
  wait_until_empty(r);
}

static void run_many(region *r, double begin) {
  team_thread self = {.api = &cpu_team, .team = r->all, .thread = 0, .threads = r->threads};
  r->function(r->context, &self);
  const double done = pbf_seconds();
  close_region(r);
  const double now = pbf_seconds();
  pbf_mutex_lock(&pool.lock);
  note_run(r->threads, now - begin, self.waited + now - done, now);
  pbf_mutex_unlock(&pool.lock);
}

/* ---- A caller's task system ---------------------------------------------------------------- */

/* Items need the lock. Without a free place the caller is alone. */
static int open_task_of(region *r) {
  if (!take_lock_soon()) return 0;
  r->task = pbf_open_tasks_add(&pool.tasks, r);
  pbf_mutex_unlock(&pool.lock);
  return r->task != 0;
}

/* What comes after that finds no task, and there is nothing left to do. Returns 0 in the child of a
 * fork, which has none of the threads that may be inside. */
static int close_task_of(const region *r) {
  pbf_mutex_lock(&pool.lock);
  const int was_open = pbf_open_tasks_remove(&pool.tasks, r->task);
  pbf_mutex_unlock(&pool.lock);
  return was_open;
}

/* An item: a member if there is a place left. Which item it is does not matter, nor how many of
 * them the task system runs at once. */
static void run_item(void *number, uint32_t first, uint32_t last) {
  (void)first, (void)last;
  pbf_fp_environment before = pbf_fp_begin();
  pbf_mutex_lock(&pool.lock);
  region *r = pbf_open_tasks_of(&pool.tasks, (uintptr_t)number);
  if (r && r->come < r->threads) join(r);
  pbf_mutex_unlock(&pool.lock);
  pbf_fp_end(before);
}

static void run_as_task(const team_tasks *tasks, region *r) {
  team_reset(r->all, r->threads);
  void *handle = tasks->enqueue(tasks->user, run_item, (void *)r->task, r->threads - 1, 1);
  (void)pbf_fp_begin();
  team_thread self = {.api = &cpu_team, .team = r->all, .thread = 0, .threads = r->threads};
  r->function(r->context, &self);
  const int was_open = close_task_of(r);
  if (handle) tasks->finish(tasks->user, handle);
  (void)pbf_fp_begin();
  if (was_open) wait_until_empty(r);
}

/* ---- A run --------------------------------------------------------------------------------- */

static void team_run(const team_tasks *tasks, team *all, uint32_t threads, team_function function,
                     void *context) {
  region r = {.all = all, .function = function, .context = context, .threads = threads, .come = 1};
  const double begin = pbf_seconds();
  see_process();
  if (threads > 1 && tasks->enqueue && open_task_of(&r)) {
    run_as_task(tasks, &r);
  } else if (threads > 1 && !tasks->enqueue && open_region(&r, begin) > 1) {
    run_many(&r, begin);
  } else {
    team_thread self = {.api = &cpu_team, .team = all, .thread = 0, .threads = 1};
    function(context, &self);
  }
}

const team_api cpu_team = {
    .resizes = 1,
    .run_length = 10000, /* about a millisecond of one thread: teams can't become smaller in less */
    .size = team_size,
    .threads = team_threads,
    .bytes = team_bytes,
    .begin = team_begin,
    .end = team_end,
    .run = team_run,
    .parallel_for = team_parallel_for};
