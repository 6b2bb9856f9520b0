#include "entries.h"

#include <string.h>

#include "text.h"

static pbf_plugin entries[PBF_MAX_PLUGINS];
static uint32_t entry_count;

uint32_t pbf_entries_count(void) { return entry_count; }

const pbf_plugin *pbf_entries_at(uint32_t index) { return &entries[index]; }

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

int pbf_entries_are_full(void) { return entry_count == PBF_MAX_PLUGINS; }

void pbf_entries_append(const pbf_plugin *plugin) {
  if (!pbf_entries_are_full()) entries[entry_count++] = *plugin;
}

void pbf_entries_append_failure(const char *name, const char *path, const char *reason) {
  pbf_plugin plugin = {0};
  pbf_text_append(plugin.name, sizeof plugin.name, name);
  pbf_text_append(plugin.path, sizeof plugin.path, path);
  pbf_text_append(plugin.reason, sizeof plugin.reason, reason);
  pbf_entries_append(&plugin);
}
