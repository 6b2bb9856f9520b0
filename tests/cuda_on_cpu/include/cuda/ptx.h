/* In place of the backend's header of this name: what its instructions do. A load by which threads
 * wait for others lets these run. */
#ifndef PBF_CUDA_PTX_H
#define PBF_CUDA_PTX_H

#include "device.h"

inline void await_launches_before() { emulated::current->awaited = true; }

inline void add_release(unsigned long long *to, unsigned long long value) {
  __atomic_fetch_add(to, value, __ATOMIC_RELEASE);
}

inline void add_relaxed(unsigned long long *to, unsigned long long value) {
  __atomic_fetch_add(to, value, __ATOMIC_RELAXED);
}

inline unsigned long long load_acquire(const unsigned long long *from) {
  emulated::yield();
  return __atomic_load_n(from, __ATOMIC_ACQUIRE);
}

inline void store_relaxed(unsigned long long *to, unsigned long long value) {
  __atomic_store_n(to, value, __ATOMIC_RELAXED);
}

inline unsigned long long load_relaxed(const unsigned long long *from) {
  emulated::yield();
  return __atomic_load_n(from, __ATOMIC_RELAXED);
}

inline void store_relaxed(ulonglong2 *to, ulonglong2 value) { *to = value; }

inline ulonglong2 load_relaxed(const ulonglong2 *from) {
  emulated::yield();
  return *from;
}

inline void store_release_of_system(uint64_t *to, uint64_t value) {
  __atomic_store_n(to, value, __ATOMIC_RELEASE);
}

inline uint64_t load_acquire_of_system(const uint64_t *from) {
  emulated::yield();
  return __atomic_load_n(from, __ATOMIC_ACQUIRE);
}

inline uint32_t shared_address(const void *at) { return emulated::shared_offset(at); }

inline uint32_t load_shared(uint32_t address) {
  return *static_cast<const uint32_t *>(emulated::shared_at(address));
}

inline unsigned long long nanoseconds() {
  timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (unsigned long long)now.tv_sec * 1000000000ull + (unsigned long long)now.tv_nsec;
}

#endif
