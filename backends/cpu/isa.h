/* Instruction sets that the pair loops are built for. */
#ifndef PBF_CPU_ISA_H
#define PBF_CPU_ISA_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum cpu_isa {
  CPU_SCALAR,
  CPU_SIMD128,
  CPU_SSE2,
  CPU_NEON,
  CPU_AVX2,
  CPU_AVX512,
  CPU_ISA_COUNT
} cpu_isa;

const char *cpu_isa_name(cpu_isa isa);

/* The widest one that this machine has and the loops were built for. 0, with a sentence in `error`,
 * when there is none. */
int cpu_isa_best(cpu_isa *isa, char *error, size_t size);

/* The one of that name; null: the one that the environment variable PBF_ISA names, or else the
 * best. 0, with a sentence in `error`, for a name that is unknown, left out of the build, or that
 * this machine can't run. */
int cpu_isa_choose(const char *name, cpu_isa *isa, char *error, size_t size);

/* "AMD EPYC 9B45" or "CPU". */
void cpu_brand(char *brand, size_t size);

#ifdef __cplusplus
}
#endif

#endif
