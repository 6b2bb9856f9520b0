/* Particles closer than the fluid ever puts them: cases 1, 2, 6, 27, 36. */

#include "stability/cases.h"
#include "stability/fluid.h"

namespace bench::stability {
namespace {

Particles coincident(uint64_t count, double where) {
  return random_box({where, where, where}, {where, where, where}, count, 1);
}

void note_cost(Record &record, const Trial &trial) {
  pbf_plan plan = {};
  plan.struct_size = sizeof plan;
  must(pbf_get_plan(trial.solver(), &plan));
  record.note("plan_bytes", plan.bytes);
  record.memory("after the step");
}

}  // namespace

void two_coincident(Record &record) {
  Start start;
  start.params.gravity[1] = 0;
  start.particles = coincident(2, 0.5);
  Trial trial(record, "pair", start);
  trial.run(120, 12);
}

void thousand_coincident(Record &record) {
  Start start;
  start.params.gravity[1] = 0;
  // So far from the walls that no particle reaches one in 2 s: walls take momentum.
  for (double &end : start.params.domain_min) end = -40;
  for (double &end : start.params.domain_max) end = 40;
  // Others beside them, since a clump alone starts point-symmetric and hides what momentum it
  // lacks.
  start.particles = coincident(record.quick_or(100, 700), 1);
  const Vector beside = {1.05, 1.02, 1.01};
  append(start.particles, random_box(beside, beside, record.quick_or(50, 300), 1));
  Trial trial(record, "clump", start);
  trial.run(20, 20);
  trial.run(220, 22);
  trial.draw("Particles that began in one point, 2 s later");
}

void one_cell(Record &record) {
  Start start;
  const uint64_t count = record.quick_or(1500, 100000);
  start.particles = random_box({0.5, 0.5, 0.5}, {0.6, 0.6, 0.6}, count, 6);
  Trial trial(record, "cell", start);
  record.memory("before the step");
  if (record.call("pbf_step", pbf_step(trial.solver(), 1)) == PBF_OK) {
    record.call("pbf_synchronize", pbf_synchronize(trial.solver()));
  }
  trial.frame();
  note_cost(record, trial);
}

// The counts that the solver tells are dumped for pbf-check, which counts for itself.
void neighbor_overflow(Record &record) {
  Start start;
  const uint64_t count = record.quick_or(600, 4000);
  start.particles = random_box({0.5, 0.5, 0.5}, {0.55, 0.55, 0.55}, count, 27);
  Trial trial(record, "crowd", start);
  trial.densities();
  const uint64_t before = trial.hash();
  pbf_stats stats = {};
  stats.struct_size = sizeof stats;
  record.call("pbf_get_stats", pbf_get_stats(trial.solver(), &stats));
  record.note("neighbors_max", stats.neighbors_max);
  record.note("neighbors_mean", stats.neighbors_mean);
  const pbf_status status = record.call("pbf_step", pbf_step(trial.solver(), 1));
  record.note("untouched", trial.hash() == before);
  if (status == PBF_OK) trial.frame();
}

void dense_start(Record &record) {
  const bool quick = record.quick();
  const Vector size = quick ? Vector{0.4, 1, 0.3} : Vector{1, 1, 0.5};
  Start start = tank(size, size);
  const double height = 0.4;
  const double volume = size[0] * height * size[2];
  const auto count = static_cast<uint64_t>(1.5 * volume / (spacing * spacing * spacing));
  start.particles = random_box({0, 0, 0}, {size[0], height, size[2]}, count, 36);
  Trial trial(record, "dense", start);
  trial.run(record.quick_or(360u, 1200u), 24);
  trial.draw("Random start at 1.5 times the rest density, after it has settled");
}

}  // namespace bench::stability
