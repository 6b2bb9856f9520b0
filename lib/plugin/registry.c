#include "registry.h"

#include <pthread.h>
#include <stddef.h>

#include "discover.h"
#include "entries.h"
#include "error.h"

static const char *const known_names[] = {"reference", "serial", "openmp", "cuda"};

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static int searched;

/* Called with the lock held. */
static void search_once(void) {
  if (searched) return;
  searched = 1;
  for (size_t i = 0; i < sizeof known_names / sizeof known_names[0]; ++i) {
    if (!pbf_entries_usable(known_names[i])) pbf_discover_name(known_names[i]);
  }
  pbf_discover_end();
}

uint32_t pbf_registry_count(void) {
  pthread_mutex_lock(&lock);
  search_once();
  uint32_t count = pbf_entries_count();
  pthread_mutex_unlock(&lock);
  return count;
}

const pbf_plugin *pbf_registry_entry(uint32_t index) {
  return index < pbf_registry_count() ? pbf_entries_at(index) : NULL;
}

pbf_status pbf_load_backend(const char *path) {
  if (!path || path[0] != '/') {
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "path is %s%s%s; it must be absolute",
                    path ? "\"" : "", path ? path : "null", path ? "\"" : "");
  }
  pthread_mutex_lock(&lock);
  pbf_status status = pbf_discover_path(path);
  pthread_mutex_unlock(&lock);
  return status;
}
