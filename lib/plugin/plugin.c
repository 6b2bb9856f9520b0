#include "plugin.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "error.h"
#include "structs.h"

pbf_status pbf_plugin_refuse(pbf_plugin *plugin, pbf_status status, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(plugin->reason, sizeof plugin->reason, format, arguments);
  va_end(arguments);
  return status;
}

/* 1 for a text of 0 or more printable characters (or UTF-8 bytes) that ends within its array. */
static int is_text(const char *text, size_t size) {
  for (size_t i = 0; i < size; ++i) {
    unsigned char c = (unsigned char)text[i];
    if (c == 0) return 1;
    if (c < 0x20 || c == 0x7f) return 0;
  }
  return 0;
}

typedef struct member {
  const char *name;
  size_t offset;
} member;

#define MEMBER(name) \
  { #name, offsetof(pbf_backend_api, name) }

static const member mandatory[] = {
    MEMBER(probe),       MEMBER(create),        MEMBER(destroy),
    MEMBER(set_params),  MEMBER(set_colliders), MEMBER(step),
    MEMBER(synchronize), MEMBER(add_particles), MEMBER(remove_particles),
    MEMBER(remove_all),  MEMBER(read),          MEMBER(write),
    MEMBER(map),         MEMBER(get_stats),     MEMBER(get_plan),
    MEMBER(describe),
};

static int is_null_member(const pbf_backend_api *api, size_t offset) {
  static const unsigned char null[sizeof(void (*)(void))];
  return memcmp((const unsigned char *)api + offset, null, sizeof null) == 0;
}

static pbf_status check_table(const pbf_backend_api *api, char *reason, size_t size) {
  for (size_t i = 0; i < sizeof mandatory / sizeof mandatory[0]; ++i) {
    if (!is_null_member(api, mandatory[i].offset)) continue;
    snprintf(reason, size, "its table has no function '%s'", mandatory[i].name);
    return PBF_ERROR_PLUGIN;
  }
  const char *half = NULL;
  if (!api->set_timing != !api->get_timings) half = "set_timing and get_timings";
  if (!api->read_pressures != !api->map_pressures) half = "read_pressures and map_pressures";
  const int arrays =
      (api->take_array != NULL) + (api->release_array != NULL) + (api->read_array != NULL);
  if (arrays % 3 != 0) {
    snprintf(reason, size,
             "its table has some of take_array, release_array and read_array; all or none must be "
             "set");
    return PBF_ERROR_PLUGIN;
  }
  if (!half) return PBF_OK;
  snprintf(reason, size, "its table has one of %s; both or neither must be set", half);
  return PBF_ERROR_PLUGIN;
}

pbf_status pbf_plugin_copy_table(const pbf_backend_api *theirs, pbf_backend_api *ours, char *reason,
                                 size_t size) {
  if (!theirs) {
    snprintf(reason, size, "it gave no table of functions");
    return PBF_ERROR_PLUGIN;
  }
  uint32_t theirs_size = pbf_struct_size(theirs);
  if (theirs_size < offsetof(pbf_backend_api, set_timing)) {
    snprintf(reason, size, "its table of functions has %u bytes; ABI version 1 begins at %zu",
             theirs_size, offsetof(pbf_backend_api, set_timing));
    return PBF_ERROR_PLUGIN;
  }
  memset(ours, 0, sizeof *ours);
  memcpy(ours, theirs, theirs_size < sizeof *ours ? theirs_size : sizeof *ours);
  return check_table(ours, reason, size);
}

static pbf_status check_name(const char *name, const char *expected, pbf_plugin *plugin) {
  if (!is_text(name, PBF_NAME_SIZE) || !name[0] || strcmp(name, "auto") == 0) {
    return pbf_plugin_refuse(
        plugin, PBF_ERROR_PLUGIN,
        "its name is not a text of 1 … %d printable characters other than \"auto\"",
        PBF_NAME_SIZE - 1);
  }
  if (expected && strcmp(name, expected) != 0) {
    return pbf_plugin_refuse(plugin, PBF_ERROR_PLUGIN,
                             "it calls itself \"%s\"; its file is that of \"%s\"", name, expected);
  }
  return PBF_OK;
}

static pbf_status check_answer(const pbf_backend_host *host, const pbf_backend_answer *answer,
                               const char *expected, pbf_plugin *plugin) {
  if (answer->abi_version < host->abi_min || answer->abi_version > host->abi_max) {
    return pbf_plugin_refuse(plugin, PBF_ERROR_UNSUPPORTED,
                             "it speaks version %u of the plugin ABI; this library speaks %u … %u",
                             answer->abi_version, host->abi_min, host->abi_max);
  }
  pbf_status status = check_name(answer->name, expected, plugin);
  if (status != PBF_OK) return status;
  memcpy(plugin->name, answer->name, sizeof plugin->name);
  if (!is_text(answer->build_id, sizeof answer->build_id))
    return pbf_plugin_refuse(plugin, PBF_ERROR_PLUGIN, "its build id is not a text");
  memcpy(plugin->build_id, answer->build_id, sizeof plugin->build_id);
  return pbf_plugin_copy_table(answer->api, &plugin->api, plugin->reason, sizeof plugin->reason);
}

pbf_status pbf_plugin_negotiate(const pbf_backend_host *host, pbf_backend_negotiate_fn entry,
                                const char *expected, pbf_plugin *plugin) {
  pbf_backend_answer answer = {.struct_size = sizeof answer};
  pbf_plugin_message_clear();
  pbf_status status = entry(host, &answer);
  if (status == PBF_OK) return check_answer(host, &answer, expected, plugin);
  const char *message = pbf_plugin_message();
  if (status == PBF_ERROR_UNAVAILABLE && message[0])
    return pbf_plugin_refuse(plugin, status, "%s", message);
  if (!message[0]) message = "it gave no reason";
  return pbf_plugin_refuse(plugin, status == PBF_ERROR_UNSUPPORTED ? status : PBF_ERROR_PLUGIN,
                           "it refused to work with version %u … %u of the plugin ABI: %s",
                           host->abi_min, host->abi_max, message);
}
