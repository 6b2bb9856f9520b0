/* CUDA's runtime, as much of it as the backend calls, over the emulated device. */
#ifndef EMULATED_CUDA_RUNTIME_API_H
#define EMULATED_CUDA_RUNTIME_API_H

#include "device.h"

#define CUDART_VERSION 13000

enum cudaError {
  cudaSuccess = 0,
  cudaErrorInvalidValue = 1,
  cudaErrorMemoryAllocation = 2,
  cudaErrorInitializationError = 3,
  cudaErrorInvalidConfiguration = 9,
  cudaErrorInsufficientDriver = 35,
  cudaErrorInvalidDeviceFunction = 98,
  cudaErrorNoDevice = 100,
  cudaErrorInvalidDevice = 101,
  cudaErrorInvalidResourceHandle = 400,
  cudaErrorSymbolNotFound = 500,
  cudaErrorNotReady = 600,
  cudaErrorPeerAccessAlreadyEnabled = 704,
  cudaErrorLaunchFailure = 719,
  cudaErrorCooperativeLaunchTooLarge = 720,
  cudaErrorNotSupported = 801
};
typedef cudaError cudaError_t;

struct CUstream_st;
struct CUevent_st;
typedef CUstream_st *cudaStream_t;
typedef CUevent_st *cudaEvent_t;

enum cudaMemcpyKind {
  cudaMemcpyHostToHost,
  cudaMemcpyHostToDevice,
  cudaMemcpyDeviceToHost,
  cudaMemcpyDeviceToDevice,
  cudaMemcpyDefault
};
enum cudaDeviceAttr { cudaDevAttrClusterLaunch = 120 };
enum cudaFuncAttribute {
  cudaFuncAttributeMaxDynamicSharedMemorySize = 8,
  cudaFuncAttributeNonPortableClusterSizeAllowed = 11
};
enum cudaDriverEntryPointQueryResult { cudaDriverEntryPointSuccess };
enum {
  cudaEnableDefault = 0,
  cudaStreamNonBlocking = 1,
  cudaEventDisableTiming = 2,
  cudaHostAllocMapped = 2,
  cudaIpcMemLazyEnablePeerAccess = 1
};

struct cudaUUID_t {
  char bytes[16];
};
struct cudaDeviceProp {
  char name[256];
  cudaUUID_t uuid;
  int major, minor, multiProcessorCount;
  size_t sharedMemPerBlock, sharedMemPerBlockOptin;
};
enum cudaMemoryType {
  cudaMemoryTypeUnregistered,
  cudaMemoryTypeHost,
  cudaMemoryTypeDevice,
  cudaMemoryTypeManaged
};
struct cudaPointerAttributes {
  cudaMemoryType type;
  int device;
};
struct cudaIpcMemHandle_t {
  char reserved[64];
};

cudaError_t cudaGetLastError();
cudaError_t cudaPeekAtLastError();
const char *cudaGetErrorName(cudaError_t error);
const char *cudaGetErrorString(cudaError_t error);

cudaError_t cudaDriverGetVersion(int *version);
cudaError_t cudaGetDeviceCount(int *count);
cudaError_t cudaGetDevice(int *device);
cudaError_t cudaSetDevice(int device);
cudaError_t cudaGetDeviceProperties(cudaDeviceProp *properties, int device);
cudaError_t cudaDeviceGetAttribute(int *value, cudaDeviceAttr attribute, int device);
cudaError_t cudaDeviceCanAccessPeer(int *can, int device, int other);
cudaError_t cudaDeviceEnablePeerAccess(int device, unsigned flags);
cudaError_t cudaGetDriverEntryPointByVersion(const char *name, void **function, unsigned version,
                                             unsigned long long flags,
                                             cudaDriverEntryPointQueryResult *result = nullptr);
cudaError_t cudaIpcGetMemHandle(cudaIpcMemHandle_t *handle, void *memory);
cudaError_t cudaIpcOpenMemHandle(void **memory, cudaIpcMemHandle_t handle, unsigned flags);
cudaError_t cudaIpcCloseMemHandle(void *memory);

