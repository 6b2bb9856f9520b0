#include "search.h"

#include <stdio.h>
#include <string.h>

#include "os.h"

static const char *list_of_environment(void) {
  return pbf_os_is_elevated() ? NULL : pbf_os_path_variable("PBF_BACKEND_PATH");
}

static pbf_folder list_entry(const char *list, size_t *passed, char *folder, size_t size) {
  const char separators[] = {pbf_os_list_separator, 0};
  const char *entry = list + strnlen(list, *passed);
  entry += strspn(entry, separators);
  const size_t length = strcspn(entry, separators);
  if (length == 0) return PBF_FOLDER_END;
  *passed = (size_t)(entry - list) + length;
  if (length >= size) return PBF_FOLDER_TOO_LONG;
  memcpy(folder, entry, length);
  folder[length] = 0;
  return pbf_os_is_absolute(folder) ? PBF_FOLDER_USABLE : PBF_FOLDER_NOT_ABSOLUTE;
}

pbf_folder pbf_search_next(pbf_search *search, char *folder, size_t size) {
  folder[0] = 0;
  const char *list = list_of_environment();
  pbf_folder found = list ? list_entry(list, &search->passed, folder, size) : PBF_FOLDER_END;
  if (found != PBF_FOLDER_END) return found;
  const uint32_t own = search->own++;
  if (own > 1 || !pbf_os_own_folder(folder, size)) return PBF_FOLDER_END;
  if (own == 0) return PBF_FOLDER_USABLE;
  size_t length = strlen(folder);
  return snprintf(folder + length, size - length, "/pbf/backends") < (int)(size - length)
             ? PBF_FOLDER_USABLE
             : PBF_FOLDER_TOO_LONG;
}
