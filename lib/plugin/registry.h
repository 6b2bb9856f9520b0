/* Every backend found and every candidate that failed, in the order of finding; only ever grows,
 * and an entry never changes, so that pointers to entries stay good. */
#ifndef PBF_LIB_REGISTRY_H
#define PBF_LIB_REGISTRY_H

#include "plugin.h"

enum { PBF_MOST_PLUGINS = 64 };

/* Looks for the known plugins the first time. */
uint32_t pbf_registry_count(void);

/* Null from pbf_registry_count() on. */
const pbf_plugin *pbf_registry_entry(uint32_t index);

/* For discover.h, called with the lock held. */

/* The entry of that name that can be used, or null. */
const pbf_plugin *pbf_registry_usable(const char *name);

/* An entry of that path, of those that can be used or of those that can't; or null. */
const pbf_plugin *pbf_registry_of_path(const char *path, int usable);

/* A full list drops the entry: the caller has its sentence all the same. */
int pbf_registry_is_full(void);
void pbf_registry_append(const pbf_plugin *plugin);
void pbf_registry_append_failure(const char *name, const char *path, const char *reason);

#endif
