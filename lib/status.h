/* Status codes. */
#ifndef PBF_LIB_STATUS_H
#define PBF_LIB_STATUS_H

#include <pbf/pbf.h>

/* 1 for a code that this library knows: a plugin may return anything. */
int pbf_status_is_known(pbf_status status);

#endif
