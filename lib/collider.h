#ifndef PBF_LIB_COLLIDER_H
#define PBF_LIB_COLLIDER_H

#include "check.h"

/* `label` is what the message calls it. A geometry must be one that is held. */
pbf_status pbf_collider_check(const pbf_collider *collider, const char *label, pbf_check_kind kind);

/* The same of one on its way, which may have shrunk to nothing. */
pbf_status pbf_collider_check_moving(const pbf_collider *collider, const char *label,
                                     pbf_check_kind kind);

/* As a backend gets it: what the dimension ignores is zero. */
pbf_collider pbf_collider_for_backend(const pbf_collider *collider, uint32_t dimension);

#endif
