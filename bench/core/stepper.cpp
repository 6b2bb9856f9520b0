#include "core/stepper.h"

#include <algorithm>

#include "core/interrupt.h"

namespace bench {

void Stepper::run(Solver &solver, uint64_t steps) const {
  for (uint64_t done = 0; done < steps && !interrupted();) {
    const auto now = static_cast<uint32_t>(std::min<uint64_t>(steps - done, per_call_));
    solver.step(now);
    done += now;
  }
  solver.synchronize();
}

void Stepper::learn(double seconds_a_step) {
  per_call_ = static_cast<uint32_t>(std::clamp(0.5 / seconds_a_step, 1.0, 1e6));
}

}  // namespace bench
