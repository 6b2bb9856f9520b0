/* The state of a run as NumPy files, for pbf-check. */
#ifndef PBF_BENCH_DUMP_H
#define PBF_BENCH_DUMP_H

#include <cstdint>
#include <string>

#include "core/solver.h"

namespace bench {

class Dump {
 public:
  // Makes the folder and its dump.json, in place of an earlier dump there; with an empty name
  // nothing is ever written.
  Dump(const std::string &folder, uint64_t every, const Scene &scene, const pbf_info &info);

  // Steps after `step` until the next dump is due.
  uint64_t steps_to_next(uint64_t step) const;
  bool due(uint64_t step) const;

  // The present step; each at most once.
  void write(const Solver &solver);

 private:
  std::string folder_;
  uint64_t every_;
  bool written_ = false;
  uint64_t last_step_ = 0;
};

}  // namespace bench

#endif
