/* From a sweep and a scene to the points that run. */
#ifndef PBF_BENCH_PLAN_H
#define PBF_BENCH_PLAN_H

#include "pareto/point.h"

namespace bench {

struct PlanOptions {
  SceneOptions scene;
  std::vector<std::string> backends = {"serial"};  // for families that name none
  double duration = 0;                             // simulated; 0: as the scene's steps have it
  unsigned frames = 10;                            // judged, beside the start
  bool cpu_time = false;                           // see Study
  std::string judge;                               // what identifies the judge, for the keys
};

struct Plan {
  Scene scene;  // as it is before any family changes it
  std::vector<Point> points;
};

// Throws Error(exit_usage) for a value that no scene takes, before anything has run.
Plan make_plan(const Sweep &sweep, const PlanOptions &options);

}  // namespace bench

#endif
