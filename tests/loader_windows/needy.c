/* A plugin that depends on a library which is not where it is. */
#include <pbf/pbf_backend.h>

__declspec(dllimport) int gone(void);
__declspec(dllexport) pbf_status
    pbf_backend_negotiate(const pbf_backend_host *host, pbf_backend_answer *answer);

pbf_status pbf_backend_negotiate(const pbf_backend_host *host, pbf_backend_answer *answer) {
  (void)host, (void)answer;
  return gone() ? PBF_ERROR_UNSUPPORTED : PBF_OK;
}
