/* A backend's one function that libpbf calls by name: exported by a plugin; hidden, and with the
 * backend's name, in a static libpbf. The build defines PBF_LINKED_ENTRY in the latter case. */
#ifndef PBF_COMMON_ENTRY_H
#define PBF_COMMON_ENTRY_H

#include <pbf/pbf_backend.h>

#ifdef PBF_LINKED_ENTRY
#define PBF_ENTRY PBF_LINKED_ENTRY
#define PBF_ENTRY_VISIBILITY "hidden"
#else
#define PBF_ENTRY pbf_backend_negotiate
#define PBF_ENTRY_VISIBILITY "default"
#endif

#ifdef __cplusplus
extern "C"
#endif
    __attribute__((visibility(PBF_ENTRY_VISIBILITY))) pbf_status
    PBF_ENTRY(const pbf_backend_host *host, pbf_backend_answer *answer);

#endif
