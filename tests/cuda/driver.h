/* What tests do as a caller with CUDA work of its own: the driver's functions, found at run time,
 * so that the tests build without CUDA and start without a driver. */
#ifndef PBF_TESTS_CUDA_DRIVER_H
#define PBF_TESTS_CUDA_DRIVER_H

#include <stddef.h>
#include <stdint.h>

typedef struct CUctx_st *cuda_context;
typedef struct CUstream_st *cuda_stream;
typedef uint64_t cuda_address;

/* A context of the caller's own on device 0, current from then on. */
cuda_context cuda_create_context(void);
void cuda_destroy_context(cuda_context context);

/* The context that all CUDA runtimes of a process share, current from then on. */
cuda_context cuda_primary_context(void);

cuda_context cuda_current(void);
void cuda_set_current(cuda_context context);

cuda_stream cuda_create_stream(void);
void cuda_destroy_stream(cuda_stream stream);
int cuda_is_busy(cuda_stream stream);
void cuda_wait(cuda_stream stream);

uint64_t cuda_free_bytes(void);
cuda_address cuda_take(uint64_t bytes); /* 0: there is none */
void cuda_give_back(cuda_address address);
void cuda_read(void *to, cuda_address from, uint64_t bytes);
void cuda_write(cuda_address to, const void *from, uint64_t bytes);

/* Memory and a semaphore of another API, by file descriptors, which then are CUDA's. */
typedef struct cuda_memory {
  void *handle;
  cuda_address address;
} cuda_memory;
typedef struct CUextSemaphore_st *cuda_semaphore;

cuda_memory cuda_import_memory(int descriptor, uint64_t bytes);
void cuda_destroy_memory(cuda_memory memory);
cuda_semaphore cuda_import_semaphore(int descriptor);
void cuda_destroy_semaphore(cuda_semaphore semaphore);

/* Signals it once `stream` has come as far. */
void cuda_signal(cuda_semaphore semaphore, cuda_stream stream);

/* Of device 0. */
void cuda_get_uuid(unsigned char uuid[16]);

/* Whether cuda_hold does: on a device that the CPU emulates it does nothing. */
int cuda_can_hold(void);

/* A kernel that keeps `stream` busy until *go is 1, or for ten seconds; go: see cuda_new_switch. */
void cuda_hold(cuda_stream stream, volatile uint32_t *go);

/* A word, 0 at first, that kernels of the current context can read. */
volatile uint32_t *cuda_new_switch(void);

/* A kernel that writes to an address of no allocation. Afterwards the current context is
 * lost. */
void cuda_fault(void);

#endif
