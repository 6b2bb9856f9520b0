/* One instruction set's loops of one variant with fused multiply-add; see kernels.h. */
#include "cpu/kernels_solve.h"

extern "C" const fused_kernels PBF_VARIANT_API;

const fused_kernels PBF_VARIANT_API = {.lambda = lambda, .move = move};
