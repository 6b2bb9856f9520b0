/* The dynamic section of a shared object, and what the dynamic loader reads by it before any code
 * runs. It takes all of this on trust; what a linker has stated twice has to agree. */
#define _GNU_SOURCE
#include "image_file.h"

#include <stdlib.h>
#include <string.h>

enum { MAX_DYNAMIC = 512, MAX_BYTES = 1 << 24 };

typedef pbf_image image;
typedef ElfW(Shdr) section;
typedef ElfW(Dyn) dynamic;
typedef ElfW(Sym) symbol;
typedef ElfW(Addr) address;

#if __ELF_NATIVE_CLASS == 64
enum { BLOOM_WORDS = 2 };
static unsigned symbol_of(uint64_t info) { return (unsigned)ELF64_R_SYM(info); }
#else
enum { BLOOM_WORDS = 1 };
static unsigned symbol_of(uint64_t info) { return (unsigned)ELF32_R_SYM(info); }
#endif

enum { RELR = 36, RELR_SIZE = 35, SECTION_RELR = 19 }; /* younger than some <elf.h> */

typedef struct tables {
  image *it;
  dynamic entries[MAX_DYNAMIC + 1];
  char *names;
  symbol *symbols;
  ElfW(Half) * versions; /* one for each symbol, or null */
  uint32_t *hashes;      /* DT_GNU_HASH, or null */
  unsigned char *needs;  /* DT_VERNEED, or null */
  uint64_t names_size, hashes_size, needs_size;
  uint32_t symbol_count;
} tables;

/* ---- Entries --------------------------------------------------------------------------------- */

static const dynamic *find_entry(const tables *t, ElfW(Sxword) tag) {
  const dynamic *e = t->entries;
  while (e->d_tag != DT_NULL && e->d_tag != tag) ++e;
  return e->d_tag == tag && tag != DT_NULL ? e : NULL;
}

static uint64_t value_of(const tables *t, ElfW(Sxword) tag) {
  const dynamic *e = find_entry(t, tag);
  return e ? e->d_un.d_val : 0;
}

static pbf_status read_entries(tables *t) {
  image *it = t->it;
  const ElfW(Phdr) *s = it->segments, *end = s + it->header.e_phnum;
  uint64_t offset;
  while (s < end && s->p_type != PT_DYNAMIC) ++s;
  if (s == end) return pbf_image_refuse(it, "it has no dynamic section");
  const size_t count = s->p_filesz / sizeof(dynamic);
  if (count > MAX_DYNAMIC || !pbf_image_find(it, s->p_vaddr, s->p_filesz, &offset) ||
      !pbf_image_read(it, t->entries, count * sizeof(dynamic), offset))
    return pbf_image_refuse(it, "its dynamic section is not in a segment that is loaded");
  t->entries[count].d_tag = DT_NULL;
  if (!find_entry(t, DT_STRTAB) || count == 0 || t->entries[count - 1].d_tag != DT_NULL)
    return pbf_image_refuse(it, "its dynamic section has no end, or nothing in it");
  size_t k = 0;
  while (t->entries[k].d_tag != DT_NULL) ++k;
  for (; k < count; ++k)
    if (t->entries[k].d_tag != DT_NULL)
      return pbf_image_refuse(it, "its dynamic section has an end in its middle");
  return PBF_OK;
}

/* A table that the loader reads: its address, the entry that has its size, if there is one, and the
 * section that it is. */
typedef struct table {
  ElfW(Sxword) at, bytes;
  uint32_t section; /* 0: any */
  int needed;
} table;

