/* One instruction set's loops of one variant; see kernels.h. */
#include "cpu/kernels_pairs.h"
#include "cpu/kernels_particles.h"
#include "cpu/kernels_search.h"

extern const kernels PBF_VARIANT_API;

const kernels PBF_VARIANT_API = {
    .width = WIDTH,
    .predict = predict,
    .bounds = bounds,
    .cells = cells,
    .velocity = velocity,
    .search = search_groups,
    .lambda = lambda,
    .move = move,
    .curl = curl,
    .confine = confine,
    .viscosity = viscosity,
    .density = density,
};
