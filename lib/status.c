#include "status.h"

uint32_t pbf_version(void) {
  return PBF_VERSION_MAJOR * 1000000u + PBF_VERSION_MINOR * 1000u + PBF_VERSION_PATCH;
}

static const char *const names[] = {
    "PBF_OK",
    "PBF_ERROR_INVALID_ARGUMENT",
    "PBF_ERROR_STRUCT_SIZE",
    "PBF_ERROR_OUT_OF_MEMORY",
    "PBF_ERROR_CAPACITY",
    "PBF_ERROR_NOT_FOUND",
    "PBF_ERROR_UNAVAILABLE",
    "PBF_ERROR_UNSUPPORTED",
    "PBF_ERROR_BUSY",
    "PBF_ERROR_STATE",
    "PBF_ERROR_DEVICE",
    "PBF_ERROR_PLUGIN",
    "PBF_ERROR_DATA",
    "PBF_ERROR_CANCELLED",
};

int pbf_status_is_known(pbf_status status) {
  return status <= 0 && status > -(pbf_status)(sizeof names / sizeof names[0]);
}

const char *pbf_status_string(pbf_status status) {
  return pbf_status_is_known(status) ? names[-status] : "unknown pbf_status";
}
