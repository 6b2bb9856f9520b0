#include "registry.h"

#include <errno.h>
#include <limits.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "error.h"
#include "search.h"
#include "text.h"

enum { MOST_ENTRIES = 64 };

static const char *const known_names[] = {"reference", "serial", "openmp", "cuda"};

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static pbf_plugin entries[MOST_ENTRIES];
static uint32_t entry_count;
static int searched;

static const pbf_plugin *find_usable(const char *name) {
  for (uint32_t i = 0; i < entry_count; ++i) {
    if (!entries[i].reason[0] && strcmp(entries[i].name, name) == 0) return &entries[i];
  }
  return NULL;
}

static const pbf_plugin *find_path(const char *path, int usable) {
  for (uint32_t i = 0; i < entry_count; ++i) {
    if ((entries[i].reason[0] == 0) == usable && strcmp(entries[i].path, path) == 0)
      return &entries[i];
  }
  return NULL;
}

/* A full list drops the entry: the caller has its sentence all the same. */
static void append(const pbf_plugin *plugin) {
  if (entry_count < MOST_ENTRIES) entries[entry_count++] = *plugin;
}

static void append_failure(const char *name, const char *path, const char *reason) {
  pbf_plugin plugin = {0};
  pbf_text_append(plugin.name, sizeof plugin.name, name);
  pbf_text_append(plugin.path, sizeof plugin.path, path);
  pbf_text_append(plugin.reason, sizeof plugin.reason, reason);
  append(&plugin);
}

/* Loads and lists one file; the first plugin of a name keeps it. */
static pbf_status load(const char *path, const char *expected, pbf_plugin *plugin) {
  pbf_status status = pbf_plugin_load(path, expected, plugin);
  const pbf_plugin *first = status == PBF_OK ? find_usable(plugin->name) : NULL;
  if (first) {
    status = PBF_ERROR_INVALID_ARGUMENT;
    snprintf(plugin->reason, sizeof plugin->reason, "its name \"%s\" is taken by %.180s",
             plugin->name, first->path);
  }
  if (status == PBF_OK || !find_path(plugin->path, 0)) append(plugin);
  return status;
}

/* 1 when the folder has such a file, whether it loads or not. */
static int try_folder(const char *folder, const char *name) {
  char path[PATH_MAX];
  struct stat file;
  pbf_plugin plugin;
  int length = snprintf(path, sizeof path, "%s/pbf_backend_%s.so", folder, name);
  if (length >= (int)sizeof path) return 0;
  if (stat(path, &file) != 0 && (errno == ENOENT || errno == ENOTDIR)) return 0;
  load(path, name, &plugin);
  return 1;
}

static void search_name(const char *name) {
  char folder[PATH_MAX], tried[200] = "";
  int candidates = 0;
  pbf_folder kind;
  for (uint32_t i = 0; (kind = pbf_search_folder(i, folder, sizeof folder)); ++i) {
    if (kind != PBF_FOLDER_USABLE) continue;
    candidates += try_folder(folder, name);
    if (find_usable(name)) return;
    if (tried[0]) pbf_text_append(tried, sizeof tried, ":");
    pbf_text_append(tried, sizeof tried, folder);
  }
  char reason[256];
  snprintf(reason, sizeof reason, "no pbf_backend_%s.so in %s", name, tried);
  if (!candidates) append_failure(name, "", reason);
}

static void list_unusable_folders(void) {
  char folder[PATH_MAX];
  pbf_folder kind;
  for (uint32_t i = 0; (kind = pbf_search_folder(i, folder, sizeof folder)); ++i) {
    if (kind == PBF_FOLDER_NOT_ABSOLUTE)
      append_failure("", folder, "a folder in PBF_BACKEND_PATH that is not absolute is left out");
    if (kind == PBF_FOLDER_TOO_LONG)
      append_failure("", "", "a folder in PBF_BACKEND_PATH is longer than a path can be");
  }
}

/* Called with the lock held. */
static void search_once(void) {
  if (searched) return;
  searched = 1;
  for (size_t i = 0; i < sizeof known_names / sizeof known_names[0]; ++i) {
    if (!find_usable(known_names[i])) search_name(known_names[i]);
  }
  list_unusable_folders();
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

static pbf_status load_explicitly(const char *path) {
  pbf_plugin plugin;
  if (find_path(path, 1)) return PBF_OK;
  if (entry_count == MOST_ENTRIES) {
    return pbf_fail(PBF_ERROR_CAPACITY, "%s: the list of backends is full with %d entries", path,
                    MOST_ENTRIES);
  }
  pbf_status status = load(path, NULL, &plugin);
  return status == PBF_OK ? PBF_OK : pbf_fail(status, "%s: %s", path, plugin.reason);
}

pbf_status pbf_load_backend(const char *path) {
  if (!path || path[0] != '/') {
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "path is %s%s%s; it must be absolute",
                    path ? "\"" : "", path ? path : "null", path ? "\"" : "");
  }
  pthread_mutex_lock(&lock);
  pbf_status status = load_explicitly(path);
  pthread_mutex_unlock(&lock);
  return status;
}
