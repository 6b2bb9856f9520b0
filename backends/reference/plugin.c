/* The `reference` plugin: the paper read aloud, one thread, no tricks. The oracle of the other
 * backends, and in float32 the naive row of the speed-up table. */
#include "reference/plugin.h"

#include <stdio.h>

#include "common/entry.h"
#include "common/host_only.h"
#include "common/instruction_sets.h"
#include "common/variants.h"

static const pbf_backend_host *negotiated;

#define VARIANT(dim, bits) {dim, bits / 8, &reference_##dim##d_f##bits},
static const pbf_variant variants[] = {PBF_EACH_VARIANT(VARIANT){0, 0, NULL}};

void reference_probe(const pbf_workload *workload, pbf_probe_result *result) {
  if (pbf_variant_refuse(variants, workload, result)) return;
  if (pbf_refuse_device(workload, result)) return;
  if (pbf_instruction_set_refuse(workload, result)) return;
  result->score = 1;
  result->device_type = PBF_DEVICE_CPU;
  snprintf(result->device_name, sizeof result->device_name, "one CPU thread");
}

static pbf_status create(const pbf_backend_desc *desc, const pbf_params *params,
                         pbf_backend_solver **solver, const pbf_backend_api **api) {
  return pbf_variant_create(variants, negotiated, desc, params, solver, api);
}

pbf_status PBF_ENTRY(const pbf_backend_host *host, pbf_backend_answer *answer) {
  static pbf_backend_api table;
  negotiated = host;
  table = *variants[0].api;
  table.create = create;
  return pbf_entry_answer(host, &table, answer);
}
