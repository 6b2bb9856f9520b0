#include "cuda/ranges.h"

#include <stdlib.h>

/* NVTX is headers alone. A toolkit of wheels may lack them: there are then no ranges. */
#if defined(__linux__) && __has_include(<nvtx3/nvToolsExt.h>)
#include <nvtx3/nvToolsExt.h>

namespace {

/* By this variable a profiler has its library loaded, which a program with elevated privileges must
 * not do. */
nvtxDomainHandle_t the_domain() {
  static const nvtxDomainHandle_t domain =
      secure_getenv("NVTX_INJECTION64_PATH") ? nvtxDomainCreateA("pbf") : nullptr;
  return domain;
}

}  // namespace

pbf_cuda_range::pbf_cuda_range(const char *name) : begun_(the_domain() != nullptr) {
  if (!begun_) return;
  nvtxEventAttributes_t attributes = {};
  attributes.version = NVTX_VERSION;
  attributes.size = NVTX_EVENT_ATTRIB_STRUCT_SIZE;
  attributes.messageType = NVTX_MESSAGE_TYPE_ASCII;
  attributes.message.ascii = name;
  nvtxDomainRangePushEx(the_domain(), &attributes);
}

pbf_cuda_range::~pbf_cuda_range() {
  if (begun_) nvtxDomainRangePop(the_domain());
}

#else

pbf_cuda_range::pbf_cuda_range(const char *) : begun_(false) {}
pbf_cuda_range::~pbf_cuda_range() {}

#endif
