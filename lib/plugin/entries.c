#include "entries.h"

#include <string.h>

#include "text.h"

static pbf_plugin entries[PBF_MAX_PLUGINS];
static uint32_t entry_count;

uint32_t pbf_entries_count(void) { return entry_count; }

const pbf_plugin *pbf_entries_at(uint32_t index) { return &entries[index]; }

int pbf_entries_name(const char *name) {
  for (uint32_t i = 0; i < entry_count; ++i)
    if (strcmp(entries[i].name, name) == 0) return 1;
  return 0;
}

const pbf_plugin *pbf_entries_usable(const char *name) {
  for (uint32_t i = 0; i < entry_count; ++i) {
    if (!entries[i].reason[0] && strcmp(entries[i].name, name) == 0) return &entries[i];
  }
  return NULL;
}

const pbf_plugin *pbf_entries_of_path(const char *path, int usable) {
  for (uint32_t i = 0; i < entry_count; ++i) {
    if ((entries[i].reason[0] == 0) == usable && strcmp(entries[i].path, path) == 0)
      return &entries[i];
  }
  return NULL;
}

int pbf_entries_have(pbf_room room) { return entry_count + (uint32_t)room < PBF_MAX_PLUGINS; }

void pbf_entries_append(const pbf_plugin *plugin, pbf_room room) {
  if (pbf_entries_have(room)) entries[entry_count++] = *plugin;
}

void pbf_entries_append_failure(const char *name, const char *path, const char *reason,
                                pbf_room room) {
  pbf_plugin plugin = {0};
  pbf_text_append(plugin.name, sizeof plugin.name, name);
  pbf_text_append(plugin.path, sizeof plugin.path, path);
  pbf_text_append(plugin.reason, sizeof plugin.reason, reason);
  pbf_entries_append(&plugin, room);
}
