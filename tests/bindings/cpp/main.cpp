/* pbf.hpp as programs use it. */
#include "support.h"

/* A solver that nothing destroys before the process ends. */
static std::optional<pbf::solver> at_exit;

int main() {
  int failed = 0;
  for (const auto &group :
       {values, motion, shapes, queries, emission, phases, batches, diffuse, lifetimes, logs})
    failed += group();
  if (failed) return failed;
  at_exit = filled();
  return at_exit->begin_step(1000000000).status();
}
