/* The tables of a shared object that the dynamic loader reads before any code runs, as the checks
 * of them share them. */
#ifndef PBF_LIB_PLUGIN_IMAGE_TABLES_H
#define PBF_LIB_PLUGIN_IMAGE_TABLES_H

#include "image_file.h"

enum { PBF_MAX_DYNAMIC = 512 };

typedef struct pbf_image_tables {
  pbf_image *it;
  ElfW(Dyn) entries[PBF_MAX_DYNAMIC + 1];
  char *names;
  ElfW(Sym) * symbols;
  ElfW(Half) * versions; /* one for each symbol, or null */
  uint32_t *hashes;      /* DT_GNU_HASH, or null */
  unsigned char *needs;  /* DT_VERNEED, or null */
  uint64_t names_size, hashes_size, needs_size;
  uint32_t symbol_count;
} pbf_image_tables;

/* The first entry of the dynamic section with this tag, or null. */
const ElfW(Dyn) * pbf_image_entry_of(const pbf_image_tables *tables, ElfW(Sxword) tag);

/* The value of an entry of the dynamic section, or 0. */
uint64_t pbf_image_value_of(const pbf_image_tables *tables, ElfW(Sxword) tag);

/* The section that begins at an address, of a type unless that is 0. */
const ElfW(Shdr) * pbf_image_section_at(const pbf_image *image, uint64_t at, uint32_t type);

/* Null where there is no text that ends. */
const char *pbf_image_name_at(const pbf_image_tables *tables, uint64_t offset);

/* In this order, once the tables are read. */
pbf_status pbf_image_check_names(pbf_image_tables *tables);
pbf_status pbf_image_check_symbols(pbf_image_tables *tables);
pbf_status pbf_image_check_hash(pbf_image_tables *tables);
pbf_status pbf_image_check_versions(pbf_image_tables *tables);

/* Whether it needs libraries of others, or loads some itself. */
int pbf_image_brings_others(const pbf_image_tables *tables);

#endif
