/* The names of the instruction sets that CPU backends build their pair loops for: what
 * pbf_desc.isa and the environment variable PBF_ISA may say. */
#ifndef PBF_COMMON_INSTRUCTION_SETS_H
#define PBF_COMMON_INSTRUCTION_SETS_H

#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <pbf/pbf_backend.h>

/* Narrower ones first. */
static const char *const pbf_instruction_sets[] = {"scalar", "simd128", "sse2",
                                                   "neon",   "avx2",    "avx512"};
enum { PBF_INSTRUCTION_SET_COUNT = sizeof pbf_instruction_sets / sizeof pbf_instruction_sets[0] };

/* PBF_INSTRUCTION_SET_COUNT: there is no such name. */
static inline int pbf_instruction_set_of(const char *name) {
  int k = 0;
  while (k < PBF_INSTRUCTION_SET_COUNT && strcmp(name, pbf_instruction_sets[k]) != 0) ++k;
  return k;
}

/* Of a backend that has no choice of them: fills the answer to a probe and returns 1 when one is
 * asked for. Otherwise it would serve in place of a CPU backend that has not got it. */
static inline int pbf_instruction_set_refuse(const pbf_workload *workload,
                                             pbf_probe_result *result) {
  if (!workload->isa) return 0;
  result->score = 0;
  snprintf(result->reason, sizeof result->reason,
           "it has no choice of instruction sets; desc.isa must be null");
  return 1;
}

#endif
