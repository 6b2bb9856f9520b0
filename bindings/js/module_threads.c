/* What the module with threads has in place of Emscripten's start-up code and system, which are made
 * for one thread. */
#include <stddef.h>
#include <stdint.h>

/* Of backends/common/system_wasm.c. */
void pbf_wasm_begin_thread(void *variables);
double pbf_seconds(void);

void __wasm_call_ctors(void);

/* First of all, in the thread that loads the module. */
void _initialize(void);
void _initialize(void) {
  static _Alignas(64) char variables[1024];
  if (__builtin_wasm_tls_size() > sizeof variables) __builtin_trap();
  pbf_wasm_begin_thread(variables);
  __wasm_call_ctors();
}

/* ---- What the C library asks of Emscripten -------------------------------------------------- */

int emscripten_resize_heap(size_t size);
int emscripten_resize_heap(size_t size) {
  enum { PAGE = 1 << 16 };
  const size_t there = __builtin_wasm_memory_size(0);
  const size_t wanted = size / PAGE + (size % PAGE != 0);
  return wanted <= there || __builtin_wasm_memory_grow(0, wanted - there) != (size_t)-1;
}

double emscripten_get_now(void);
double emscripten_get_now(void) { return 1e3 * pbf_seconds(); }

void *emscripten_memcpy_big(void *to, const void *from, size_t size);
void *emscripten_memcpy_big(void *to, const void *from, size_t size) {
  __asm__ volatile("local.get %0\nlocal.get %1\nlocal.get %2\nmemory.copy 0, 0"
                   :
                   : "r"(to), "r"(from), "r"(size)
                   : "memory");
  return to;
}

/* Is told of the first thread. */
void __emscripten_init_main_thread_js(void *thread);
void __emscripten_init_main_thread_js(void *thread) { (void)thread; }
