/* A domain one cell thick, and particles that would leave it: cases 24 and 25. */
#include "stability/cases.h"
#include "stability/fluid.h"

namespace bench::stability {

void thin_domain(Record &record) {
  const uint32_t steps = record.quick_or(60u, 480u);
  Trial sheet(record, "one-cell-thick", tank({1, 1, support}, {0.4, 0.6, support}));
  sheet.run(steps, 12);
  Trial(record, "one-particle-thick", tank({1, 1, spacing}, {0.4, 0.6, spacing})).run(steps, 12);
  Trial(record, "one-cell", tank({support, support, support}, {support, support, support}))
      .run(steps, 12);
}

// The policy: walls hold the particles, whatever brought them there; none is taken out.
void leaving(Record &record) {
  Start start = tank({1, 1, 0.3}, {0.3, 0.3, 0.3});
  for (uint64_t i = 0; i < start.particles.count; ++i) {
    start.particles.velocities[3 * i] = 20;
    start.particles.velocities[3 * i + 1] = 30;
  }
  Trial trial(record, "thrown", start);
  trial.run(60, 12);

  // The domain is taken away from under the fluid.
  pbf_params smaller = start.params;
  smaller.domain_max[0] = 0.5;
  smaller.domain_max[1] = 0.8;
  must(pbf_set_params(trial.solver(), &smaller));
  trial.step(1);
  trial.change(smaller, "shrunk");
  trial.run(60, 12);

  const Bytes outside = trial.scalars({0.25, 0.25, 0.15, 0.25, 0.9, 0.15});
  const uint64_t before = trial.hash();
  pbf_status status = pbf_set_positions(trial.solver(), 4, 2, outside.data());
  record.refusal("pbf_set_positions outside", status, "positions[5][1]", trial.hash() == before);
  status = pbf_add_particles(trial.solver(), 2, outside.data(), nullptr, nullptr);
  record.refusal("pbf_add_particles outside", status, "", trial.hash() == before);
}

}  // namespace bench::stability
