/* Of ELF, before the dynamic loader believes what a file says of itself. */
#include "image.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "image_file.h"
#include "os.h"

typedef pbf_image image;
typedef ElfW(Ehdr) header;
typedef ElfW(Phdr) segment;
typedef ElfW(Shdr) section;
typedef ElfW(Addr) address;

/* ---- Of which machine ---------------------------------------------------------------------- */

/* The header of this library, which the dynamic loader has mapped with it. */
static const header *own_header(void) {
  const header *own = pbf_os_own_image();
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
  if (!pbf_image_read(it, h, there, 0))
    return errno ? pbf_plugin_refuse(it->plugin, PBF_ERROR_UNAVAILABLE, "can't read it: %s",
                                     strerror(errno))
                 : pbf_plugin_refuse(it->plugin, PBF_ERROR_UNAVAILABLE,
                                     "it has fewer bytes than the system says, %llu",
                                     (unsigned long long)it->size);
  if (there < SELFMAG || memcmp(h->e_ident, ELFMAG, SELFMAG) != 0)
    return pbf_plugin_refuse(it->plugin, PBF_ERROR_UNAVAILABLE,
                             "it is no shared object: it does not begin as an ELF file");
  if (there < sizeof *h) return pbf_image_refuse_short(it, "headers");
  pbf_status status = check_machine(it);
  if (status != PBF_OK) return status;
  if (h->e_type != ET_DYN)
    return pbf_plugin_refuse(it->plugin, PBF_ERROR_UNAVAILABLE,
                             "it is an ELF file, and no shared object");
  return PBF_OK;
}

/* ---- Segments: what is mapped -------------------------------------------------------------- */

static pbf_status check_mapped(image *it, const segment *s, address *end) {
  if (!pbf_image_fits(s->p_offset, s->p_filesz, it->size))
    return pbf_image_refuse_short(it, "segments");
  if (s->p_filesz > s->p_memsz || s->p_vaddr < *end || s->p_memsz > UINTPTR_MAX / 2 - s->p_vaddr)
    return pbf_image_refuse(it, "its segments overlap");
  if (s->p_align & (s->p_align - 1) ||
      (s->p_align && (s->p_vaddr - s->p_offset) & (s->p_align - 1)))
    return pbf_image_refuse(it, "its segments are not aligned");
  *end = s->p_vaddr + s->p_memsz;
  return PBF_OK;
}

static pbf_status check_segments(image *it) {
  const header *h = &it->header;
  address end = 0;
  size_t bytes = h->e_phnum * sizeof(segment);
  if (h->e_phentsize != sizeof(segment) || h->e_phnum == 0 || h->e_phnum > PBF_MAX_SEGMENTS)
    return pbf_image_refuse(it, "its header names no segments");
  if (!pbf_image_fits(h->e_phoff, bytes, it->size)) return pbf_image_refuse_short(it, "headers");
  if (!pbf_image_read(it, it->segments, bytes, h->e_phoff))
    return pbf_image_refuse(it, "it can't be read");
  for (unsigned i = 0; i < h->e_phnum; ++i) {
    const segment *s = &it->segments[i];
    if (!pbf_image_fits(s->p_offset, s->p_filesz, it->size))
      return pbf_image_refuse_short(it, "segments");
    pbf_status status = s->p_type == PT_LOAD ? check_mapped(it, s, &end) : PBF_OK;
    if (status != PBF_OK) return status;
  }
  return end ? PBF_OK : pbf_image_refuse(it, "none of its segments is loaded");
}

/* ---- Sections ------------------------------------------------------------------------------- */

/* A linker writes sections last: a file with an end that has been reserved, and was not written,
 * has zeros there. */
static pbf_status check_section_names(image *it) {
  const section *names = &it->sections[it->header.e_shstrndx];
  if (names->sh_type != SHT_STRTAB)
    return pbf_image_refuse(it, "its sections have not been written");
  return pbf_image_fits(names->sh_offset, names->sh_size, it->size)
             ? PBF_OK
             : pbf_image_refuse_short(it, "sections");
}

static pbf_status read_sections(image *it) {
  const header *h = &it->header;
  const size_t bytes = h->e_shnum * sizeof(section);
  if (h->e_shoff == 0) return PBF_OK; /* stripped of them */
  if (h->e_shentsize != sizeof(section) || h->e_shnum > PBF_MAX_SECTIONS ||
      h->e_shstrndx >= h->e_shnum)
    return pbf_image_refuse(it, "its header names no sections");
  if (!pbf_image_fits(h->e_shoff, bytes, it->size)) return pbf_image_refuse_short(it, "sections");
  it->sections = malloc(bytes);
  if (!it->sections) return pbf_image_refuse_now(it);
  it->section_count = h->e_shnum;
  if (!pbf_image_read(it, it->sections, bytes, h->e_shoff))
    return pbf_image_refuse(it, "it can't be read");
  return check_section_names(it);
}

/* A linker states where things are twice, in sections and in segments. */
static int carries(const segment *load, const section *s) {
  const address from = s->sh_addr - load->p_vaddr;
  const unsigned wanted =
      PF_R | (s->sh_flags & SHF_WRITE ? PF_W : 0u) | (s->sh_flags & SHF_EXECINSTR ? PF_X : 0u);
  if (load->p_type != PT_LOAD || s->sh_addr < load->p_vaddr ||
      !pbf_image_fits(from, s->sh_size, load->p_memsz) || (load->p_flags & wanted) != wanted)
    return 0;
  if (s->sh_type == SHT_NOBITS) return from >= load->p_filesz;
  return pbf_image_fits(from, s->sh_size, load->p_filesz) && s->sh_offset == load->p_offset + from;
}

