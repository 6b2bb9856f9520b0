#include "helpers.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <string.h>
#include <time.h>

enum { SHOWN = MOST_ACTORS * SUBJECTS * TWINS, MOST_HELPERS = 8 };

static struct {
  const settings *with;
  uint64_t seed;
  actor *actors;
  _Atomic(pbf_solver *) shown[SHOWN];
  _Atomic(pbf_solver *) to_cancel[MOST_ACTORS];
  pthread_t threads[MOST_HELPERS];
  uint32_t count, cancellers;
  atomic_int over;
} all;

void helpers_show(const actor *a) {
  for (uint32_t k = 0; k < SUBJECTS * TWINS; ++k)
    atomic_store(&all.shown[a->number * SUBJECTS * TWINS + k],
                 a->subjects[k / TWINS].twin[k % TWINS]);
}

/* Of a helper, whose findings are no actor's. */
static actor nobody = {.number = MOST_ACTORS, .function = "another thread"};

static void rest(dice *d, uint32_t most_microseconds) {
  const struct timespec nap = {0, 1000 * (long)(1 + dice_below(d, most_microseconds))};
  nanosleep(&nap, NULL);
}

static pbf_solver *draw_solver(dice *d) { return atomic_load(&all.shown[dice_below(d, SHOWN)]); }

/* ---- Calls into solvers of others ---- */

static void intrude(pbf_solver *s, dice *d) {
  pbf_info info = {.struct_size = sizeof info};
  pbf_plan plan = {.struct_size = sizeof plan};
  uint64_t hash;
  uint32_t count;
  pbf_status status;
  count_fault(FAULT_INTRUDER);
  switch (dice_below(d, 5)) {
    case 0:
      status = pbf_get_count(s, &count);
      break;
    case 1:
      status = pbf_hash(s, &hash);
      break;
    case 2:
      status = pbf_get_info(s, &info);
      break;
    case 3:
      status = pbf_get_plan(s, &plan);
      break;
    default:
      status = pbf_synchronize(s);
      break;
  }
  check_status(&nobody, status, pbf_last_error());
}

static void *meddle(void *unused) {
  dice d = dice_of(all.seed, 7777, 1);
  (void)unused;
  while (!all.over) {
    pbf_solver *s = draw_solver(&d);
    if (s && all.with->cancels && dice_one_in(&d, 4))
      check_status(&nobody, pbf_cancel(s), pbf_last_error());
    if (s && all.with->intruders) intrude(s, &d);
    rest(&d, 2000);
  }
  return NULL;
}

/* ---- Cancelling on request ---- */

int helpers_cancel_soon(pbf_solver *solver) {
  if (all.cancellers == 0 || !this_actor) return 0;
  atomic_store(&all.to_cancel[this_actor->number], solver);
  return 1;
}

void helpers_cancel_no_more(void) { atomic_store(&all.to_cancel[this_actor->number], NULL); }

static void *cancel(void *unused) {
  dice d = dice_of(all.seed, 7777, 2);
  (void)unused;
  while (!all.over) {
    rest(&d, 1500);
    for (int k = 0; k < MOST_ACTORS; ++k) {
      pbf_solver *s = atomic_load(&all.to_cancel[k]);
      if (s) check_status(&nobody, pbf_cancel(s), pbf_last_error());
    }
  }
  return NULL;
}

/* ---- Reading ---- */

static void check_snapshot(const pbf_snapshot *s) {
  for (uint32_t i = 0; i < s->count; ++i)
    if (i > 0 && s->ids[i] <= s->ids[i - 1]) found(MOST_ACTORS, "a snapshot's ids do not increase");
  for (uint64_t i = 0; i < (uint64_t)s->count * s->dimension; ++i) {
    const double x = s->element_type == PBF_TYPE_FLOAT32 ? (double)((const float *)s->positions)[i]
                                                         : ((const double *)s->positions)[i];
    if (!isfinite(x)) found(MOST_ACTORS, "a snapshot's position is not finite");
  }
}

