/* Plugins that are loaded from files. */
#ifndef PBF_LIB_PLUGIN_PLUGIN_FILE_H
#define PBF_LIB_PLUGIN_PLUGIN_FILE_H

#include "plugin.h"

/* Loads the file for the life of the process. `expected` is the name that it must give, null for
 * any. On failure plugin->reason says why. Leaves pbf_last_error alone. */
pbf_status pbf_plugin_load(const char *path, const char *expected, pbf_plugin *plugin);

/* Whether the last one that was loaded wanted descriptors or memory, which another time there may
 * be. */
int pbf_plugin_was_short(void);

#endif
