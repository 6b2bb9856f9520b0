#include "backend_call.h"

#include <stdio.h>

#include "error.h"
#include "status.h"

pbf_status pbf_backend_check_status(const pbf_plugin *plugin, pbf_status status,
                                    const char *function, char *why, size_t size) {
  const char *message = pbf_plugin_message();
  if (status == PBF_OK) return PBF_OK;
  if (!pbf_status_is_known(status)) {
    snprintf(why, size, "the backend \"%s\" returned the unknown status %d from %s", plugin->name,
             status, function);
    return PBF_ERROR_PLUGIN;
  }
  if (message[0]) {
    snprintf(why, size, "%s", message);
  } else {
    snprintf(why, size, "the backend \"%s\" failed in %s with %s and gave no reason", plugin->name,
             function, pbf_status_string(status));
  }
  return status;
}

pbf_status pbf_backend_result(const pbf_solver *solver, pbf_status status, const char *function) {
  char why[PBF_MESSAGE_SIZE];
  if (status == PBF_OK) return PBF_OK;
  status = pbf_backend_check_status(solver->plugin, status, function, why, sizeof why);
  return pbf_fail(status, "%s", why);
}
