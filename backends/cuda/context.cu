#include "cuda/context.h"

#include "cuda/driver_function.h"
#include "cuda/status.h"

namespace {

typedef int (*get_current_fn)(pbf_cuda_context *);
typedef int (*set_current_fn)(pbf_cuda_context);
typedef int (*stream_context_fn)(void *, pbf_cuda_context *);

struct driver {
  get_current_fn get_current = pbf_cuda_driver_function<get_current_fn>("cuCtxGetCurrent");
  set_current_fn set_current = pbf_cuda_driver_function<set_current_fn>("cuCtxSetCurrent");
  stream_context_fn stream_context = pbf_cuda_driver_function<stream_context_fn>("cuStreamGetCtx");
  bool complete() const { return get_current && set_current && stream_context; }
};

const driver &the_driver() {
  static const driver functions;
  return functions;
}

}  // namespace

pbf_cuda_scope::pbf_cuda_scope(pbf_cuda_context context) {
  if (!context || the_driver().get_current(&before_) != 0 || before_ == context) return;
  changed_ = the_driver().set_current(context) == 0;
}

pbf_cuda_scope::~pbf_cuda_scope() {
  if (changed_) the_driver().set_current(before_);
}

pbf_status pbf_cuda_context_find(int device, void *stream, pbf_cuda_context *context) {
  const driver &functions = the_driver();
  if (!functions.complete())
    return pbf_cuda_check(cudaErrorSymbolNotFound, "cudaGetDriverEntryPointByVersion");
  if (stream) {
    if (functions.stream_context(stream, context) == 0) return PBF_OK;
    return pbf_cuda_check(cudaErrorInvalidResourceHandle, "cuStreamGetCtx on pbf_desc.stream");
  }
  pbf_cuda_context before = nullptr;
  functions.get_current(&before);
  pbf_status status = pbf_cuda_check(cudaSetDevice(device), "cudaSetDevice");
  if (status == PBF_OK) functions.get_current(context);
  functions.set_current(before);
  return status;
}
