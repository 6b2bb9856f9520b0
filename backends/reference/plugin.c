/* The `reference` plugin: the paper read aloud, one thread, no tricks. The oracle of the other
 * backends, and in float32 the naive row of the speed-up table. */
#include "reference/plugin.h"

#include <stdio.h>

const pbf_backend_host *reference_host;

void reference_probe(const pbf_workload *workload, pbf_probe_result *result) {
  (void)workload;
  result->score = 1;
  result->device_type = PBF_DEVICE_CPU;
  snprintf(result->device_name, sizeof result->device_name, "one CPU thread");
}

static pbf_status create(const pbf_backend_desc *desc, const pbf_params *params,
                         pbf_backend_solver **solver, const pbf_backend_api **api) {
  const pbf_backend_api *variant =
      desc->dimension == 2
          ? (desc->precision == PBF_FLOAT32 ? &reference_2d_f32 : &reference_2d_f64)
          : (desc->precision == PBF_FLOAT32 ? &reference_3d_f32 : &reference_3d_f64);
  return variant->create(desc, params, solver, api);
}

pbf_status pbf_backend_negotiate(const pbf_backend_host *host, pbf_backend_answer *answer);

__attribute__((visibility("default"))) pbf_status pbf_backend_negotiate(
    const pbf_backend_host *host, pbf_backend_answer *answer) {
  static pbf_backend_api table;
  if (host->abi_min > PBF_BACKEND_ABI_VERSION || host->abi_max < PBF_BACKEND_ABI_VERSION)
    return PBF_ERROR_UNSUPPORTED;
  reference_host = host;
  table = reference_3d_f32;
  table.create = create;
  answer->abi_version = PBF_BACKEND_ABI_VERSION;
  answer->api = &table;
  snprintf(answer->name, sizeof answer->name, "%s", PBF_BACKEND_NAME);
  snprintf(answer->build_id, sizeof answer->build_id, "%s", PBF_BUILD_ID);
  return PBF_OK;
}
