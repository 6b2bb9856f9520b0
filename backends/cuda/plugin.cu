/* The `cuda` plugin: its one exported function, and the choice of a variant. */
#include "cuda/plugin.h"

#include <stdio.h>

const pbf_backend_host *pbf_cuda_host;

namespace {

pbf_status create(const pbf_backend_desc *desc, const pbf_params *params,
                  pbf_backend_solver **solver, const pbf_backend_api **api) {
  const pbf_backend_api *variant =
      desc->dimension == 2 ? (desc->precision == PBF_FLOAT32 ? &cuda_2d_f32 : &cuda_2d_f64)
                           : (desc->precision == PBF_FLOAT32 ? &cuda_3d_f32 : &cuda_3d_f64);
  return variant->create(desc, params, solver, api);
}

}  // namespace

extern "C" __attribute__((visibility("default"))) pbf_status pbf_backend_negotiate(
    const pbf_backend_host *host, pbf_backend_answer *answer) {
  static pbf_backend_api table;
  if (host->abi_min > PBF_BACKEND_ABI_VERSION || host->abi_max < PBF_BACKEND_ABI_VERSION)
    return PBF_ERROR_UNSUPPORTED;
  pbf_cuda_host = host;
  table = cuda_3d_f32;
  table.create = create;
  answer->abi_version = PBF_BACKEND_ABI_VERSION;
  answer->api = &table;
  snprintf(answer->name, sizeof answer->name, "%s", PBF_BACKEND_NAME);
  snprintf(answer->build_id, sizeof answer->build_id, "%s", PBF_BUILD_ID);
  return PBF_OK;
}
