/* What all checks of a shared object need: refusals, and bytes by their place or their address. */
#include "image_file.h"

#include "os.h"

pbf_status pbf_image_refuse(pbf_image *it, const char *what) {
  return pbf_plugin_refuse(it->plugin, PBF_ERROR_UNAVAILABLE, "it is damaged: %s", what);
}

pbf_status pbf_image_refuse_short(pbf_image *it, const char *what) {
  return pbf_plugin_refuse(it->plugin, PBF_ERROR_UNAVAILABLE,
                           "it is cut short: its %s lie beyond its end, at %llu bytes", what,
                           (unsigned long long)it->size);
}

pbf_status pbf_image_refuse_now(pbf_image *it) {
  return pbf_plugin_refuse(it->plugin, PBF_ERROR_OUT_OF_MEMORY,
                           "there is no memory to look at it by");
}

int pbf_image_read(const pbf_image *it, void *bytes, size_t count, uint64_t offset) {
  return pbf_os_read(it->file, bytes, count, offset);
}

int pbf_image_find(const pbf_image *it, ElfW(Addr) from, uint64_t bytes, uint64_t *offset) {
  for (unsigned i = 0; i < it->header.e_phnum; ++i) {
    const ElfW(Phdr) *s = &it->segments[i];
    if (s->p_type != PT_LOAD || from < s->p_vaddr) continue;
    if (!pbf_image_fits(from - s->p_vaddr, bytes, s->p_filesz)) continue;
    *offset = s->p_offset + (from - s->p_vaddr);
    return 1;
  }
  return 0;
}
