#define _GNU_SOURCE /* dladdr */
#include "image.h"

#if !defined(__ELF__)

pbf_status pbf_image_check(int file, uint64_t size, pbf_plugin *plugin) {
  (void)file, (void)size, (void)plugin;
  return PBF_OK;
}

#else

#include <dlfcn.h>
#include <errno.h>
#include <link.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* Headers beyond these numbers are garbage: a linker writes some ten segments, and 64 sections. */
enum { MAX_SEGMENTS = 64, MAX_SECTIONS = 4096, MAX_DYNAMIC = 512 };

typedef ElfW(Ehdr) header;
typedef ElfW(Phdr) segment;
typedef ElfW(Shdr) section;
typedef ElfW(Dyn) dynamic;
typedef ElfW(Addr) address;

typedef struct image {
  int file;
  uint64_t size;
  pbf_plugin *plugin;
  header header;
  segment segments[MAX_SEGMENTS];
} image;

static pbf_status refuse(image *it, const char *what) {
  return pbf_plugin_refuse(it->plugin, PBF_ERROR_UNAVAILABLE, "it is damaged: %s", what);
}

static pbf_status refuse_short(image *it, const char *what) {
  return pbf_plugin_refuse(it->plugin, PBF_ERROR_UNAVAILABLE,
                           "it is cut short: its %s lie beyond its end, at %llu bytes", what,
                           (unsigned long long)it->size);
}

static int fits(uint64_t offset, uint64_t bytes, uint64_t size) {
  return offset <= size && bytes <= size - offset;
}

static int read_at(const image *it, void *bytes, size_t count, uint64_t offset) {
  for (size_t done = 0; done < count;) {
    ssize_t got = pread(it->file, (char *)bytes + done, count - done, (off_t)(offset + done));
    if (got == 0 || (got < 0 && errno != EINTR)) return 0;
    if (got > 0) done += (size_t)got;
  }
  return 1;
}

/* ---- Of which machine ---------------------------------------------------------------------- */

/* The header of this library, which the dynamic loader has mapped with it. */
static const header *own_header(void) {
  Dl_info info;
  if (!dladdr((void *)(uintptr_t)&pbf_image_check, &info)) return NULL;
  const header *own = info.dli_fbase;
  return own && memcmp(own->e_ident, ELFMAG, SELFMAG) == 0 ? own : NULL;
}

static const char *machine_name(unsigned machine) {
  static const struct {
    unsigned machine;
    const char *name;
  } known[] = {{EM_386, "x86"},         {EM_X86_64, "x86-64"}, {EM_ARM, "Arm"},
               {EM_AARCH64, "AArch64"}, {EM_PPC, "POWER"},     {EM_PPC64, "64-bit POWER"},
               {EM_S390, "s390"},       {EM_MIPS, "MIPS"},     {243, "RISC-V"},
               {258, "LoongArch"}};
  for (size_t i = 0; i < sizeof known / sizeof known[0]; ++i)
    if (known[i].machine == machine) return known[i].name;
  return NULL;
}

static const char *machine_text(unsigned machine, char text[32]) {
  const char *name = machine_name(machine);
  snprintf(text, 32, name ? "%s" : "ELF machine %.0s%u", name ? name : "", machine);
  return text;
}

static pbf_status check_machine(image *it) {
  const header *own = own_header(), *theirs = &it->header;
  char text[2][32];
  if (!own) return PBF_OK;
  if (theirs->e_ident[EI_DATA] != own->e_ident[EI_DATA])
    return pbf_plugin_refuse(it->plugin, PBF_ERROR_UNAVAILABLE,
                             "it is for machines of another byte order than this process");
  if (theirs->e_machine != own->e_machine)
    return pbf_plugin_refuse(
        it->plugin, PBF_ERROR_UNAVAILABLE, "it is for another architecture, %s; this process is %s",
        machine_text(theirs->e_machine, text[0]), machine_text(own->e_machine, text[1]));
  if (theirs->e_ident[EI_CLASS] != own->e_ident[EI_CLASS])
    return pbf_plugin_refuse(
        it->plugin, PBF_ERROR_UNAVAILABLE, "it has %s-bit pointers; this process has %zu-bit ones",
        theirs->e_ident[EI_CLASS] == ELFCLASS32 ? "32" : "64", 8 * sizeof(void *));
  return PBF_OK;
}

