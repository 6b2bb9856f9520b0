#include "probe.h"

#include <stdio.h>

#include "common/fp_environment.h"
#include "os.h"

static void refuse(pbf_probe_result *result, const char *reason) {
  result->score = 0;
  snprintf(result->reason, sizeof result->reason, "%s", reason);
}

static void sanitize(pbf_probe_result *result) {
  result->device_name[sizeof result->device_name - 1] = 0;
  result->reason[sizeof result->reason - 1] = 0;
  if (result->score < 0) result->score = 0;
  if (result->score > 0 && result->device_type != PBF_DEVICE_CPU &&
      result->device_type != PBF_DEVICE_CUDA)
    refuse(result, "its probe names a type of device that this library does not know");
  if (result->score > 0) result->reason[0] = 0;
  if (result->score == 0 && !result->reason[0]) refuse(result, "its probe gave no reason");
}

pbf_probe_result pbf_probe(const pbf_plugin *plugin, const pbf_checked_desc *checked) {
  const pbf_desc *desc = &checked->desc;
  pbf_probe_result result = {.struct_size = sizeof result};
  if (plugin->reason[0]) {
    refuse(&result, plugin->reason);
    return result;
  }
  const pbf_workload workload = {
      .struct_size = sizeof workload,
      .dimension = desc->dimension,
      .precision = desc->precision,
      .capacity = desc->capacity,
      .device = desc->device,
      .threads = desc->threads,
      .isa = pbf_desc_isa(checked, plugin->name),
      .has_tasks = desc->enqueue_task != NULL,
  };
  const int cancellation = pbf_uncancelled_begin();
  pbf_fp_environment callers = pbf_fp_begin();
  plugin->api.probe(&workload, &result);
  pbf_fp_end(callers);
  pbf_uncancelled_end(cancellation);
  sanitize(&result);
  return result;
}
