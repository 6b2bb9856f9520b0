#define _GNU_SOURCE
#include "search.h"

#include <dlfcn.h>
#include <inttypes.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "privilege.h"

const char *pbf_search_environment(void) {
  pbf_identity identity = pbf_identity_of_process();
  return pbf_is_elevated(&identity) ? NULL : secure_getenv("PBF_BACKEND_PATH");
}

/* The file mapped where this function is, as the kernel names it. */
static int file_by_map(char *path, size_t size) {
  FILE *maps = fopen("/proc/self/maps", "re");
  if (!maps) return 0;
  uintptr_t here = (uintptr_t)&file_by_map;
  char *line = NULL;
  size_t line_size = 0;
  int found = 0;
  while (!found && getline(&line, &line_size, maps) > 0) {
    uintptr_t first, end;
    if (sscanf(line, "%" SCNxPTR "-%" SCNxPTR, &first, &end) != 2) continue;
    const char *name = strchr(line, '/');
    if (here < first || here >= end || !name) continue;
    found = snprintf(path, size, "%.*s", (int)strcspn(name, "\n"), name) < (int)size;
  }
  free(line);
  fclose(maps);
  return found;
}

/* The folder of libpbf's own file, links resolved. The dynamic loader knows the name by which the
 * library was opened, which may be relative to a working directory long gone. */
static int own_folder(char *folder, size_t size) {
  Dl_info info;
  char path[PATH_MAX], file[PATH_MAX];
  if (!dladdr((void *)(uintptr_t)&pbf_search_folder, &info) || !info.dli_fname) return 0;
  const char *name = info.dli_fname;
  if (name[0] != '/') name = file_by_map(path, sizeof path) ? path : NULL;
  if (!name || !realpath(name, file)) return 0;
  char *slash = strrchr(file, '/');
  *slash = 0;
  return snprintf(folder, size, "%s", file) < (int)size;
}

/* Entry `*index` of a list with colons; counts *index down by the entries there are. */
static pbf_folder list_entry(const char *list, uint32_t *index, char *folder, size_t size) {
  while (*list) {
    size_t length = strcspn(list, ":");
    if (length > 0 && (*index)-- == 0) {
      if (length >= size) return PBF_FOLDER_TOO_LONG;
      memcpy(folder, list, length);
      folder[length] = 0;
      return folder[0] == '/' ? PBF_FOLDER_USABLE : PBF_FOLDER_NOT_ABSOLUTE;
    }
    list += length + (list[length] == ':');
  }
  return PBF_FOLDER_END;
}

pbf_folder pbf_search_folder(uint32_t index, char *folder, size_t size) {
  folder[0] = 0;
  const char *list = pbf_search_environment();
  pbf_folder found = list ? list_entry(list, &index, folder, size) : PBF_FOLDER_END;
  if (found != PBF_FOLDER_END) return found;
  if (index > 1 || !own_folder(folder, size)) return PBF_FOLDER_END;
  if (index == 0) return PBF_FOLDER_USABLE;
  size_t length = strlen(folder);
  return snprintf(folder + length, size - length, "/pbf/backends") < (int)(size - length)
             ? PBF_FOLDER_USABLE
             : PBF_FOLDER_TOO_LONG;
}
