/* Backends that the library was linked with. */
#include <stdio.h>
#include <string.h>

#include "discover.h"
#include "entries.h"
#include "error.h"
#include "pbf_linked.h"

#define DECLARE(name) \
  pbf_status pbf_backend_negotiate_##name(const pbf_backend_host *host, pbf_backend_answer *answer);
PBF_EACH_LINKED(DECLARE)

static const struct {
  const char *name;
  pbf_backend_negotiate_fn entry;
} linked[] = {
#define ROW(name) {#name, pbf_backend_negotiate_##name},
    PBF_EACH_LINKED(ROW)};

const pbf_backend_host pbf_plugin_host = {
    .struct_size = sizeof(pbf_backend_host),
    .abi_min = PBF_BACKEND_ABI_VERSION,
    .abi_max = PBF_BACKEND_ABI_VERSION,
    .set_error = pbf_plugin_message_set,
};

int pbf_discover_name(const char *name) {
  for (size_t i = 0; i < sizeof linked / sizeof linked[0]; ++i) {
    if (strcmp(linked[i].name, name) != 0) continue;
    pbf_plugin plugin = {0};
    snprintf(plugin.name, sizeof plugin.name, "%s", name);
    pbf_plugin_negotiate(&pbf_plugin_host, linked[i].entry, name, &plugin);
    pbf_entries_append(&plugin, PBF_ROOM_SEARCH);
    return 1;
  }
  pbf_entries_append_failure(name, "", "built without it", PBF_ROOM_SEARCH);
  return 1;
}

void pbf_discover_end(void) {}

pbf_status pbf_discover_path(const char *path) {
  return pbf_fail(PBF_ERROR_UNSUPPORTED,
                  "%s: built without plugins; the backends of this library are linked in", path);
}
