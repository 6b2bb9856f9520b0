/* Two fluids in one solver: cases 20, 21 and 39. Facts tell the judge which rows are of which. */
#include "stability/cases.h"
#include "stability/fluid.h"

namespace bench::stability {
namespace {

// The rows from `second` on are of the second phase.
void set_two_phases(Record &record, const std::string &label, Trial &trial, uint32_t second,
                    double first_density, double second_density) {
  pbf_phase phases[2];
  for (pbf_phase &phase : phases) must(pbf_phase_init(&phase, sizeof phase));
  phases[0].rest_density = first_density;
  phases[1].rest_density = second_density;
  const std::vector<uint32_t> ones(trial.count() - second, 1);
  must(pbf_set_phases(trial.solver(), 2, phases));
  must(pbf_set_particle_phases(trial.solver(), second, uint32_t(ones.size()), ones.data()));
  record.append(
      "fluids",
      {{"trial", label}, {"second", second}, {"densities", {first_density, second_density}}});
}

void two_drops(Record &record, const std::string &label, double ratio) {
  const double radius = record.quick_or(0.15, 0.3);
  Start start;
  start.params.gravity[1] = 0;
  for (double &side : start.params.domain_max) side = 6;
  start.particles = ball({3 - 1.2 * radius, 3, 3}, radius, {1, 0, 0});
  const auto second = uint32_t(start.particles.count);
  append(start.particles, ball({3 + 1.2 * radius, 3 + radius / 2, 3}, radius, {-1, 0, 0}));
  Trial trial(record, label, start);
  set_two_phases(record, label, trial, second, ratio, 1);
  trial.run(record.quick_or(60u, 120u), 12);
  trial.draw("A drop and one " + label.substr(0, label.find('-')) + " times as heavy have met");
}

// A heavier fluid above stays there, as in a glass without a breath of air, unless it is uneven.
void two_layers(Record &record, const std::string &label, double below, double above,
                uint32_t steps, double uneven = 0, double support_over_spacing = 2) {
  const double side = record.quick_or(0.4, 0.6), height = record.quick_or(0.2, 0.4);
  Start start = tank({side, 3 * height, side}, {side, 2 * height, side});
  start.particles = box({0, 0, 0}, {side, height, side});
  const auto second = uint32_t(start.particles.count);
  append(start.particles, box({0, height, 0}, {side, 2 * height, side}));
  start.params.spacing = spacing;
  start.params.smoothing_radius = support_over_spacing * spacing;
  if (uneven > 0) jitter(start.particles, uneven, 1);
  Trial trial(record, label, start);
  set_two_phases(record, label, trial, second, below, above);
  trial.run(steps, 12);
  trial.draw("Two fluids, the lower one of density " + std::to_string(below).substr(0, 5));
}

}  // namespace

void mass_ratio(Record &record) {
  two_drops(record, "10-drops", 10);
  two_drops(record, "1000-drops", 1000);
}

void density_ratio(Record &record) {
  const uint32_t steps = record.quick_or(360u, 720u);
  two_layers(record, "rest-10", 1, 0.1, steps);
  two_layers(record, "rest-1000", 1, 0.001, steps);
}

void heavy_above(Record &record) {
  const uint32_t steps = record.quick_or(720u, 1440u);
  two_layers(record, "sort-2", 0.5, 1, steps, 0.2 * spacing);
  two_layers(record, "sort-2-wide", 0.5, 1, steps, 0.2 * spacing, 2.5);
}

}  // namespace bench::stability
