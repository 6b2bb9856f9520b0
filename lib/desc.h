/* Checks of the description that a solver is created from. */
#ifndef PBF_LIB_DESC_H
#define PBF_LIB_DESC_H

#include <pbf/pbf.h>

/* A checked description with a copy of its allocator; desc.allocator is not to be followed. */
typedef struct pbf_checked_desc {
  pbf_desc desc;
  pbf_allocator allocator;
  char backend[PBF_NAME_SIZE];
  char isa[PBF_NAME_SIZE];     /* empty: the best */
  uint32_t isa_by_environment; /* 1: PBF_ISA asked for it, not the description */
  uint32_t worlds;             /* of the batch that the solver is for; 0: of none */
} pbf_checked_desc;

/* `theirs` null: the defaults. */
pbf_status pbf_desc_check(const pbf_desc *theirs, pbf_checked_desc *checked);

/* The instruction set that a backend of this name has to use; null: its choice. A backend that was
 * asked for by name looks into the environment itself, if it has any choice. */
const char *pbf_desc_isa(const pbf_checked_desc *checked, const char *backend);

#endif
