/* The dynamic section of a shared object, and what the dynamic loader reads by it before any code
 * runs. It takes all of this on trust; what a linker has stated twice has to agree. */
#define _GNU_SOURCE
#include "image_tables.h"

#include <stdlib.h>
#include <string.h>

enum { MAX_BYTES = 1 << 24 };

typedef pbf_image image;
typedef ElfW(Shdr) section;
typedef ElfW(Dyn) dynamic;
typedef ElfW(Sym) symbol;
typedef ElfW(Addr) address;
typedef pbf_image_tables tables;

#if __ELF_NATIVE_CLASS == 64
static unsigned symbol_of(uint64_t info) { return (unsigned)ELF64_R_SYM(info); }
#else
static unsigned symbol_of(uint64_t info) { return (unsigned)ELF32_R_SYM(info); }
#endif

enum { RELR = 36, RELR_SIZE = 35, SECTION_RELR = 19 }; /* younger than some <elf.h> */

/* ---- Entries --------------------------------------------------------------------------------- */

static pbf_status read_entries(tables *t) {
  image *it = t->it;
  const ElfW(Phdr) *s = it->segments, *end = s + it->header.e_phnum;
  uint64_t offset;
  while (s < end && s->p_type != PT_DYNAMIC) ++s;
  if (s == end) return pbf_image_refuse(it, "it has no dynamic section");
  const size_t count = s->p_filesz / sizeof(dynamic);
  if (count > PBF_MAX_DYNAMIC || !pbf_image_find(it, s->p_vaddr, s->p_filesz, &offset) ||
      !pbf_image_read(it, t->entries, count * sizeof(dynamic), offset))
    return pbf_image_refuse(it, "its dynamic section is not in a segment that is loaded");
  t->entries[count].d_tag = DT_NULL;
  if (!pbf_image_entry_of(t, DT_STRTAB) || count == 0 || t->entries[count - 1].d_tag != DT_NULL)
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
  const dynamic *first = pbf_image_entry_of(t, tag), *other = first;
  if (!first) return 1;
  do ++other;
  while (other->d_tag != DT_NULL && other->d_tag != tag);
  return other->d_tag == DT_NULL;
}

static int has_section(const image *it, uint32_t type) {
  for (uint32_t k = 0; k < it->section_count; ++k)
    if (it->sections[k].sh_flags & SHF_ALLOC && it->sections[k].sh_type == type) return 1;
  return 0;
}

/* Whether an entry and the section table agree on where a table is. */
static int agrees(const tables *t, const table *kind) {
  const dynamic *at = pbf_image_entry_of(t, kind->at), *bytes = pbf_image_entry_of(t, kind->bytes);
  if (t->it->section_count == 0 || !kind->section) return 1;
  if (!at) return kind->section == SHT_STRTAB || !has_section(t->it, kind->section);
  const section *s = pbf_image_section_at(t->it, at->d_un.d_ptr, kind->section);
  return s && (!bytes || bytes->d_un.d_val == s->sh_size);
}

static pbf_status check_known(tables *t) {
  uint64_t unused;
  for (int k = 0; k < KNOWN; ++k) {
    const table *kind = &known[k];
    const dynamic *at = pbf_image_entry_of(t, kind->at),
                  *bytes = pbf_image_entry_of(t, kind->bytes);
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
    if (pbf_image_entry_of(t, sizes[k].of) && pbf_image_value_of(t, sizes[k].tag) != sizes[k].size)
      return pbf_image_refuse(t->it, "a table of its dynamic section has entries of another size");
  const uint64_t kind = pbf_image_value_of(t, DT_PLTREL);
  if (pbf_image_entry_of(t, DT_JMPREL) && kind != DT_RELA && kind != DT_REL)
    return pbf_image_refuse(t->it, "its dynamic section says nothing of the kind of a table");
  return PBF_OK;
}

/* What is called, and what the loader writes into: the begin of a section that has that right. */
static pbf_status check_places(tables *t) {
  const ElfW(Sxword) tags[] = {DT_INIT, DT_FINI, DT_PLTGOT};
  for (int k = 0; k < 3; ++k) {
    const dynamic *e = pbf_image_entry_of(t, tags[k]);
    if (!e || t->it->section_count == 0) continue;
    const section *s = pbf_image_section_at(t->it, e->d_un.d_ptr, SHT_PROGBITS);
    const int is_code = s && s->sh_flags & SHF_EXECINSTR && s->sh_entsize == 0;
    if (!s || !(tags[k] == DT_PLTGOT ? (s->sh_flags & SHF_WRITE) != 0 : is_code))
      return pbf_image_refuse(t->it, "its dynamic section points to nothing");
  }
  return PBF_OK;
}

/* ---- Reading the tables --------------------------------------------------------------------- */

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
  const dynamic *e = pbf_image_entry_of(t, tag);
  const section *s = e ? pbf_image_section_at(t->it, e->d_un.d_ptr, type) : NULL;
  return s ? s->sh_size : 0;
}

