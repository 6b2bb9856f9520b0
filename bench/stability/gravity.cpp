/* Forces and parameters that jump: cases 13, 14, 28. */
#include "stability/cases.h"
#include "stability/fluid.h"

namespace bench::stability {
namespace {

Start half_full(bool quick) {
  return quick ? tank({0.4, 0.6, 0.3}, {0.4, 0.3, 0.3}) : tank({0.6, 1, 0.5}, {0.6, 0.5, 0.5});
}

}  // namespace

void heavy(Record &record) {
  Start start = half_full(record.quick());
  Trial trial(record, "settling", start);
  trial.run(settling_steps, 2);
  pbf_params heavier = start.params;
  heavier.gravity[1] *= 1000;
  trial.change(heavier, "heavy");
  trial.run(60, 12);
  trial.draw("Gravity x 1,000 for half a second");
  trial.change(start.params, "after");
  trial.run(record.quick_or(360u, 720u), 6);
  trial.draw("After gravity was normal again");
}

void flipping_gravity(Record &record) {
  Start start = half_full(record.quick());
  Trial trial(record, "settling", start);
  trial.run(settling_steps, 2);
  trial.begin("second-0");
  const unsigned flips = record.quick_or(2u, 10u);
  for (unsigned second = 1; second <= flips; ++second) {
    trial.run(120, 3);
    pbf_params params = trial.params();
    params.gravity[1] = -params.gravity[1];
    trial.change(params, "second-" + std::to_string(second));
  }
  trial.run(record.quick_or(240u, 600u), 4);
  trial.draw("After gravity has flipped every second");
}

void sudden_changes(Record &record) {
  Start start = half_full(record.quick());
  // Spelt out, so that a change of one does not change the other.
  start.params.spacing = spacing;
  start.params.particle_volume = spacing * spacing * spacing;
  Trial trial(record, "settling", start);
  const uint32_t steps = record.quick_or(90u, 240u);
  const auto then = [&](const char *label, void (*edit)(pbf_params &)) {
    pbf_params params = trial.params();
    edit(params);
    trial.change(params, label);
    trial.run(12, 12);
    trial.run(steps, 8);
  };
  trial.run(steps, 4);
  then("support-up", [](pbf_params &p) { p.smoothing_radius *= 1.1; });
  then("support-back", [](pbf_params &p) { p.smoothing_radius /= 1.1; });
  then("lighter", [](pbf_params &p) { p.particle_volume *= 1.05; });
  then("heavier", [](pbf_params &p) { p.particle_volume /= 1.05; });
  then("gravity-doubled", [](pbf_params &p) { p.gravity[1] *= 2; });
  then("gravity-sideways", [](pbf_params &p) {
    p.gravity[0] = 4;
    p.gravity[1] /= 2;
  });
}

}  // namespace bench::stability
