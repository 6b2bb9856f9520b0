/* Backends in files: found by their known names in the folders of search.h. */
#include "discover.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "entries.h"
#include "error.h"
#include "os.h"
#include "pbf_build.h"
#include "plugin_file.h"
#include "search.h"
#include "text.h"

/* Loads and lists one file; the first plugin of a name keeps it. One that works takes `room`. */
static pbf_status load(const char *path, const char *expected, pbf_plugin *plugin, pbf_room room) {
  pbf_status status = pbf_plugin_load(path, expected, plugin);
  const pbf_plugin *first = status == PBF_OK ? pbf_entries_usable(plugin->name) : NULL;
  if (first) {
    status = PBF_ERROR_INVALID_ARGUMENT;
    snprintf(plugin->reason, sizeof plugin->reason, "its name \"%s\" is taken by %.180s",
             plugin->name, first->path);
  }
  if (status == PBF_OK)
    pbf_entries_append(plugin, room);
  else if (!pbf_entries_of_path(plugin->path, 0))
    pbf_entries_append(plugin, PBF_ROOM_FAILED);
  return status;
}

/* 1 when the folder has such a file, whether it loads or not; `reason` is why it does not. */
static int try_folder(const char *folder, const char *name, char reason[256]) {
  char path[PBF_OS_PATH_SIZE];
  int is_regular;
  pbf_plugin plugin;
  int length = snprintf(path, sizeof path, "%s/pbf_backend_%s" PBF_PLUGIN_SUFFIX, folder, name);
  if (length >= (int)sizeof path) return 0;
  const int failed = pbf_os_look(path, &is_regular);
  if (failed == ENOENT || failed == ENOTDIR) return 0;
  load(path, name, &plugin, PBF_ROOM_SEARCH);
  memcpy(reason, plugin.reason, sizeof plugin.reason);
  return 1;
}

int pbf_discover_name(const char *name) {
  char folder[PBF_OS_PATH_SIZE], tried[200] = "", reason[256];
  int candidates = 0, is_settled = pbf_os_own_folder(folder, sizeof folder);
  pbf_folder kind;
  pbf_search search = {0, 0};
  while ((kind = pbf_search_next(&search, folder, sizeof folder))) {
    if (kind != PBF_FOLDER_USABLE) continue;
    candidates += try_folder(folder, name, reason);
    if (pbf_entries_usable(name)) return 1;
    if (pbf_plugin_was_short()) is_settled = 0;
    const char separator[] = {pbf_os_list_separator, 0};
    if (tried[0]) pbf_text_append(tried, sizeof tried, separator);
    pbf_text_append(tried, sizeof tried, folder);
  }
  if (!candidates && !tried[0])
    snprintf(reason, sizeof reason,
             "no folder to look for pbf_backend_%s" PBF_PLUGIN_SUFFIX
             " in: where libpbf is loaded from can't be told; PBF_BACKEND_PATH can name one",
             name);
  else if (!candidates)
    snprintf(reason, sizeof reason, "no pbf_backend_%s" PBF_PLUGIN_SUFFIX " in %s", name, tried);
  if (!pbf_entries_name(name)) pbf_entries_append_failure(name, "", reason, PBF_ROOM_SEARCH);
  return is_settled;
}

void pbf_discover_end(void) {
  char folder[PBF_OS_PATH_SIZE];
  pbf_folder kind;
  pbf_search search = {0, 0};
  while ((kind = pbf_search_next(&search, folder, sizeof folder))) {
    if (kind == PBF_FOLDER_NOT_ABSOLUTE)
      pbf_entries_append_failure("", folder,
                                 "a folder in PBF_BACKEND_PATH that is not absolute is left out",
                                 PBF_ROOM_FAILED);
    if (kind == PBF_FOLDER_TOO_LONG)
      pbf_entries_append_failure(
          "", "", "a folder in PBF_BACKEND_PATH is longer than a path can be", PBF_ROOM_FAILED);
  }
}

pbf_status pbf_discover_path(const char *path) {
  pbf_plugin plugin;
  if (pbf_entries_of_path(path, 1)) return PBF_OK;
  if (!pbf_entries_have(PBF_ROOM_LOADED)) {
    return pbf_fail(PBF_ERROR_CAPACITY, "%s: the list of backends is full with %u entries", path,
                    pbf_entries_count());
  }
  pbf_status status = load(path, NULL, &plugin, PBF_ROOM_LOADED);
  return status == PBF_OK ? PBF_OK : pbf_fail(status, "%s: %s", path, plugin.reason);
}