static const table known[] = {
    {DT_STRTAB, DT_STRSZ, SHT_STRTAB, 1},
    {DT_SYMTAB, 0, SHT_DYNSYM, 1},
    {DT_HASH, 0, SHT_HASH, 0},
    {DT_GNU_HASH, 0, SHT_GNU_HASH, 0},
    {DT_VERSYM, 0, SHT_GNU_versym, 0},
    {DT_VERNEED, 0, SHT_GNU_verneed, 0},
    {DT_VERDEF, 0, SHT_GNU_verdef, 0},
    {DT_INIT_ARRAY, DT_INIT_ARRAYSZ, SHT_INIT_ARRAY, 0},
    {DT_FINI_ARRAY, DT_FINI_ARRAYSZ, SHT_FINI_ARRAY, 0},
    {RELR, RELR_SIZE, SECTION_RELR, 0},
    {DT_RELA, DT_RELASZ, 0, 0},
    {DT_REL, DT_RELSZ, 0, 0},
    {DT_JMPREL, DT_PLTRELSZ, 0, 0},
};
enum { KNOWN = sizeof known / sizeof known[0] };

static int is_unique(const tables *t, ElfW(Sxword) tag) {
  const dynamic *first = find_entry(t, tag), *other = first;
  if (!first) return 1;
  do ++other;
  while (other->d_tag != DT_NULL && other->d_tag != tag);
  return other->d_tag == DT_NULL;
}

/* The section that begins at an address, of a type unless that is 0. */
static const section *section_at(const image *it, uint64_t at, uint32_t type) {
  for (uint32_t k = 0; k < it->section_count; ++k) {
    const section *s = &it->sections[k];
    if (s->sh_flags & SHF_ALLOC && s->sh_addr == at && (!type || s->sh_type == type)) return s;
  }
  return NULL;
}

static int has_section(const image *it, uint32_t type) {
  for (uint32_t k = 0; k < it->section_count; ++k)
    if (it->sections[k].sh_flags & SHF_ALLOC && it->sections[k].sh_type == type) return 1;
  return 0;
}

/* Whether an entry and the section table agree on where a table is. */
static int agrees(const tables *t, const table *kind) {
  const dynamic *at = find_entry(t, kind->at), *bytes = find_entry(t, kind->bytes);
  if (t->it->section_count == 0 || !kind->section) return 1;
  if (!at) return kind->section == SHT_STRTAB || !has_section(t->it, kind->section);
  const section *s = section_at(t->it, at->d_un.d_ptr, kind->section);
  return s && (!bytes || bytes->d_un.d_val == s->sh_size);
}

static pbf_status check_known(tables *t) {
  uint64_t unused;
  for (int k = 0; k < KNOWN; ++k) {
    const table *kind = &known[k];
    const dynamic *at = find_entry(t, kind->at), *bytes = find_entry(t, kind->bytes);
    if ((!at && kind->needed) || (kind->bytes && !at != !bytes))
      return pbf_image_refuse(t->it, "its dynamic section lacks a table");
    if (at && !pbf_image_find(t->it, at->d_un.d_ptr, bytes ? bytes->d_un.d_val : 1, &unused))
      return pbf_image_refuse(t->it, "its dynamic section points to nothing");
    if (!is_unique(t, kind->at) || !is_unique(t, kind->bytes) || !agrees(t, kind))
      return pbf_image_refuse(t->it, "its dynamic section and its sections contradict each other");
  }
  return PBF_OK;
}

/* Sizes of entries, as there are no others. */
static pbf_status check_entry_sizes(tables *t) {
  const struct {
    ElfW(Sxword) of, tag;
    uint64_t size;
  } sizes[] = {{DT_SYMTAB, DT_SYMENT, sizeof(symbol)},
               {DT_RELA, DT_RELAENT, sizeof(ElfW(Rela))},
               {DT_REL, DT_RELENT, sizeof(ElfW(Rel))}};
  for (int k = 0; k < 3; ++k)
    if (find_entry(t, sizes[k].of) && value_of(t, sizes[k].tag) != sizes[k].size)
      return pbf_image_refuse(t->it, "a table of its dynamic section has entries of another size");
  const uint64_t kind = value_of(t, DT_PLTREL);
  if (find_entry(t, DT_JMPREL) && kind != DT_RELA && kind != DT_REL)
    return pbf_image_refuse(t->it, "its dynamic section says nothing of the kind of a table");
  return PBF_OK;
}

