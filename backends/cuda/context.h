/* The CUDA context that a solver works in, current only while a call is inside the solver. */
#ifndef PBF_CUDA_CONTEXT_H
#define PBF_CUDA_CONTEXT_H

#include "cuda/plugin.h"

struct CUctx_st;
typedef CUctx_st *pbf_cuda_context;

/* The context of `stream`, or without one the primary context of `device`. */
pbf_status pbf_cuda_context_find(int device, void *stream, pbf_cuda_context *context);

/* Makes `context` current for a scope; the caller's own is current again after it. */
class pbf_cuda_scope {
 public:
  explicit pbf_cuda_scope(pbf_cuda_context context);
  ~pbf_cuda_scope();
  pbf_cuda_scope(const pbf_cuda_scope &) = delete;
  pbf_cuda_scope &operator=(const pbf_cuda_scope &) = delete;

 private:
  pbf_cuda_context before_ = nullptr;
  bool changed_ = false;
};

#endif
