/* The optional features of a scene, to be taken away and put back one at a time. */
#ifndef PBF_BENCH_FEATURES_H
#define PBF_BENCH_FEATURES_H

#include <string>
#include <vector>

#include "scene/scene.h"

namespace bench {

// What a row asks of its solver beside the scene.
struct Requests {
  bool timing = false;  // times of stages
  bool stats = false;   // statistics after every step
};

struct Variant {
  std::string name;
  Scene scene;
  Requests requests;
};

// The scene without anything optional; its kernel and its fluid stay.
Variant minimal(const Scene &scene);

// That with one feature, for each feature: with the scene's own value where it has one, and a usual
// one where it has none; then with all but
// the requests.
std::vector<Variant> one_at_a_time(const Scene &scene);

}  // namespace bench

#endif
