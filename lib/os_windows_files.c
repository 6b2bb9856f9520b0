/* Paths, files and libraries of Windows: of a libpbf that loads plugins. From Windows 8 on: its
 * loader looks into no folder that it was not told of. */
#define WIN32_LEAN_AND_MEAN
#define _WIN32_WINNT 0x0602
#include <windows.h>

#include <errno.h>
#include <fcntl.h>
#include <io.h>
#include <share.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <wchar.h>

#include "os.h"
#include "compiler.h"

/* ---- Paths ---------------------------------------------------------------------------------- */

const char pbf_os_list_separator = ';';

/* 0: it is no UTF-8, or too long. */
static int to_wide(const char *path, wchar_t wide[PBF_OS_PATH_SIZE]) {
  if (!MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, path, -1, wide, PBF_OS_PATH_SIZE))
    return 0;
  for (wchar_t *c = wide; *c; ++c) /* what safe loading of libraries wants */
    if (*c == L'/') *c = L'\\';
  return 1;
}

static int to_utf8(const wchar_t *wide, char *text, size_t size) {
  return WideCharToMultiByte(CP_UTF8, 0, wide, -1, text, (int)size, NULL, NULL) > 0;
}

static HMODULE own_module(void) {
  HMODULE own = NULL;
  GetModuleHandleExW(
      GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS | GET_MODULE_HANDLE_EX_FLAG_UNCHANGED_REFCOUNT,
      (LPCWSTR)(uintptr_t)&own_module, &own);
  return own;
}

int pbf_os_own_folder(char *folder, size_t size) {
  wchar_t wide[PBF_OS_PATH_SIZE];
  const HMODULE own = own_module();
  const DWORD length = own ? GetModuleFileNameW(own, wide, PBF_OS_PATH_SIZE) : 0;
  if (length == 0 || length >= PBF_OS_PATH_SIZE) return 0;
  wchar_t *end = wcsrchr(wide, L'\\');
  if (!end) return 0;
  *end = 0;
  if (!to_utf8(wide, folder, size)) return 0;
  for (char *c = folder; *c; ++c)
    if (*c == '\\') *c = '/';
  return 1;
}

const char *pbf_os_name_in(const char *path) {
  const char *name = path;
  for (const char *c = path; *c; ++c)
    if (*c == '/' || *c == '\\') name = c + 1;
  return name;
}

int pbf_os_resolve(const char *path, char *file, size_t size) {
  (void)path, (void)file, (void)size;
  return 0;
}

/* A process that was given more rights has its own user's environment. */
int pbf_os_is_elevated(void) { return 0; }

const char *pbf_os_path_variable(const char *name) {
  static char text[32768];
  static wchar_t value[32768 / 2];
  wchar_t wide[64];
  if (!MultiByteToWideChar(CP_UTF8, 0, name, -1, wide, 64)) return NULL;
  const DWORD length = GetEnvironmentVariableW(wide, value, sizeof value / sizeof value[0]);
  if (length == 0 || length >= sizeof value / sizeof value[0]) return NULL;
  return to_utf8(value, text, sizeof text) ? text : NULL;
}

/* ---- Files ---------------------------------------------------------------------------------- */

int pbf_os_look(const char *path, int *is_regular) {
  wchar_t wide[PBF_OS_PATH_SIZE];
  struct _stat64 file;
  if (!to_wide(path, wide)) return EINVAL;
  if (_wstat64(wide, &file) != 0) return errno;
  *is_regular = (file.st_mode & _S_IFMT) == _S_IFREG;
  return 0;
}

int pbf_os_open(const char *path, int *file, uint64_t *size) {
  wchar_t wide[PBF_OS_PATH_SIZE];
  if (!to_wide(path, wide)) return EINVAL;
  const errno_t failed =
      _wsopen_s(file, wide, _O_RDONLY | _O_BINARY | _O_NOINHERIT, _SH_DENYNO, _S_IREAD);
  if (failed) return failed;
  *size = (uint64_t)_filelengthi64(*file);
  return 0;
}

void pbf_os_close(int file) { _close(file); }

int pbf_os_read(int file, void *bytes, size_t count, uint64_t offset) {
  if (_lseeki64(file, (int64_t)offset, SEEK_SET) < 0) return 0;
  for (size_t done = 0; done < count;) {
    const size_t rest = count - done;
    const int got = _read(file, (char *)bytes + done, rest < 1 << 20 ? (unsigned)rest : 1 << 20);
    if (got == 0) errno = 0;
    if (got <= 0) return 0;
    done += (size_t)got;
  }
  return 1;
}

size_t pbf_os_page(void) {
  SYSTEM_INFO info;
  GetSystemInfo(&info);
  return info.dwPageSize;
}

/* ---- Libraries ------------------------------------------------------------------------------ */

/* The folder of the library that is loaded, the program's, and the system's: never the working
 * directory, nor PATH. */