cudaError_t cudaMalloc(void **memory, size_t bytes);
cudaError_t cudaFree(void *memory);
cudaError_t cudaHostAlloc(void **memory, size_t bytes, unsigned flags);
cudaError_t cudaFreeHost(void *memory);
cudaError_t cudaHostGetDevicePointer(void **device, void *host, unsigned flags);
cudaError_t cudaMemcpy(void *to, const void *from, size_t bytes, cudaMemcpyKind kind);
cudaError_t cudaMemcpyAsync(void *to, const void *from, size_t bytes, cudaMemcpyKind kind,
                            cudaStream_t stream = nullptr);
cudaError_t cudaMemcpy2DAsync(void *to, size_t to_pitch, const void *from, size_t from_pitch,
                              size_t width, size_t height, cudaMemcpyKind kind,
                              cudaStream_t stream = nullptr);
cudaError_t cudaPointerGetAttributes(cudaPointerAttributes *attributes, const void *memory);
cudaError_t cudaMemsetAsync(void *to, int value, size_t bytes, cudaStream_t stream = nullptr);

cudaError_t cudaStreamCreate(cudaStream_t *stream);
cudaError_t cudaStreamCreateWithFlags(cudaStream_t *stream, unsigned flags);
cudaError_t cudaStreamCreateWithPriority(cudaStream_t *stream, unsigned flags, int priority);
cudaError_t cudaDeviceGetStreamPriorityRange(int *least, int *greatest);
cudaError_t cudaStreamDestroy(cudaStream_t stream);
cudaError_t cudaStreamSynchronize(cudaStream_t stream);
cudaError_t cudaStreamQuery(cudaStream_t stream);
cudaError_t cudaStreamWaitEvent(cudaStream_t stream, cudaEvent_t event, unsigned flags = 0);

cudaError_t cudaEventCreate(cudaEvent_t *event);
cudaError_t cudaEventCreateWithFlags(cudaEvent_t *event, unsigned flags);
cudaError_t cudaEventDestroy(cudaEvent_t event);
cudaError_t cudaEventRecord(cudaEvent_t event, cudaStream_t stream = nullptr);
cudaError_t cudaEventSynchronize(cudaEvent_t event);
cudaError_t cudaEventElapsedTime(float *milliseconds, cudaEvent_t begin, cudaEvent_t end);

template <class T>
inline cudaError_t cudaMalloc(T **memory, size_t bytes) {
  return cudaMalloc(reinterpret_cast<void **>(memory), bytes);
}
template <class T>
inline cudaError_t cudaHostAlloc(T **memory, size_t bytes, unsigned flags) {
  return cudaHostAlloc(reinterpret_cast<void **>(memory), bytes, flags);
}
template <class T>
inline cudaError_t cudaMallocHost(T **memory, size_t bytes, unsigned flags = 0) {
  return cudaHostAlloc(reinterpret_cast<void **>(memory), bytes, flags);
}
template <class T>
inline cudaError_t cudaHostGetDevicePointer(T **device, void *host, unsigned flags) {
  return cudaHostGetDevicePointer(reinterpret_cast<void **>(device), host, flags);
}

/* ---- Launches ------------------------------------------------------------------------------ */

struct cudaLaunchConfig_t;
enum cudaLaunchAttributeID {
  cudaLaunchAttributeCooperative = 2,
  cudaLaunchAttributeClusterDimension = 4,
  cudaLaunchAttributeProgrammaticStreamSerialization = 6
};
struct cudaLaunchAttribute {
  cudaLaunchAttributeID id;
  struct {
    struct {
      unsigned x, y, z;
    } clusterDim;
    int programmaticStreamSerializationAllowed, cooperative;
  } val;
};
struct cudaLaunchConfig_t {
  dim3 gridDim, blockDim;
  size_t dynamicSmemBytes;
  cudaStream_t stream;
  cudaLaunchAttribute *attrs;
  unsigned numAttrs;
};

namespace emulated {

cudaError_t set_attribute(const void *kernel, cudaFuncAttribute attribute, int value);
cudaError_t occupancy(int *clusters, const void *kernel, const cudaLaunchConfig_t *config);

/* Work that a stream does in its turn. */
struct work {
  virtual void run() = 0;
  virtual ~work() {}
};

/* Checks the shape as CUDA does, and has the stream run it; takes the work. */
cudaError_t launch_on(cudaStream_t stream, const launch_shape &shape, work *work);

/* In the stream's turn: all threads of a grid. */
void run_grid(const launch_shape &shape, thread_function run, void *arguments);

/* The arguments are kept until then. */
template <class... Parameters>
struct kernel_work : work {
  typedef void (*function)(Parameters...);
  typedef std::tuple<typename std::decay<Parameters>::type...> values;
  launch_shape shape;
  values arguments;

