/* An allocator that counts what is out, and fails or is left when told to. */
#ifndef PBF_TESTS_SOAK_HEAP_H
#define PBF_TESTS_SOAK_HEAP_H

#include <pthread.h>
#include <setjmp.h>
#include <stdatomic.h>

#include <pbf/pbf.h>

typedef struct heap {
  uint32_t actor;
  atomic_int_least64_t bytes, blocks;
  uint64_t most;            /* bytes that may be out */
  atomic_int failing_in;    /* the call that gets nothing, counted down; 0: none */
  atomic_int leaving_in;    /* the call that `jump` leaves, in `thread` alone */
  atomic_int failed, left;  /* so many have */
  _Atomic pthread_t thread; /* that of the call; other threads allocate meanwhile */
  jmp_buf jump;
} heap;

pbf_allocator heap_allocator(heap *h);

#endif
