/* Plugins that break a rule: each refused with its reason, and listed. */
#include <stdio.h>
#include <sys/stat.h>

#include "child.h"

static const struct {
  int defect;
  pbf_status status;
  const char *words;
} broken[] = {
    {1, PBF_ERROR_UNSUPPORTED, "it speaks version 2 of the plugin ABI; this library speaks 3 … 3"},
    {2, PBF_ERROR_UNSUPPORTED, "it speaks version 4"},
    {3, PBF_ERROR_UNSUPPORTED, "the stub likes no host"},
    {4, PBF_ERROR_PLUGIN, "it gave no reason"},
    {5, PBF_ERROR_PLUGIN, "it gave no table"},
    {6, PBF_ERROR_PLUGIN, "no function 'map'"},
    {7, PBF_ERROR_PLUGIN, "its table of functions has"},
    {8, PBF_ERROR_PLUGIN, "one of set_timing and get_timings"},
    {9, PBF_ERROR_PLUGIN, "its name is not a text"},
    {10, PBF_ERROR_PLUGIN, "its name is not a text"},
    {11, PBF_ERROR_PLUGIN, "its name is not a text"},
    {12, PBF_ERROR_PLUGIN, "other than \"auto\""},
    {13, PBF_ERROR_PLUGIN, "exports no function pbf_backend_negotiate"},
    {14, PBF_ERROR_PLUGIN, "its build id is not a text"},
};

static void check_listed(const char *path, const char *words) {
  uint32_t count = 0;
  check_ok(pbf_get_backend_count(&count));
  for (uint32_t i = 0; i < count; ++i) {
    pbf_backend_info info = {.struct_size = sizeof info};
    check_ok(pbf_get_backend_info(NULL, i, &info));
    if (strcmp(info.path, path) != 0) continue;
    check(!info.available && info.score == 0);
    check(strstr(info.reason, words));
    return;
  }
  check(!"the candidate that failed is listed");
}

static void refuse_all(void) {
  for (size_t i = 0; i < sizeof broken / sizeof broken[0]; ++i) {
    char path[1024];
    snprintf(path, sizeof path, PBF_STUB_DIR "/broken%d.so", broken[i].defect);
    check_fails(pbf_load_backend(path), broken[i].status, broken[i].words);
    check_fails(pbf_load_backend(path), broken[i].status, path); /* again, and named */
    check_listed(path, broken[i].words);
  }
  uint32_t before = 0, after = 0;
  check_ok(pbf_get_backend_count(&before));
  check_fails(pbf_load_backend(PBF_STUB_DIR "/broken1.so"), PBF_ERROR_UNSUPPORTED, "version 2");
  check_ok(pbf_get_backend_count(&after));
  check(before == after); /* the same failure is not listed twice */
}

static void broken_plugins(void **state) {
  (void)state;
  in_child(refuse_all);
}

static char folder[64];

static void refuse_files(void) {
  char path[1024];
  snprintf(path, sizeof path, "%s/text.so", folder);
  check_fails(pbf_load_backend(path), PBF_ERROR_UNAVAILABLE, "text.so");
  check_listed(path, "it is no shared object");
  snprintf(path, sizeof path, "%s/empty.so", folder);
  check_fails(pbf_load_backend(path), PBF_ERROR_UNAVAILABLE, "it is empty");
  check_fails(pbf_load_backend(folder), PBF_ERROR_UNAVAILABLE, "not a regular file");
  snprintf(path, sizeof path, "%s/pipe.so", folder);
  check_fails(pbf_load_backend(path), PBF_ERROR_UNAVAILABLE, "not a regular file");
  snprintf(path, sizeof path, "%s/none.so", folder);
  check_fails(pbf_load_backend(path), PBF_ERROR_NOT_FOUND, "No such file");
  snprintf(path, sizeof path, "%s/text.so/none.so", folder);
  check_fails(pbf_load_backend(path), PBF_ERROR_UNAVAILABLE, "Not a directory");
  check_fails(pbf_load_backend("ballistic.so"), PBF_ERROR_INVALID_ARGUMENT,
              "path is \"ballistic.so\"; it must be absolute");
  check_fails(pbf_load_backend("./ballistic.so"), PBF_ERROR_INVALID_ARGUMENT, "absolute");
  check_fails(pbf_load_backend(""), PBF_ERROR_INVALID_ARGUMENT, "absolute");
}

