#include "search.h"

#include <stdio.h>
#include <string.h>

#include "os.h"

static const char *list_of_environment(void) {
  return pbf_os_is_elevated() ? NULL : pbf_os_path_variable("PBF_BACKEND_PATH");
}

/* Entry `*index` of a list; counts *index down by the entries there are. */
static pbf_folder list_entry(const char *list, uint32_t *index, char *folder, size_t size) {
  while (*list) {
    const char separator[] = {pbf_os_list_separator, 0};
    size_t length = strcspn(list, separator);
    if (length > 0 && (*index)-- == 0) {
      if (length >= size) return PBF_FOLDER_TOO_LONG;
      memcpy(folder, list, length);
      folder[length] = 0;
      return pbf_os_is_absolute(folder) ? PBF_FOLDER_USABLE : PBF_FOLDER_NOT_ABSOLUTE;
    }
    list += length + (list[length] != 0);
  }
  return PBF_FOLDER_END;
}

pbf_folder pbf_search_folder(uint32_t index, char *folder, size_t size) {
  folder[0] = 0;
  const char *list = list_of_environment();
  pbf_folder found = list ? list_entry(list, &index, folder, size) : PBF_FOLDER_END;
  if (found != PBF_FOLDER_END) return found;
  if (index > 1 || !pbf_os_own_folder(folder, size)) return PBF_FOLDER_END;
  if (index == 0) return PBF_FOLDER_USABLE;
  size_t length = strlen(folder);
  return snprintf(folder + length, size - length, "/pbf/backends") < (int)(size - length)
             ? PBF_FOLDER_USABLE
             : PBF_FOLDER_TOO_LONG;
}