enum { SEARCH = LOAD_LIBRARY_SEARCH_DLL_LOAD_DIR | LOAD_LIBRARY_SEARCH_DEFAULT_DIRS };

static void describe_failure(DWORD error, char *reason, size_t size) {
  wchar_t wide[256] = L"";
  char text[512] = "";
  FormatMessageW(FORMAT_MESSAGE_FROM_SYSTEM | FORMAT_MESSAGE_IGNORE_INSERTS, NULL, error, 0, wide,
                 sizeof wide / sizeof wide[0], NULL);
  wide[wcscspn(wide, L"\r\n")] = 0;
  to_utf8(wide, text, sizeof text);
  snprintf(reason, size, "Windows can't load it: %.180s (error %lu)", text, error);
}

/* Of the folder that `path` is in. */
static int is_beside(const wchar_t *path, const wchar_t *name) {
  wchar_t file[PBF_OS_PATH_SIZE];
  const wchar_t *end = wcsrchr(path, L'\\');
  if (!end || (size_t)(end - path) + wcslen(name) + 2 > PBF_OS_PATH_SIZE) return 0;
  wmemcpy(file, path, (size_t)(end - path) + 1);
  wcscpy(file + (end - path) + 1, name);
  HMODULE there = LoadLibraryExW(file, NULL, SEARCH);
  if (there) FreeLibrary(there);
  return there != NULL;
}

static int can_be_had(const wchar_t *path, const char *name) {
  wchar_t wide[MAX_PATH];
  if (!MultiByteToWideChar(CP_UTF8, 0, name, -1, wide, MAX_PATH)) return 1;
  HMODULE there = LoadLibraryExW(wide, NULL, LOAD_LIBRARY_SEARCH_DEFAULT_DIRS);
  if (there) FreeLibrary(there);
  return there || is_beside(path, wide);
}

/* Looks at the imports of an image that is mapped and not loaded. */
static const char *missing_import(const wchar_t *path, const unsigned char *image) {
  const IMAGE_DOS_HEADER *dos = (const void *)image;
  const IMAGE_NT_HEADERS *nt = (const void *)(image + dos->e_lfanew);
  const IMAGE_DATA_DIRECTORY *imports =
      &nt->OptionalHeader.DataDirectory[IMAGE_DIRECTORY_ENTRY_IMPORT];
  const IMAGE_IMPORT_DESCRIPTOR *one = (const void *)(image + imports->VirtualAddress);
  if (!imports->VirtualAddress) return NULL;
  for (; one->Name; ++one)
    if (!can_be_had(path, (const char *)image + one->Name)) return (const char *)image + one->Name;
  return NULL;
}

/* The system says only that something is missing. */
static void name_missing(const wchar_t *path, char *reason, size_t size) {
  HMODULE mapped = LoadLibraryExW(path, NULL, LOAD_LIBRARY_AS_IMAGE_RESOURCE);
  if (!mapped) return;
  const char *name =
      missing_import(path, (const unsigned char *)((uintptr_t)mapped & ~(uintptr_t)3));
  if (name)
    snprintf(reason, size,
             "it needs %.100s, which is neither beside it nor in the program's folder", name);
  FreeLibrary(mapped);
}

int pbf_os_is_shortage(int error) { return error == EMFILE || error == ENOMEM; }

static int is_shortage(DWORD error) {
  return error == ERROR_TOO_MANY_OPEN_FILES || error == ERROR_NOT_ENOUGH_MEMORY ||
         error == ERROR_OUTOFMEMORY || error == ERROR_NO_SYSTEM_RESOURCES ||
         error == ERROR_COMMITMENT_LIMIT;
}

int pbf_os_has_thread_key(void) { return 1; }

void *pbf_os_load(const char *path, char *reason, size_t size, int *failed) {
  wchar_t wide[PBF_OS_PATH_SIZE];
  HMODULE pinned;
  if (!to_wide(path, wide)) return snprintf(reason, size, "its path is no UTF-8"), NULL;
  HMODULE library = LoadLibraryExW(wide, NULL, SEARCH);
  if (!library) {
    const DWORD error = GetLastError();
    if (is_shortage(error)) *failed = ENOMEM;
    describe_failure(error, reason, size);
    if (error == ERROR_MOD_NOT_FOUND) name_missing(wide, reason, size);
    return NULL;
  }
  GetModuleHandleExW(GET_MODULE_HANDLE_EX_FLAG_PIN | GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS,
                     (LPCWSTR)(void *)library, &pinned);
  return library;
}

pbf_os_function pbf_os_function_of(void *library, const char *name) {
  return (pbf_os_function)(void (*)(void))GetProcAddress(library, name);
}

const void *pbf_os_own_image(void) { return own_module(); }

/* Backends call back for the life of the process. */
PBF_AT_LOAD(stay) {
  HMODULE own;
  GetModuleHandleExW(GET_MODULE_HANDLE_EX_FLAG_PIN | GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS,
                     (LPCWSTR)(uintptr_t)&stay, &own);
}
