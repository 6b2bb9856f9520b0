/* Plugins in files. */
#include "plugin_file.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "error.h"
#include "image.h"
#include "os.h"

/* With the registry's lock held. */
static int was_short;

int pbf_plugin_was_short(void) { return was_short; }

static pbf_status refuse_to_open(pbf_plugin *plugin, int error) {
  was_short |= pbf_os_is_shortage(error);
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
  was_short |= status == PBF_ERROR_OUT_OF_MEMORY;
  pbf_os_close(file);
  return status;
}

/* OpenMP's runtime ends the process where it gets no key of thread-specific data, and others may.
 */
static pbf_status check_keys(pbf_plugin *plugin) {
  if (!plugin->brings || pbf_os_has_thread_key()) return PBF_OK;
  was_short = 1;
  return pbf_plugin_refuse(plugin, PBF_ERROR_UNAVAILABLE,
                           "the process has no key of pthread_key_create left, which libraries "
                           "that it brings may want");
}

/* Once it has been looked at. */
static pbf_status load_file(const char *path, pbf_plugin *plugin, void **library) {
  pbf_status status = check_file(path, plugin);
  if (status == PBF_OK) status = check_keys(plugin);
  if (status != PBF_OK) return status;
  int error = 0;
  *library = pbf_os_load(path, plugin->reason, sizeof plugin->reason, &error);
  was_short |= pbf_os_is_shortage(error);
  return *library ? PBF_OK : PBF_ERROR_UNAVAILABLE;
}

/* ---- Parts ---------------------------------------------------------------------------------- */

/* The path of the plugin that negotiates; null: none does. With the registry's lock held. */
static const char *negotiating;

/* Whether there is such a file in the folder of `path`. */
static int is_beside(const char *path, const char *file, char found[PBF_OS_PATH_SIZE]) {
  const int folder = (int)(pbf_os_name_in(path) - path);
  int is_regular;
  return snprintf(found, PBF_OS_PATH_SIZE, "%.*s%s", folder, path, file) < PBF_OS_PATH_SIZE &&
         pbf_os_look(found, &is_regular) == 0;
}

static int find_part(const char *file, char found[PBF_OS_PATH_SIZE]) {
  char real[PBF_OS_PATH_SIZE];
  return is_beside(negotiating, file, found) ||
         (pbf_os_resolve(negotiating, real, sizeof real) && is_beside(real, file, found));
}

PBF_PRINTF(1, 2)
static const void *refuse_part(const char *format, ...) {
  char sentence[PBF_MESSAGE_SIZE];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(sentence, sizeof sentence, format, arguments);
  va_end(arguments);
  pbf_plugin_message_set(sentence);
  return NULL;
}

static const void *load_part(const char *file) {
  char path[PBF_OS_PATH_SIZE];
  pbf_plugin part = {0};
  void *library = NULL;
  if (!negotiating) return refuse_part("%s is a part, which only negotiating loads", file);
  if (!find_part(file, path)) return refuse_part("it needs %s, which is not beside it", file);
  if (load_file(path, &part, &library) != PBF_OK)
    return refuse_part("it needs %s beside it: %s", file, part.reason);
  pbf_backend_part_fn entry = (pbf_backend_part_fn)pbf_os_function_of(library, PBF_BACKEND_PART);
  if (!entry)
    return refuse_part("it needs %s beside it, which exports no function " PBF_BACKEND_PART, file);
  return entry();
}

const pbf_backend_host pbf_plugin_host = {
    .struct_size = sizeof(pbf_backend_host),
    .abi_min = PBF_BACKEND_ABI_VERSION,
    .abi_max = PBF_BACKEND_ABI_VERSION,
    .set_error = pbf_plugin_message_set,
    .load_part = load_part,
};

/* ---- Plugins -------------------------------------------------------------------------------- */

pbf_status pbf_plugin_load(const char *path, const char *expected, pbf_plugin *plugin) {
  void *library = NULL;
  was_short = 0;
  memset(plugin, 0, sizeof *plugin);
  snprintf(plugin->name, sizeof plugin->name, "%s", expected ? expected : "");
  snprintf(plugin->path, sizeof plugin->path, "%s", path);
  pbf_status status = load_file(path, plugin, &library);
  if (status != PBF_OK) return status;
  pbf_backend_negotiate_fn entry =
      (pbf_backend_negotiate_fn)pbf_os_function_of(library, PBF_BACKEND_ENTRY);
  if (!entry) {
    return pbf_plugin_refuse(plugin, PBF_ERROR_PLUGIN, "it exports no function " PBF_BACKEND_ENTRY);
  }
  negotiating = path;
  status = pbf_plugin_negotiate(&pbf_plugin_host, entry, expected, plugin);
  negotiating = NULL;
  return status;
}
