/* Where plugins are looked for, with a libpbf of the test's own in a folder of the test's own. */
#define _GNU_SOURCE /* unshare, stpcpy */
#include <stdio.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <grp.h>

#if defined(__linux__)
#include <sched.h>
#include <sys/mount.h>
#endif

#include "child.h"
#include "support.h"

static char folder[64];    /* libpbf.so and the program that asks it */
static char output[16384]; /* what it said */

static int set_up(void **state) {
  (void)state;
  make_folder(folder, sizeof folder);
  put_file(folder, "libpbf.so", LIBPBF_FILE);
  put_file(folder, "list", LIST_PROGRAM);
  return unsetenv("PBF_BACKEND_PATH");
}

static int tear_down(void **state) {
  (void)state;
  drop_folder(folder);
  return unsetenv("PBF_BACKEND_PATH");
}

/* Has nothing in /proc from now on; 0 where that can't be done. */
static int hide_proc(void) {
#if defined(__linux__)
  return unshare(CLONE_NEWNS) == 0 && mount(NULL, "/", NULL, MS_REC | MS_PRIVATE, NULL) == 0 &&
         mount("none", "/proc", "tmpfs", 0, NULL) == 0;
#else
  return 0;
#endif
}

/* Runs the program as it stands in the folder, from `directory`, for a user of no rank if so
 * wished; false when that can't be done here. */
static int try_to_ask(const char *directory, const char *library, int as_nobody, int has_proc) {
  enum { CANT_HIDE = 93 };
  char program[128];
  int ends[2], status = 0;
  snprintf(program, sizeof program, "%s/list", folder);
  assert_int_equal(pipe(ends), 0);
  fflush(NULL);
  pid_t child = fork();
  if (child == 0) {
    dup2(ends[1], STDOUT_FILENO);
    if (chdir(directory) != 0) _exit(90);
    if (!has_proc && !hide_proc()) _exit(CANT_HIDE);
    if (as_nobody && (setgroups(0, NULL) || setgid(65534) || setuid(65534))) _exit(91);
    execl(program, program, library, (char *)NULL);
    _exit(92);
  }
  close(ends[1]);
  size_t used = 0;
  ssize_t got;
  while ((got = read(ends[0], output + used, sizeof output - 1 - used)) > 0) used += (size_t)got;
  output[used] = 0;
  close(ends[0]);
  assert_int_equal(waitpid(child, &status, 0), child);
  assert_true(WIFEXITED(status));
  if (WEXITSTATUS(status) == CANT_HIDE) return 0;
  assert_int_equal(WEXITSTATUS(status), 0);
  return 1;
}

static void ask(const char *directory, const char *library, int as_nobody) {
  try_to_ask(directory, library, as_nobody, 1);
}

static void ask_plainly(void) {
  char library[128];
  snprintf(library, sizeof library, "%s/libpbf.so", folder);
  ask("/", library, 0);
}

static void assert_says(const char *format, const char *a) {
  char line[512];
  snprintf(line, sizeof line, format, a);
  if (!strstr(output, line)) fail_msg("no \"%s\" in\n%s", line, output);
}

static void nothing_there(void **state) {
  (void)state;
  ask_plainly();
  assert_says("serial|0||no pbf_backend_serial.so in %s", folder);
  assert_says("cuda|0||no pbf_backend_cuda.so in %s", folder);
  assert_says("auto|none%s", "");
}

/* Opened by a relative name, in a process that can't ask the kernel where that was. */
static void no_folder_to_look_in(void **state) {
  (void)state;
  if (!try_to_ask(folder, "./libpbf.so", 0, 0)) test_skip("/proc can't be hidden here");
  assert_says("serial|0||no folder to look for pbf_backend_serial.so in: where libpbf%s", " is");
  assert_int_equal(setenv("PBF_BACKEND_PATH", folder, 1), 0);
  put_file(folder, "pbf_backend_serial.so", "stub_serial.so");
  assert_true(try_to_ask(folder, "./libpbf.so", 0, 0));
  assert_says("serial|1|%s/pbf_backend_serial.so|", folder);
}

