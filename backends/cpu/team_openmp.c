/* Threads by OpenMP. */
#include <omp.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "common/at_load.h"
#include "common/fp_environment.h"
#include "cpu/team_loops.h"
#include "cpu/startable_threads.h"

#if defined(__GLIBC__)
#include <dlfcn.h>
#endif

/* OMP_NUM_THREADS may want more than there are CPUs: then `auto` would prefer this runtime, which
 * ends the process where it can't start a thread. */
static uint32_t team_size(uint32_t wanted) {
  if (!pbf_process_is_told()) return 1; /* not a call of the runtime: see below */
  uint32_t threads = wanted ? wanted : (uint32_t)omp_get_max_threads();
  if (!wanted && threads > pbf_processors()) threads = pbf_processors();
  uint32_t limit = (uint32_t)omp_get_thread_limit();
  if (threads > limit) threads = limit;
  return threads < TEAM_MAX_THREADS ? threads : TEAM_MAX_THREADS;
}

static void nothing(void) {}

/* ---- Threads that can be had --------------------------------------------------------------- */

/* Where OpenMP's threads are: they do not go along with a fork, and the runtime would wait for them
 * in the child for ever, also for those that the program's own loops have left it. 0: nowhere. */
static uint32_t home;

/* LLVM's runtime names memory that all processes see after the process's number: the second process
 * that is not told its own would find that of the first, and end. */
static int may_use_runtime(void) { return pbf_process() == home && pbf_process_is_told(); }

/* GCC's runtime ends threads by pthread_exit, for which the C library then loads the unwinder, and
 * ends the process where there is no memory for that: it has to be there before. */
static int has_unwinder(void) {
#if defined(__GLIBC__)
  return dlopen("libgcc_s.so.1", RTLD_NOW | RTLD_NODELETE) != NULL;
#else
  return 1;
#endif
}

/* Of the stacks of the runtime's threads: it has read this when it was loaded. 0: not said. */
static size_t stack_bytes;

static size_t bytes_of(const char *text) {
  static const char units[] = "bkmg";
  if (!text) return 0;
  const unsigned long long number = strtoull(text, (char **)&text, 10);
  while (*text == ' ') ++text;
  const char *unit = *text ? strchr(units, *text | 0x20) : units + 1;
  if (!unit || !*unit) return 0;
  const unsigned shift = 10 * (unsigned)(unit - units);
  return number < SIZE_MAX >> shift ? (size_t)number << shift : 0;
}

PBF_CONSTRUCTOR static void remember_home(void) {
  home = has_unwinder() ? pbf_process() : 0;
  stack_bytes = bytes_of(pbf_environment("OMP_STACKSIZE"));
}

/* Threads of the last run that this thread began, and their numbers: the runtime keeps them for the
 * next one, unless a loop of the program's own has wanted fewer. Most that there could be when it
 * wanted more; 0: it did not, or got them. */
typedef struct last_run {
  uint32_t kept, max_threads;
  long numbers[TEAM_MAX_THREADS];
} last_run;

static pbf_per_thread last_runs;

PBF_CONSTRUCTOR static void begin_last_runs(void) {
  pbf_per_thread_begin(&last_runs, sizeof(last_run));
}

PBF_DESTRUCTOR static void end_last_runs(void) { pbf_per_thread_end(&last_runs); }

static uint32_t team_threads(uint32_t threads) {
  const last_run *last = pbf_per_thread_look(&last_runs);
  if (!may_use_runtime()) return 1;
  return last && last->max_threads && last->max_threads < threads ? last->max_threads : threads;
}

/* The calling thread and those of the last run that have not ended. */
static uint32_t threads_there(const last_run *last) {
  uint32_t there = 1;
  while (there < last->kept && thread_is_there(last->numbers[there])) ++there;
  return there;
}

/* OpenMP's runtime ends the process when it can't start a thread. `last` may be null. */
static uint32_t threads_to_be_had(last_run *last, uint32_t threads) {
  if (!last || threads == 1 || !may_use_runtime() || !pbf_can_wait()) return 1;
  uint32_t there = threads_there(last);
  uint32_t had = threads;
  if (threads > there) had = there + startable_threads(threads - there, stack_bytes);
  last->max_threads = had < threads ? had : 0;
  return last->kept = had;
}

