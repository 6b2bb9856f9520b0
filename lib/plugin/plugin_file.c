/* Plugins in files. */
#include "plugin_file.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "image.h"
#include "os.h"

static pbf_status refuse_to_open(pbf_plugin *plugin, int error) {
  return pbf_plugin_refuse(plugin, error == ENOENT ? PBF_ERROR_NOT_FOUND : PBF_ERROR_UNAVAILABLE,
                           "can't open it: %s", strerror(error));
}

/* Opening a pipe or a device could wait for ever, or do something. */
static pbf_status check_file(const char *path, pbf_plugin *plugin) {
  int is_regular, file;
  uint64_t size;
  int failed = pbf_os_look(path, &is_regular);
  if (failed) return refuse_to_open(plugin, failed);
  if (!is_regular)
    return pbf_plugin_refuse(plugin, PBF_ERROR_UNAVAILABLE, "it is not a regular file");
  failed = pbf_os_open(path, &file, &size);
  if (failed) return refuse_to_open(plugin, failed);
  pbf_status status = pbf_image_check(file, size, plugin);
  pbf_os_close(file);
  return status;
}

pbf_status pbf_plugin_load(const char *path, const char *expected, pbf_plugin *plugin) {
  memset(plugin, 0, sizeof *plugin);
  snprintf(plugin->name, sizeof plugin->name, "%s", expected ? expected : "");
  snprintf(plugin->path, sizeof plugin->path, "%s", path);
  pbf_status status = check_file(path, plugin);
  if (status != PBF_OK) return status;
  void *library = pbf_os_load(path, plugin->reason, sizeof plugin->reason);
  if (!library) return PBF_ERROR_UNAVAILABLE;
  pbf_backend_negotiate_fn entry =
      (pbf_backend_negotiate_fn)pbf_os_function_of(library, PBF_BACKEND_ENTRY);
  if (!entry) {
    return pbf_plugin_refuse(plugin, PBF_ERROR_PLUGIN, "it exports no function " PBF_BACKEND_ENTRY);
  }
  return pbf_plugin_negotiate(entry, expected, plugin);
}
