/* A CUDA device that a CPU emulates, for tests: the threads of a grid are fibers, of which one runs
 * at a time. This header is what kernels see: indices, shared memory, barriers, warps, atomics. It
 * is included before anything else of a file. */
#ifndef EMULATED_DEVICE_H
#define EMULATED_DEVICE_H

#include <float.h>
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <initializer_list>
#include <tuple>
#include <type_traits>
#include <utility>

#define __host__
#define __device__
#define __global__
#define __constant__
#define __grid_constant__
#define __launch_bounds__(...)
#define __forceinline__ inline __attribute__((always_inline, unused))
#define __noinline__ /* also an attribute of GNU C, by which its headers name it */

/* ---- Vectors ------------------------------------------------------------------------------- */

struct uint3 {
  unsigned x, y, z;
};
struct dim3 {
  unsigned x, y, z;
  constexpr dim3(unsigned x = 1, unsigned y = 1, unsigned z = 1) : x(x), y(y), z(z) {}
};
struct alignas(8) uint2 {
  unsigned x, y;
};
struct alignas(16) uint4 {
  unsigned x, y, z, w;
};
struct alignas(8) float2 {
  float x, y;
};
struct alignas(16) float4 {
  float x, y, z, w;
};
struct alignas(16) double2 {
  double x, y;
};
struct alignas(16) ulonglong2 {
  unsigned long long x, y;
};

