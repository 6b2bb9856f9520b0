/* Whether a file is a whole shared object, before the dynamic loader maps it. */
#ifndef PBF_LIB_PLUGIN_IMAGE_H
#define PBF_LIB_PLUGIN_IMAGE_H

#include <stdint.h>

#include "plugin.h"

/* Whether an open file of `size` bytes is a whole shared object for the machine of this process.
 * The dynamic loader takes a file's word for where its parts lie: one that is shorter, as after a
 * broken copy, ends the process with SIGBUS within dlopen, and one with bits turned over by some
 * other signal. So all that the loader reads before any code runs is looked at, mostly by what a
 * linker has stated twice. Code and data are not. Says nothing where shared objects are not ELF
 * files. Notes whether it brings in others. */
pbf_status pbf_image_check(int file, uint64_t size, pbf_plugin *plugin);

#endif