  kernel_work(const launch_shape &shape, const values &arguments)
      : shape(shape), arguments(arguments) {}
  static void run_thread(const void *kernel, void *kept) {
    std::apply(reinterpret_cast<function>(const_cast<void *>(kernel)),
               *static_cast<const values *>(kept));
  }
  void run() override { run_grid(shape, run_thread, &arguments); }
};

template <class... Parameters>
struct pending_launch {
  launch_shape shape;
  cudaStream_t stream;

  cudaError_t operator()(Parameters... arguments) const {
    return launch_on(stream, shape, new kernel_work<Parameters...>(shape, {arguments...}));
  }
};

/* Of a kernel that its arguments choose, which are kept as they are given. */
template <class Kernel>
struct pending_call {
  launch_shape shape;
  cudaStream_t stream;

  template <class... Values>
  struct work_of : work {
    launch_shape shape;
    std::tuple<Values...> values;

    work_of(const launch_shape &shape, const Values &...values) : shape(shape), values(values...) {}
    static void run_thread(const void *, void *kept) {
      /* A kernel may change its parameters. */
      std::tuple<Values...> own = *static_cast<const std::tuple<Values...> *>(kept);
      std::apply(
          [](auto &...each) {
            Kernel *none = nullptr;
            (*none)(each...);
          },
          own);
    }
    void run() override { run_grid(shape, run_thread, &values); }
  };

  template <class... Values>
  cudaError_t operator()(const Values &...values) const {
    return launch_on(stream, shape,
                     new work_of<typename std::decay<const Values>::type...>(shape, values...));
  }
};

template <class Kernel>
inline pending_call<Kernel> launch(const char *name, Kernel, dim3 grid, dim3 block,
                                   size_t shared = 0, cudaStream_t stream = nullptr) {
  return {{name, nullptr, grid, block, shared, false, false}, stream};
}

/* name<<<grid, block, shared, stream>>> */
template <class... Parameters>
inline pending_launch<Parameters...> launch(const char *name, void (*kernel)(Parameters...),
                                            dim3 grid, dim3 block, size_t shared = 0,
                                            cudaStream_t stream = nullptr) {
  return {{name, reinterpret_cast<const void *>(kernel), grid, block, shared, false, false},
          stream};
}

}  // namespace emulated

template <class... Parameters, class... Arguments>
inline cudaError_t cudaLaunchKernelEx(const cudaLaunchConfig_t *config,
                                      void (*kernel)(Parameters...), Arguments &&...arguments) {
  const char *name = "an early kernel";
  bool together = false, early = false;
  for (unsigned k = 0; k < config->numAttrs; ++k) {
    const cudaLaunchAttributeID id = config->attrs[k].id;
    early = early || id == cudaLaunchAttributeProgrammaticStreamSerialization;
    if (id == cudaLaunchAttributeProgrammaticStreamSerialization) continue;
    name = id == cudaLaunchAttributeCooperative ? "a cooperative kernel" : "a kernel of a cluster";
    together = true;
  }
  const emulated::launch_shape shape = {name,
                                        reinterpret_cast<const void *>(kernel),
                                        config->gridDim,
                                        config->blockDim,
                                        config->dynamicSmemBytes,
                                        together,
                                        early};
  return emulated::launch_on(
      config->stream, shape,
      new emulated::kernel_work<Parameters...>(shape, {std::forward<Arguments>(arguments)...}));
}

template <class Kernel>
inline cudaError_t cudaFuncSetAttribute(Kernel kernel, cudaFuncAttribute attribute, int value) {
  return emulated::set_attribute(reinterpret_cast<const void *>(kernel), attribute, value);
}

template <class Kernel>
inline cudaError_t cudaOccupancyMaxActiveClusters(int *clusters, Kernel kernel,
                                                  const cudaLaunchConfig_t *config) {
  return emulated::occupancy(clusters, reinterpret_cast<const void *>(kernel), config);
}

#endif
