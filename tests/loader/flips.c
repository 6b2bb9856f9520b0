/* Files that differ from a plugin in a bit, somewhere in what the dynamic loader reads before any
 * code runs: each is refused, or the plugin works all the same. Nothing ends the process. */
#include <elf.h>
#include <link.h>
#include <signal.h>
#include <stdio.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "child.h"
#include "random.h"

enum { FLIPS = TEST_INSTRUMENTED ? 150 : 600, MOST_PARTS = 16, TIME_LIMIT = 60 /* seconds */ };

static char folder[64], path[128];
static unsigned char *whole;
static size_t whole_size;

/* Bytes of the file. */
typedef struct part {
  size_t first, size;
} part;

static part parts[MOST_PARTS];
static int part_count;
static size_t parts_size;

static void add_part(size_t first, size_t size) {
  assert_in_range(part_count, 0, MOST_PARTS - 1);
  parts[part_count++] = (part){first, size};
  parts_size += size;
}

static int is_read_by_loader(const ElfW(Shdr) * s) {
  return s->sh_type == SHT_DYNAMIC || s->sh_type == SHT_DYNSYM || s->sh_type == SHT_GNU_HASH ||
         s->sh_type == SHT_HASH || s->sh_type == SHT_GNU_versym || s->sh_type == SHT_GNU_verneed;
}

static void find_parts(void) {
  const ElfW(Ehdr) *h = (const void *)whole;
  add_part(0, sizeof *h);
  add_part(h->e_phoff, h->e_phnum * sizeof(ElfW(Phdr)));
  for (unsigned i = 0; i < h->e_shnum; ++i) {
    const ElfW(Shdr) *s = (const void *)(whole + h->e_shoff + i * sizeof *s);
    if (is_read_by_loader(s)) add_part(s->sh_offset, s->sh_size);
  }
  assert_in_range(part_count, 6, MOST_PARTS); /* both headers, and four tables at least */
}

static int set_up(void **state) {
  struct stat file;
  (void)state;
  make_folder(folder, sizeof folder);
  snprintf(path, sizeof path, "%s/flipped.so", folder);
  assert_int_equal(stat(PBF_STUB_DIR "/ballistic.so", &file), 0);
  whole_size = (size_t)file.st_size;
  whole = malloc(whole_size);
  FILE *stream = fopen(PBF_STUB_DIR "/ballistic.so", "rb");
  assert_non_null(stream);
  assert_int_equal(fread(whole, 1, whole_size, stream), whole_size);
  fclose(stream);
  find_parts();
  return 0;
}

static int tear_down(void **state) {
  (void)state;
  drop_folder(folder);
  free(whole);
  return 0;
}

/* A new file each time: the loader knows those that it has loaded by their inodes. */
static void put_flipped(size_t byte, unsigned bit) {
  remove(path);
  FILE *stream = fopen(path, "wb");
  assert_non_null(stream);
  whole[byte] ^= (unsigned char)(1u << bit);
  assert_int_equal(fwrite(whole, 1, whole_size, stream), whole_size);
  whole[byte] ^= (unsigned char)(1u << bit);
  fclose(stream);
}

enum { REFUSED = 10, WORKED = 11 };

static int use_it(void) {
  const float x[3] = {0.5f, 0.5f, 0.5f};
  pbf_desc desc;
  pbf_solver *solver = NULL;
  if (pbf_load_backend(path) != PBF_OK) return pbf_last_error()[0] ? REFUSED : 1;
  if (pbf_desc_init(&desc, sizeof desc) != PBF_OK) return 2;
  desc.backend = "ballistic";
  desc.strict = 1;
  desc.capacity = 8;
  if (pbf_create(&desc, NULL, &solver) != PBF_OK) return 3;
  if (pbf_add_particles(solver, 1, x, NULL, NULL) != PBF_OK) return 4;
  if (pbf_step(solver, 2) != PBF_OK) return 5;
  pbf_destroy(solver);
  return WORKED;
}

static int outcome(size_t byte, unsigned bit) {
  int status = 0;
  put_flipped(byte, bit);
  fflush(NULL);
  pid_t child = fork();
  assert_true(child >= 0);
  if (child == 0) {
    for (int number = 1; number < 32; ++number) signal(number, SIG_DFL); /* cmocka's handlers */
    alarm(TIME_LIMIT);
    exit(use_it()); /* destructors are the plugin's, too */
  }
  assert_int_equal(waitpid(child, &status, 0), child);
  if (WIFSIGNALED(status)) return -WTERMSIG(status);
  return WEXITSTATUS(status);
}

static int fails_at(size_t at, unsigned bit, int *refused) {
  int k = 0;
  while (at >= parts[k].size) at -= parts[k++].size;
  const size_t byte = parts[k].first + at;
  const int came = outcome(byte, bit);
  *refused += came == REFUSED;
  if (came == REFUSED || came == WORKED) return 0;
  print_message("bit %u of byte %zu, part %d, byte %zu of it: %d\n", bit, byte, k, at, came);
  return 1;
}

static void a_bit_is_flipped(void **state) {
  uint64_t seed = 1;
  int failed = 0, refused = 0;
  (void)state;
  for (int i = 0; i < FLIPS; ++i) {
    const size_t at = (size_t)random_in(&seed, 0, (double)parts_size);
    failed += fails_at(at, (unsigned)random_in(&seed, 0, 8), &refused);
  }
  assert_int_equal(failed, 0);
  assert_in_range(refused, FLIPS / 4, FLIPS);
}

/* All of them take minutes: only when asked for. */
static void every_bit_is_flipped(void **state) {
  int failed = 0, refused = 0;
  (void)state;
  for (size_t at = 0; at < parts_size; ++at)
    for (unsigned bit = 0; bit < 8; ++bit) failed += fails_at(at, bit, &refused);
  print_message("%zu bits: %d refused, %d fail\n", 8 * parts_size, refused, failed);
  assert_int_equal(failed, 0);
}

int main(int argc, char **argv) {
  const struct CMUnitTest some[] = {cmocka_unit_test(a_bit_is_flipped)};
  const struct CMUnitTest all[] = {cmocka_unit_test(every_bit_is_flipped)};
  if (argc == 2 && strcmp(argv[1], "all") == 0)
    return cmocka_run_group_tests(all, set_up, tear_down);
  return cmocka_run_group_tests(some, set_up, tear_down);
}