static void files_that_are_none(void **state) {
  (void)state;
  char path[128];
  make_folder(folder, sizeof folder);
  put_text(folder, "text.so", "not an ELF file");
  put_text(folder, "empty.so", "");
  snprintf(path, sizeof path, "%s/pipe.so", folder);
  assert_int_equal(mkfifo(path, 0600), 0);
  in_child(refuse_files);
  drop_folder(folder);
}

static void load_two_of_one_name(void) {
  pbf_backend_info info;
  check_ok(pbf_load_backend(PBF_STUB_DIR "/ballistic.so"));
  check_ok(pbf_load_backend(PBF_STUB_DIR "/ballistic.so"));
  check_fails(pbf_load_backend(PBF_STUB_DIR "/ballistic_twin.so"), PBF_ERROR_INVALID_ARGUMENT,
              "its name \"ballistic\" is taken by " PBF_STUB_DIR "/ballistic.so");
  check(find_backend("ballistic", PBF_STUB_DIR "/ballistic.so", &info) >= 0);
  check(info.available == 1 && info.score == 1 && info.reason[0] == 0);
  check(strcmp(info.build_id, "stub") == 0 && strcmp(info.device_name, "a stub") == 0);
  check(find_backend("ballistic", PBF_STUB_DIR "/ballistic_twin.so", &info) >= 0);
  check(info.available == 0 && strstr(info.reason, "is taken by"));
}

static void two_of_one_name(void **state) {
  (void)state;
  in_child(load_two_of_one_name);
}

/* Tables of an older and of a later header are fine. */
static void load_other_tables(void) {
  pbf_backend_info info;
  pbf_desc desc = test_desc(3, PBF_FLOAT32, 8);
  pbf_solver *solver = NULL;
  check_ok(pbf_load_backend(PBF_STUB_DIR "/broken15.so"));
  check_ok(pbf_load_backend(PBF_STUB_DIR "/broken16.so"));
  check(find_backend("broken15", NULL, &info) >= 0 && info.available);
  check(find_backend("broken16", NULL, &info) >= 0 && info.available);
  check(strlen(info.device_name) == sizeof info.device_name - 1); /* it has no end of its own */
  desc.backend = "broken16";
  check_fails(pbf_create(&desc, NULL, &solver), PBF_ERROR_DEVICE,
              "failed in create with PBF_ERROR_DEVICE and gave no reason");
}

static void tables_of_other_headers(void **state) {
  (void)state;
  in_child(load_other_tables);
}

static void load_bad_probes(void) {
  pbf_backend_info info;
  check_ok(pbf_load_backend(PBF_STUB_DIR "/broken17.so"));
  check_ok(pbf_load_backend(PBF_STUB_DIR "/broken18.so"));
  check_ok(pbf_load_backend(PBF_STUB_DIR "/failing_probe.so"));
  check(find_backend("broken17", NULL, &info) >= 0 && !info.available);
  check(strstr(info.reason, "a type of device that this library does not know"));
  check(find_backend("broken18", NULL, &info) >= 0 && !info.available && info.score == 0);
  check(strstr(info.reason, "its probe gave no reason"));
  check(find_backend("failing", NULL, &info) >= 0 && !info.available);
  check(strcmp(info.reason, "the stub's probe always fails") == 0);
}

static void bad_probes(void **state) {
  (void)state;
  in_child(load_bad_probes);
}

static void ask_beyond_the_list(void) {
  uint32_t count = 0;
  pbf_backend_info info = {.struct_size = sizeof info};
  check_ok(pbf_get_backend_count(&count));
  check_fails(pbf_get_backend_info(NULL, count, &info), PBF_ERROR_NOT_FOUND, "entries");
  check_fails(pbf_get_backend_info(NULL, UINT32_MAX, &info), PBF_ERROR_NOT_FOUND, "4294967295");
}

