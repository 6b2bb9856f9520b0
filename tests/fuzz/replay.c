/* Runs a fuzz target over files and folders of files: the corpora as ordinary tests, in builds
 * without libFuzzer. */
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "target.h"

static int fail(const char *path, const char *what) {
  fprintf(stderr, "%s: %s\n", path, what);
  return -1;
}

static long replay_file(const char *path, const struct stat *info) {
  FILE *file = fopen(path, "rb");
  uint8_t *data = malloc((size_t)info->st_size + 1);
  if (!file || !data) {
    free(data);
    if (file) fclose(file);
    return fail(path, "can't be read");
  }
  size_t size = fread(data, 1, (size_t)info->st_size, file);
  fclose(file);
  /* In a block of its own size, so that a look beyond its end is seen. */
  uint8_t *exact = malloc(size + !size);
  memcpy(exact, data, size);
  free(data);
  setenv("PBF_FUZZ_INPUT", path, 1); /* for whoever looks at the core */
  LLVMFuzzerTestOneInput(exact, size);
  free(exact);
  return 1;
}

static long replay(const char *path);

static long replay_folder(const char *path) {
  struct dirent **entries;
  long total = 0;
  int count = scandir(path, &entries, NULL, alphasort);
  if (count < 0) return fail(path, "can't be listed");
  for (int i = 0; i < count; ++i) {
    char inner[4096];
    if (entries[i]->d_name[0] != '.' && total >= 0) {
      snprintf(inner, sizeof inner, "%s/%s", path, entries[i]->d_name);
      long more = replay(inner);
      total = more < 0 ? more : total + more;
    }
    free(entries[i]);
  }
  free(entries);
  return total;
}

static long replay(const char *path) {
  struct stat info;
  if (stat(path, &info) != 0) return fail(path, "is not there");
  return S_ISDIR(info.st_mode) ? replay_folder(path) : replay_file(path, &info);
}

int main(int argc, char **argv) {
  long total = 0;
  for (int i = 1; i < argc; ++i) {
    long count = replay(argv[i]);
    if (count < 0) return 1;
    total += count;
  }
  printf("%ld inputs replayed\n", total);
  return total > 0 ? 0 : 1;
}
