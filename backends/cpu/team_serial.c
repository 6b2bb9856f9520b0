/* A team of one thread: the caller. */
#include "cpu/team.h"

static uint32_t one(uint32_t wanted) {
  (void)wanted;
  return 1;
}

static uint32_t all_of(uint32_t threads) { return threads; }

static uint64_t no_bytes(uint32_t threads) {
  (void)threads;
  return 0;
}

static void nothing(void) {}

static void run_here(const team_tasks *tasks, team *all, uint32_t threads, team_function function,
                     void *context) {
  (void)tasks;
  team_thread self = {.api = &cpu_team, .team = all, .thread = 0, .threads = threads};
  function(context, &self);
}

static void one_after_another(team_thread *self, uint32_t tasks, task_function task,
                              completion_function last, void *context) {
  (void)self;
  for (uint32_t k = 0; k < tasks; ++k) task(context, k);
  if (last) last(context);
}

const team_api cpu_team = {.run_length = UINT64_MAX,
                           .size = one,
                           .threads = all_of,
                           .bytes = no_bytes,
                           .begin = nothing,
                           .end = nothing,
                           .run = run_here,
                           .parallel_for = one_after_another};
