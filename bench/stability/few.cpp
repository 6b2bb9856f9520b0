/* None, one, two: cases 3, 4, 5. */
#include "stability/cases.h"
#include "stability/fluid.h"

namespace bench::stability {

void no_particles(Record &record) {
  Trial trial(record, "empty", Start());
  pbf_solver *solver = trial.solver();
  record.call("pbf_step", pbf_step(solver, 10));
  record.call("pbf_synchronize", pbf_synchronize(solver));
  record.note("steps", trial.info().step);
  pbf_stats stats = {};
  stats.struct_size = sizeof stats;
  record.call("pbf_get_stats", pbf_get_stats(solver, &stats));
  uint64_t hash = 0;
  record.call("pbf_hash", pbf_hash(solver, &hash));
  record.call("pbf_add_particles of none", pbf_add_particles(solver, 0, nullptr, nullptr, nullptr));
  trial.frame();
}

void one_falling(Record &record) {
  Start start;
  start.particles = at({{0.5, 0.95, 0.5}});
  Trial trial(record, "fall", start);
  trial.run(48, 12);
}

void two_particles(Record &record) {
  Start start;
  start.params.gravity[1] = 0;
  start.particles = at({{0.5, 0.5, 0.5}, {0.51, 0.52, 0.53}});
  start.particles.velocities = {0.25, 0.125, 0, -0.125, 0.0625, 0.25};
  Trial trial(record, "pair", start);
  trial.run(120, 12);
}

}  // namespace bench::stability
