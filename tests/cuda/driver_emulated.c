/* The same on a device that the CPU emulates (tests/cuda_on_cpu): its plugin has these functions
 * for tests. */
#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>

#include "driver.h"
#include "support.h"

static void *function_of_plugin(const char *name) {
  static void *plugin;
  if (!plugin) plugin = dlopen(PBF_CUDA_PLUGIN, RTLD_NOW | RTLD_LOCAL);
  if (!plugin) fail_msg("%s", dlerror());
  void *address = dlsym(plugin, name);
  if (!address) fail_msg("the plugin has no %s", name);
  return address;
}

cuda_context cuda_primary_context(void) { return NULL; }
void cuda_set_current(cuda_context context) { (void)context; }

cuda_stream cuda_create_stream(void) {
  cuda_stream (*create)(void);
  *(void **)&create = function_of_plugin("pbf_emulated_create_stream");
  return create();
}

void cuda_destroy_stream(cuda_stream stream) {
  void (*destroy)(cuda_stream);
  *(void **)&destroy = function_of_plugin("pbf_emulated_destroy_stream");
  destroy(stream);
}

void cuda_wait(cuda_stream stream) {
  void (*wait)(cuda_stream);
  *(void **)&wait = function_of_plugin("pbf_emulated_wait");
  wait(stream);
}

cuda_address cuda_take(uint64_t bytes) {
  void *(*take)(size_t);
  *(void **)&take = function_of_plugin("pbf_emulated_take");
  return (cuda_address)(uintptr_t)take(bytes);
}

void cuda_give_back(cuda_address address) {
  void (*give_back)(void *);
  *(void **)&give_back = function_of_plugin("pbf_emulated_give_back");
  give_back((void *)(uintptr_t)address);
}

static void copy(void *to, const void *from, uint64_t bytes) {
  void (*call)(void *, const void *, size_t, cuda_stream);
  *(void **)&call = function_of_plugin("pbf_emulated_copy");
  call(to, from, bytes, NULL);
  cuda_wait(NULL);
}

void cuda_read(void *to, cuda_address from, uint64_t bytes) {
  copy(to, (const void *)(uintptr_t)from, bytes);
}

void cuda_write(cuda_address to, const void *from, uint64_t bytes) {
  copy((void *)(uintptr_t)to, from, bytes);
}

/* There is no kernel of the caller's to hold a stream by. */
int cuda_can_hold(void) { return 0; }
int cuda_is_busy(cuda_stream stream) { return (void)stream, 0; }
void cuda_hold(cuda_stream stream, volatile uint32_t *go) { (void)stream, (void)go; }
volatile uint32_t *cuda_new_switch(void) {
  static uint32_t word;
  return &word;
}
