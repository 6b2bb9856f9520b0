#include "round.h"

#include <dirent.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "actor.h"
#include "helpers.h"
#include "limits.h"
#include "table.h"
#include "tasks.h"

/* ---- Which backends there are ---- */

static const char *const known[] = {"reference", "serial", "threads", "openmp", "cuda"};
enum { KNOWN = sizeof known / sizeof known[0] };

static int serves(const char *name) {
  pbf_backend_info info = {.struct_size = sizeof info};
  for (uint32_t k = 0; pbf_get_backend_info(NULL, k, &info) == PBF_OK; ++k)
    if (strcmp(info.name, name) == 0 && info.available) return 1;
  return 0;
}

/* ---- What it has ---- */

static void draw_limits(settings *s, dice *d) {
  s->limit_addresses = !s->instrumented && dice_one_in(d, 2);
  s->limit_threads = !s->limit_addresses;
  s->actors = 1; /* what one finds is not to be had for another a moment later */
  s->memory = dice_one_in(d, 2);
}

static void draw_disturbers(settings *s, dice *d) {
  s->actors = 1 + dice_below(d, 3);
  s->memory = dice_one_in(d, 2);
  s->leaving = dice_one_in(d, 3);
  s->cancels = dice_one_in(d, 2);
  s->intruders = dice_one_in(d, 3);
  s->signals = dice_one_in(d, 3);
  s->readers = dice_one_in(d, 2);
  s->tasks = dice_one_in(d, 2);
  s->busy_threads = dice_one_in(d, 4) ? 1 : 0;
  s->forks = 1;
}

static settings draw_settings(uint64_t seed, int instrumented) {
  static const char *found[KNOWN];
  dice d = dice_of(seed, 9999, 0);
  settings s = {.instrumented = instrumented, .calls = MOST_CALLS, .backends = found};
  s.environments = dice_one_in(&d, 2);
  s.exits = dice_one_in(&d, 8);
  if (dice_one_in(&d, 8))
    draw_limits(&s, &d);
  else
    draw_disturbers(&s, &d);
  if (instrumented) { /* a sanitizer's runtime has locks of its own, which a fork leaves taken */
    const int alone = s.actors == 1 && !s.cancels && !s.intruders && !s.signals && !s.readers;
    s.forks = 0 && alone;
    s.leaving = 0;
  }
  for (int k = 0; k < KNOWN; ++k)
    if (serves(known[k])) found[s.backend_count++] = known[k];
  return s;
}

/* ---- What is left over ---- */

static int entries_in(const char *folder) {
  DIR *opened = opendir(folder);
  int count = 0;
  if (!opened) return -1;
  while (readdir(opened)) ++count;
  closedir(opened);
  return count;
}

static void check_left_over(const char *folder, int before, const char *what) {
  const struct timespec nap = {0, 20000000};
  int now = entries_in(folder);
  for (int tries = 0; tries < 3000 && now > before; ++tries) { /* threads end a little later */
    nanosleep(&nap, NULL);
    now = entries_in(folder);
  }
  if (now > before)
    found(MOST_ACTORS, "%d %s before the first solver, and %d after the last", before - 2, what,
          now - 2);
}

static int has_device(const settings *s) {
  return strcmp(s->backends[s->backend_count - 1], "cuda") == 0;
}

/* A device's driver, and clang's OpenMP. */
static int runtimes_keep_threads(const settings *s) {
#if defined(__clang__)
  (void)s;
  return 1;
#else
  return has_device(s);
#endif
}

/* ---- Limits ---- */

static void lower_limits(const settings *s, dice *d) {
  if (s->limit_threads) limit_threads(1 + dice_below(d, 6));
  if (s->limit_addresses) limit_addresses(dice_below(d, 96u << 20));
}

/* ---- Running ---- */

static atomic_uint done;
static atomic_int limits_are_lowered;

static void *act(void *user) {
  const struct timespec nap = {0, 1000000};
  actor *a = user;
  while (!limits_are_lowered) nanosleep(&nap, NULL);
  this_actor = a;
  for (a->call = 0; a->call < a->with->calls; ++a->call) make_call(a);
  this_actor = NULL;
  atomic_fetch_add(&done, 1);
  return NULL;
}

static void begin_actors(actor *all, const settings *s, uint64_t seed) {
  for (uint32_t k = 0; k < s->actors; ++k) {
    all[k].number = k;
    all[k].with = s;
    all[k].seed = seed;
    all[k].others = all;
    all[k].thread = pthread_self();
  }
}

static uint32_t start_actors(actor *all, const settings *s, int only) {
  uint32_t started = 0;
  for (uint32_t k = 0; k < s->actors; ++k)
    if ((only == EVERY_ACTOR || only == (int)k) &&
        pthread_create(&all[k].thread, NULL, act, &all[k]) == 0)
      ++started;
  return started;
}

static void drop_all(actor *all, const settings *s) {
  for (uint32_t k = 0; k < s->actors; ++k)
    for (int i = 0; i < SUBJECTS; ++i) {
      all[k].function = "pbf_destroy";
      subject_drop(&all[k], &all[k].subjects[i]);
    }
}

/* A sanitizer that looks for leaks wants a thread for that. */
_Noreturn static void end(const settings *s) {
  if (s->instrumented && s->limit_threads) _exit(0);
  exit(0);
}

void round_run(uint64_t seed, int only_actor) {
  static actor all[MOST_ACTORS];
  const struct timespec nap = {0, 1000000};
  settings s = draw_settings(seed, TEST_INSTRUMENTED);
  dice d = dice_of(seed, 9999, 1);
  if (s.backend_count == 0) found(MOST_ACTORS, "no backend serves");
  const int threads = entries_in("/proc/self/task"), files = entries_in("/proc/self/fd");
  begin_actors(all, &s, seed);
  if (s.tasks) tasks_begin(2);
  helpers_begin(&s, seed, all);
  const uint32_t started = start_actors(all, &s, only_actor);
  lower_limits(&s, &d);
  limits_are_lowered = 1;
  while (done < started) nanosleep(&nap, NULL);
  helpers_end();
  for (uint32_t k = 0; k < s.actors; ++k)
    if (!pthread_equal(all[k].thread, pthread_self())) pthread_join(all[k].thread, NULL);
  if (s.exits) {
    count_fault(FAULT_EXIT);
    end(&s);
  }
  drop_all(all, &s);
  tasks_end();
  check_heaps();
  if (!runtimes_keep_threads(&s)) check_left_over("/proc/self/task", threads, "threads");
  if (!has_device(&s)) check_left_over("/proc/self/fd", files, "descriptors");
  end(&s);
}
