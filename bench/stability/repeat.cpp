/* The same bits again: cases 32 and 33. */
#include "stability/cases.h"
#include "stability/fluid.h"

namespace bench::stability {

void save_and_load(Record &record) {
  const Start start = dam_break(true);
  const uint32_t steps = record.quick_or(30u, 120u);
  Trial whole(record, "whole", start);
  whole.step(steps);
  uint64_t size = 0;
  must(pbf_save(whole.solver(), nullptr, &size));
  Bytes state(size);
  must(pbf_save(whole.solver(), state.data(), &size));
  whole.run(steps, 2);

  Start empty = start;
  empty.particles = Particles();
  empty.capacity = static_cast<uint32_t>(start.particles.count);
  Trial resumed(record, "empty", empty);
  record.call("pbf_load", pbf_load(resumed.solver(), state.data(), size));
  resumed.begin("resumed");
  resumed.run(steps, 2);
}

void thread_counts(Record &record) {
  Start start = dam_break(true);
  const uint32_t steps = record.quick_or(30u, 240u);
  for (const uint32_t threads : {1, 2, 3, 8}) {
    start.threads = threads;
    Trial(record, "threads-" + std::to_string(threads), start).run(steps, 2);
  }
}

}  // namespace bench::stability
