/* Of CUB: the exclusive prefix sum, in the stream's turn. */
#ifndef EMULATED_CUB_DEVICE_SCAN_H
#define EMULATED_CUB_DEVICE_SCAN_H

#include <cuda_runtime_api.h>

namespace emulated {

template <class T>
struct scan_work : work {
  const T *from;
  T *to;
  size_t count;

  scan_work(const T *from, T *to, size_t count) : from(from), to(to), count(count) {}
  void run() override {
    T sum = 0;
    for (size_t k = 0; k < count; ++k) {
      const T value = from[k];
      to[k] = sum;
      sum += value;
    }
  }
};

/* What a launch tells at once. */
cudaError_t run_on(cudaStream_t stream, work *work);

}  // namespace emulated

namespace cub {

struct DeviceScan {
  template <class T, class Count>
  static cudaError_t ExclusiveSum(void *scratch, size_t &bytes, const T *from, T *to, Count count,
                                  cudaStream_t stream = nullptr) {
    if (!scratch) {
      bytes = 1;
      return cudaSuccess;
    }
    return emulated::run_on(stream, new emulated::scan_work<T>(from, to, (size_t)count));
  }
};

}  // namespace cub

#endif
