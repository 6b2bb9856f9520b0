/* A shared object in a file, as the checks of it share it. */
#ifndef PBF_LIB_PLUGIN_IMAGE_FILE_H
#define PBF_LIB_PLUGIN_IMAGE_FILE_H

#include <link.h>

#include "plugin.h"

/* Headers beyond these numbers are garbage: a linker writes some ten segments, and 64 sections. */
enum { PBF_MAX_SEGMENTS = 64, PBF_MAX_SECTIONS = 4096 };

typedef struct pbf_image {
  int file;
  uint64_t size;
  pbf_plugin *plugin;
  ElfW(Ehdr) header;
  ElfW(Phdr) segments[PBF_MAX_SEGMENTS];
  ElfW(Shdr) * sections; /* null: stripped of them */
  uint32_t section_count;
} pbf_image;

pbf_status pbf_image_refuse(pbf_image *it, const char *what);
pbf_status pbf_image_refuse_short(pbf_image *it, const char *what);
/* Where the process has no memory for the look. */
pbf_status pbf_image_refuse_now(pbf_image *it);

int pbf_image_read(const pbf_image *it, void *bytes, size_t count, uint64_t offset);

static inline int pbf_image_fits(uint64_t offset, uint64_t bytes, uint64_t size) {
  return offset <= size && bytes <= size - offset;
}

/* Where the bytes at an address are in the file, if they all are. */
int pbf_image_find(const pbf_image *it, ElfW(Addr) from, uint64_t bytes, uint64_t *offset);

/* The dynamic section and the tables that it leads to: names, symbols, versions, relocations. */
pbf_status pbf_image_check_tables(pbf_image *it);

#endif