/* Where a team is smaller than the last one of this thread, GCC's runtime ends the threads that it
 * has no use for. They read the memory of the pool until they have ended, and that goes when this
 * thread ends, without waiting for those. Other runtimes keep theirs, which shows once. */
static void wait_for_surplus(const last_run *last, uint32_t kept_before) {
#if defined(__linux__) && !defined(__clang__)
  static _Atomic int keeps_threads;
  for (uint32_t k = last->kept; k < kept_before && !keeps_threads; ++k)
    if (!thread_has_ended(last->numbers[k], 1)) keeps_threads = 1;
#else
  (void)last, (void)kept_before;
#endif
}

#if defined(__linux__) && !defined(__clang__)
extern int omp_pause_resource(omp_pause_resource_t, int) __attribute__((weak)); /* since GCC 9 */
#endif

/* Which thread a solver was last run in, by the memory of its team, as far as there is room. */
static struct { _Atomic uintptr_t team, caller; } last_callers[64];

static int comes_from_another_thread(const team *all) {
  enum { SLOTS = sizeof last_callers / sizeof *last_callers };
  const size_t slot = (uintptr_t)all / TEAM_ALIGNMENT % SLOTS;
  const uintptr_t own = pbf_this_thread();
  const uintptr_t team_before = atomic_exchange(&last_callers[slot].team, (uintptr_t)all);
  const uintptr_t before = atomic_exchange(&last_callers[slot].caller, own);
  return team_before == (uintptr_t)all && before != own;
}

/* GCC's runtime keeps a pool for each thread that has begun a loop. Of threads that run a solver by
 * turns all but the first give theirs back: then there are as many as were asked for. */
static void give_back_if_by_turns(const team *all, last_run *last) {
#if defined(__linux__) && !defined(__clang__)
  if (!comes_from_another_thread(all) || !omp_pause_resource) return;
  if (omp_pause_resource(omp_pause_soft, omp_get_initial_device()) == 0) last->kept = 1;
#else
  (void)all, (void)last, (void)comes_from_another_thread;
#endif
}

static void run_alone(team *all, team_function function, void *context) {
  team_thread alone = {.api = &cpu_team, .team = all, .thread = 0, .threads = 1};
  function(context, &alone);
}

/* Not inlined: LLVM's compiler calls the runtime where a function begins that has such a loop. */
__attribute__((noinline)) static void run_together(team *all, uint32_t threads,
                                                   team_function function, void *context,
                                                   long *numbers) {
#pragma omp parallel num_threads((int)threads)
  {
    numbers[omp_get_thread_num()] = thread_number();
    pbf_fp_environment before = pbf_fp_begin();
    team_thread self = {.api = &cpu_team,
                        .team = all,
                        .thread = (uint32_t)omp_get_thread_num(),
                        .threads = (uint32_t)omp_get_num_threads()};
    function(context, &self);
    pbf_fp_end(before);
  }
}

static void team_run(const team_tasks *tasks, team *all, uint32_t threads, team_function function,
                     void *context) {
  (void)tasks;
  last_run *last = threads == 1 ? NULL : pbf_per_thread_take(&last_runs);
  const uint32_t kept_before = last ? last->kept : 0;
  threads = threads_to_be_had(last, threads);
  team_reset(all, threads);
  if (threads == 1) {
    run_alone(all, function, context);
    return;
  }
  run_together(all, threads, function, context, last->numbers);
  wait_for_surplus(last, kept_before);
  give_back_if_by_turns(all, last);
}

const team_api cpu_team = {.ignores_tasks = 1,
                           .run_length = UINT64_MAX,
                           .size = team_size,
                           .threads = team_threads,
                           .bytes = team_bytes,
                           .begin = nothing,
                           .end = nothing,
                           .run = team_run,
                           .parallel_for = team_parallel_for};
