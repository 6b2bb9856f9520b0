#include "cpu/core.h"

#include <stdio.h>

#include "common/exported.h"
#include "common/host_only.h"
#include "common/variants.h"
#include "cpu/isa.h"
#include "cpu/team_worth.h"

#define VARIANT(dim, bits) {dim, bits / 8, &cpu_##dim##d_f##bits},
static const pbf_variant variants[] = {PBF_EACH_VARIANT(VARIANT){0, 0, NULL}};

/* Millions of particle-iterations a second that one thread does in the benchmark, by the bits of
 * its vectors. */
static int32_t thread_score(cpu_isa isa, const pbf_workload *workload) {
  static const int32_t scores[CPU_ISA_COUNT] = {
      [CPU_SCALAR] = 10, [CPU_SIMD128] = 16, [CPU_SSE2] = 16,
      [CPU_NEON] = 16,   [CPU_AVX2] = 30,    [CPU_AVX512] = 80};
  int32_t score = scores[isa];
  if (workload->precision == PBF_FLOAT64) score = score / 2;
  return workload->dimension == 3 ? score / 3 : score;
}

static void probe(const team_api *teams, const pbf_workload *workload, pbf_probe_result *result) {
  cpu_isa isa;
  if (pbf_variant_refuse(variants, workload, result)) return;
  if (pbf_refuse_device(workload, result)) return;
  if (!cpu_isa_choose(workload->isa, &isa, result->reason, sizeof result->reason)) return;
  if (workload->has_tasks && teams->ignores_tasks) {
    snprintf(result->reason, sizeof result->reason,
             "it has threads of its own; with desc.enqueue_task \"threads\" has none");
    return;
  }
  char brand[64];
  const double work = workload->capacity;
  uint32_t threads = teams->size(workload->threads);
  if (!workload->threads && teams->resizes) threads = team_worth(work, threads);
  const double speed_up = work / team_cost(work, threads);
  int32_t score = (int32_t)(thread_score(isa, workload) * speed_up);
  cpu_brand(brand, sizeof brand);
  result->score = score > 1 ? score : 1;
  result->device_type = PBF_DEVICE_CPU;
  snprintf(result->device_name, sizeof result->device_name, "%s (%s)", brand, cpu_isa_name(isa));
}

const cpu_core pbf_cpu_part = {.build = cpu_build, .variants = variants, .probe = probe};

#ifndef PBF_LINKED
PBF_EXPORTED const void *pbf_backend_part(void);

const void *pbf_backend_part(void) { return &pbf_cpu_part; }
#endif
