/* A saved state, read from a buffer and checked, before anything of the solver changes. */
#ifndef PBF_LIB_STATE_SAVED_STATE_H
#define PBF_LIB_STATE_SAVED_STATE_H

#include "diffuse/diffuse.h"
#include "emission/emission.h"
#include "particles/phases.h"
#include "snapshot.h"

typedef struct pbf_saved_state {
  pbf_snapshot_header header;
  pbf_snapshot_layout layout;
  const unsigned char *buffer;
  pbf_params params;
  double time;
  pbf_collider *colliders; /* null when there are none */
  uint32_t collider_holds; /* so many have references to what they are made of */
  uint32_t *ids;           /* `capacity` long */
  void *positions;
  void *velocities;
  pbf_kept_fields kept;
  void *accelerations;    /* as the solver's own, or null */
  pbf_emission *emission; /* or null */
  pbf_phases *phases;     /* or null */
  pbf_diffuse *diffuse;   /* or null */
} pbf_saved_state;

/* Fails with PBF_ERROR_DATA for what pbf_save did not write, and unless the solver can hold it. */
pbf_status pbf_saved_state_read(pbf_solver *solver, const void *buffer, uint64_t size,
                                pbf_saved_state *in);

/* The same as far as the size, the kind and the checksum tell it. What the state names, as shapes,
 * may be made later. */
pbf_status pbf_saved_state_check(const pbf_solver *solver, const void *buffer, uint64_t size);

/* Whatever a solver is to own must be null in `in` by now. */
void pbf_saved_state_free(pbf_solver *solver, pbf_saved_state *in);

#endif
