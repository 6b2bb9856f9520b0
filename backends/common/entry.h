/* A backend's one function that libpbf calls by name: exported by a plugin; hidden, and with the
 * backend's name, in a static libpbf. The build defines PBF_LINKED_ENTRY in the latter case, and
 * PBF_LINKED for what backends share, too. */
#ifndef PBF_COMMON_ENTRY_H
#define PBF_COMMON_ENTRY_H

#include <stdio.h>

#include <pbf/pbf_backend.h>

#include "common/exported.h"

#ifdef PBF_LINKED_ENTRY
#define PBF_ENTRY PBF_LINKED_ENTRY
#else
#define PBF_ENTRY pbf_backend_negotiate
#endif

#ifdef __cplusplus
extern "C"
#endif
    PBF_EXPORTED pbf_status
    PBF_ENTRY(const pbf_backend_host *host, pbf_backend_answer *answer);

/* The answer, under the names that the build gives: PBF_OK, or no version in common. */
static inline pbf_status pbf_entry_answer(const pbf_backend_host *host, const pbf_backend_api *api,
                                          pbf_backend_answer *answer) {
  if (host->abi_min > PBF_BACKEND_ABI_VERSION || host->abi_max < PBF_BACKEND_ABI_VERSION)
    return PBF_ERROR_UNSUPPORTED;
  answer->abi_version = PBF_BACKEND_ABI_VERSION;
  answer->api = api;
  snprintf(answer->name, sizeof answer->name, "%s", PBF_BACKEND_NAME);
  snprintf(answer->build_id, sizeof answer->build_id, "%s", PBF_BUILD_ID);
  return PBF_OK;
}

#endif
