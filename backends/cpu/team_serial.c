#include "cpu/team.h"

uint32_t team_size(uint32_t wanted) {
  (void)wanted;
  return 1;
}

uint32_t team_threads(uint32_t threads) { return threads; }

uint64_t team_bytes(uint32_t threads) {
  (void)threads;
  return 0;
}

const int team_resizes = 0;

const int team_ignores_tasks = 0;

const uint64_t team_run_length = UINT64_MAX;

void team_begin(void) {}

void team_end(void) {}

void team_run(const team_tasks *tasks, team *all, uint32_t threads, team_function function,
              void *context) {
  (void)tasks;
  team_thread self = {.team = all, .thread = 0, .threads = threads};
  function(context, &self);
}

void parallel_for(team_thread *self, uint32_t tasks, task_function task, completion_function last,
                  void *context) {
  (void)self;
  for (uint32_t k = 0; k < tasks; ++k) task(context, k);
  if (last) last(context);
}
