/* What a description can ask for that backends on the host do not have: other devices, streams. */
#ifndef PBF_COMMON_HOST_ONLY_H
#define PBF_COMMON_HOST_ONLY_H

#include <stdio.h>

#include <pbf/pbf_backend.h>

/* Fills the answer to a probe and returns 1 when it asks about another device. */
static inline int pbf_refuse_device(const pbf_workload *workload, pbf_probe_result *result) {
  if (workload->device == 0) return 0;
  result->score = 0;
  snprintf(result->reason, sizeof result->reason,
           "desc.device is %d; it must be 0, the CPU is one device", workload->device);
  return 1;
}

static inline pbf_status pbf_refuse_stream(const pbf_backend_desc *desc) {
  if (!desc->stream) return PBF_OK;
  desc->host->set_error("desc.stream is not null; the CPU has no streams");
  return PBF_ERROR_INVALID_ARGUMENT;
}

#endif
