/* The `cuda` plugin: its one exported function, and the choice of a variant. */
#include "cuda/plugin.h"

#include "common/entry.h"
#include "common/instruction_sets.h"
#include "common/variants.h"

__thread const pbf_backend_host *pbf_cuda_host;

namespace {

const pbf_backend_host *negotiated;

#define VARIANT(dim, bits) {dim, bits / 8, &cuda_##dim##d_f##bits},
const pbf_variant variants[] = {PBF_EACH_CUDA_VARIANT(VARIANT){0, 0, nullptr}};

pbf_status create(const pbf_backend_desc *desc, const pbf_params *params,
                  pbf_backend_solver **solver, const pbf_backend_api **api) {
  return pbf_variant_create(variants, negotiated, desc, params, solver, api);
}

/* The variants' own tables ask the device alone: libpbf asks a backend's first table. */
void probe(const pbf_workload *workload, pbf_probe_result *result) {
  result->device_type = PBF_DEVICE_CUDA;
  if (pbf_variant_refuse(variants, workload, result)) return;
  if (!pbf_instruction_set_refuse(workload, result)) pbf_cuda_probe(workload, result);
}

}  // namespace

pbf_status PBF_ENTRY(const pbf_backend_host *host, pbf_backend_answer *answer) {
  static pbf_backend_api table;
  negotiated = host;
  table = *variants[0].api;
  table.probe = probe;
  table.create = create;
  return pbf_entry_answer(host, &table, answer);
}
