/* The names, symbols, their hashes and versions of a shared object. */
#define _GNU_SOURCE
#include <stdlib.h>
#include <string.h>

#include "image_tables.h"

typedef pbf_image image;
typedef ElfW(Shdr) section;
typedef ElfW(Dyn) dynamic;
typedef ElfW(Sym) symbol;
typedef pbf_image_tables tables;

enum { BLOOM_WORDS = __ELF_NATIVE_CLASS == 64 ? 2 : 1 };

/* ---- Names ---------------------------------------------------------------------------------- */

const char *pbf_image_name_at(const tables *t, uint64_t offset) {
  if (offset >= t->names_size) return NULL;
  return memchr(t->names + offset, 0, t->names_size - offset) ? t->names + offset : NULL;
}

pbf_status pbf_image_check_names(tables *t) {
  const ElfW(Sxword) tags[] = {DT_NEEDED,    DT_SONAME, DT_RPATH, DT_RUNPATH,
                               DT_AUXILIARY, DT_FILTER, DT_AUDIT, DT_DEPAUDIT};
  for (const dynamic *e = t->entries; e->d_tag != DT_NULL; ++e)
    for (size_t k = 0; k < sizeof tags / sizeof tags[0]; ++k)
      if (e->d_tag == tags[k] && !pbf_image_name_at(t, e->d_un.d_val))
        return pbf_image_refuse(t->it, "its dynamic section points to nothing");
  return PBF_OK;
}

static int is_needed(const tables *t, const char *file) {
  for (const dynamic *e = t->entries; e->d_tag != DT_NULL; ++e)
    if (e->d_tag == DT_NEEDED && strcmp(t->names + e->d_un.d_val, file) == 0) return 1;
  return 0;
}

/* Of the C library and the compiler. */
static int is_basic(const char *file) {
  static const char *const names[] = {"libc.",       "libm.",  "libdl.",    "ld-",
                                      "libpthread.", "librt.", "libgcc_s.", "ld64."};
  for (size_t k = 0; k < sizeof names / sizeof names[0]; ++k)
    if (strncmp(file, names[k], strlen(names[k])) == 0) return 1;
  return 0;
}

int pbf_image_brings_others(const tables *t) {
  for (const dynamic *e = t->entries; e->d_tag != DT_NULL; ++e)
    if (e->d_tag == DT_NEEDED && !is_basic(t->names + e->d_un.d_val)) return 1;
  for (uint32_t k = 0; k < t->symbol_count; ++k)
    if (strcmp(t->names + t->symbols[k].st_name, "dlopen") == 0) return 1;
  return 0;
}

/* ---- Symbols -------------------------------------------------------------------------------- */

/* In the section that it says, and of a kind that has an address as it stands. */
static int is_definition_sound(const tables *t, const symbol *s) {
  const unsigned type = s->st_info & 0xf;
  if (s->st_shndx >= t->it->section_count) return s->st_shndx == SHN_ABS && type <= STT_OBJECT;
  const section *in = &t->it->sections[s->st_shndx];
  if (type == STT_TLS) return (in->sh_flags & SHF_TLS) != 0;
  if (type == STT_SECTION) return s->st_info >> 4 == STB_LOCAL;
  if (type > STT_FUNC || (type == STT_FUNC && !(in->sh_flags & SHF_EXECINSTR))) return 0;
  if (type == STT_NOTYPE) return 1; /* gold's _edata and _end name any section */
  return s->st_value >= in->sh_addr && s->st_value - in->sh_addr <= in->sh_size;
}

static int is_symbol_sound(const tables *t, uint32_t k, uint32_t first_global) {
  const symbol *s = &t->symbols[k];
  const unsigned binding = s->st_info >> 4;
  const int is_local = k < first_global;
  if (!pbf_image_name_at(t, s->st_name) || is_local != (binding == STB_LOCAL)) return 0;
  if (!is_local && binding != STB_GLOBAL && binding != STB_WEAK && binding != STB_GNU_UNIQUE)
    return 0;
  if (s->st_shndx != SHN_UNDEF) return is_definition_sound(t, s);
  return (s->st_info & 0xf) <= STT_TLS && (is_local || s->st_other == STV_DEFAULT);
}

