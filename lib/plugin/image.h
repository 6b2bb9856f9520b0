#ifndef PBF_LIB_PLUGIN_IMAGE_H
#define PBF_LIB_PLUGIN_IMAGE_H

#include <stdint.h>

#include "plugin.h"

/* Whether an open file of `size` bytes is a whole shared object for the machine of this process.
 * The dynamic loader takes a file's word for where its parts lie: one that is shorter, as after a
 * broken copy, ends the process with SIGBUS within dlopen. What a part holds is not looked at, but
 * that it is there. Says nothing where shared objects are not ELF files. */
pbf_status pbf_image_check(int file, uint64_t size, pbf_plugin *plugin);

#endif
