/* Every backend found and every candidate that failed, in the order of finding. The list only ever
 * grows, and an entry never changes, so that pointers to entries stay good. All but pbf_entries_at
 * are called with the registry's lock held. */
#ifndef PBF_LIB_PLUGIN_ENTRIES_H
#define PBF_LIB_PLUGIN_ENTRIES_H

#include "plugin.h"

enum { PBF_MAX_PLUGINS = 64 };

/* What an entry leaves free for others: a plugin that the caller loads for what the search finds,
 * and a failure also for the plugins that the caller may load later. */
typedef enum pbf_room { PBF_ROOM_SEARCH = 0, PBF_ROOM_LOADED = 8, PBF_ROOM_FAILED = 32 } pbf_room;

uint32_t pbf_entries_count(void);

/* `index` is below a count that the registry has given. */
const pbf_plugin *pbf_entries_at(uint32_t index);

/* Whether there is an entry of that name, usable or not. */
int pbf_entries_name(const char *name);

/* The entry of that name that can be used, or null. */
const pbf_plugin *pbf_entries_usable(const char *name);

/* An entry of that path, of those that can be used or of those that can't; or null. */
const pbf_plugin *pbf_entries_of_path(const char *path, int usable);

/* Whether the list has room for such an entry. One that has none drops it: the caller has its
 * message all the same. */
int pbf_entries_have(pbf_room room);
void pbf_entries_append(const pbf_plugin *plugin, pbf_room room);
void pbf_entries_append_failure(const char *name, const char *path, const char *reason,
                                pbf_room room);

#endif
