#include "driver.h"

#include <dlfcn.h>

#include "support.h"

enum { OUT_OF_MEMORY = 2, NOT_READY = 600, HOST_MAPPED = 2 };

static void *function_of_driver(const char *name) {
  static void *library;
  if (!library) library = dlopen("libcuda.so.1", RTLD_NOW | RTLD_LOCAL);
  assert_non_null(library);
  void *address = dlsym(library, name);
  if (!address) fail_msg("libcuda.so.1 has no %s", name);
  return address;
}

/* Calls the driver's function of the type int (*)(...); the test fails unless it returns 0. */
#define CALL(name, types, ...)                                        \
  do {                                                                \
    int(*called) types;                                               \
    *(void **)&called = function_of_driver(name);                     \
    int error = called(__VA_ARGS__);                                  \
    if (error) fail_msg("%s failed with CUDA error %d", name, error); \
  } while (0)

static int device_0(void) {
  int device = -1;
  CALL("cuInit", (unsigned), 0);
  CALL("cuDeviceGet", (int *, int), &device, 0);
  return device;
}

cuda_context cuda_create_context(void) {
  cuda_context context = NULL;
  CALL("cuCtxCreate_v2", (cuda_context *, unsigned, int), &context, 0, device_0());
  return context;
}

void cuda_destroy_context(cuda_context context) {
  CALL("cuCtxDestroy_v2", (cuda_context), context);
}

cuda_context cuda_primary_context(void) {
  cuda_context context = NULL;
  CALL("cuDevicePrimaryCtxRetain", (cuda_context *, int), &context, device_0());
  cuda_set_current(context);
  return context;
}

cuda_context cuda_current(void) {
  cuda_context context = NULL;
  CALL("cuCtxGetCurrent", (cuda_context *), &context);
  return context;
}

void cuda_set_current(cuda_context context) { CALL("cuCtxSetCurrent", (cuda_context), context); }

cuda_stream cuda_create_stream(void) {
  cuda_stream stream = NULL;
  CALL("cuStreamCreate", (cuda_stream *, unsigned), &stream, 0);
  return stream;
}

void cuda_destroy_stream(cuda_stream stream) { CALL("cuStreamDestroy_v2", (cuda_stream), stream); }

int cuda_is_busy(cuda_stream stream) {
  int (*query)(cuda_stream);
  *(void **)&query = function_of_driver("cuStreamQuery");
  int error = query(stream);
  assert_true(error == 0 || error == NOT_READY);
  return error == NOT_READY;
}

void cuda_wait(cuda_stream stream) { CALL("cuStreamSynchronize", (cuda_stream), stream); }

uint64_t cuda_free_bytes(void) {
  size_t available = 0, total = 0;
  CALL("cuMemGetInfo_v2", (size_t *, size_t *), &available, &total);
  return available;
}

cuda_address cuda_take(uint64_t bytes) {
  int (*take)(cuda_address *, size_t);
  *(void **)&take = function_of_driver("cuMemAlloc_v2");
  cuda_address address = 0;
  int error = take(&address, bytes);
  assert_true(error == 0 || error == OUT_OF_MEMORY);
  return error ? 0 : address;
}

void cuda_give_back(cuda_address address) { CALL("cuMemFree_v2", (cuda_address), address); }

void cuda_read(void *to, cuda_address from, uint64_t bytes) {
  CALL("cuMemcpyDtoH_v2", (void *, cuda_address, size_t), to, from, bytes);
}

void cuda_write(cuda_address to, const void *from, uint64_t bytes) {
  CALL("cuMemcpyHtoD_v2", (cuda_address, const void *, size_t), to, from, bytes);
}

/* As CUDA's driver has them; what is left out of unions is longer than a descriptor. */
enum { OPAQUE_FD = 1 };
typedef struct memory_desc {
  int type;
  union {
    int descriptor;
    void *pointers[2];
  } handle;
  unsigned long long size;
  unsigned flags, reserved[16];
} memory_desc;
typedef struct mapping_desc {
  unsigned long long offset, size;
  unsigned flags, reserved[16];
} mapping_desc;
typedef struct semaphore_desc {
  int type;
  union {
    int descriptor;
    void *pointers[2];
  } handle;
  unsigned flags, reserved[16];
} semaphore_desc;
typedef struct signal_desc {
  unsigned long long numbers[3];
  unsigned more[12], flags, reserved[16];
} signal_desc;

