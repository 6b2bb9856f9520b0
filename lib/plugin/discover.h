/* Where backends come from: files (discover_files.c) or, in a static library, its own objects
 * (discover_linked.c); a build has one of the two. All is called with the registry's lock held. */
#ifndef PBF_LIB_PLUGIN_DISCOVER_H
#define PBF_LIB_PLUGIN_DISCOVER_H

#include <pbf/pbf.h>

/* Looks for a known backend and adds what it finds, or why there is none, to the entries. 0: it
 * could not be looked at for want of descriptors or memory, and is worth another look. */
int pbf_discover_name(const char *name);

/* After all known names. */
void pbf_discover_end(void);

/* What pbf_load_backend does with an absolute path. */
pbf_status pbf_discover_path(const char *path);

#endif
