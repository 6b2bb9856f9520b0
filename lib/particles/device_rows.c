#include "device_rows.h"

#include "error.h"
#include "solver/backend_call.h"

static const pbf_backend_device_rows *extension_of(const pbf_solver *solver) {
  const pbf_backend_api *api = &solver->api;
  return api->get_extension ? api->get_extension(PBF_BACKEND_DEVICE_ROWS) : NULL;
}

static pbf_status check_host(const char *call, const void *stream) {
  if (!stream) return PBF_OK;
  return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                  "%s.stream is set; it must be null for host memory (%s.device_type 0 or 1)", call,
                  call);
}

pbf_status pbf_device_rows_check(const pbf_solver *solver, const char *call, uint32_t device_type,
                                 uint32_t reserved, const void *stream, int *is_device) {
  *is_device = device_type == PBF_DEVICE_CUDA;
  if (device_type > PBF_DEVICE_CUDA)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "%s.device_type is %u; it must be 0, 1 (PBF_DEVICE_CPU) or 2 (PBF_DEVICE_CUDA)",
                    call, device_type);
  if (reserved != 0)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "%s.reserved is %u; it must be 0", call, reserved);
  if (!*is_device) return check_host(call, stream);
  if (!extension_of(solver))
    return pbf_fail(
        PBF_ERROR_UNSUPPORTED,
        "%s.device_type is 2 (PBF_DEVICE_CUDA); the solver's backend \"%s\" has no such "
        "memory",
        call, solver->plugin->name);
  if (solver->ranks.count > 0)
    return pbf_fail(PBF_ERROR_UNSUPPORTED,
                    "%s.device_type is 2 (PBF_DEVICE_CUDA); on ranks particles are in host memory "
                    "alone",
                    call);
  return PBF_OK;
}

pbf_status pbf_device_rows_read(pbf_solver *solver, const pbf_device_rows *to) {
  return pbf_backend_result(solver, extension_of(solver)->read(solver->backend, to), "read");
}

pbf_status pbf_device_rows_write(pbf_solver *solver, const pbf_device_rows *from) {
  return pbf_backend_result(solver, extension_of(solver)->write(solver->backend, from), "write");
}

pbf_status pbf_device_rows_fetch(pbf_solver *solver, const pbf_device_rows *from, void *to) {
  return pbf_backend_result(solver, extension_of(solver)->fetch(solver->backend, from, to),
                            "fetch");
}