namespace emulated {

/* ---- Threads ------------------------------------------------------------------------------- */

struct block;
struct warp;

/* What one waits for. */
enum wait_kind { WAITS_NOT, AT_BLOCK_BARRIER, AT_CLUSTER_BARRIER, IN_WARP, AT_ACTIVE_MASK };

/* An operation of the lanes of a mask: what each of them gave. */
enum warp_operation { SYNC_WARP, SHUFFLE, VOTE, MATCH, REDUCE };
struct gathered {
  uint64_t values[32];
  uint32_t lanes;
};

struct thread {
  uint3 index;
  struct block *block;
  struct warp *warp;
  void *fiber; /* of one that has begun and not ended */
  uint32_t linear, lane;
  bool awaited; /* launches before its own */
  wait_kind waits;
  const char *at; /* the barrier's name */
  /* In a warp: */
  uint32_t mask;
  warp_operation operation;
  uint64_t value;
  gathered *result;
  int votes; /* of a barrier of the block: threads that said yes, … */
  int all;   /* … and those that were asked */
};

/* The one that runs in this thread of the system; null between launches. */
extern __thread thread *current __attribute__((tls_model("initial-exec")));

uint3 block_index(const block *b);

/* Lets others run: in each look of a loop that waits for what another thread does. */
void yield();

/* Of the block: threads that have ended do not count. Returns how many said yes. */
int block_barrier(const char *name, bool yes, int *all = nullptr);
void cluster_barrier();

/* Of the lanes in `mask` that have not ended. */
void in_warp(warp_operation operation, uint32_t mask, uint64_t value, gathered *result);
uint32_t active_mask();

/* ---- Shared memory ------------------------------------------------------------------------- */

int new_shared_variable();
void *shared_variable_at(int variable, size_t bytes, size_t align);
void *dynamic_shared();
uint32_t shared_offset(const void *at);
void *shared_at(uint32_t offset);
void *shared_of_block(void *at, uint32_t rank);

template <class T>
inline T *shared_variable(int variable) {
  return static_cast<T *>(shared_variable_at(variable, sizeof(T), alignof(T)));
}

/* ---- Values of lanes ----------------------------------------------------------------------- */

template <class T>
inline uint64_t bits_of(T value) {
  static_assert(sizeof(T) <= sizeof(uint64_t), "as values of lanes are");
  uint64_t bits = 0;
  memcpy(&bits, &value, sizeof value);
  return bits;
}

template <class T>
inline T value_of(uint64_t bits) {
  T value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

/* What a lane outside of the mask would give, nothing may use. */
template <class T>
inline T shuffled(uint32_t mask, T value, int from) {
  gathered all;
  in_warp(SHUFFLE, mask, bits_of(value), &all);
  return value_of<T>(all.lanes >> from & 1 ? all.values[from] : ~0ull);
}

inline int segment_of(uint32_t lane, int width) { return (int)lane & ~(width - 1); }

inline uint32_t votes(uint32_t mask, bool yes, uint32_t *asked = nullptr) {
  gathered all;
  uint32_t said = 0;
  in_warp(VOTE, mask, yes, &all);
  for (uint32_t k = 0; k < 32; ++k)
    if (all.lanes >> k & 1 && all.values[k]) said |= 1u << k;
  if (asked) *asked = all.lanes;
  return said;
}

template <class T, class Combine>
inline T reduced(uint32_t mask, T value, Combine combine) {
  gathered all;
  in_warp(REDUCE, mask, bits_of(value), &all);
  T result = value;
  for (uint32_t k = 0; k < 32; ++k)
    if (all.lanes >> k & 1) result = combine(result, value_of<T>(all.values[k]));
  return result;
}

/* ---- Launches ------------------------------------------------------------------------------ */

struct launch_shape {
  const char *name;
  const void *kernel;
  dim3 grid, block;
  size_t shared;
  bool together; /* all blocks at the same time: cooperative, or a cluster */
  bool early;    /* before what was launched last is over: its threads have to await that */
};

/* Calls run(arguments) in each thread of the grid. */
typedef void (*thread_function)(const void *kernel, void *arguments);

}  // namespace emulated

#define threadIdx (::emulated::current->index)
#define blockIdx (::emulated::block_index(::emulated::current->block))
extern __thread uint3 gridDim, blockDim __attribute__((tls_model("initial-exec")));

/* ---- Barriers and warps, by their names in CUDA ---------------------------------------------- */

inline void __syncthreads() { emulated::block_barrier("__syncthreads", false); }
inline int __syncthreads_or(int yes) {
  return emulated::block_barrier("__syncthreads_or", yes != 0) > 0;
}
inline int __syncthreads_count(int yes) {
  return emulated::block_barrier("__syncthreads_count", yes != 0);
}
inline int __syncthreads_and(int yes) {
  int all = 0;
  return emulated::block_barrier("__syncthreads_and", yes != 0, &all) == all;
}
inline void __syncwarp(uint32_t mask = ~0u) {
  emulated::gathered all;
  emulated::in_warp(emulated::SYNC_WARP, mask, 0, &all);
}
inline uint32_t __activemask() { return emulated::active_mask(); }
inline uint32_t __ballot_sync(uint32_t mask, int yes) { return emulated::votes(mask, yes != 0); }
inline int __any_sync(uint32_t mask, int yes) { return emulated::votes(mask, yes != 0) != 0; }
inline int __all_sync(uint32_t mask, int yes) {
  uint32_t asked;
  return emulated::votes(mask, yes != 0, &asked) == asked;
}
template <class T>
inline T __shfl_sync(uint32_t mask, T value, int from, int width = 32) {
  return emulated::shuffled(
      mask, value, emulated::segment_of(emulated::current->lane, width) + (from & (width - 1)));
}
template <class T>
inline T __shfl_xor_sync(uint32_t mask, T value, int by, int width = 32) {
  const int lane = (int)emulated::current->lane, from = lane ^ by;
  const bool beyond = from >= emulated::segment_of((uint32_t)lane, width) + width;
  return emulated::shuffled(mask, value, beyond ? lane : from);
}
template <class T>
inline T __shfl_up_sync(uint32_t mask, T value, unsigned by, int width = 32) {
  const int lane = (int)emulated::current->lane, from = lane - (int)by;
  return emulated::shuffled(mask, value,
                            from < emulated::segment_of((uint32_t)lane, width) ? lane : from);
}
template <class T>
inline T __shfl_down_sync(uint32_t mask, T value, unsigned by, int width = 32) {
  const int lane = (int)emulated::current->lane, from = lane + (int)by;
  return emulated::shuffled(
      mask, value, from >= emulated::segment_of((uint32_t)lane, width) + width ? lane : from);
}
template <class T>
inline uint32_t __match_any_sync(uint32_t mask, T value) {
  emulated::gathered all;
  uint32_t alike = 0;
  emulated::in_warp(emulated::MATCH, mask, emulated::bits_of(value), &all);
  for (uint32_t k = 0; k < 32; ++k)
    if (all.lanes >> k & 1 && all.values[k] == emulated::bits_of(value)) alike |= 1u << k;
  return alike;
}
inline uint32_t __reduce_min_sync(uint32_t mask, uint32_t value) {
  return emulated::reduced(mask, value, [](uint32_t a, uint32_t b) { return a < b ? a : b; });
}
inline uint32_t __reduce_max_sync(uint32_t mask, uint32_t value) {
  return emulated::reduced(mask, value, [](uint32_t a, uint32_t b) { return a > b ? a : b; });
}
inline uint32_t __reduce_or_sync(uint32_t mask, uint32_t value) {
  return emulated::reduced(mask, value, [](uint32_t a, uint32_t b) { return a | b; });
}

/* ---- Memory -------------------------------------------------------------------------------- */

inline void __threadfence() { __atomic_thread_fence(__ATOMIC_SEQ_CST); }
inline void __threadfence_system() { __atomic_thread_fence(__ATOMIC_SEQ_CST); }

template <class T>
inline T __ldcv(const T *from) {
  return *static_cast<const volatile T *>(from);
}

/* Ranks of a process work in other threads of the system. */
template <class T>
inline T atomicAdd(T *to, T value) {
  if constexpr (std::is_integral<T>::value) {
    return __atomic_fetch_add(to, value, __ATOMIC_RELAXED);
  } else {
    const T before = *to;
    *to += value;
    return before;
  }
}
template <class T>
inline T atomicAnd(T *to, T value) {
  return __atomic_fetch_and(to, value, __ATOMIC_RELAXED);
}
template <class T>
inline T atomicOr(T *to, T value) {
  return __atomic_fetch_or(to, value, __ATOMIC_RELAXED);
}
template <class T>
inline T atomicMin(T *to, T value) {
  const T before = *to;
  if (value < before) *to = value;
  return before;
}
template <class T>
inline T atomicMax(T *to, T value) {
  const T before = *to;
  if (value > before) *to = value;
  return before;
}

/* ---- Numbers ------------------------------------------------------------------------------- */

inline int __popc(unsigned a) { return __builtin_popcount(a); }
inline int __ffs(int a) { return __builtin_ffs(a); }
inline int __ffsll(long long a) { return __builtin_ffsll(a); }
inline int __clz(int a) { return a ? __builtin_clz((unsigned)a) : 32; }
inline unsigned __funnelshift_l(unsigned low, unsigned high, unsigned by) {
  return (unsigned)(((uint64_t)high << 32 | low) << (by & 31) >> 32);
}
inline unsigned __float_as_uint(float a) {
  return emulated::value_of<unsigned>(emulated::bits_of(a));
}
inline float __uint_as_float(unsigned a) { return emulated::value_of<float>(a); }
inline long long __double_as_longlong(double a) { return (long long)emulated::bits_of(a); }
inline double __longlong_as_double(long long a) { return emulated::value_of<double>((uint64_t)a); }
inline int __double2hiint(double a) { return (int)(emulated::bits_of(a) >> 32); }
inline float __fmul_rn(float a, float b) { return a * b; }
inline float __fmaf_rn(float a, float b, float c) { return fmaf(a, b, c); }
inline float __double2float_rd(double a) {
  const float nearest = (float)a;
  return (double)nearest > a ? nextafterf(nearest, -INFINITY) : nearest;
}
inline float __double2float_ru(double a) {
  const float nearest = (float)a;
  return (double)nearest < a ? nextafterf(nearest, INFINITY) : nearest;
}
inline float rsqrtf(float a) { return 1 / sqrtf(a); }
inline double rsqrt(double a) { return 1 / sqrt(a); }

template <class A, class B>
inline typename std::common_type<A, B>::type min(A a, B b) {
  typedef typename std::common_type<A, B>::type both;
  if constexpr (std::is_floating_point<both>::value) return fmin((both)a, (both)b);
  return (both)b < (both)a ? (both)b : (both)a;
}
template <class A, class B>
inline typename std::common_type<A, B>::type max(A a, B b) {
  typedef typename std::common_type<A, B>::type both;
  if constexpr (std::is_floating_point<both>::value) return fmax((both)a, (both)b);
  return (both)a < (both)b ? (both)b : (both)a;
}

#endif