static pbf_status read_tables(tables *t) {
  const uint64_t symbols = size_of(t, DT_SYMTAB, SHT_DYNSYM);
  const uint64_t versions = size_of(t, DT_VERSYM, SHT_GNU_versym);
  t->names_size = pbf_image_value_of(t, DT_STRSZ);
  t->hashes_size = size_of(t, DT_GNU_HASH, SHT_GNU_HASH);
  t->needs_size = size_of(t, DT_VERNEED, SHT_GNU_verneed);
  t->symbol_count = (uint32_t)(symbols / sizeof(symbol));
  if (versions && versions != t->symbol_count * sizeof *t->versions)
    return pbf_image_refuse(t->it, "its symbols and their versions are not as many");
  pbf_status status = read_table(t, pbf_image_value_of(t, DT_STRTAB), t->names_size, &t->names);
  if (status == PBF_OK)
    status = read_table(t, pbf_image_value_of(t, DT_SYMTAB), symbols, &t->symbols);
  if (status == PBF_OK)
    status = read_table(t, pbf_image_value_of(t, DT_VERSYM), versions, &t->versions);
  if (status == PBF_OK)
    status = read_table(t, pbf_image_value_of(t, DT_GNU_HASH), t->hashes_size, &t->hashes);
  if (status == PBF_OK)
    status = read_table(t, pbf_image_value_of(t, DT_VERNEED), t->needs_size, &t->needs);
  return status;
}

/* ---- Relocations ---------------------------------------------------------------------------- */

/* What is relocated is a place that can be written to; the first `relative` ones have no symbol. */
static int is_relocation_sound(const tables *t, const ElfW(Rela) * r, int is_relative) {
  if (symbol_of(r->r_info) >= t->symbol_count || (is_relative && symbol_of(r->r_info))) return 0;
  for (unsigned i = 0; i < t->it->header.e_phnum; ++i) {
    const ElfW(Phdr) *s = &t->it->segments[i];
    if (s->p_type != PT_LOAD || !(s->p_flags & PF_W) || r->r_offset < s->p_vaddr) continue;
    if (pbf_image_fits(r->r_offset - s->p_vaddr, sizeof(address), s->p_memsz)) return 1;
  }
  return pbf_image_entry_of(t, DT_TEXTREL) != NULL;
}

static pbf_status check_relocations(tables *t, ElfW(Sxword) at, ElfW(Sxword) bytes) {
  ElfW(Rela) *all = NULL;
  const uint64_t count = pbf_image_value_of(t, bytes) / sizeof *all;
  const uint64_t relative = at == DT_RELA ? pbf_image_value_of(t, DT_RELACOUNT) : 0;
  const section *s = pbf_image_section_at(t->it, pbf_image_value_of(t, at), SHT_RELA);
  if (t->symbol_count == 0 || count == 0) return PBF_OK;
  if (!s || s->sh_size > pbf_image_value_of(t, bytes) || relative > count)
    return pbf_image_refuse(t->it, "its relocations are garbage");
  pbf_status status = read_table(t, pbf_image_value_of(t, at), count * sizeof *all, &all);
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
  if (status == PBF_OK && pbf_image_value_of(t, DT_PLTREL) == DT_RELA)
    status = check_relocations(t, DT_JMPREL, DT_PLTRELSZ);
  for (uint32_t k = 0; k < t->it->section_count && status == PBF_OK; ++k) {
    const section *s = &t->it->sections[k];
    if (!(s->sh_flags & SHF_ALLOC) || s->sh_type != SHT_RELA || s->sh_size == 0) continue;
    const uint64_t a = s->sh_addr - pbf_image_value_of(t, DT_RELA),
                   b = s->sh_addr - pbf_image_value_of(t, DT_JMPREL);
    if (!pbf_image_fits(a, s->sh_size, pbf_image_value_of(t, DT_RELASZ)) &&
        !pbf_image_fits(b, s->sh_size, pbf_image_value_of(t, DT_PLTRELSZ)))
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
  if (status == PBF_OK) status = pbf_image_check_names(t);
  if (status == PBF_OK) status = pbf_image_check_symbols(t);
  if (status == PBF_OK) status = pbf_image_check_hash(t);
  if (status == PBF_OK) status = pbf_image_check_versions(t);
  if (status == PBF_OK) status = check_all_relocations(t);
  if (status == PBF_OK) t->it->plugin->brings = pbf_image_brings_others(t);
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
