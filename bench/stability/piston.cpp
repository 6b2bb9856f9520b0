/* A wall that drives the fluid together and lets go again: cases 18 and 19. */
#include "stability/cases.h"
#include "stability/fluid.h"

namespace bench::stability {
namespace {

constexpr double half_turn = 3.14159265358979323846;

Start at_rest(Start start) {
  pbf_params &params = start.params;
  params.domain_max[0] += params.wall_amplitude[PBF_WALL_X_MAX];
  params.wall_amplitude[PBF_WALL_X_MAX] = 0;
  return start;
}

// The swing begins at this time.
pbf_params from_now(pbf_params params, double time) {
  params.wall_phase[PBF_WALL_X_MAX] -= params.wall_frequency[PBF_WALL_X_MAX] * time;
  return params;
}

// The upper wall of x swings from 1 to `nearest` and back in two seconds, and then stands.
void squeeze(Record &record, double nearest) {
  const bool quick = record.quick();
  const double depth = quick ? 0.2 : 0.4;
  Start start = tank({1, 0.5, depth}, {1, 0.2, depth});
  pbf_params &params = start.params;
  params.domain_max[0] = (1 + nearest) / 2;
  params.wall_amplitude[PBF_WALL_X_MAX] = (1 - nearest) / 2;
  params.wall_frequency[PBF_WALL_X_MAX] = half_turn;
  params.wall_phase[PBF_WALL_X_MAX] = half_turn / 2;
  Trial trial(record, "settling", at_rest(start));
  trial.run(settling_steps, 2);
  trial.change(from_now(params, trial.info().time), "stroke");
  trial.run(120, 12);
  const pbf_stats stats = trial.stats();
  record.note("reported", {{"density_error_mean", stats.density_error_mean},
                           {"density_error_max", stats.density_error_max}});
  trial.draw("At the end of the stroke");
  trial.run(120, 12);
  pbf_params still = default_params();
  std::copy(params.domain_max + 1, params.domain_max + 3, still.domain_max + 1);
  trial.change(still, "after");
  trial.run(600, 6);  // it takes that long to calm down
  trial.draw("After the piston has gone back");
}

}  // namespace

void piston(Record &record) { squeeze(record, 0.5); }

void overfull_piston(Record &record) { squeeze(record, 0.32); }

}  // namespace bench::stability
