#include "registry.h"

#include <stddef.h>

#include "discover.h"
#include "entries.h"
#include "error.h"
#include "lock.h"
#include "os.h"

static const char *const known_names[] = {"reference", "serial", "threads", "openmp", "cuda"};

enum { KNOWN = sizeof known_names / sizeof known_names[0] };

/* Once each, but for those that there were too few descriptors, or too little memory, to look at.
 * Called with the lock held. */
static void search(void) {
  static int searched, settled[KNOWN];
  for (size_t i = 0; i < KNOWN; ++i) {
    if (settled[i]) continue;
    settled[i] = pbf_entries_usable(known_names[i]) || pbf_discover_name(known_names[i]);
  }
  if (!searched) pbf_discover_end();
  searched = 1;
}

uint32_t pbf_registry_count(void) {
  const int cancellation = pbf_uncancelled_begin();
  pbf_lock_take(PBF_LOCK_BACKENDS);
  search();
  uint32_t count = pbf_entries_count();
  pbf_lock_release(PBF_LOCK_BACKENDS);
  pbf_uncancelled_end(cancellation);
  return count;
}

const pbf_plugin *pbf_registry_entry(uint32_t index) {
  return index < pbf_registry_count() ? pbf_entries_at(index) : NULL;
}

pbf_status pbf_load_backend(const char *path) {
  if (!path || !pbf_os_is_absolute(path)) {
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "path is %s%s%s; it must be absolute",
                    path ? "\"" : "", path ? path : "null", path ? "\"" : "");
  }
  pbf_status status = pbf_lock_check();
  if (status != PBF_OK) return status;
  const int cancellation = pbf_uncancelled_begin();
  pbf_lock_take(PBF_LOCK_BACKENDS);
  status = pbf_discover_path(path);
  pbf_lock_release(PBF_LOCK_BACKENDS);
  pbf_uncancelled_end(cancellation);
  return status;
}
