/* What a solver's fluid is in at present: the domain's walls and the colliders, as they have moved.
 */
#ifndef PBF_BENCH_SURROUNDINGS_H
#define PBF_BENCH_SURROUNDINGS_H

#include <pbf/pbf.h>

#include <vector>

#include "scene/scene.h"

namespace bench {

struct Box {
  Vector lower{}, upper{};
};

Box domain_at(const pbf_params &params, unsigned dimension, double time);

// Throws Error with the library's sentence.
std::vector<pbf_collider> colliders_of(pbf_solver *solver);

}  // namespace bench

#endif
