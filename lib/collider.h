#ifndef PBF_LIB_COLLIDER_H
#define PBF_LIB_COLLIDER_H

#include "check.h"

/* `index` is for the message. A geometry must be one that is held. */
pbf_status pbf_collider_check(const pbf_collider *collider, uint32_t index, pbf_check_kind kind);

/* As a backend gets it: what the dimension ignores is zero. */
pbf_collider pbf_collider_for_backend(const pbf_collider *collider, uint32_t dimension);

#endif