/* Only then does "auto" take it. */
static void reference_alone(void **state) {
  (void)state;
  put_file(folder, "pbf_backend_reference.so", "stub_reference.so");
  ask_plainly();
  assert_says("reference|1|%s/pbf_backend_reference.so|", folder);
  assert_says("auto|reference%s", "");
}

static void beside_and_below(void **state) {
  (void)state;
  make_subfolder(folder, "pbf");
  make_subfolder(folder, "pbf/backends");
  put_file(folder, "pbf/backends/pbf_backend_serial.so", "stub_serial.so");
  put_file(folder, "pbf/backends/pbf_backend_openmp.so", "stub_openmp.so");
  put_file(folder, "pbf_backend_openmp.so", "stub_openmp.so");
  ask_plainly();
  assert_says("serial|1|%s/pbf/backends/pbf_backend_serial.so|", folder);
  assert_says("openmp|1|%s/pbf_backend_openmp.so|", folder);
  assert_null(strstr(output, "backends/pbf_backend_openmp.so"));
}

/* A candidate that fails keeps its place in the list, and the next folder is tried. */
static void a_failure_is_not_the_end(void **state) {
  (void)state;
  make_subfolder(folder, "pbf");
  make_subfolder(folder, "pbf/backends");
  put_text(folder, "pbf_backend_serial.so", "not an ELF file");
  put_file(folder, "pbf/backends/pbf_backend_serial.so", "stub_serial.so");
  put_file(folder, "pbf/backends/pbf_backend_openmp.so", "stub_serial.so");
  ask_plainly();
  assert_says("serial|0|%s/pbf_backend_serial.so|", folder);
  assert_says("serial|1|%s/pbf/backends/pbf_backend_serial.so|", folder);
  assert_says("it calls itself \"serial\"; its file is that of \"openmp\"%s", "");
  assert_says("auto|serial%s", "");
}

static void the_environment_comes_first(void **state) {
  (void)state;
  char path[256];
  make_subfolder(folder, "one");
  make_subfolder(folder, "two");
  put_file(folder, "pbf_backend_serial.so", "stub_serial.so");
  put_file(folder, "one/pbf_backend_openmp.so", "stub_openmp.so");
  put_file(folder, "two/pbf_backend_openmp.so", "stub_openmp.so");
  put_file(folder, "two/pbf_backend_serial.so", "stub_serial.so");
  snprintf(path, sizeof path, "::relative:%s/one:%s/two:.", folder, folder);
  setenv("PBF_BACKEND_PATH", path, 1);
  ask_plainly();
  assert_says("openmp|1|%s/one/pbf_backend_openmp.so|", folder);
  assert_says("serial|1|%s/two/pbf_backend_serial.so|", folder);
  assert_says("|0|relative|a folder in PBF_BACKEND_PATH that is not absolute%s", "");
  assert_says("|0|.|a folder in PBF_BACKEND_PATH that is not absolute%s", "");
  char *far = calloc(1, 6000);
  memset(far, '/', 5999);
  setenv("PBF_BACKEND_PATH", far, 1);
  free(far);
  ask_plainly();
  assert_says("|0||a folder in PBF_BACKEND_PATH is longer than a path can be%s", "");
}