static int is_carried(const image *it, const section *s) {
  const int takes_no_place = s->sh_type == SHT_NOBITS && s->sh_flags & SHF_TLS;
  if (!(s->sh_flags & SHF_ALLOC) || s->sh_size == 0 || takes_no_place) return 1;
  for (unsigned i = 0; i < it->header.e_phnum; ++i)
    if (carries(&it->segments[i], s)) return 1;
  return 0;
}

/* The one section of a kind is what a segment of its own is about. */
static int is_of_section(const image *it, const segment *s, uint32_t type) {
  for (uint32_t k = 0; k < it->section_count; ++k) {
    const section *one = &it->sections[k];
    if (one->sh_type == type && one->sh_addr == s->p_vaddr && one->sh_offset == s->p_offset &&
        one->sh_size == s->p_filesz)
      return 1;
  }
  return it->section_count == 0;
}

static int is_thread_local(const image *it, const segment *s) {
  address first = s->p_vaddr + s->p_memsz, end = s->p_vaddr, stored = s->p_vaddr;
  int count = 0;
  for (uint32_t k = 0; k < it->section_count; ++k) {
    const section *one = &it->sections[k];
    if (!(one->sh_flags & SHF_TLS)) continue;
    ++count;
    if (one->sh_addr < first) first = one->sh_addr;
    if (one->sh_addr + one->sh_size > end) end = one->sh_addr + one->sh_size;
    if (one->sh_type != SHT_NOBITS && one->sh_addr + one->sh_size > stored)
      stored = one->sh_addr + one->sh_size;
  }
  if (it->section_count == 0) return 1;
  return count > 0 && first == s->p_vaddr && end == s->p_vaddr + s->p_memsz &&
         stored == s->p_vaddr + s->p_filesz && !(s->p_align & (s->p_align - 1)) &&
         s->p_align <= 1u << 16;
}

/* Of a section that is written to as long as the object is loaded. */
static int is_data(const image *it, const section *s) {
  const section *names = &it->sections[it->header.e_shstrndx];
  char name[16] = {0};
  if (!(s->sh_flags & SHF_WRITE) || s->sh_size == 0 ||
      !pbf_image_fits(s->sh_name, sizeof name - 1, names->sh_size) ||
      !pbf_image_read(it, name, sizeof name - 1, names->sh_offset + s->sh_name))
    return 0;
  return (strncmp(name, ".data", 5) == 0 && strncmp(name, ".data.rel.ro", 12) != 0) ||
         (strncmp(name, ".bss", 4) == 0 && strncmp(name, ".bss.rel.ro", 11) != 0);
}

/* Pages that are read-only once the loader is done: in part of a page nothing is. */
static int protects_no_data(const image *it, const segment *s) {
  const address end = (s->p_vaddr + s->p_memsz) & ~((address)pbf_os_page() - 1);
  for (uint32_t k = 0; k < it->section_count; ++k) {
    const section *one = &it->sections[k];
    if (is_data(it, one) && one->sh_addr < end && one->sh_addr + one->sh_size > s->p_vaddr)
      return 0;
  }
  return 1;
}

static int protects_writable(const image *it, const segment *s) {
  const address page = (address)pbf_os_page();
  for (unsigned i = 0; i < it->header.e_phnum; ++i) {
    const segment *load = &it->segments[i];
    const int is_start = load->p_vaddr == s->p_vaddr && load->p_offset == s->p_offset;
    if (load->p_type == PT_LOAD && load->p_flags & PF_W && is_start &&
        s->p_memsz < load->p_memsz + page)
      return protects_no_data(it, s);
  }
  return 0;
}

static int has_bytes(const image *it, const segment *s) {
  uint64_t offset;
  return pbf_image_find(it, s->p_vaddr, s->p_filesz, &offset) && offset == s->p_offset;
}

/* Those beside PT_LOAD that the loader, or a thread's start, goes by. */
static int is_segment_sound(const image *it, const segment *s) {
  switch (s->p_type) {
    case PT_DYNAMIC:
      return is_of_section(it, s, SHT_DYNAMIC);
    case PT_TLS:
      return is_thread_local(it, s);
    case PT_GNU_RELRO:
      return protects_writable(it, s);
    case PT_PHDR:
      return s->p_offset == it->header.e_phoff && has_bytes(it, s);
    case PT_NOTE:
    case PT_GNU_PROPERTY:
      return has_bytes(it, s);
    default:
      return 1;
  }
}

static int has_segment(const image *it, uint32_t type) {
  for (unsigned i = 0; i < it->header.e_phnum; ++i)
    if (it->segments[i].p_type == type) return 1;
  return 0;
}

static pbf_status check_agreement(image *it) {
  int is_sound = 1;
  for (unsigned i = 0; i < it->header.e_phnum; ++i)
    is_sound &= is_segment_sound(it, &it->segments[i]);
  for (uint32_t k = 0; k < it->section_count; ++k) {
    is_sound &= is_carried(it, &it->sections[k]);
    if (it->sections[k].sh_flags & SHF_TLS) is_sound &= has_segment(it, PT_TLS);
  }
  return is_sound ? PBF_OK
                  : pbf_image_refuse(it, "its segments and sections contradict each other");
}

pbf_status pbf_image_check(int file, uint64_t size, pbf_plugin *plugin) {
  image it = {.file = file, .size = size, .plugin = plugin};
  pbf_status status = check_header(&it);
  if (status == PBF_OK) status = check_segments(&it);
  if (status == PBF_OK) status = read_sections(&it);
  if (status == PBF_OK) status = check_agreement(&it);
  if (status == PBF_OK) status = pbf_image_check_tables(&it);
  free(it.sections);
  return status;
}
