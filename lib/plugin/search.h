/* Folders of plugins: absolute ones only, never the working directory. */
#ifndef PBF_LIB_PLUGIN_SEARCH_H
#define PBF_LIB_PLUGIN_SEARCH_H

#include <stddef.h>
#include <stdint.h>

typedef enum pbf_folder {
  PBF_FOLDER_END,
  PBF_FOLDER_USABLE,
  PBF_FOLDER_NOT_ABSOLUTE, /* an entry of PBF_BACKEND_PATH that is not searched */
  PBF_FOLDER_TOO_LONG      /* likewise */
} pbf_folder;

/* Folder `index` of the search, in its order. */
pbf_folder pbf_search_folder(uint32_t index, char *folder, size_t size);

#endif
