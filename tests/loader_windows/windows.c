/* Paths, what is searched, what is missing, what is damaged. */
#include <stdio.h>
#include <windows.h>

#include "support.h"

#define FOLDER HERE "/fl\xc3\xbcssig \xe6\xb0\xb4" /* fluessig, with its umlaut, and water */

static void wide(const char *text, wchar_t to[1024]) {
  assert_true(MultiByteToWideChar(CP_UTF8, 0, text, -1, to, 1024) > 0);
}

static void copy(const char *from, const char *to) {
  wchar_t source[1024], target[1024];
  wide(from, source);
  wide(to, target);
  assert_true(CopyFileW(source, target, FALSE));
}

static void make_folder(void) {
  wchar_t folder[1024];
  wide(FOLDER, folder);
  CreateDirectoryW(folder, NULL);
}

/* A part of the stub, with a byte changed. */
static void write_damaged(const char *path, long bytes, long changed, int value) {
  FILE *from = fopen(PBF_STUB_DIR "/ballistic.so", "rb"), *to = fopen(path, "wb");
  assert_true(from && to);
  for (long k = 0; k < bytes; ++k) {
    const int byte = fgetc(from);
    if (byte == EOF) break;
    fputc(k == changed ? value : byte, to);
  }
  fclose(from);
  fclose(to);
}

static uint32_t place_of_header(void) {
  unsigned char bytes[4];
  FILE *file = fopen(PBF_STUB_DIR "/ballistic.so", "rb");
  assert_non_null(file);
  fseek(file, 60, SEEK_SET);
  assert_int_equal(fread(bytes, 1, 4, file), 4);
  fclose(file);
  return bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16;
}

static void paths_are_utf8_and_absolute(void **state) {
  (void)state;
  make_folder();
  copy(PBF_STUB_DIR "/ballistic.so", FOLDER "/plugin.dll");
  assert_ok(pbf_load_backend(FOLDER "/plugin.dll"));
  assert_fails(pbf_load_backend("plugin.dll"), PBF_ERROR_INVALID_ARGUMENT, "absolute");
  assert_fails(pbf_load_backend("\\plugin.dll"), PBF_ERROR_INVALID_ARGUMENT, "absolute");
  assert_fails(pbf_load_backend("C:plugin.dll"), PBF_ERROR_INVALID_ARGUMENT, "absolute");
  assert_fails(pbf_load_backend(FOLDER "/not there.dll"), PBF_ERROR_NOT_FOUND, "can't open it");
  assert_fails(pbf_load_backend(FOLDER), PBF_ERROR_UNAVAILABLE, "not a regular file");
}

/* The name of the list's first entry at such a path; null: there is none. */
static const char *listed_at(const char *path, pbf_backend_info *info) {
  for (uint32_t k = 0;; ++k) {
    *info = (pbf_backend_info){.struct_size = sizeof *info};
    if (pbf_get_backend_info(NULL, k, info) != PBF_OK) return NULL;
    if (strstr(info->path, path)) return info->name;
  }
}

static void a_list_of_folders_has_semicolons(void **state) {
  (void)state;
  pbf_backend_info info;
  make_folder();
  copy(PBF_STUB_DIR "/stub_openmp.so", FOLDER "/pbf_backend_openmp.dll");
  wchar_t list[1024] = L"not\\absolute;", folder[1024];
  wide(FOLDER, folder);
  wcscat(list, folder);
  SetEnvironmentVariableW(L"PBF_BACKEND_PATH", list);
  const char *name = listed_at("ssig \xe6\xb0\xb4/pbf_backend_openmp.dll", &info);
  assert_non_null(name);
  assert_string_equal(name, "openmp");
  assert_string_equal(info.reason, "");
  assert_non_null(listed_at("not\\absolute", &info));
  assert_non_null(strstr(info.reason, "not absolute"));
}

static void what_is_missing_has_a_name(void **state) {
  (void)state;
  assert_fails(pbf_load_backend(HERE "/needy.dll"), PBF_ERROR_UNAVAILABLE, "it needs gone.dll");
  SetCurrentDirectoryA(HERE "/apart"); /* where it is: no place to look for it */
  assert_fails(pbf_load_backend(HERE "/needy.dll"), PBF_ERROR_UNAVAILABLE, "it needs gone.dll");
  SetCurrentDirectoryA(HERE);
  make_folder();
  copy(HERE "/needy.dll", FOLDER "/needy.dll");
  copy(HERE "/apart/gone.dll", FOLDER "/gone.dll");
  assert_fails(pbf_load_backend(FOLDER "/needy.dll"), PBF_ERROR_UNSUPPORTED, "it refused");
}

static void what_is_damaged_is_refused(void **state) {
  (void)state;
  const char *path = HERE "/damaged.dll";
  const long machine = (long)place_of_header() + 4;
  const struct {
    long bytes, changed;
    int value;
    const char *words;
  } cases[] = {{0, -1, 0, "it is empty"},
               {1 << 24, 0, 'X', "it is no DLL"},
               {40, -1, 0, "its headers lie beyond its end"},
               {1 << 24, machine, 0x4c, "for another architecture"},
               {1 << 24, machine + 19, 0, "it is a program, and no DLL"},
               {4000, -1, 0, "its sections lie beyond its end"}};
  for (size_t k = 0; k < sizeof cases / sizeof cases[0]; ++k) {
    write_damaged(path, cases[k].bytes, cases[k].changed, cases[k].value);
    assert_fails(pbf_load_backend(path), PBF_ERROR_UNAVAILABLE, cases[k].words);
  }
}

static void a_part_lies_beside(void **state) {
  (void)state;
  make_folder();
  copy(PBF_STUB_DIR "/split.so", FOLDER "/split.dll");
  assert_fails(pbf_load_backend(FOLDER "/split.dll"), PBF_ERROR_UNAVAILABLE,
               "it needs part.so, which is not beside it");
  write_damaged(HERE "/damaged.dll", 4000, -1, 0);
  copy(HERE "/damaged.dll", FOLDER "/part.so");
  assert_fails(pbf_load_backend(FOLDER "/split.dll"), PBF_ERROR_UNAVAILABLE,
               "it needs part.so beside it: it is cut short");
  copy(PBF_STUB_DIR "/part.so", FOLDER "/part.so");
  assert_ok(pbf_load_backend(FOLDER "/split.dll"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_list_of_folders_has_semicolons), /* before the list is made */
      cmocka_unit_test(paths_are_utf8_and_absolute),
      cmocka_unit_test(what_is_missing_has_a_name),
      cmocka_unit_test(what_is_damaged_is_refused),
      cmocka_unit_test(a_part_lies_beside),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
