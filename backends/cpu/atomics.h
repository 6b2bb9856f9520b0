/* C's atomics for C++17, by the compiler's builtins: <atomic> is of the C++ library. */
#ifndef PBF_CPU_ATOMICS_H
#define PBF_CPU_ATOMICS_H

#ifdef __cplusplus

typedef unsigned int atomic_uint;
typedef unsigned long long atomic_ullong;
enum {
  memory_order_relaxed = __ATOMIC_RELAXED,
  memory_order_acquire = __ATOMIC_ACQUIRE,
  memory_order_release = __ATOMIC_RELEASE,
  memory_order_acq_rel = __ATOMIC_ACQ_REL,
  memory_order_seq_cst = __ATOMIC_SEQ_CST
};
#define atomic_load_explicit(a, order) __atomic_load_n(a, order)
#define atomic_load(a) __atomic_load_n(a, __ATOMIC_SEQ_CST)
#define atomic_store_explicit(a, value, order) __atomic_store_n(a, value, order)
#define atomic_store(a, value) __atomic_store_n(a, value, __ATOMIC_SEQ_CST)
#define atomic_init(a, value) __atomic_store_n(a, value, __ATOMIC_RELAXED)
#define atomic_exchange_explicit(a, value, order) __atomic_exchange_n(a, value, order)
#define atomic_fetch_add_explicit(a, value, order) __atomic_fetch_add(a, value, order)
#define atomic_fetch_add(a, value) __atomic_fetch_add(a, value, __ATOMIC_SEQ_CST)
#define atomic_compare_exchange_weak_explicit(a, expected, value, yes, no) \
  __atomic_compare_exchange_n(a, expected, value, 1, yes, no)

#else

#include <stdatomic.h>

#endif

#endif
