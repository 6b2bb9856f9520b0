/* Files that are not, or not all of, a plugin for this process: each is refused with a reason, and
 * listed with it. What the test damages lies where the ELF specification says, in numbers of its
 * own where they are the same in all classes. */
#include <elf.h>
#include <fcntl.h>
#include <link.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

#include "child.h"

static char folder[64], path[128];
static unsigned char *whole;
static size_t whole_size;

static void read_whole(const char *from) {
  struct stat file;
  assert_int_equal(stat(from, &file), 0);
  whole_size = (size_t)file.st_size;
  whole = malloc(whole_size);
  FILE *stream = fopen(from, "rb");
  assert_non_null(stream);
  assert_int_equal(fread(whole, 1, whole_size, stream), whole_size);
  fclose(stream);
}

static int set_up(void **state) {
  (void)state;
  make_folder(folder, sizeof folder);
  snprintf(path, sizeof path, "%s/damaged.so", folder);
  read_whole(PBF_STUB_DIR "/ballistic.so");
  return 0;
}

static int tear_down(void **state) {
  (void)state;
  drop_folder(folder);
  free(whole);
  return 0;
}

/* A new file each time: the loader knows those that it has loaded by their inodes. */
static void put(const unsigned char *bytes, size_t size) {
  remove(path);
  FILE *stream = fopen(path, "wb");
  assert_non_null(stream);
  assert_int_equal(fwrite(bytes, 1, size, stream), size);
  fclose(stream);
}

static const char *words;

static void refuse_it(void) {
  pbf_backend_info info;
  uint32_t count = 0;
  check_fails(pbf_load_backend(path), PBF_ERROR_UNAVAILABLE, words);
  check_ok(pbf_get_backend_count(&count));
  check(find_backend("", path, &info) >= 0 && !info.available && strstr(info.reason, words));
}

static void assert_refused(const char *reason) {
  words = reason;
  in_child(refuse_it);
}

/* With something else at `offset`. */
static void assert_changed_refused(size_t offset, const void *bytes, size_t count,
                                   const char *reason) {
  unsigned char *changed = malloc(whole_size);
  memcpy(changed, whole, whole_size);
  memcpy(changed + offset, bytes, count);
  put(changed, whole_size);
  free(changed);
  assert_refused(reason);
}

static void cut_short(void **state) {
  (void)state;
  enum { CUTS = 120 };
  for (size_t i = 1; i < CUTS; ++i) {
    put(whole, whole_size * i / CUTS);
    assert_refused("it is cut short: its ");
  }
  put(whole, whole_size - 1);
  assert_refused("it is cut short: its sections lie beyond its end");
  put(whole, 20);
  assert_refused("it is cut short: its headers lie beyond its end");
  put(whole, 0);
  assert_refused("it is empty");
}

static void loads_whole(void) { check_ok(pbf_load_backend(path)); }

/* The test's own writing does no damage. */
static void not_cut(void **state) {
  (void)state;
  put(whole, whole_size);
  in_child(loads_whole);
}

/* As after a download into a file whose room was reserved before. */
static void ends_with_zeros(void **state) {
  (void)state;
  for (size_t i = 0; i < 20; ++i) {
    unsigned char *changed = calloc(1, whole_size);
    memcpy(changed, whole, whole_size * i / 20);
    put(changed, whole_size);
    free(changed);
    assert_refused(i ? "it is damaged: its " : "it is no shared object");
  }
}

static void of_another_machine(void **state) {
  (void)state;
  const ElfW(Half) other = ((ElfW(Ehdr) *)whole)->e_machine == EM_AARCH64 ? EM_X86_64 : EM_AARCH64;
  const unsigned char order = whole[EI_DATA] == ELFDATA2LSB ? ELFDATA2MSB : ELFDATA2LSB;
  const unsigned char class = whole[EI_CLASS] == ELFCLASS64 ? ELFCLASS32 : ELFCLASS64;
  assert_changed_refused(18, &other, sizeof other,
                         other == EM_AARCH64
                             ? "it is for another architecture, AArch64; this process"
                             : "it is for another architecture, x86-64; this process");
  assert_changed_refused(EI_DATA, &order, 1, "machines of another byte order");
  assert_changed_refused(EI_CLASS, &class, 1, "-bit pointers; this process has ");
}

static void of_another_type(void **state) {
  (void)state;
  const ElfW(Half) object = ET_REL;
  assert_changed_refused(16, &object, sizeof object, "it is an ELF file, and no shared object");
  assert_changed_refused(1, "elf", 3, "it is no shared object");
}

static size_t segment_at(ElfW(Word) type) {
  const ElfW(Ehdr) *header = (const void *)whole;
  for (unsigned i = 0; i < header->e_phnum; ++i) {
    size_t at = header->e_phoff + i * sizeof(ElfW(Phdr));
    if (((const ElfW(Phdr) *)(const void *)(whole + at))->p_type == type) return at;
  }
  fail_msg("no segment of type %u", (unsigned)type);
  return 0;
}