/* e_machine is at the same place in both classes. */
static pbf_status check_header(image *it) {
  header *h = &it->header;
  if (it->size == 0) return pbf_plugin_refuse(it->plugin, PBF_ERROR_UNAVAILABLE, "it is empty");
  size_t there = it->size < sizeof *h ? (size_t)it->size : sizeof *h;
  if (!read_at(it, h, there, 0))
    return pbf_plugin_refuse(it->plugin, PBF_ERROR_UNAVAILABLE, "can't read it: %s",
                             strerror(errno));
  if (there < SELFMAG || memcmp(h->e_ident, ELFMAG, SELFMAG) != 0)
    return pbf_plugin_refuse(it->plugin, PBF_ERROR_UNAVAILABLE,
                             "it is no shared object: it does not begin as an ELF file");
  if (there < sizeof *h) return refuse_short(it, "headers");
  pbf_status status = check_machine(it);
  if (status != PBF_OK) return status;
  if (h->e_type != ET_DYN)
    return pbf_plugin_refuse(it->plugin, PBF_ERROR_UNAVAILABLE,
                             "it is an ELF file, and no shared object");
  return PBF_OK;
}

/* ---- Segments: what is mapped -------------------------------------------------------------- */

static pbf_status check_mapped(image *it, const segment *s, address *end) {
  if (!fits(s->p_offset, s->p_filesz, it->size)) return refuse_short(it, "segments");
  if (s->p_filesz > s->p_memsz || s->p_vaddr < *end || s->p_memsz > UINTPTR_MAX / 2 - s->p_vaddr)
    return refuse(it, "its segments overlap");
  if (s->p_align & (s->p_align - 1) ||
      (s->p_align && (s->p_vaddr - s->p_offset) & (s->p_align - 1)))
    return refuse(it, "its segments are not aligned");
  *end = s->p_vaddr + s->p_memsz;
  return PBF_OK;
}

static pbf_status check_segments(image *it) {
  const header *h = &it->header;
  address end = 0;
  size_t bytes = h->e_phnum * sizeof(segment);
  if (h->e_phentsize != sizeof(segment) || h->e_phnum == 0 || h->e_phnum > MAX_SEGMENTS)
    return refuse(it, "its header names no segments");
  if (!fits(h->e_phoff, bytes, it->size)) return refuse_short(it, "headers");
  if (!read_at(it, it->segments, bytes, h->e_phoff)) return refuse(it, "it can't be read");
  for (unsigned i = 0; i < h->e_phnum; ++i) {
    const segment *s = &it->segments[i];
    if (!fits(s->p_offset, s->p_filesz, it->size)) return refuse_short(it, "segments");
    pbf_status status = s->p_type == PT_LOAD ? check_mapped(it, s, &end) : PBF_OK;
    if (status != PBF_OK) return status;
  }
  return end ? PBF_OK : refuse(it, "none of its segments is loaded");
}

/* ---- The dynamic section: what the loader follows ------------------------------------------ */

/* Where the bytes at an address are in the file, if they all are. */
static int find_bytes(const image *it, address from, uint64_t bytes, uint64_t *offset) {
  for (unsigned i = 0; i < it->header.e_phnum; ++i) {
    const segment *s = &it->segments[i];
    if (s->p_type != PT_LOAD || from < s->p_vaddr) continue;
    if (!fits(from - s->p_vaddr, bytes, s->p_filesz)) continue;
    *offset = s->p_offset + (from - s->p_vaddr);
    return 1;
  }
  return 0;
}

/* A table that the loader reads: where it is, and the entry that has its size, if there is one. */
typedef struct table {
  ElfW(Sxword) at, bytes;
  int needed;
} table;

static const table tables[] = {
    {DT_STRTAB, DT_STRSZ, 1},
    {DT_SYMTAB, 0, 1},
    {DT_RELA, DT_RELASZ, 0},
    {DT_REL, DT_RELSZ, 0},
    {DT_JMPREL, DT_PLTRELSZ, 0},
    {DT_INIT_ARRAY, DT_INIT_ARRAYSZ, 0},
    {DT_HASH, 0, 0},
    {DT_GNU_HASH, 0, 0},
    {DT_VERSYM, 0, 0},
    {DT_VERNEED, 0, 0},
    {DT_FINI_ARRAY, DT_FINI_ARRAYSZ, 0},
};

