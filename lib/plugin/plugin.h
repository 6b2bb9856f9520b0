/* One backend: asking it, and checking every field of its answer. */
#ifndef PBF_LIB_PLUGIN_PLUGIN_H
#define PBF_LIB_PLUGIN_PLUGIN_H

#include <stddef.h>

#include <pbf/pbf_backend.h>

#include "compiler.h"

/* A backend, or a candidate for one that can't be used. */
typedef struct pbf_plugin {
  char name[PBF_NAME_SIZE];
  char build_id[96];
  char path[256];   /* cut when longer */
  char reason[256]; /* why it is not usable; empty: usable */
  int brings;       /* code of others: libraries beside the C library's own */
  pbf_backend_api api;
} pbf_plugin;

/* What backends get of this library: from files in plugin_file.c, linked ones in discover_linked.c,
 * which have no parts. */
extern const pbf_backend_host pbf_plugin_host;

/* Asks a backend by its entry function; plugin->path is the caller's. `expected` is the name that
 * it must give, null for any. */
pbf_status pbf_plugin_negotiate(const pbf_backend_host *host, pbf_backend_negotiate_fn entry,
                                const char *expected, pbf_plugin *plugin);

/* Writes why the plugin can't be used, and gives `status` back. */
PBF_PRINTF(3, 4)
pbf_status pbf_plugin_refuse(pbf_plugin *plugin, pbf_status status, const char *format, ...);

/* A table that a plugin gave, made complete: a plugin built against an older header has a shorter
 * one. Fails with the reason when a mandatory function is missing. */
pbf_status pbf_plugin_copy_table(const pbf_backend_api *theirs, pbf_backend_api *ours, char *reason,
                                 size_t size);

#endif
