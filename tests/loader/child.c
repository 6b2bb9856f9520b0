#include "child.h"

#include <stdio.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static int failures;

void in_child(void (*body)(void)) {
  fflush(NULL);
  pid_t child = fork();
  assert_true(child >= 0);
  if (child == 0) {
    failures = 0;
    body();
    fflush(NULL);
    _exit(failures != 0);
  }
  int status = 0;
  assert_int_equal(waitpid(child, &status, 0), child);
  assert_true(WIFEXITED(status));
  assert_int_equal(WEXITSTATUS(status), 0);
}

void check_at(int condition, const char *text, const char *file, int line) {
  if (condition) return;
  ++failures;
  fprintf(stderr, "%s:%d: not so: %s\n", file, line, text);
}

void check_status_at(pbf_status status, pbf_status expected, const char *words, const char *call,
                     const char *file, int line) {
  if (status == expected && (expected == PBF_OK || strstr(pbf_last_error(), words))) return;
  ++failures;
  fprintf(stderr, "%s:%d: %s gave %s \"%s\", expected %s with \"%s\"\n", file, line, call,
          pbf_status_string(status), pbf_last_error(), pbf_status_string(expected), words);
}

void make_folder(char *folder, size_t size) {
  snprintf(folder, size, "/tmp/pbf-loader-XXXXXX");
  assert_non_null(mkdtemp(folder));
  assert_int_equal(chmod(folder, 0755), 0);
}

static void run(const char *format, const char *a, const char *b) {
  char command[4096];
  assert_true(snprintf(command, sizeof command, format, a, b) < (int)sizeof command);
  assert_int_equal(system(command), 0);
}

void drop_folder(const char *folder) { run("rm -rf '%s'%s", folder, ""); }

void put_file(const char *folder, const char *name, const char *source) {
  char from[1024], to[1024];
  snprintf(from, sizeof from, source[0] == '/' ? "%s" : PBF_STUB_DIR "/%s", source);
  snprintf(to, sizeof to, "%s/%s", folder, name);
  run("cp '%s' '%s'", from, to);
}

void put_text(const char *folder, const char *name, const char *text) {
  char path[1024];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE *file = fopen(path, "w");
  assert_non_null(file);
  fputs(text, file);
  fclose(file);
}

void make_subfolder(const char *folder, const char *name) {
  char path[1024];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  assert_int_equal(mkdir(path, 0755), 0);
}

int find_backend(const char *name, const char *path, pbf_backend_info *info) {
  uint32_t count = 0;
  check_ok(pbf_get_backend_count(&count));
  for (uint32_t i = 0; i < count; ++i) {
    *info = (pbf_backend_info){.struct_size = sizeof *info};
    check_ok(pbf_get_backend_info(NULL, i, info));
    if (strcmp(info->name, name) == 0 && (!path || strcmp(info->path, path) == 0)) return (int)i;
  }
  return -1;
}
