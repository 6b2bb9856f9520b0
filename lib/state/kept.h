/* Fields that a backend keeps of each particle in some scenes only, and a saved state with it. */
#ifndef PBF_LIB_STATE_KEPT_H
#define PBF_LIB_STATE_KEPT_H

#include "solver/solver.h"

typedef enum pbf_kept {
  PBF_KEPT_REST,
  PBF_KEPT_OVERLAP,
  PBF_KEPT_LAST_PRESSURE, /* states without it begin with none */
  PBF_KEPT_COUNT
} pbf_kept;

/* Memory for one field of each kind; null where it is not kept. */
typedef struct pbf_kept_fields {
  void *data[PBF_KEPT_COUNT];
  uint64_t bytes[PBF_KEPT_COUNT];
} pbf_kept_fields;

/* A bit for each kind that the solver keeps now. */
uint32_t pbf_kept_by(const pbf_solver *solver);

/* PBF_BACKEND_FIELD_… */
uint32_t pbf_kept_field(pbf_kept kept);

uint32_t pbf_kept_components(pbf_kept kept);

/* Bytes of a field of `count` particles with numbers of `precision` bytes; 0 where its bit is not
 * among `kinds`. */
uint64_t pbf_kept_bytes(pbf_kept kept, uint32_t kinds, uint32_t count, uint32_t precision);

/* The fields of these kinds; on failure free has to follow. */
pbf_status pbf_kept_allocate(const pbf_solver *solver, uint32_t kinds, uint32_t count,
                             const char *purpose, pbf_kept_fields *fields);
void pbf_kept_free(const pbf_solver *solver, pbf_kept_fields *fields);

/* To the backend, after the particles with these ids, which they belong to. A backend of another
 * plugin may have no pressures. */
pbf_status pbf_kept_write(pbf_solver *solver, uint32_t count, const uint32_t *ids,
                          const pbf_kept_fields *fields);

#endif
