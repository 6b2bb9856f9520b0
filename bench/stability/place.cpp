/* Where the domain lies and how long it is: cases 15 and 35. */
#include <cstdio>
#include <string>

#include "stability/cases.h"
#include "stability/fluid.h"

namespace bench::stability {
namespace {

Start shifted(const Start &start, double by) {
  Start far = start;
  for (double &x : far.particles.positions) x += by;
  for (unsigned axis = 0; axis < 3; ++axis) {
    far.params.domain_min[axis] += by;
    far.params.domain_max[axis] += by;
  }
  return far;
}

}  // namespace

// A quarter of a second, in which the column begins to fall over: a fluid that breaks is chaos
// after that, wherever it is and in float64 too.
void far_origin(Record &record) {
  const Start start = dam_break(record.quick());
  const uint32_t steps = 30, frames = 6;
  Trial(record, "origin", start).run(steps, frames);
  // The farthest power of two that the library takes float32 at, of this spacing.
  record.note("far", 64.0);
  Trial(record, "far", shifted(start, 64)).run(steps, frames);

  for (const double by : {4096.0, 1e6}) {
    const Start farther = shifted(start, by);
    const pbf_desc desc = desc_for(record, 3, 8, 0);
    pbf_solver *solver = nullptr;
    const pbf_status status =
        record.call("pbf_create", pbf_create(&desc, &farther.params, &solver));
    pbf_destroy(solver);
    const std::string label = "far-" + std::to_string(static_cast<int>(by));
    if (status == PBF_OK) Trial(record, label, farther).run(steps, frames);
  }
}

void tank_lengths(Record &record) {
  const std::vector<double> lengths = record.quick()
                                          ? std::vector<double>{0.84, 3.6}
                                          : std::vector<double>{0.84, 1.2, 2, 2.8, 3.6, 4};
  const double depth = record.quick_or(0.15, 0.4), column = record.quick_or(0.3, 0.6);
  for (const double length : lengths) {
    char label[32];
    std::snprintf(label, sizeof label, "length-%g", length);
    Start start = tank({length, 1.5, depth}, {column, record.quick_or(0.5, 1.0), depth});
    Trial trial(record, label, start);
    trial.run(record.quick_or(180u, 960u), 16);
    if (length == 3.6) trial.draw("A tank of 3.6 m");
  }
}

}  // namespace bench::stability
