/* Steps in calls of about half a second, between which Ctrl-C is heard. */
#ifndef PBF_BENCH_STEPPER_H
#define PBF_BENCH_STEPPER_H

#include <cstdint>

#include "core/solver.h"

namespace bench {

class Stepper {
 public:
  // Up to the device's end. Fewer steps after Ctrl-C.
  void run(Solver &solver, uint64_t steps) const;

  // Before this is known, every call is one step.
  void learn(double seconds_a_step);

 private:
  uint32_t per_call_ = 1;
};

}  // namespace bench

#endif
