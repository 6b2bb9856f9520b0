#include "registry.h"

#include <pthread.h>
#include <string.h>

#include "discover.h"
#include "error.h"
#include "text.h"

static const char *const known_names[] = {"reference", "serial", "openmp", "cuda"};

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static pbf_plugin entries[PBF_MOST_PLUGINS];
static uint32_t entry_count;
static int searched;

const pbf_plugin *pbf_registry_usable(const char *name) {
  for (uint32_t i = 0; i < entry_count; ++i) {
    if (!entries[i].reason[0] && strcmp(entries[i].name, name) == 0) return &entries[i];
  }
  return NULL;
}

const pbf_plugin *pbf_registry_of_path(const char *path, int usable) {
  for (uint32_t i = 0; i < entry_count; ++i) {
    if ((entries[i].reason[0] == 0) == usable && strcmp(entries[i].path, path) == 0)
      return &entries[i];
  }
  return NULL;
}

int pbf_registry_is_full(void) { return entry_count == PBF_MOST_PLUGINS; }

void pbf_registry_append(const pbf_plugin *plugin) {
  if (!pbf_registry_is_full()) entries[entry_count++] = *plugin;
}

void pbf_registry_append_failure(const char *name, const char *path, const char *reason) {
  pbf_plugin plugin = {0};
  pbf_text_append(plugin.name, sizeof plugin.name, name);
  pbf_text_append(plugin.path, sizeof plugin.path, path);
  pbf_text_append(plugin.reason, sizeof plugin.reason, reason);
  pbf_registry_append(&plugin);
}

/* Called with the lock held. */
static void search_once(void) {
  if (searched) return;
  searched = 1;
  for (size_t i = 0; i < sizeof known_names / sizeof known_names[0]; ++i) {
    if (!pbf_registry_usable(known_names[i])) pbf_discover_name(known_names[i]);
  }
  pbf_discover_end();
}

uint32_t pbf_registry_count(void) {
  pthread_mutex_lock(&lock);
  search_once();
  uint32_t count = entry_count;
  pthread_mutex_unlock(&lock);
  return count;
}

const pbf_plugin *pbf_registry_entry(uint32_t index) {
  return index < pbf_registry_count() ? &entries[index] : NULL;
}

pbf_status pbf_load_backend(const char *path) {
  if (!path || path[0] != '/') {
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "path is %s%s%s; it must be absolute",
                    path ? "\"" : "", path ? path : "null", path ? "\"" : "");
  }
  pthread_mutex_lock(&lock);
  pbf_status status = pbf_discover_path(path);
  pthread_mutex_unlock(&lock);
  return status;
}
