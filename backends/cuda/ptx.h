/* What CUDA C++ has no words for: instructions of PTX, each in a function. tests/cuda_on_cpu has
 * the same functions for its emulation. */
#ifndef PBF_CUDA_PTX_H
#define PBF_CUDA_PTX_H

#include <stdint.h>

/* Until all that was launched before is over, and what it wrote is seen. */
static __device__ __forceinline__ void await_launches_before() {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 900
  asm volatile("griddepcontrol.wait;" ::: "memory");
#endif
}

/* *to += value, which others see with all that came before. */
static __device__ __forceinline__ void add_release(unsigned long long *to,
                                                   unsigned long long value) {
  asm volatile("red.release.gpu.global.add.u64 [%0], %1;" ::"l"(to), "l"(value) : "memory");
}

static __device__ __forceinline__ void add_relaxed(unsigned long long *to,
                                                   unsigned long long value) {
  asm volatile("red.relaxed.gpu.global.add.u64 [%0], %1;" ::"l"(to), "l"(value) : "memory");
}

static __device__ __forceinline__ unsigned long long load_acquire(const unsigned long long *from) {
  unsigned long long value;
  asm volatile("ld.acquire.gpu.global.u64 %0, [%1];" : "=l"(value) : "l"(from) : "memory");
  return value;
}

static __device__ __forceinline__ void store_relaxed(unsigned long long *to,
                                                     unsigned long long value) {
  asm volatile("st.relaxed.gpu.global.b64 [%0], %1;" ::"l"(to), "l"(value) : "memory");
}

static __device__ __forceinline__ unsigned long long load_relaxed(const unsigned long long *from) {
  unsigned long long value;
  asm volatile("ld.relaxed.gpu.global.b64 %0, [%1];" : "=l"(value) : "l"(from) : "memory");
  return value;
}

/* Sixteen bytes in one piece. */
static __device__ __forceinline__ void store_relaxed(ulonglong2 *to, ulonglong2 value) {
  asm volatile(
      "{\n\t.reg .b128 whole;\n\tmov.b128 whole, {%1, %2};\n\t"
      "st.relaxed.gpu.global.b128 [%0], whole;\n\t}" ::"l"(to),
      "l"(value.x), "l"(value.y)
      : "memory");
}

static __device__ __forceinline__ ulonglong2 load_relaxed(const ulonglong2 *from) {
  ulonglong2 value;
  asm volatile(
      "{\n\t.reg .b128 whole;\n\tld.relaxed.gpu.global.b128 whole, [%2];\n\t"
      "mov.b128 {%0, %1}, whole;\n\t}"
      : "=l"(value.x), "=l"(value.y)
      : "l"(from)
      : "memory");
  return value;
}

/* For all devices of a system. */
static __device__ __forceinline__ void store_release_of_system(uint64_t *to, uint64_t value) {
  asm volatile("st.release.sys.global.u64 [%0], %1;" ::"l"(to), "l"(value) : "memory");
}

static __device__ __forceinline__ uint64_t load_acquire_of_system(const uint64_t *from) {
  uint64_t value;
  asm volatile("ld.acquire.sys.global.u64 %0, [%1];" : "=l"(value) : "l"(from) : "memory");
  return value;
}

/* Where something is in shared memory, … */
static __device__ __forceinline__ uint32_t shared_address(const void *at) {
  return (uint32_t)__cvta_generic_to_shared(at);
}

/* … which an instruction reads by that. */
static __device__ __forceinline__ uint32_t load_shared(uint32_t address) {
  uint32_t value;
  asm("ld.shared.u32 %0, [%1];" : "=r"(value) : "r"(address));
  return value;
}

static __device__ __forceinline__ unsigned long long nanoseconds() {
  unsigned long long now;
  asm volatile("mov.u64 %0, %%globaltimer;" : "=l"(now));
  return now;
}

#endif
