#ifndef PBF_LIB_DESC_H
#define PBF_LIB_DESC_H

#include <pbf/pbf.h>

/* A checked description with a copy of its allocator; desc.allocator is not to be followed. */
typedef struct pbf_checked_desc {
  pbf_desc desc;
  pbf_allocator allocator;
  char backend[PBF_NAME_SIZE];
} pbf_checked_desc;

/* `theirs` null: the defaults. */
pbf_status pbf_desc_check(const pbf_desc *theirs, pbf_checked_desc *checked);

#endif
