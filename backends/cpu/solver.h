/* The CPU solver of one variant. */
#ifndef PBF_CPU_SOLVER_H
#define PBF_CPU_SOLVER_H

#include "common/memory.h"
#include "cpu/isa.h"
#include "cpu/kernels.h"
#include "cpu/team.h"
#include "physics/schedule.h"

/* Fields change their parts from stage to stage, so that nothing is copied back. */
typedef struct buffers {
  field x, v;     /* the state */
  field spare[4]; /* prediction and its velocity, the same sorted; x*; what later stages need */
  uint32_t *ids;  /* of the state */
  uint32_t *spare_ids;
} buffers;

/* What a thread tells the others between two barriers; on a cache line of its own. */
typedef struct share {
  _Alignas(64) pbf_vec lower;
  pbf_vec upper;
  uint64_t particles; /* in the cells that the thread sorts */
  uint64_t units;     /* of memory for neighbours that its groups want */
} share;

struct pbf_backend_solver {
  pbf_memory memory;
  const pbf_backend_host *host;
  const kernels *kernels;
  cpu_isa isa;
  uint32_t threads;

  pbf_params params;
  pbf_constants constants;
  pbf_schedule schedule;

  uint32_t capacity, count;
  buffers buffers;
  pbf_real *lambda; /* of this iteration, or of all of a step: accelerated, and then also … */
  pbf_real *before; /* … the lambda an iteration earlier */
  pbf_real *slack;  /* in very short steps only */

  /* The sort by cell and id. */
  uint32_t *cells;        /* of the particles in their present order */
  uint32_t *sorted_cells; /* of the sorted ones */
  uint32_t *order;        /* sorted -> present index */
  uint32_t *cell_end;
  uint32_t *chunk_low, *chunk_high; /* lowest and highest cell among CHUNK particles */

  group *groups;
  uint8_t *list_data;
  uint64_t list_units; /* room in it */

  share *shares; /* one a thread */

  int timing;
  double seconds[PBF_STAGE_COUNT];
  uint64_t runs[PBF_STAGE_COUNT];

  double now; /* end of the last step: where walls stand for statistics */
  uint32_t collider_count;
  double collider_time;
  pbf_collider colliders[PBF_MAX_COLLIDERS];
};
typedef struct pbf_backend_solver solver;

/* Particles that threads cut their work by when the order does not matter yet. */
enum { CHUNK = 256 };

static inline uint64_t chunks_of(uint32_t count) { return ((uint64_t)count + CHUNK - 1) / CHUNK; }

static inline uint64_t cell_limit(uint32_t capacity) { return 2 * (uint64_t)capacity + 1024; }

/* Elements of an array of one real for each particle, with room for whole vectors at both ends. */
static inline uint64_t padded(uint32_t capacity) {
  return ((uint64_t)capacity + 15) / 16 * 16 + FIELD_FRONT + FIELD_BACK;
}

#endif