/* What the unwinder looks functions up in: sorted pairs of where one begins, and where its record
 * is, both counted from the table's head. */
typedef struct unwind_head {
  unsigned char version, pointer_kind, count_kind, pair_kind;
  int32_t pointer;
  uint32_t count;
} unwind_head;

typedef struct unwind_pair {
  int32_t begin, record;
} unwind_pair;

static int read_mapped(const image *it, uint64_t at, uint64_t bytes, void *into) {
  uint64_t offset;
  return pbf_image_find(it, at, bytes, &offset) && pbf_image_read(it, into, bytes, offset);
}

/* The last function that begins at an address or before it; 0: none is known to. */
static int find_function(const image *it, uint64_t head_at, uint64_t place, unwind_pair *found) {
  unwind_head head;
  const unwind_head usual = {1, 0x1b, 0x03, 0x3b, 0, 0};
  if (!read_mapped(it, head_at, sizeof head, &head) || memcmp(&head, &usual, 4) != 0) return 0;
  uint32_t low = 0, high = head.count;
  while (low < high) {
    const uint32_t middle = low + (high - low) / 2;
    if (!read_mapped(it, head_at + sizeof head + middle * sizeof *found, sizeof *found, found))
      return 0;
    if (head_at + (uint64_t)(int64_t)found->begin <= place)
      low = middle + 1;
    else
      high = middle;
  }
  return low > 0 &&
         read_mapped(it, head_at + sizeof head + (low - 1) * sizeof *found, sizeof *found, found);
}

/* Whether an address lies within a function, and not at its begin. */
static int is_amid_function(const image *it, uint64_t place) {
  const ElfW(Phdr) *s = it->segments, *end = s + it->header.e_phnum;
  struct {
    uint32_t length, common, begin, range;
  } record;
  unwind_pair pair;
  while (s < end && s->p_type != PT_GNU_EH_FRAME) ++s;
  if (s == end || !find_function(it, s->p_vaddr, place, &pair)) return 0;
  const uint64_t begin = s->p_vaddr + (uint64_t)(int64_t)pair.begin;
  return read_mapped(it, s->p_vaddr + (uint64_t)(int64_t)pair.record, sizeof record, &record) &&
         place != begin && place - begin < record.range;
}

/* The function that is called first, of a plugin or a part. */
static int is_entry_sound(const tables *t, uint32_t k) {
  const symbol *s = &t->symbols[k];
  const char *name = t->names + s->st_name;
  if (strcmp(name, PBF_BACKEND_ENTRY) != 0 && strcmp(name, PBF_BACKEND_PART) != 0) return 1;
  return s->st_shndx == SHN_UNDEF || !is_amid_function(t->it, s->st_value);
}

pbf_status pbf_image_check_symbols(tables *t) {
  const section *s = pbf_image_section_at(t->it, pbf_image_value_of(t, DT_SYMTAB), SHT_DYNSYM);
  for (uint32_t k = 0; k < t->symbol_count; ++k)
    if (!is_symbol_sound(t, k, s->sh_info) || !is_entry_sound(t, k))
      return pbf_image_refuse(t->it, "a symbol of it is garbage");
  return PBF_OK;
}

/* ---- The hash table ------------------------------------------------------------------------- */

static uint32_t hash_of(const char *name) {
  uint32_t hash = 5381;
  for (; *name; ++name) hash = hash * 33 + (unsigned char)*name;
  return hash;
}

/* Each symbol from the first one on is in the chain of its bucket, which begins with its first one
 * and ends with an odd number; the filter lets it pass. */