static double seconds_of_children(void) {
  struct rusage used;
  assert_int_equal(getrusage(RUSAGE_CHILDREN, &used), 0);
  return (double)(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
         1e-6 * (double)(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
}

/* To find what lies in the last of so many folders. */
static double seconds_of_search(uint32_t folders) {
  char *list = malloc(3 * (size_t)folders + sizeof folder), *end = list;
  for (uint32_t k = 0; k < folders; ++k) end = stpcpy(end, "/x:");
  strcpy(end, folder);
  setenv("PBF_BACKEND_PATH", list, 1);
  free(list);
  const double before = seconds_of_children();
  ask_plainly();
  assert_says("serial|1|%s/pbf_backend_serial.so|", folder);
  return seconds_of_children() - before;
}

/* Four times as many take four times as long, not sixteen. */
static void a_long_list(void **state) {
  (void)state;
  put_file(folder, "pbf_backend_serial.so", "stub_serial.so");
  const double some = seconds_of_search(2500), more = seconds_of_search(10000);
  if (more > 8 * some + 0.05) print_error("%g s for 2500 folders, %g for 10000\n", some, more);
  assert_true(more <= 8 * some + 0.05);
}

/* Neither the working directory nor a name by which the library was opened from there. */
static void never_the_working_directory(void **state) {
  (void)state;
  char elsewhere[128], library[160];
  make_subfolder(folder, "cwd");
  snprintf(elsewhere, sizeof elsewhere, "%s/cwd", folder);
  put_file(folder, "cwd/pbf_backend_serial.so", "stub_serial.so");
  snprintf(library, sizeof library, "%s/libpbf.so", folder);
  setenv("PBF_BACKEND_PATH", ".", 1);
  ask(elsewhere, library, 0);
  assert_says("serial|0||no pbf_backend_serial.so in %s", folder);
  put_file(folder, "pbf_backend_openmp.so", "stub_openmp.so");
  ask(elsewhere, "../libpbf.so", 0);
  assert_says("openmp|1|%s/pbf_backend_openmp.so|", folder);
  assert_says("serial|0||no pbf_backend_serial.so in %s", folder);
}

/* Links of packagers: the plugins lie with the real file. */
static void through_a_link(void **state) {
  (void)state;
  char target[128], link[128];
  make_subfolder(folder, "real");
  put_file(folder, "real/libpbf.so", LIBPBF_FILE);
  put_file(folder, "real/pbf_backend_serial.so", "stub_serial.so");
  snprintf(target, sizeof target, "%s/real/libpbf.so", folder);
  snprintf(link, sizeof link, "%s/link.so", folder);
  assert_int_equal(symlink(target, link), 0);
  ask("/", link, 0);
  assert_says("serial|1|%s/real/pbf_backend_serial.so|", folder);
}

/* The program runs as the user nobody, once plainly and once with the rights of another group. */
static void elevated_privileges(void **state) {
  (void)state;
  char program[128], library[128], trap[128];
  if (geteuid() != 0) test_skip("only root can make a program of another group");
  snprintf(program, sizeof program, "%s/list", folder);
  snprintf(library, sizeof library, "%s/libpbf.so", folder);
  snprintf(trap, sizeof trap, "%s/trap", folder);
  make_subfolder(folder, "trap");
  put_file(folder, "trap/pbf_backend_serial.so", "stub_serial.so");
  setenv("PBF_BACKEND_PATH", trap, 1);
  assert_int_equal(chmod(program, 0755), 0);
  ask("/", library, 1);
  assert_says("secure|0%s", "");
  assert_says("serial|1|%s/trap/pbf_backend_serial.so|", folder);
  assert_int_equal(chown(program, 0, 1), 0);
  assert_int_equal(chmod(program, 02755), 0);
  ask("/", library, 1);
  if (strstr(output, "secure|0")) test_skip("this file system grants no such rights");
  assert_null(strstr(output, "trap"));
  assert_says("serial|0||no pbf_backend_serial.so in %s", folder);
}

#define PLACE(test) cmocka_unit_test_setup_teardown(test, set_up, tear_down)

int main(void) {
  const struct CMUnitTest places[] = {
      PLACE(nothing_there),
      PLACE(no_folder_to_look_in),
      PLACE(reference_alone),
      PLACE(beside_and_below),
      PLACE(a_failure_is_not_the_end),
      PLACE(the_environment_comes_first),
      PLACE(a_long_list),
      PLACE(never_the_working_directory),
      PLACE(through_a_link),
      PLACE(elevated_privileges),
  };
  return cmocka_run_group_tests(places, NULL, NULL);
}
