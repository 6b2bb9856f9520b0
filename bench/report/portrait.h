/* A picture of what a solver holds at present: particles by speed, colliders, the domain. */
#ifndef PBF_BENCH_PORTRAIT_H
#define PBF_BENCH_PORTRAIT_H

#include <pbf/pbf.h>

#include <string>
#include <vector>

namespace bench {

struct Portrait {
  int width = 640;           // pixels
  double fastest = 0;        // the speed at the upper end of the colours; 0: the 99.5th percentile
  std::vector<double> view;  // lower corner, upper corner of what is shown; empty: the domain
};

// A PNG file's bytes. Throws Error with the library's sentence.
std::string draw_solver(pbf_solver *solver, const Portrait &portrait);

// The same of a state that pbf_save has written.
std::string draw_state(const std::string &state, const Portrait &portrait);

}  // namespace bench

#endif
