/* Every backend found and every candidate that failed, in the order of finding; only ever grows,
 * and an entry never changes, so that pointers to entries stay good. */
#ifndef PBF_LIB_REGISTRY_H
#define PBF_LIB_REGISTRY_H

#include "plugin.h"

/* Looks for the known plugins the first time. */
uint32_t pbf_registry_count(void);

/* Null from pbf_registry_count() on. */
const pbf_plugin *pbf_registry_entry(uint32_t index);

#endif
