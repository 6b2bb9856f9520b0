/* What compilers spell differently, for the library's own sources. */
#ifndef PBF_LIB_COMPILER_H
#define PBF_LIB_COMPILER_H

#if defined(__GNUC__) /* and clang */

#include "common/at_load.h"

/* A function's argument number `text` is printf's, for those from `first` on. */
#define PBF_PRINTF(text, first) __attribute__((format(printf, text, first)))

/* Inlined whatever its size: what is constant in a call is so in the body. */
#define PBF_ALWAYS_INLINE inline __attribute__((always_inline))

/* Not looked after by what checks accesses to memory. */
#define PBF_UNSANITIZED __attribute__((noinline, no_sanitize("address"), no_sanitize("thread")))

#define PBF_FRAME_ADDRESS() __builtin_frame_address(0)

/* Runs when the library is loaded: static, void (void). Of a function that is declared twice GCC
 * takes the priority of the first declaration. */
#define PBF_AT_LOAD(function)                 \
  PBF_CONSTRUCTOR static void function(void); \
  static void function(void)

/* Runs when it is unloaded, or the program ends. */
#define PBF_AT_UNLOAD(function)              \
  PBF_DESTRUCTOR static void function(void); \
  static void function(void)

#else /* cl */

#include <intrin.h>

#define PBF_PRINTF(text, first)
#define PBF_ALWAYS_INLINE __forceinline
#define PBF_UNSANITIZED __declspec(noinline)
#define PBF_FRAME_ADDRESS() _AddressOfReturnAddress()

#pragma section(".CRT$XCU", read)
#define PBF_AT_LOAD(function)                                                       \
  static void function(void);                                                       \
  __declspec(allocate(".CRT$XCU")) void (*pbf_at_load_##function)(void) = function; \
  static void function(void)

#define PBF_AT_UNLOAD(function)                          \
  static void function(void);                            \
  PBF_AT_LOAD(register_##function) { atexit(function); } \
  static void function(void)

#endif

#endif
