/* Time steps too large, too small and changing: cases 7 to 10. */
#include "stability/cases.h"
#include "stability/fluid.h"

namespace bench::stability {
namespace {

void coarse(Record &record, double factor) {
  Start start = dam_break(record.quick());
  start.params.time_step *= factor;
  Trial trial(record, "dam", start);
  trial.run(60, 60);
  trial.draw("After 60 steps");
}

// A tank whose surface is a step, which then sloshes gently.
Start sloshing(bool quick) {
  const double width = 0.8, depth = quick ? 0.2 : 0.4;
  Start start = tank({width, 0.8, 0.2}, {width / 2, 0.45, 0.2});
  append(start.particles, box({width / 2, 0, 0}, {width, 0.35, 0.2}));
  if (quick) {
    start.particles = box({0, 0, 0}, {width / 2, depth + 0.05, 0.2});
    append(start.particles, box({width / 2, 0, 0}, {width, depth - 0.05, 0.2}));
  }
  return start;
}

}  // namespace

void step_times_10(Record &record) { coarse(record, 10); }

void step_times_100(Record &record) { coarse(record, 100); }

// A drop that flies and water at rest: a particle moves less in a step than float32 tells apart.
void tiny_step(Record &record) {
  const uint32_t steps = record.quick_or(1000u, 10000u);
  Start drop;
  drop.params.time_step = 1e-7;
  drop.params.gravity[1] = 0;
  drop.particles = ball({0.5, 0.5, 0.5}, 0.15, {1, 0.5, 0.25});
  Trial(record, "drop", drop).run(steps, 4);
  Start still = tank({0.3, 0.6, 0.3}, {0.3, 0.3, 0.3});
  still.params.time_step = 1e-7;
  Trial(record, "still", still).run(steps, 4);
}

void alternating_step(Record &record) {
  const double shortest = 1.0 / 1200;
  Start start = sloshing(record.quick());
  start.params.time_step = 5.5 * shortest;
  const uint32_t pairs = 30, frames = record.quick_or(2u, 8u);  // 0.275 s a frame
  Trial(record, "constant", start).run(frames * 2 * pairs, frames);

  start.params.time_step = shortest;
  Trial trial(record, "alternating", start);
  pbf_params params = start.params;
  for (uint32_t frame = 0; frame < frames; ++frame) {
    for (uint32_t pair = 0; pair < pairs; ++pair) {
      for (const double step : {shortest, 10 * shortest}) {
        params.time_step = step;
        must(pbf_set_params(trial.solver(), &params));
        trial.step(1);
      }
    }
    trial.frame();
  }
}

}  // namespace bench::stability