static const dynamic *find_entry(const dynamic *entries, ElfW(Sxword) tag) {
  while (entries->d_tag != DT_NULL && entries->d_tag != tag) ++entries;
  return entries->d_tag == tag && tag != DT_NULL ? entries : NULL;
}

static pbf_status check_tables(image *it, const dynamic *entries) {
  uint64_t unused;
  for (size_t i = 0; i < sizeof tables / sizeof tables[0]; ++i) {
    const dynamic *at = find_entry(entries, tables[i].at);
    const dynamic *bytes = find_entry(entries, tables[i].bytes);
    if (!at && tables[i].needed) return refuse(it, "its dynamic section lacks a table");
    if (at && !find_bytes(it, at->d_un.d_ptr, bytes ? bytes->d_un.d_val : 1, &unused))
      return refuse(it, "its dynamic section points to nothing");
  }
  return PBF_OK;
}

/* Names are offsets into the string table. */
static pbf_status check_names(image *it, const dynamic *entries) {
  const dynamic *size = find_entry(entries, DT_STRSZ);
  if (!size) return refuse(it, "its dynamic section lacks a table");
  for (const dynamic *e = entries; e->d_tag != DT_NULL; ++e) {
    int names = e->d_tag == DT_NEEDED || e->d_tag == DT_SONAME || e->d_tag == DT_RPATH ||
                e->d_tag == DT_RUNPATH;
    if (names && e->d_un.d_val >= size->d_un.d_val)
      return refuse(it, "its dynamic section points to nothing");
  }
  return PBF_OK;
}

static pbf_status check_dynamic(image *it) {
  dynamic entries[MAX_DYNAMIC + 1];
  const segment *s = it->segments, *end = s + it->header.e_phnum;
  uint64_t offset;
  while (s < end && s->p_type != PT_DYNAMIC) ++s;
  if (s == end) return refuse(it, "it has no dynamic section");
  size_t count = s->p_filesz / sizeof(dynamic);
  if (count > MAX_DYNAMIC || !find_bytes(it, s->p_vaddr, s->p_filesz, &offset) ||
      !read_at(it, entries, count * sizeof(dynamic), offset))
    return refuse(it, "its dynamic section is not in a segment that is loaded");
  entries[count].d_tag = DT_NULL;
  if (!find_entry(entries, DT_STRTAB) || count == 0 || entries[count - 1].d_tag != DT_NULL)
    return refuse(it, "its dynamic section has no end, or nothing in it");
  pbf_status status = check_tables(it, entries);
  return status == PBF_OK ? check_names(it, entries) : status;
}

/* ---- Sections: the last that a linker writes ----------------------------------------------- */

/* A file whose end has been reserved, and was not written, has zeros there. */
static pbf_status check_sections(image *it) {
  const header *h = &it->header;
  section names;
  if (h->e_shoff == 0) return PBF_OK; /* stripped of them */
  if (h->e_shentsize != sizeof(section) || h->e_shnum > MAX_SECTIONS || h->e_shstrndx >= h->e_shnum)
    return refuse(it, "its header names no sections");
  if (!fits(h->e_shoff, (uint64_t)h->e_shnum * sizeof(section), it->size))
    return refuse_short(it, "sections");
  if (!read_at(it, &names, sizeof names, h->e_shoff + h->e_shstrndx * sizeof(section)))
    return refuse(it, "it can't be read");
  if (names.sh_type != SHT_STRTAB) return refuse(it, "its sections have not been written");
  if (!fits(names.sh_offset, names.sh_size, it->size)) return refuse_short(it, "sections");
  return PBF_OK;
}

pbf_status pbf_image_check(int file, uint64_t size, pbf_plugin *plugin) {
  image it = {.file = file, .size = size, .plugin = plugin};
  pbf_status status = check_header(&it);
  if (status == PBF_OK) status = check_segments(&it);
  if (status == PBF_OK) status = check_dynamic(&it);
  if (status == PBF_OK) status = check_sections(&it);
  return status;
}

#endif
