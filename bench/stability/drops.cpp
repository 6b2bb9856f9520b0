/* Two drops that collide in free space: case 29. */
#include "stability/cases.h"
#include "stability/fluid.h"

namespace bench::stability {

void colliding_drops(Record &record) {
  const double radius = record.quick_or(0.15, 0.3);
  Start start;
  start.params.gravity[1] = 0;
  for (double &side : start.params.domain_max) side = 6;
  start.particles = ball({3 - 1.2 * radius, 3, 3}, radius, {1, 0, 0});
  append(start.particles, ball({3 + 1.2 * radius, 3 + radius / 2, 3}, radius, {-1, 0, 0}));
  Trial trial(record, "drops", start);
  trial.run(record.quick_or(60u, 120u), 12);
  trial.draw("Two drops after they have met");
}

}  // namespace bench::stability
