/* The list of backends, for any thread. The first call searches for them. */
#ifndef PBF_LIB_PLUGIN_REGISTRY_H
#define PBF_LIB_PLUGIN_REGISTRY_H

#include "plugin.h"

uint32_t pbf_registry_count(void);

/* Null from pbf_registry_count() on. */
const pbf_plugin *pbf_registry_entry(uint32_t index);

#endif