/* What is called, and what the loader writes into: the begin of a section that has that right. */
static pbf_status check_places(tables *t) {
  const ElfW(Sxword) tags[] = {DT_INIT, DT_FINI, DT_PLTGOT};
  for (int k = 0; k < 3; ++k) {
    const dynamic *e = find_entry(t, tags[k]);
    if (!e || t->it->section_count == 0) continue;
    const section *s = section_at(t->it, e->d_un.d_ptr, SHT_PROGBITS);
    const int is_code = s && s->sh_flags & SHF_EXECINSTR && s->sh_entsize == 0;
    if (!s || !(tags[k] == DT_PLTGOT ? (s->sh_flags & SHF_WRITE) != 0 : is_code))
      return pbf_image_refuse(t->it, "its dynamic section points to nothing");
  }
  return PBF_OK;
}

/* ---- Reading the tables ------------------------------------------------------------------------
 */

/* Null for what is not there: no entry, or no section that tells its size. */
static pbf_status read_table(tables *t, uint64_t at, uint64_t bytes, void *into) {
  uint64_t offset;
  void *memory = NULL;
  if (bytes == 0) return PBF_OK;
  if (bytes > MAX_BYTES || !pbf_image_find(t->it, at, bytes, &offset))
    return pbf_image_refuse(t->it, "its dynamic section points to nothing");
  memory = malloc(bytes);
  memcpy(into, &memory, sizeof memory);
  if (!memory) return pbf_image_refuse_now(t->it);
  if (!pbf_image_read(t->it, memory, bytes, offset))
    return pbf_image_refuse(t->it, "it can't be read");
  return PBF_OK;
}

static uint64_t size_of(const tables *t, ElfW(Sxword) tag, uint32_t type) {
  const dynamic *e = find_entry(t, tag);
  const section *s = e ? section_at(t->it, e->d_un.d_ptr, type) : NULL;
  return s ? s->sh_size : 0;
}

static pbf_status read_tables(tables *t) {
  const uint64_t symbols = size_of(t, DT_SYMTAB, SHT_DYNSYM);
  const uint64_t versions = size_of(t, DT_VERSYM, SHT_GNU_versym);
  t->names_size = value_of(t, DT_STRSZ);
  t->hashes_size = size_of(t, DT_GNU_HASH, SHT_GNU_HASH);
  t->needs_size = size_of(t, DT_VERNEED, SHT_GNU_verneed);
  t->symbol_count = (uint32_t)(symbols / sizeof(symbol));
  if (versions && versions != t->symbol_count * sizeof *t->versions)
    return pbf_image_refuse(t->it, "its symbols and their versions are not as many");
  pbf_status status = read_table(t, value_of(t, DT_STRTAB), t->names_size, &t->names);
  if (status == PBF_OK) status = read_table(t, value_of(t, DT_SYMTAB), symbols, &t->symbols);
  if (status == PBF_OK) status = read_table(t, value_of(t, DT_VERSYM), versions, &t->versions);
  if (status == PBF_OK)
    status = read_table(t, value_of(t, DT_GNU_HASH), t->hashes_size, &t->hashes);
  if (status == PBF_OK) status = read_table(t, value_of(t, DT_VERNEED), t->needs_size, &t->needs);
  return status;
}

/* ---- Names -------------------------------------------------------------------------------------
 */

/* Null where there is no text that ends. */
static const char *name_at(const tables *t, uint64_t offset) {
  if (offset >= t->names_size) return NULL;
  return memchr(t->names + offset, 0, t->names_size - offset) ? t->names + offset : NULL;
}