static int is_hash_sound(const tables *t) {
  const uint32_t *head = t->hashes, buckets = head[0], first = head[1], words = head[2];
  const uint64_t filter = (uint64_t)words * BLOOM_WORDS, chains = t->symbol_count - first;
  if (buckets == 0 || words == 0 || words & (words - 1) || first > t->symbol_count || head[3] > 31)
    return 0;
  if ((4 + filter + buckets + chains) * 4 != t->hashes_size) return 0;
  const uint32_t *bucket = head + 4 + filter, *chain = bucket + buckets;
  for (uint32_t b = 0; b < buckets; ++b)
    if (bucket[b] && (bucket[b] < first || bucket[b] >= t->symbol_count)) return 0;
  for (uint32_t k = 0; k < chains; ++k) {
    const uint32_t hash = hash_of(t->names + t->symbols[first + k].st_name);
    const int is_last =
        k + 1 == chains ||
        hash_of(t->names + t->symbols[first + k + 1].st_name) % buckets != hash % buckets;
    if ((chain[k] | 1) != (hash | 1) || (chain[k] & 1) != (uint32_t)is_last) return 0;
    if (bucket[hash % buckets] == 0 || bucket[hash % buckets] > first + k) return 0;
  }
  return 1;
}

pbf_status pbf_image_check_hash(tables *t) {
  if (t->hashes_size == 0 || t->symbol_count == 0) return PBF_OK;
  if (t->hashes_size >= 16 && is_hash_sound(t)) return PBF_OK;
  return pbf_image_refuse(t->it, "its table of symbols' hashes is garbage");
}

/* ---- Versions ------------------------------------------------------------------------------- */

enum { MOST_VERSIONS = 0x8000 };

/* Notes which versions there are in `there`. */
static int read_needs(const tables *t, unsigned char *there) {
  uint64_t at = 0, count = pbf_image_value_of(t, DT_VERNEEDNUM);
  for (; count > 0; --count) {
    ElfW(Verneed) need;
    if (!pbf_image_fits(at, sizeof need, t->needs_size)) return 0;
    memcpy(&need, t->needs + at, sizeof need);
    const char *file = pbf_image_name_at(t, need.vn_file);
    if (need.vn_version != 1 || !file || !is_needed(t, file)) return 0;
    uint64_t inner = at + need.vn_aux;
    for (unsigned k = 0; k < need.vn_cnt; ++k) {
      ElfW(Vernaux) one;
      if (!pbf_image_fits(inner, sizeof one, t->needs_size)) return 0;
      memcpy(&one, t->needs + inner, sizeof one);
      if (!pbf_image_name_at(t, one.vna_name) || there[one.vna_other & 0x7fff]) return 0;
      there[one.vna_other & 0x7fff] = 1;
      if (!one.vna_next != (k + 1 == need.vn_cnt)) return 0;
      inner += one.vna_next;
    }
    if (need.vn_cnt == 0 || !need.vn_next != (count == 1)) return 0;
    at += need.vn_next;
  }
  return 1;
}

/* What it defines itself is counted up from 1; 0 and 1 are what has no version. */
static int are_versions_sound(const tables *t, unsigned char *there) {
  const uint64_t defined = pbf_image_value_of(t, DT_VERDEFNUM);
  if (defined >= MOST_VERSIONS || !read_needs(t, there)) return 0;
  for (uint64_t k = 0; k <= defined; ++k) there[k] = 1;
  there[1] = 1;
  for (uint32_t k = 0; k < t->symbol_count && t->versions; ++k)
    if (!there[t->versions[k] & 0x7fff]) return 0;
  return 1;
}

pbf_status pbf_image_check_versions(tables *t) {
  if (!t->needs && !t->versions) return PBF_OK;
  unsigned char *there = calloc(MOST_VERSIONS, 1);
  if (!there) return pbf_image_refuse_now(t->it);
  const int is_sound = are_versions_sound(t, there);
  free(there);
  return is_sound ? PBF_OK : pbf_image_refuse(t->it, "its versions of symbols are garbage");
}
