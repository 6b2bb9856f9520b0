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

/* How far a search has come; all 0 before it begins. */
typedef struct pbf_search {
  size_t passed; /* bytes of the list of PBF_BACKEND_PATH: plugins may change it meanwhile */
  uint32_t own;  /* of the library's own folders */
} pbf_search;

/* The next folder, in the order of the search. */
pbf_folder pbf_search_next(pbf_search *search, char *folder, size_t size);

#endif
