/* Emitters, drains and lifetimes in a saved state: the head, sources, drains, births, none of them
 * where a solver never had any. */
#ifndef PBF_LIB_EMISSION_SAVED_H
#define PBF_LIB_EMISSION_SAVED_H

#include "emission.h"

/* Bytes; 0 where there is nothing to save. */
uint64_t pbf_emission_saved_size(const pbf_solver *solver);

/* Writes these bytes. */
void pbf_emission_save(const pbf_solver *solver, void *buffer);

/* As many, of what acts alone: what shapes and the dimension ignore, and may be anything, is as the
 * functions that initialize the structs give it. */
void pbf_emission_put_clean(const pbf_solver *solver, void *buffer);

/* A new one from `size` bytes, checked, of a state with these parameters and ids below `next_id`;
 * null for none. */
pbf_status pbf_emission_read(pbf_solver *solver, const void *buffer, uint64_t size,
                             uint64_t next_id, pbf_emission **emission);

#endif
