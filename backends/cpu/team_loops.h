/* What the teams that share loops need of them: team_loops.c has parallel_for and team_bytes. */
#ifndef PBF_CPU_TEAM_LOOPS_H
#define PBF_CPU_TEAM_LOOPS_H

#include "cpu/team.h"

/* More threads than that gain nothing. */
enum { TEAM_MAX_THREADS = 256 };

/* Before so many threads begin to run: no loop has begun. */
void team_reset(team *all, uint32_t threads);

#endif
