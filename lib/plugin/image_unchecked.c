/* Of a format that is not looked into: what is damaged the dynamic loader finds, or not. */
#include "image.h"

pbf_status pbf_image_check(int file, uint64_t size, pbf_plugin *plugin) {
  (void)file;
  plugin->brings = 1; /* for all that is known */
  return size ? PBF_OK : pbf_plugin_refuse(plugin, PBF_ERROR_UNAVAILABLE, "it is empty");
}
