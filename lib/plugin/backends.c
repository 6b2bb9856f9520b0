/* The public list of backends. */
#include <string.h>

#include "check.h"
#include "desc.h"
#include "error.h"
#include "lock.h"
#include "probe.h"
#include "registry.h"
#include "structs.h"
#include "text.h"

pbf_status pbf_get_backend_count(uint32_t *count) {
  pbf_status status = pbf_check_pointer("count", count, sizeof *count);
  if (status == PBF_OK) status = pbf_lock_check();
  if (status == PBF_OK) *count = pbf_registry_count();
  return status;
}

pbf_status pbf_get_backend_info(const pbf_desc *desc, uint32_t index, pbf_backend_info *info) {
  pbf_checked_desc checked;
  pbf_status status = pbf_desc_check(desc, &checked);
  if (status == PBF_OK) status = pbf_struct_check_out(&pbf_kind_backend_info, info);
  if (status == PBF_OK) status = pbf_lock_check();
  if (status != PBF_OK) return status;
  const pbf_plugin *plugin = pbf_registry_entry(index);
  if (!plugin) {
    return pbf_fail(PBF_ERROR_NOT_FOUND, "index is %u; the list of backends has %u entries", index,
                    pbf_registry_count());
  }
  pbf_probe_result probe = pbf_probe(plugin, &checked);
  pbf_backend_info ours = {
      .available = probe.score > 0,
      .score = probe.score,
      .device_type = probe.device_type,
  };
  memcpy(ours.name, plugin->name, sizeof ours.name);
  memcpy(ours.device_name, probe.device_name, sizeof ours.device_name);
  memcpy(ours.build_id, plugin->build_id, sizeof ours.build_id);
  memcpy(ours.path, plugin->path, sizeof ours.path);
  pbf_text_end_whole(ours.path);
  memcpy(ours.reason, probe.reason, sizeof ours.reason);
  pbf_text_make_line(ours.reason);
  pbf_struct_out(&pbf_kind_backend_info, &ours, info, info->struct_size);
  return PBF_OK;
}
