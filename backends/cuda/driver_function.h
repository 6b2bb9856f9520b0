/* Functions of the driver, found at run time: the plugin must load where there is no driver. */
#ifndef PBF_CUDA_DRIVER_FUNCTION_H
#define PBF_CUDA_DRIVER_FUNCTION_H

/* Null: there is none. */
template <class Function>
static Function pbf_cuda_driver_function(const char *name) {
  void *address = nullptr;
  cudaDriverEntryPointQueryResult result;
#if CUDART_VERSION >= 12050 /* from then on; CUDA 13 has no other */
  cudaError_t error =
      cudaGetDriverEntryPointByVersion(name, &address, 12000, cudaEnableDefault, &result);
#else
  cudaError_t error = cudaGetDriverEntryPoint(name, &address, cudaEnableDefault, &result);
#endif
  if (error != cudaSuccess) cudaGetLastError();
  return error == cudaSuccess ? reinterpret_cast<Function>(address) : nullptr;
}

#endif
