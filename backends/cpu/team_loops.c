/* Loops that threads share, wherever the threads come from. A step has some fifteen loops, each a
 * few microseconds long in a small scene, on cores that others may use too: OpenMP's would wait for
 * the slowest thread in each of them.
 *
 * A thread's part of a loop is a run of tasks. The thread takes them from its front; one that has
 * done with its own part takes tasks from the end of another's. A loop is over when its tasks are
 * done, whether or not all threads have come. */
#include "cpu/team_loops.h"

#include "cpu/atomics.h"

/* Looks of a thread that waits before it counts the tasks done itself, in case thread 0 can't. */
enum { LOOKS_BEFORE_COUNT = 64 };

/* After so many looks a wait is long: a thread has a task in hand, and no core to do it on. */
enum { LOOKS_OF_LONG_WAIT = 1000 };

/* Pieces of a loop that are still to be taken from a part. */
typedef struct left {
  uint32_t loop, first, last; /* up to last - 1 */
} left;

/* What threads write is on cache lines of its own each; processors fetch them in pairs. */
enum { LINES = 2 * TEAM_ALIGNMENT };
typedef struct thread_tasks {
  _Alignas(TEAM_ALIGNMENT) atomic_ullong left; /* of the thread's part: packed */
  char apart[LINES - sizeof(atomic_ullong)];
  atomic_ullong done; /* tasks in all loops, by this thread */
  char apart_too[LINES - sizeof(atomic_ullong)];
} thread_tasks;

struct team {
  _Alignas(TEAM_ALIGNMENT) atomic_uint over; /* loops that are */
  char apart[LINES - sizeof(atomic_uint)];
  atomic_uint ending; /* the loop of which `last` has been taken */
  char apart_too[LINES - sizeof(atomic_uint)];
  atomic_ullong alone; /* nanoseconds in all `last`, when one thread works */
  char apart_as_well[LINES - sizeof(atomic_ullong)];
  thread_tasks of_thread[];
};

uint64_t team_bytes(uint32_t threads) { return sizeof(team) + threads * sizeof(thread_tasks); }

void team_reset(team *all, uint32_t threads) {
  atomic_init(&all->over, 0);
  atomic_init(&all->ending, 0);
  atomic_init(&all->alone, 0);
  for (uint32_t t = 0; t < threads; ++t) {
    atomic_init(&all->of_thread[t].left, 0);
    atomic_init(&all->of_thread[t].done, 0);
  }
}

/* Numbers of loops may wrap around. */
static int is_before(uint32_t a, uint32_t b) { return (int32_t)(a - b) < 0; }

static unsigned long long pack(left l) {
  return (unsigned long long)l.loop << 32 | l.first << 16 | l.last;
}

static left unpack(unsigned long long word) {
  return (left){(uint32_t)(word >> 32), (uint32_t)(word >> 16) & TEAM_MAX_TASKS,
                (uint32_t)word & TEAM_MAX_TASKS};
}

/* Takes a task of the loop from a thread's part; 0 when none is left there. The first thread that
 * comes divides the part up. */
static int take_task(const team_thread *self, uint32_t thread, uint32_t tasks, uint32_t *task) {
  atomic_ullong *word = &self->team->of_thread[thread].left;
  unsigned long long seen = atomic_load_explicit(word, memory_order_relaxed), next;
  do {
    left l = unpack(seen);
    if (is_before(self->loops, l.loop)) return 0;
    if (l.loop != self->loops)
      l = (left){self->loops, (uint32_t)((uint64_t)tasks * thread / self->threads),
                 (uint32_t)((uint64_t)tasks * (thread + 1) / self->threads)};
    if (l.first == l.last) return 0;
    *task = thread == self->thread ? l.first++ : --l.last;
    next = pack(l);
  } while (!atomic_compare_exchange_weak_explicit(word, &seen, next, memory_order_relaxed,
                                                  memory_order_relaxed));
  return 1;
}

static void work_on(team_thread *self, uint32_t thread, uint32_t tasks, task_function task,
                    void *context) {
  uint64_t done = self->done;
  for (uint32_t k; take_task(self, thread, tasks, &k); ++self->done) task(context, k);
  if (self->done > done)
    atomic_store_explicit(&self->team->of_thread[self->thread].done, self->done,
                          memory_order_release);
}

static int loop_is_over(const team_thread *self) {
  return !is_before(atomic_load_explicit(&self->team->over, memory_order_acquire), self->loops);
}

/* Counts only grow, and none of the next loop's tasks is done before this loop is over. */
static int all_done(const team_thread *self) {
  uint64_t done = 0;
  for (uint32_t t = 0; t < self->threads; ++t)
    done += atomic_load_explicit(&self->team->of_thread[t].done, memory_order_acquire);
  return done >= self->tasks;
}

/* One thread alone ends a loop. */
static void end_loop(const team_thread *self, completion_function last, void *context) {
  uint32_t ended = atomic_load_explicit(&self->team->ending, memory_order_relaxed);
  if (!is_before(ended, self->loops)) return;
  if (!atomic_compare_exchange_strong_explicit(&self->team->ending, &ended, self->loops,
                                               memory_order_relaxed, memory_order_relaxed))
    return;
  if (last) {
    const double begin = pbf_seconds();
    last(context);
    atomic_fetch_add_explicit(&self->team->alone,
                              (unsigned long long)(1e9 * (pbf_seconds() - begin)),
                              memory_order_relaxed);
  }
  atomic_store_explicit(&self->team->over, self->loops, memory_order_release);
}

/* Seconds that one thread has worked alone. */
static double seconds_alone(const team_thread *self) {
  return 1e-9 * (double)atomic_load_explicit(&self->team->alone, memory_order_relaxed);
}

static void wait_for_end(team_thread *self, completion_function last, void *context) {
  const double alone = seconds_alone(self);
  double since = 0;
  for (unsigned looks = 1; !loop_is_over(self); wait_a_little(&looks)) {
    if ((self->thread == 0 || looks % LOOKS_BEFORE_COUNT == 0) && all_done(self))
      end_loop(self, last, context);
    if (looks == LOOKS_OF_LONG_WAIT) since = pbf_seconds();
  }
  if (since == 0) return;
  const double waited = pbf_seconds() - since - (seconds_alone(self) - alone);
  if (waited > 0) self->waited += waited;
}

void team_parallel_for(team_thread *self, uint32_t tasks, task_function task,
                       completion_function last, void *context) {
  ++self->loops;
  self->tasks += tasks;
  if (self->threads == 1) {
    for (uint32_t k = 0; k < tasks; ++k) task(context, k);
    if (last) last(context);
    return;
  }
  for (uint32_t k = 0; k < self->threads && !loop_is_over(self); ++k)
    work_on(self, (self->thread + self->threads - k) % self->threads, tasks, task, context);
  wait_for_end(self, last, context);
}