cuda_memory cuda_import_memory(int descriptor, uint64_t bytes) {
  const memory_desc desc = {.type = OPAQUE_FD, .handle.descriptor = descriptor, .size = bytes};
  const mapping_desc whole = {.size = bytes};
  cuda_memory memory = {NULL, 0};
  CALL("cuImportExternalMemory", (void **, const memory_desc *), &memory.handle, &desc);
  CALL("cuExternalMemoryGetMappedBuffer", (cuda_address *, void *, const mapping_desc *),
       &memory.address, memory.handle, &whole);
  return memory;
}

void cuda_destroy_memory(cuda_memory memory) {
  cuda_give_back(memory.address);
  CALL("cuDestroyExternalMemory", (void *), memory.handle);
}

cuda_semaphore cuda_import_semaphore(int descriptor) {
  const semaphore_desc desc = {.type = OPAQUE_FD, .handle.descriptor = descriptor};
  cuda_semaphore semaphore = NULL;
  CALL("cuImportExternalSemaphore", (cuda_semaphore *, const semaphore_desc *), &semaphore, &desc);
  return semaphore;
}

void cuda_destroy_semaphore(cuda_semaphore semaphore) {
  CALL("cuDestroyExternalSemaphore", (cuda_semaphore), semaphore);
}

void cuda_signal(cuda_semaphore semaphore, cuda_stream stream) {
  const signal_desc once = {.flags = 0};
  CALL("cuSignalExternalSemaphoresAsync",
       (const cuda_semaphore *, const signal_desc *, unsigned, cuda_stream), &semaphore, &once, 1,
       stream);
}

void cuda_get_uuid(unsigned char uuid[16]) {
  CALL("cuDeviceGetUuid_v2", (unsigned char *, int), uuid, device_0());
}

int cuda_can_hold(void) { return 1; }

static const char kernels[] =
    ".version 7.0\n"
    ".target sm_80\n"
    ".address_size 64\n"
    ".visible .entry fault()\n"
    "{\n"
    "  .reg .b64 %address;\n"
    "  mov.u64 %address, 64;\n"
    "  st.global.u32 [%address], 1;\n"
    "  ret;\n"
    "}\n"
    ".visible .entry hold(.param .u64 go)\n"
    "{\n"
    "  .reg .b64 %word, %begin, %now;\n"
    "  .reg .b32 %value;\n"
    "  .reg .pred %leave, %early;\n"
    "  ld.param.u64 %word, [go];\n"
    "  mov.u64 %begin, %globaltimer;\n"
    "again:\n"
    "  ld.volatile.global.u32 %value, [%word];\n"
    "  setp.ne.u32 %leave, %value, 0;\n"
    "  @%leave bra done;\n"
    "  mov.u64 %now, %globaltimer;\n"
    "  sub.u64 %now, %now, %begin;\n"
    "  setp.lt.u64 %early, %now, 10000000000;\n"
    "  @%early bra again;\n"
    "done:\n"
    "  ret;\n"
    "}\n";

/* One thread; the module lasts as long as its context. */
static void launch(const char *name, cuda_stream stream, void **arguments) {
  void *module = NULL, *function = NULL;
  CALL("cuModuleLoadData", (void **, const void *), &module, kernels);
  CALL("cuModuleGetFunction", (void **, void *, const char *), &function, module, name);
  CALL("cuLaunchKernel",
       (void *, unsigned, unsigned, unsigned, unsigned, unsigned, unsigned, unsigned, cuda_stream,
        void **, void **),
       function, 1, 1, 1, 1, 1, 1, 0, stream, arguments, NULL);
}

volatile uint32_t *cuda_new_switch(void) {
  void *word = NULL;
  CALL("cuMemHostAlloc", (void **, size_t, unsigned), &word, sizeof(uint32_t), HOST_MAPPED);
  *(volatile uint32_t *)word = 0;
  return word;
}

void cuda_hold(cuda_stream stream, volatile uint32_t *go) {
  cuda_address address = 0;
  void *arguments[] = {&address};
  CALL("cuMemHostGetDevicePointer_v2", (cuda_address *, void *, unsigned), &address,
       (void *)(uintptr_t)go, 0);
  launch("hold", stream, arguments);
}

void cuda_fault(void) {
  int (*synchronize)(void);
  *(void **)&synchronize = function_of_driver("cuCtxSynchronize");
  launch("fault", NULL, NULL);
  assert_int_not_equal(synchronize(), 0);
}