static uint64_t sum_of(const pbf_snapshot *s) {
  uint64_t sum = s->count + s->step;
  const unsigned char *x = s->positions;
  for (uint64_t i = 0; i < (uint64_t)s->count * s->dimension * s->element_type; ++i)
    sum = (sum ^ x[i]) * UINT64_C(0x100000001b3);
  return sum;
}

/* What is held stays as it is, also when its solver is gone. */
static void *read_snapshots(void *unused) {
  dice d = dice_of(all.seed, 7777, 3);
  (void)unused;
  while (!all.over) {
    pbf_snapshot held = {.struct_size = sizeof held};
    pbf_solver *s = draw_solver(&d);
    pbf_status status = s ? pbf_acquire_snapshot(s, &held) : PBF_ERROR_NOT_FOUND;
    if (s) check_status(&nobody, status, pbf_last_error());
    if (status == PBF_OK) {
      count_fault(FAULT_READER);
      check_snapshot(&held);
      const uint64_t before = sum_of(&held);
      rest(&d, 4000);
      if (sum_of(&held) != before) found(MOST_ACTORS, "a snapshot that is held has changed");
      if (pbf_release_snapshot(&held) != PBF_OK)
        found(MOST_ACTORS, "pbf_release_snapshot: %s", pbf_last_error());
    }
    rest(&d, 1000);
  }
  return NULL;
}

/* ---- Signals ---- */

static void handle(int number) {
  actor *a = this_actor;
  const int error = errno;
  uint32_t count;
  (void)number;
  if (!a) return;
  ++a->signals;
  count_fault(FAULT_SIGNAL);
  for (int k = 0; k < SUBJECTS; ++k) {
    pbf_solver *s = atomic_load(&all.shown[(a->number * SUBJECTS + (uint32_t)k) * TWINS]);
    pbf_status status = s ? pbf_get_count(s, &count) : PBF_OK;
    if (status > 0 || status < PBF_ERROR_CANCELLED)
      found(a->number, "a signal handler: pbf_get_count returns %d", (int)status);
  }
  errno = error;
}

static void *send_signals(void *unused) {
  dice d = dice_of(all.seed, 7777, 4);
  (void)unused;
  while (!all.over) {
    rest(&d, 3000);
    actor *a = &all.actors[dice_below(&d, all.with->actors)];
    pthread_kill(a->thread, SIGUSR1);
  }
  return NULL;
}

/* ---- Load ---- */

static void *be_busy(void *unused) {
  volatile uint64_t turns = 0;
  (void)unused;
  count_fault(FAULT_LOAD);
  while (!all.over) ++turns;
  return NULL;
}

/* ---- All of them ---- */

static uint32_t begin_one(void *(*work)(void *)) {
  sigset_t every, before;
  sigfillset(&every);
  pthread_sigmask(SIG_SETMASK, &every, &before);
  const int started =
      all.count < MOST_HELPERS && pthread_create(&all.threads[all.count], NULL, work, NULL) == 0;
  pthread_sigmask(SIG_SETMASK, &before, NULL);
  all.count += (uint32_t)started;
  return (uint32_t)started;
}

void helpers_begin(const settings *with, uint64_t seed, actor *actors) {
  all.with = with;
  all.seed = seed;
  all.actors = actors;
  struct sigaction handler = {.sa_handler = handle, .sa_flags = SA_RESTART};
  sigaction(SIGUSR1, &handler, NULL);
  if (with->cancels) all.cancellers = begin_one(cancel);
  if (with->cancels || with->intruders) begin_one(meddle);
  if (with->readers) begin_one(read_snapshots);
  if (with->signals) begin_one(send_signals);
  for (uint32_t k = 0; k < with->busy_threads; ++k) begin_one(be_busy);
}

void helpers_end(void) {
  all.over = 1;
  for (uint32_t k = 0; k < all.count; ++k) pthread_join(all.threads[k], NULL);
  all.count = 0;
}