static void headers_are_garbage(void **state) {
  (void)state;
  const ElfW(Off) far = ~(ElfW(Off))0 - 7;
  const ElfW(Half) many = 0xffff, none = 0;
  const ElfW(Xword) odd = 0x1001, huge = (ElfW(Xword))1 << 62;
  size_t load = segment_at(PT_LOAD), dynamic = segment_at(PT_DYNAMIC);
  assert_changed_refused(offsetof(ElfW(Ehdr), e_phoff), &far, sizeof far, "its headers lie beyond");
  assert_changed_refused(offsetof(ElfW(Ehdr), e_phnum), &many, sizeof many, "names no segments");
  assert_changed_refused(offsetof(ElfW(Ehdr), e_phnum), &none, sizeof none, "names no segments");
  assert_changed_refused(offsetof(ElfW(Ehdr), e_phentsize), &none, sizeof none,
                         "names no segments");
  assert_changed_refused(offsetof(ElfW(Ehdr), e_shoff), &far, sizeof far,
                         "its sections lie beyond");
  assert_changed_refused(load + offsetof(ElfW(Phdr), p_offset), &far, sizeof far,
                         "its segments lie beyond its end");
  assert_changed_refused(load + offsetof(ElfW(Phdr), p_align), &odd, sizeof odd, "not aligned");
  assert_changed_refused(load + offsetof(ElfW(Phdr), p_memsz), &huge, sizeof huge, "overlap");
  assert_changed_refused(dynamic + offsetof(ElfW(Phdr), p_vaddr), &far, sizeof far,
                         "its segments and sections contradict each other");
  assert_changed_refused(dynamic, &none, sizeof none, "it has no dynamic section");
}

/* Each entry that the loader follows, pointing beyond the file. */
static void dynamic_section_is_garbage(void **state) {
  (void)state;
  const ElfW(Phdr) *segment = (const void *)(whole + segment_at(PT_DYNAMIC));
  const ElfW(Addr) far = ~(ElfW(Addr))0 - 4095;
  int followed = 0;
  for (size_t at = segment->p_offset;; at += sizeof(ElfW(Dyn))) {
    const ElfW(Dyn) *entry = (const void *)(whole + at);
    if (entry->d_tag == DT_NULL) break;
    if (entry->d_tag != DT_STRTAB && entry->d_tag != DT_SYMTAB && entry->d_tag != DT_RELA &&
        entry->d_tag != DT_GNU_HASH && entry->d_tag != DT_NEEDED && entry->d_tag != DT_STRSZ)
      continue;
    assert_changed_refused(at + offsetof(ElfW(Dyn), d_un), &far, sizeof far,
                           "its dynamic section points to nothing");
    ++followed;
  }
  assert_in_range(followed, 4, 8);
}

static void device(void) {
  check_fails(pbf_load_backend("/dev/zero"), PBF_ERROR_UNAVAILABLE, "not a regular file");
  check_fails(pbf_load_backend("/proc/self/mem"), PBF_ERROR_UNAVAILABLE, "/proc/self/mem: ");
  check_fails(pbf_load_backend("/proc/self/status"), PBF_ERROR_UNAVAILABLE, "it is empty");
  /* As a file that is cut short between two looks at it. */
  static const char said_to_be_a_page[] = "/sys/devices/system/cpu/possible";
  if (access(said_to_be_a_page, R_OK) == 0)
    check_fails(pbf_load_backend(said_to_be_a_page), PBF_ERROR_UNAVAILABLE,
                "it has fewer bytes than the system says, ");
}

static void files_of_the_system(void **state) {
  (void)state;
  in_child(device);
}

static void serve_beside_it(void) {
  pbf_desc desc;
  pbf_solver *solver = NULL;
  pbf_backend_info info;
  check_ok(pbf_desc_init(&desc, sizeof desc));
  desc.backend = "serial";
  desc.strict = 1;
  desc.capacity = 8;
  check_ok(pbf_create(&desc, NULL, &solver));
  pbf_destroy(solver);
  check(find_backend("openmp", NULL, &info) >= 0 && !info.available);
  check(strstr(info.reason, "it is cut short"));
}

/* One damaged file in a folder of plugins. */
static void others_still_serve(void **state) {
  (void)state;
  snprintf(path, sizeof path, "%s/pbf_backend_openmp.so", folder);
  put(whole, whole_size / 2);
  put_file(folder, "pbf_backend_serial.so", "stub_serial.so");
  setenv("PBF_BACKEND_PATH", folder, 1);
  in_child(serve_beside_it);
  unsetenv("PBF_BACKEND_PATH");
}

int main(void) {
  const struct CMUnitTest damaged[] = {
      cmocka_unit_test(cut_short),
      cmocka_unit_test(not_cut),
      cmocka_unit_test(ends_with_zeros),
      cmocka_unit_test(of_another_machine),
      cmocka_unit_test(of_another_type),
      cmocka_unit_test(headers_are_garbage),
      cmocka_unit_test(dynamic_section_is_garbage),
      cmocka_unit_test(files_of_the_system),
      cmocka_unit_test(others_still_serve),
  };
  return cmocka_run_group_tests(damaged, set_up, tear_down);
}
