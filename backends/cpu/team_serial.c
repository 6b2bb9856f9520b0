#include <stddef.h>

#include "cpu/team.h"

uint32_t team_size(uint32_t wanted) {
  (void)wanted;
  return 1;
}

void team_run(uint32_t threads, team_function function, void *context) {
  member me = {.team = NULL, .thread = 0, .threads = threads};
  function(context, &me);
}

void team_barrier(member *me) { (void)me; }
