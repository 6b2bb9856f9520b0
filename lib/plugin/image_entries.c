/* Where the dynamic section of a shared object, and its table of sections, say that something is.
 */
#define _GNU_SOURCE
#include "image_tables.h"

typedef ElfW(Shdr) section;
typedef ElfW(Dyn) dynamic;

const dynamic *pbf_image_entry_of(const pbf_image_tables *t, ElfW(Sxword) tag) {
  const dynamic *e = t->entries;
  while (e->d_tag != DT_NULL && e->d_tag != tag) ++e;
  return e->d_tag == tag && tag != DT_NULL ? e : NULL;
}

uint64_t pbf_image_value_of(const pbf_image_tables *t, ElfW(Sxword) tag) {
  const dynamic *e = pbf_image_entry_of(t, tag);
  return e ? e->d_un.d_val : 0;
}

const section *pbf_image_section_at(const pbf_image *it, uint64_t at, uint32_t type) {
  for (uint32_t k = 0; k < it->section_count; ++k) {
    const section *s = &it->sections[k];
    if (s->sh_flags & SHF_ALLOC && s->sh_addr == at && (!type || s->sh_type == type)) return s;
  }
  return NULL;
}
