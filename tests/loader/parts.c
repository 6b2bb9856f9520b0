/* Plugins of which a part lies in a file beside them: it is found, and one that is missing, damaged
 * or of another build is refused with the plugin, in words. */
#include <dlfcn.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

#include <pbf/pbf_backend.h>

#include "child.h"

static char folder[64], path[128];

static int set_up(void **state) {
  (void)state;
  make_folder(folder, sizeof folder);
  put_file(folder, "split.so", "split.so");
  snprintf(path, sizeof path, "%s/split.so", folder);
  return 0;
}

static int tear_down(void **state) {
  (void)state;
  drop_folder(folder);
  return unsetenv("PBF_BACKEND_PATH");
}

static const char *words;

static void load_it(void) {
  pbf_desc desc;
  pbf_solver *solver = NULL;
  check_ok(pbf_load_backend(path));
  check_ok(pbf_desc_init(&desc, sizeof desc));
  desc.backend = "split";
  desc.strict = 1;
  desc.capacity = 8;
  check_ok(pbf_create(&desc, NULL, &solver));
  pbf_destroy(solver);
}

static void refuse_it(void) {
  pbf_backend_info info;
  check_fails(pbf_load_backend(path), PBF_ERROR_UNAVAILABLE, words);
  check(find_backend("", path, &info) >= 0 && !info.available && strstr(info.reason, words));
}

static void assert_refused(const char *reason) {
  words = reason;
  in_child(refuse_it);
}

static void beside_the_plugin(void **state) {
  (void)state;
  put_file(folder, "part.so", "part.so");
  in_child(load_it);
}

/* Packagers link single files: the part lies beside the link, or beside what that names. */
static void through_a_link(void **state) {
  (void)state;
  char link[128];
  make_subfolder(folder, "links");
  snprintf(link, sizeof link, "%s/links/split.so", folder);
  assert_int_equal(symlink(path, link), 0);
  memcpy(path, link, sizeof path);
  assert_refused("it needs part.so, which is not beside it");
  put_file(folder, "links/part.so", "part.so");
  in_child(load_it);
  snprintf(link, sizeof link, "%s/links/part.so", folder);
  assert_int_equal(remove(link), 0);
  put_file(folder, "part.so", "part.so");
  in_child(load_it);
}

static void not_there(void **state) {
  (void)state;
  assert_refused("it needs part.so, which is not beside it");
}

static void cut_short(void **state) {
  (void)state;
  char part[128];
  struct stat whole;
  snprintf(part, sizeof part, "%s/part.so", folder);
  for (int k = 1; k < 20; ++k) {
    put_file(folder, "part.so", "part.so");
    assert_int_equal(stat(part, &whole), 0);
    assert_int_equal(truncate(part, whole.st_size * k / 20), 0);
    assert_refused("it needs part.so beside it: it is cut short: its ");
  }
  put_text(folder, "part.so", "none");
  assert_refused("it needs part.so beside it: it is no shared object");
}

static void no_part(void **state) {
  (void)state;
  put_file(folder, "part.so", "ballistic.so");
  assert_refused("it needs part.so beside it, which exports no function pbf_backend_part");
}

/* ---- The CPU backends ----------------------------------------------------------------------- */

static int has_serial(void) { return access(BACKEND_DIR "/pbf_backend_serial.so", R_OK) == 0; }

static void take_serial(void) {
  if (!has_serial()) test_skip("built without serial");
  put_file(folder, "split.so", BACKEND_DIR "/pbf_backend_serial.so");
}

static void core_is_missing(void **state) {
  (void)state;
  take_serial();
  assert_refused("it needs pbf_cpu.so, which is not beside it");
}

static void core_is_of_another_build(void **state) {
  (void)state;
  take_serial();
  put_file(folder, "pbf_cpu.so", "part.so");
  assert_refused("it needs pbf_cpu.so beside it, and that one is of another build");
}

static char said[256];
static void note(const char *sentence) { snprintf(said, sizeof said, "%s", sentence); }

/* As libraries were before there were parts. */
static void ask_with_an_older_host(void) {
  const pbf_backend_host host = {.struct_size = offsetof(pbf_backend_host, load_part),
                                 .abi_min = PBF_BACKEND_ABI_VERSION,
                                 .abi_max = PBF_BACKEND_ABI_VERSION,
                                 .set_error = note};
  pbf_backend_answer answer = {.struct_size = sizeof answer};
  pbf_backend_negotiate_fn entry;
  void *plugin = dlopen(BACKEND_DIR "/pbf_backend_serial.so", RTLD_NOW);
  check(plugin != NULL);
  *(void **)&entry = dlsym(plugin, PBF_BACKEND_ENTRY);
  check(entry(&host, &answer) == PBF_ERROR_UNAVAILABLE);
  check(strstr(said, "it needs pbf_cpu.so, which this version of libpbf does not load"));
}

static void host_is_older(void **state) {
  (void)state;
  if (!has_serial()) test_skip("built without serial");
  in_child(ask_with_an_older_host);
}

/* A folder with a plugin that lacks its part is not the last one. */
static void fall_back(void) {
  pbf_backend_info info;
  check(find_backend("serial", path, &info) >= 0 && !info.available);
  check(strstr(info.reason, "it needs pbf_cpu.so, which is not beside it"));
  check(find_backend("serial", BACKEND_DIR "/pbf_backend_serial.so", &info) >= 0 && info.available);
}

static void the_next_folder_is_tried(void **state) {
  (void)state;
  char list[256];
  if (!has_serial()) test_skip("built without serial");
  put_file(folder, "pbf_backend_serial.so", BACKEND_DIR "/pbf_backend_serial.so");
  snprintf(path, sizeof path, "%s/pbf_backend_serial.so", folder);
  snprintf(list, sizeof list, "%s:" BACKEND_DIR, folder);
  setenv("PBF_BACKEND_PATH", list, 1);
  in_child(fall_back);
}

#define PART(test) cmocka_unit_test_setup_teardown(test, set_up, tear_down)

int main(void) {
  const struct CMUnitTest parts[] = {
      PART(beside_the_plugin),
      PART(through_a_link),
      PART(not_there),
      PART(cut_short),
      PART(no_part),
      PART(core_is_missing),
      PART(core_is_of_another_build),
      PART(host_is_older),
      PART(the_next_folder_is_tried),
  };
  return cmocka_run_group_tests(parts, NULL, NULL);
}
