#include "cpu/isa.h"

#include <stdio.h>
#include <string.h>

#include "common/at_load.h"
#include "common/instruction_sets.h"
#include "common/system.h"
#include "pbf_build.h"

#if defined(__x86_64__)
#include <cpuid.h>
#endif

const char *cpu_isa_name(cpu_isa isa) {
  _Static_assert((int)CPU_ISA_COUNT == (int)PBF_INSTRUCTION_SET_COUNT, "a name for each");
  return pbf_instruction_sets[isa];
}

/* Asked for once: under a hypervisor each question takes some twenty microseconds. */
static char brand_there[64] = "CPU";

#if defined(__x86_64__)
static int has_lzcnt; /* without it the same bytes are another instruction */

static void ask_for_brand(void) {
  unsigned int words[13] = {0};
  if ((unsigned)__get_cpuid_max(0x80000000u, NULL) < 0x80000004u) return;
  for (unsigned int k = 0; k < 3; ++k)
    __get_cpuid(0x80000002u + k, &words[4 * k], &words[4 * k + 1], &words[4 * k + 2],
                &words[4 * k + 3]);
  const char *text = (const char *)words;
  text += strspn(text, " ");
  size_t length = strlen(text);
  while (length && text[length - 1] == ' ') --length;
  if (length) snprintf(brand_there, sizeof brand_there, "%.*s", (int)length, text);
}

PBF_CONSTRUCTOR static void ask_processor(void) {
  unsigned int a, b, c, d;
  has_lzcnt = __get_cpuid(0x80000001u, &a, &b, &c, &d) && c & bit_LZCNT;
  ask_for_brand();
}
#endif

static int has(cpu_isa isa) {
#if defined(__x86_64__)
  __builtin_cpu_init();
  if (isa == CPU_AVX2)
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
           __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2") && has_lzcnt;
  if (isa == CPU_AVX512)
    return has(CPU_AVX2) && __builtin_cpu_supports("avx512f") &&
           __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512bw") &&
           __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
  return isa != CPU_NEON && isa != CPU_SIMD128;
#elif defined(__aarch64__)
  return isa == CPU_SCALAR || isa == CPU_NEON; /* of which every AArch64 has it */
#elif defined(__wasm__)
  return isa == CPU_SCALAR || isa == CPU_SIMD128; /* a machine without it refuses the module */
#else
  return isa == CPU_SCALAR;
#endif
}

static int is_built(cpu_isa isa) {
#define BIT(name, NAME) | 1 << CPU_##NAME
  return ((0 PBF_EACH_ISA(BIT)) >> isa) & 1;
}

int cpu_isa_best(cpu_isa *isa, char *error, size_t size) {
  for (int k = CPU_ISA_COUNT - 1; k >= 0; --k)
    if (is_built((cpu_isa)k) && has((cpu_isa)k)) {
      *isa = (cpu_isa)k;
      return 1;
    }
  snprintf(error, size, "built without an instruction set that this machine has");
  return 0;
}

int cpu_isa_choose(const char *name, cpu_isa *isa, char *error, size_t size) {
  cpu_isa best;
  if (!cpu_isa_best(&best, error, size)) return 0;
  *isa = best;
  if (!name) name = pbf_environment("PBF_ISA");
  if (!name || !*name) return 1;
  *isa = (cpu_isa)pbf_instruction_set_of(name);
  if (*isa < CPU_ISA_COUNT && has(*isa) && is_built(*isa)) return 1;
  const char *why = *isa == CPU_ISA_COUNT ? "has no meaning"
                    : has(*isa)           ? "this build is without"
                                          : "this machine can't run";
  snprintf(
      error, size,
      "desc.isa, or else PBF_ISA in the environment, is '%.20s', which %s; the best here is '%s'",
      name, why, cpu_isa_name(best));
  return 0;
}

void cpu_brand(char *brand, size_t size) { snprintf(brand, size, "%s", brand_there); }
