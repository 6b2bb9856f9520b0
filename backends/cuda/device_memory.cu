#include "cuda/device_memory.h"

#include <stdio.h>

#include "cuda/driver_function.h"
#include "cuda/status.h"

namespace {

typedef int (*address_range_fn)(unsigned long long *, size_t *, unsigned long long);

pbf_status refuse(const char *name, const char *why) {
  char sentence[160];
  snprintf(sentence, sizeof sentence, "%s %s", name, why);
  pbf_cuda_host->set_error(sentence);
  return PBF_ERROR_INVALID_ARGUMENT;
}

/* What a pointer to host memory, or to nothing, would do to a kernel is the end of its context. */
pbf_status check_place(const char *name, const void *data, int device) {
  cudaPointerAttributes at;
  const cudaError_t error = cudaPointerGetAttributes(&at, data);
  if (error != cudaSuccess) cudaGetLastError();
  if (error == cudaSuccess && at.type == cudaMemoryTypeManaged) return PBF_OK;
  if (error != cudaSuccess || at.type != cudaMemoryTypeDevice)
    return refuse(name, "is not memory of a device");
  return at.device == device ? PBF_OK : refuse(name, "is memory of another device");
}

}  // namespace

/* Mappings may lie side by side: each is asked about. */
pbf_status pbf_cuda_check_memory(const char *name, const void *data, uint64_t bytes, int device) {
  static const address_range_fn range_of =
      pbf_cuda_driver_function<address_range_fn>("cuMemGetAddressRange");
  if (pbf_status status = check_place(name, data, device)) return status;
  const unsigned long long first = reinterpret_cast<uintptr_t>(data), end = first + bytes;
  for (unsigned long long at = first; range_of && at < end;) {
    unsigned long long base;
    size_t size;
    if (range_of(&base, &size, at) != 0 || base + size <= at) {
      char why[96];
      snprintf(why, sizeof why, "has %llu bytes from there on; it must have %llu", at - first,
               (unsigned long long)bytes);
      return at == first ? PBF_OK : refuse(name, why); /* of what is not known nothing is said */
    }
    at = base + size;
  }
  return PBF_OK;
}
