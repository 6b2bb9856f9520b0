/* Long runs: case 30. */
#include <string>

#include "stability/cases.h"
#include "stability/fluid.h"

namespace bench::stability {
namespace {

// Memory is looked at after the first tenth, when everything has been allocated, and at the end.
void run_long(Record &record, Trial &trial, const std::string &label) {
  const uint32_t steps = record.quick_or(1200u, 100000u);
  trial.run(steps / 10, 10);
  record.memory(label + ", a tenth");
  trial.run(steps - steps / 10, 90);
  record.memory(label + ", the end");
}

}  // namespace

void long_runs(Record &record) {
  const double side = record.quick_or(0.25, 0.3);
  Start start = tank({side, 0.5, side}, {side, side, side});
  Trial rest(record, "rest", start);
  run_long(record, rest, "rest");
  rest.draw("At the end of a long rest");

  // A wall that swings makes waves for as long as the run lasts.
  start.params.wall_amplitude[PBF_WALL_X_MAX] = spacing;
  start.params.wall_frequency[PBF_WALL_X_MAX] = 7;
  Trial motion(record, "motion", start);
  run_long(record, motion, "motion");
  motion.draw("At the end of a long shaking");
}

}  // namespace bench::stability
