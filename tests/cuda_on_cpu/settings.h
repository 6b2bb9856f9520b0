/* What the environment says of the emulated device. */
#ifndef EMULATED_SETTINGS_H
#define EMULATED_SETTINGS_H

#include <stdint.h>

namespace emulated {

/* PBF_CUDA_EMULATED_SEED: 0, threads run in their order and calls at once; else threads, blocks and
 * streams run in an order of this seed, and as late as CUDA allows. */
uint64_t seed();

/* PBF_CUDA_EMULATED_MULTIPROCESSORS: 4, unless it is set. */
int multiprocessors();

/* PBF_CUDA_EMULATED_DEVICES: 1, unless it is set. Each sees the others' memory. */
enum { DEVICES_MOST = 16 };
int devices();

/* A number below `limit`, of a sequence that the seed begins. */
uint32_t random_below(uint32_t limit);

enum { SHARED_UNASKED = 48 * 1024, SHARED_MOST = 232448, SHARED_OF_MULTIPROCESSOR = 233472 };

}  // namespace emulated

#endif