static void beyond_the_list(void **state) {
  (void)state;
  in_child(ask_beyond_the_list);
}

static void check_builtin_found(void) {
  static const char *const names[] = {"reference", "serial", "openmp", "cuda"};
  pbf_backend_info info;
  pbf_desc desc;
  pbf_solver *solver = NULL;
  for (int i = 0; i < 4; ++i) check(find_backend(names[i], NULL, &info) >= 0);
  check(find_backend("serial", NULL, &info) >= 0 && info.available);
  check_ok(pbf_desc_init(&desc, sizeof desc));
  desc.capacity = 8;
  desc.backend = "serial";
  desc.strict = 1;
  check_ok(pbf_create(&desc, NULL, &solver));
  pbf_destroy(solver);
}

/* In a process of its own, where the search finds one backend. */
static void beside_a_serial(void (*call)(void)) {
  make_folder(folder, sizeof folder);
  put_file(folder, "pbf_backend_serial.so", "stub_serial.so");
  setenv("PBF_BACKEND_PATH", folder, 1);
  in_child(call);
  unsetenv("PBF_BACKEND_PATH");
  drop_folder(folder);
}

/* More failures than the list has room for lose nothing but their place in it. */
static void overfill(void) {
  char path[1024];
  for (int i = 0; i < 100; ++i) {
    snprintf(path, sizeof path, "%s/none%d.so", "/nowhere", i);
    check_fails(pbf_load_backend(path), PBF_ERROR_NOT_FOUND, path);
  }
  check_ok(pbf_load_backend(PBF_STUB_DIR "/ballistic.so"));
  check_builtin_found();
}

static void a_list_full_of_failures(void **state) {
  (void)state;
  beside_a_serial(overfill);
}

/* Nor do plugins that the caller loads keep out those that come with the library. */
static void fill_with_plugins(void) {
  char path[1024], name[16];
  int loaded = 0;
  for (int i = 0; i < 70; ++i) {
    snprintf(name, sizeof name, "plugin-%02d", i);
    snprintf(path, sizeof path, "%s/%s", folder, name);
    put_file(folder, name, "ballistic.so");
    setenv("PBF_STUB_NAME", name, 1);
    loaded += pbf_load_backend(path) == PBF_OK;
  }
  unsetenv("PBF_STUB_NAME");
  check(loaded > 40 && loaded < 70);
  check_fails(pbf_load_backend(path), PBF_ERROR_CAPACITY, "is full");
  check_builtin_found();
}

static void a_list_full_of_plugins(void **state) {
  (void)state;
  beside_a_serial(fill_with_plugins);
}

/* Broken files of one name in many folders before a whole one of the next name. */
static void search_past_failures(void) { check_builtin_found(); }

static void folders_full_of_failures(void **state) {
  (void)state;
  static char list[70 * 80];
  make_folder(folder, sizeof folder);
  for (int i = 0; i < 70; ++i) {
    char name[16], text[128];
    snprintf(name, sizeof name, "%d", i);
    make_subfolder(folder, name);
    snprintf(text, sizeof text, "%s/pbf_backend_reference.so", name);
    put_text(folder, text, "text");
    snprintf(list + strlen(list), sizeof list - strlen(list), "%s%s/%d", i ? ":" : "", folder, i);
  }
  put_file(folder, "69/pbf_backend_serial.so", "stub_serial.so");
  setenv("PBF_BACKEND_PATH", list, 1);
  in_child(search_past_failures);
  unsetenv("PBF_BACKEND_PATH");
  drop_folder(folder);
}

int main(void) {
  const struct CMUnitTest plugins[] = {
      cmocka_unit_test(broken_plugins),
      cmocka_unit_test(files_that_are_none),
      cmocka_unit_test(two_of_one_name),
      cmocka_unit_test(tables_of_other_headers),
      cmocka_unit_test(bad_probes),
      cmocka_unit_test(beyond_the_list),
      cmocka_unit_test(a_list_full_of_failures),
      cmocka_unit_test(a_list_full_of_plugins),
      cmocka_unit_test(folders_full_of_failures),
  };
  return cmocka_run_group_tests(plugins, NULL, NULL);
}