static pbf_status check_names(tables *t) {
  const ElfW(Sxword) tags[] = {DT_NEEDED,    DT_SONAME, DT_RPATH, DT_RUNPATH,
                               DT_AUXILIARY, DT_FILTER, DT_AUDIT, DT_DEPAUDIT};
  for (const dynamic *e = t->entries; e->d_tag != DT_NULL; ++e)
    for (size_t k = 0; k < sizeof tags / sizeof tags[0]; ++k)
      if (e->d_tag == tags[k] && !name_at(t, e->d_un.d_val))
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

/* It needs libraries of others, or loads some itself. */
static int brings_others(const tables *t) {
  for (const dynamic *e = t->entries; e->d_tag != DT_NULL; ++e)
    if (e->d_tag == DT_NEEDED && !is_basic(t->names + e->d_un.d_val)) return 1;
  for (uint32_t k = 0; k < t->symbol_count; ++k)
    if (strcmp(t->names + t->symbols[k].st_name, "dlopen") == 0) return 1;
  return 0;
}

/* ---- Symbols -----------------------------------------------------------------------------------
 */

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
  if (!name_at(t, s->st_name) || is_local != (binding == STB_LOCAL)) return 0;
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

static pbf_status check_symbols(tables *t) {
  const section *s = section_at(t->it, value_of(t, DT_SYMTAB), SHT_DYNSYM);
  for (uint32_t k = 0; k < t->symbol_count; ++k)
    if (!is_symbol_sound(t, k, s->sh_info) || !is_entry_sound(t, k))
      return pbf_image_refuse(t->it, "a symbol of it is garbage");
  return PBF_OK;
}

/* ---- The hash table
 * ------------------------------------------------------------------------------ */

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

static pbf_status check_hash(tables *t) {
  if (t->hashes_size == 0 || t->symbol_count == 0) return PBF_OK;
  if (t->hashes_size >= 16 && is_hash_sound(t)) return PBF_OK;
  return pbf_image_refuse(t->it, "its table of symbols' hashes is garbage");
}

/* ---- Versions -----------------------------------------------------------------------------------
 */

enum { MOST_VERSIONS = 0x8000 };

/* Notes which versions there are in `there`. */
static int read_needs(const tables *t, unsigned char *there) {
  uint64_t at = 0, count = value_of(t, DT_VERNEEDNUM);
  for (; count > 0; --count) {
    ElfW(Verneed) need;
    if (!pbf_image_fits(at, sizeof need, t->needs_size)) return 0;
    memcpy(&need, t->needs + at, sizeof need);
    const char *file = name_at(t, need.vn_file);
    if (need.vn_version != 1 || !file || !is_needed(t, file)) return 0;
    uint64_t inner = at + need.vn_aux;
    for (unsigned k = 0; k < need.vn_cnt; ++k) {
      ElfW(Vernaux) one;
      if (!pbf_image_fits(inner, sizeof one, t->needs_size)) return 0;
      memcpy(&one, t->needs + inner, sizeof one);
      if (!name_at(t, one.vna_name) || there[one.vna_other & 0x7fff]) return 0;
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
  const uint64_t defined = value_of(t, DT_VERDEFNUM);
  if (defined >= MOST_VERSIONS || !read_needs(t, there)) return 0;
  for (uint64_t k = 0; k <= defined; ++k) there[k] = 1;
  there[1] = 1;
  for (uint32_t k = 0; k < t->symbol_count && t->versions; ++k)
    if (!there[t->versions[k] & 0x7fff]) return 0;
  return 1;
}

static pbf_status check_versions(tables *t) {
  if (!t->needs && !t->versions) return PBF_OK;
  unsigned char *there = calloc(MOST_VERSIONS, 1);
  if (!there) return pbf_image_refuse_now(t->it);
  const int is_sound = are_versions_sound(t, there);
  free(there);
  return is_sound ? PBF_OK : pbf_image_refuse(t->it, "its versions of symbols are garbage");
}

/* ---- Relocations
 * --------------------------------------------------------------------------------- */

/* What is relocated is a place that can be written to; the first `relative` ones have no symbol. */
static int is_relocation_sound(const tables *t, const ElfW(Rela) * r, int is_relative) {
  if (symbol_of(r->r_info) >= t->symbol_count || (is_relative && symbol_of(r->r_info))) return 0;
  for (unsigned i = 0; i < t->it->header.e_phnum; ++i) {
    const ElfW(Phdr) *s = &t->it->segments[i];
    if (s->p_type != PT_LOAD || !(s->p_flags & PF_W) || r->r_offset < s->p_vaddr) continue;
    if (pbf_image_fits(r->r_offset - s->p_vaddr, sizeof(address), s->p_memsz)) return 1;
  }
  return find_entry(t, DT_TEXTREL) != NULL;
}

static pbf_status check_relocations(tables *t, ElfW(Sxword) at, ElfW(Sxword) bytes) {
  ElfW(Rela) *all = NULL;
  const uint64_t count = value_of(t, bytes) / sizeof *all;
  const uint64_t relative = at == DT_RELA ? value_of(t, DT_RELACOUNT) : 0;
  const section *s = section_at(t->it, value_of(t, at), SHT_RELA);
  if (t->symbol_count == 0 || count == 0) return PBF_OK;
  if (!s || s->sh_size > value_of(t, bytes) || relative > count)
    return pbf_image_refuse(t->it, "its relocations are garbage");
  pbf_status status = read_table(t, value_of(t, at), count * sizeof *all, &all);
  for (uint64_t k = 0; k < count && status == PBF_OK; ++k)
    if (!is_relocation_sound(t, &all[k], k < relative) ||
        (k < relative && all[k].r_info != all[0].r_info))
      status = pbf_image_refuse(t->it, "its relocations are garbage");
  free(all);
  return status;
}

/* Each table of them in the file is one that the loader is told of. */
static pbf_status check_all_relocations(tables *t) {
  pbf_status status = check_relocations(t, DT_RELA, DT_RELASZ);
  if (status == PBF_OK && value_of(t, DT_PLTREL) == DT_RELA)
    status = check_relocations(t, DT_JMPREL, DT_PLTRELSZ);
  for (uint32_t k = 0; k < t->it->section_count && status == PBF_OK; ++k) {
    const section *s = &t->it->sections[k];
    if (!(s->sh_flags & SHF_ALLOC) || s->sh_type != SHT_RELA || s->sh_size == 0) continue;
    const uint64_t a = s->sh_addr - value_of(t, DT_RELA), b = s->sh_addr - value_of(t, DT_JMPREL);
    if (!pbf_image_fits(a, s->sh_size, value_of(t, DT_RELASZ)) &&
        !pbf_image_fits(b, s->sh_size, value_of(t, DT_PLTRELSZ)))
      status = pbf_image_refuse(t->it, "its relocations are garbage");
  }
  return status;
}

static pbf_status check(tables *t) {
  pbf_status status = read_entries(t);
  if (status == PBF_OK) status = check_known(t);
  if (status == PBF_OK) status = check_entry_sizes(t);
  if (status == PBF_OK) status = check_places(t);
  if (status == PBF_OK) status = read_tables(t);
  if (status == PBF_OK) status = check_names(t);
  if (status == PBF_OK) status = check_symbols(t);
  if (status == PBF_OK) status = check_hash(t);
  if (status == PBF_OK) status = check_versions(t);
  if (status == PBF_OK) status = check_all_relocations(t);
  if (status == PBF_OK) t->it->plugin->brings = brings_others(t);
  return status;
}

pbf_status pbf_image_check_tables(image *it) {
  tables t = {.it = it};
  pbf_status status = check(&t);
  free(t.names);
  free(t.symbols);
  free(t.versions);
  free(t.hashes);
  free(t.needs);
  return status;
}
