/* Lattices that fit between the walls. */
#ifndef PBF_BENCH_FIT_H
#define PBF_BENCH_FIT_H

#include "scene/scene.h"

namespace bench {

// `finer`, or what is near it where its lattice does not fit and another one of about `particles`
// does.
double fitting_finer(const Scene &scene, double finer, uint64_t particles);

}  // namespace bench

#endif
