/* Where the domain lies and how long it is: cases 15 and 35. */
#include <cstdio>

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

void far_origin(Record &record) {
  const Start start = dam_break(true);
  const uint32_t steps = 120;
  Trial(record, "origin", start).run(steps, 4);
  // The farthest power of two that the library takes at this spacing.
  record.note("far", 4096.0);
  Trial(record, "far", shifted(start, 4096)).run(steps, 4);

  const Start million = shifted(start, 1e6);
  const pbf_desc desc = desc_for(record, 3, 8, 0);
  pbf_solver *solver = nullptr;
  const pbf_status status = record.call("pbf_create", pbf_create(&desc, &million.params, &solver));
  pbf_destroy(solver);
  if (status == PBF_OK) Trial(record, "million", million).run(steps, 4);
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
