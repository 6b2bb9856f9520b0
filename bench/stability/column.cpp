/* Deep water, and many iterations: cases 11 and 12. */
#include "stability/cases.h"
#include "stability/fluid.h"

namespace bench::stability {

void deep_columns(Record &record) {
  const std::vector<unsigned> depths =
      record.quick() ? std::vector<unsigned>{20, 60} : std::vector<unsigned>{100, 300, 1000};
  for (const unsigned layers : depths) {
    const double side = 4 * spacing, height = layers * spacing;
    Start start = tank({side, 1.1 * height, side}, {side, height, side});
    Trial trial(record, "layers-" + std::to_string(layers), start);
    trial.run(record.quick_or(240u, 1800u), 12);
  }
}

// One step of ever more iterations, each from the same squeezed and shaken block.
void many_iterations(Record &record) {
  Start start;
  start.params.gravity[1] = 0;
  start.params.prestabilization = 0;  // the iterations are to find the squeezed block
  const double apart = 0.92 * spacing, side = 7 * apart;
  start.particles = box({0.3, 0.3, 0.3}, {0.3 + side, 0.3 + side, 0.3 + side}, apart);
  jitter(start.particles, 0.05 * spacing, 12);
  for (const uint32_t iterations : {1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1000}) {
    start.params.iterations = iterations;
    Trial(record, "iterations-" + std::to_string(iterations), start).run(1, 1);
  }
}

}  // namespace bench::stability
