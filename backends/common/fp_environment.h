/* The floating-point environment that everything computes under: to nearest, with subnormal
 * numbers, exceptions masked. A thread's environment is its owner's: a caller's may be another one,
 * and the threads of a pool have that of whoever started them, so that the bits would depend on
 * which thread did what. */
#ifndef PBF_COMMON_FP_ENVIRONMENT_H
#define PBF_COMMON_FP_ENVIRONMENT_H

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error \
    "pbf looks for NaNs and counts on rounding: compile it with -fno-fast-math -fno-finite-math-only"
#endif

#include <stdint.h>

#if defined(__x86_64__)

/* The control and status of SSE, and the control word of the x87 unit, which long double and some
 * of libm use. */
typedef struct pbf_fp_environment {
  uint32_t mxcsr;
  uint16_t x87_control;
} pbf_fp_environment;

enum { PBF_DEFAULT_MXCSR = 0x1f80, PBF_DEFAULT_X87_CONTROL = 0x037f };

static inline void pbf_set_mxcsr(uint32_t value) {
  __asm__ volatile("ldmxcsr %0" : : "m"(value) : "memory");
}

static inline void pbf_set_x87_control(uint16_t value) {
  __asm__ volatile("fldcw %0" : : "m"(value) : "memory");
}

/* That of this thread. */
static inline pbf_fp_environment pbf_fp_now(void) {
  pbf_fp_environment now;
  __asm__ volatile("stmxcsr %0" : "=m"(now.mxcsr) : : "memory");
  __asm__ volatile("fnstcw %0" : "=m"(now.x87_control) : : "memory");
  return now;
}

/* Sets the environment of this thread, and returns the one before. Also after functions of the
 * caller's, which may have left another one. */
static inline pbf_fp_environment pbf_fp_begin(void) {
  const pbf_fp_environment before = pbf_fp_now();
  pbf_set_mxcsr(PBF_DEFAULT_MXCSR);
  if (before.x87_control != PBF_DEFAULT_X87_CONTROL) pbf_set_x87_control(PBF_DEFAULT_X87_CONTROL);
  return before;
}

/* Puts back what pbf_fp_begin has found, flags of exceptions included. */
static inline void pbf_fp_end(pbf_fp_environment before) {
  pbf_set_mxcsr(before.mxcsr);
  if (before.x87_control != pbf_fp_now().x87_control) pbf_set_x87_control(before.x87_control);
}

#else

#include <fenv.h>

typedef struct pbf_fp_environment {
  fenv_t environment;
} pbf_fp_environment;

static inline pbf_fp_environment pbf_fp_now(void) {
  pbf_fp_environment now;
  fegetenv(&now.environment);
  return now;
}

static inline pbf_fp_environment pbf_fp_begin(void) {
  const pbf_fp_environment before = pbf_fp_now();
  fesetenv(FE_DFL_ENV);
  return before;
}

static inline void pbf_fp_end(pbf_fp_environment before) { fesetenv(&before.environment); }

#endif

#endif
