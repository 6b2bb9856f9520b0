/* Memory of the device that belongs to the caller. */
#ifndef PBF_CUDA_DEVICE_MEMORY_H
#define PBF_CUDA_DEVICE_MEMORY_H

#include <stdint.h>

#include "cuda/plugin.h"

/* Whether `bytes` from `data` on are memory of `device`, which is current; `name` is what the
 * caller calls it. */
pbf_status pbf_cuda_check_memory(const char *name, const void *data, uint64_t bytes, int device);

#endif
