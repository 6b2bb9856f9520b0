/* What the teams that share loops need of them: those that cpu_team has in common
 * with another one, and what comes before a run. */
#ifndef PBF_CPU_TEAM_LOOPS_H
#define PBF_CPU_TEAM_LOOPS_H

#include "cpu/team.h"

/* More threads than that gain nothing. */
enum { TEAM_MAX_THREADS = 256 };

/* Before so many threads begin to run: no loop has begun. */
void team_reset(team *all, uint32_t threads);

uint64_t team_bytes(uint32_t threads);
void team_parallel_for(team_thread *self, uint32_t tasks, task_function task,
                       completion_function last, void *context);

#endif
