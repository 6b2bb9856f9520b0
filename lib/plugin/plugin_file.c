/* Plugins in files. */
#include "plugin_file.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "image.h"

static pbf_status refuse_to_open(pbf_plugin *plugin) {
  return pbf_plugin_refuse(plugin, errno == ENOENT ? PBF_ERROR_NOT_FOUND : PBF_ERROR_UNAVAILABLE,
                           "can't open it: %s", strerror(errno));
}

static pbf_status check_open_file(int descriptor, pbf_plugin *plugin) {
  struct stat file;
  if (fstat(descriptor, &file) != 0) return refuse_to_open(plugin);
  return pbf_image_check(descriptor, (uint64_t)file.st_size, plugin);
}

/* Opening a pipe or a device could wait for ever, or do something. */
static pbf_status check_file(const char *path, pbf_plugin *plugin) {
  struct stat file;
  if (stat(path, &file) != 0) return refuse_to_open(plugin);
  if (!S_ISREG(file.st_mode))
    return pbf_plugin_refuse(plugin, PBF_ERROR_UNAVAILABLE, "it is not a regular file");
  int descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return refuse_to_open(plugin);
  pbf_status status = check_open_file(descriptor, plugin);
  close(descriptor);
  return status;
}

pbf_status pbf_plugin_load(const char *path, const char *expected, pbf_plugin *plugin) {
  memset(plugin, 0, sizeof *plugin);
  snprintf(plugin->name, sizeof plugin->name, "%s", expected ? expected : "");
  snprintf(plugin->path, sizeof plugin->path, "%s", path);
  pbf_status status = check_file(path, plugin);
  if (status != PBF_OK) return status;
  /* Threads of a backend's runtime outlive dlclose. */
  void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (!library) return pbf_plugin_refuse(plugin, PBF_ERROR_UNAVAILABLE, "%s", dlerror());
  pbf_backend_negotiate_fn entry;
  *(void **)&entry = dlsym(library, PBF_BACKEND_ENTRY);
  if (!entry) {
    return pbf_plugin_refuse(plugin, PBF_ERROR_PLUGIN, "it exports no function " PBF_BACKEND_ENTRY);
  }
  return pbf_plugin_negotiate(entry, expected, plugin);
}
