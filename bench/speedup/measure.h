/* Times contestants on one scene through Google Benchmark. */
#ifndef PBF_BENCH_MEASURE_H
#define PBF_BENCH_MEASURE_H

#include <vector>

#include "scene/scene.h"
#include "speedup/contestant.h"

namespace bench {

// One result a contestant, in their order, also for those that could not run. Repetitions of
// different contestants alternate at random, so that a machine that slows down hits all alike.
// Each repetition starts from the same state; only its steps are timed, up to the device's end.
std::vector<Result> measure(const Scene &scene, const std::vector<Contestant> &contestants,
                            bool keep_frames);

}  // namespace bench

#endif
