/* One setting of a sweep: what runs, and what came of it. */
#ifndef PBF_BENCH_POINT_H
#define PBF_BENCH_POINT_H

#include <map>
#include <string>
#include <vector>

#include "core/solver.h"
#include "pareto/sweep.h"

namespace bench {

// What a run found out, and the results file keeps.
struct Outcome {
  std::map<std::string, double> errors;  // by figure; a figure that means nothing here is missing
  std::map<std::string, double> start;   // the same of the first frame, where it has the figure
  std::map<std::string, std::string> reasons;  // … and why it is missing
  std::string state;                           // the hash after the last step
  std::vector<double> seconds;                 // of each timed run
  std::string reason;                          // why there is nothing of the above; else empty
  std::string commit;                          // that measured it

  bool judged() const { return !state.empty() || !reason.empty(); }
};

struct Point {
  size_t family = 0;
  std::vector<Choice> choices;
  SolverOptions solver;
  Scene scene;          // its parameters, steps and walls are this point's own
  uint32_t divide = 1;  // the scene's own time step over this point's
  uint64_t every = 1;   // steps between dumps
  double work = 1;      // a guess of its cost, for the time left
  std::string label;    // "8 iterations, Δt/2"
  std::string key;      // changes with everything that could change an outcome
  Outcome outcome;
};

double simulated_time(const Point &point);

// Wall seconds for each simulated time unit. Of a point that was timed.
double median_cost(const Point &point);
double least_cost(const Point &point);
double most_cost(const Point &point);

}  // namespace bench

#endif
