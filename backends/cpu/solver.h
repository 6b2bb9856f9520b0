/* Part of worker.h: the CPU solver of one variant. */
#ifndef PBF_CPU_SOLVER_H
#define PBF_CPU_SOLVER_H

#include "cpu/atomics.h"

#include <pbf/ranks.h>

#include "common/collider_table.h"
#include "common/pressure_grid.h"
#include "cpu/isa.h"
#include "cpu/kernels.h"
#include "cpu/state.h"
#include "cpu/team.h"
#include "cpu/team_worth.h"
#include "physics/loads.h"
#include "physics/schedule.h"

typedef struct range {
  uint32_t first, last; /* up to last - 1 */
} range;

/* The smallest box around some particles. */
typedef struct box {
  pbf_vec lower, upper;
} box;

/* Slabs of a thread that it or others have taken; on a cache line of its own. */
typedef struct slab_counter {
  _Alignas(64) atomic_uint taken;
} slab_counter;

/* The solve on the pressure grid (pressure_grid_solve.h), and its parts where threads share them.
 */
typedef struct pressure_grid_solve {
  pbf_pressure_grid_solve solve;
  int iteration;                /* under way */
  uint32_t in_runs, nodes;      /* in all runs, and with the torn ones */
  uint32_t parts;               /* of an iteration */
  pbf_pressure_grid_box inside; /* nodes of cells that hold particles */
  atomic_uint led, solved;
  _Alignas(64) atomic_ullong next; /* the iteration, and the next of its parts to be taken */
  _Alignas(64) atomic_uint done;   /* parts, of all iterations */
  atomic_uint lacking;             /* 1: a node was missing more than enough */
} pressure_grid_solve;

/* Memory of no fixed size. */
typedef struct rank_memory {
  void *data;
  uint64_t bytes;
} rank_memory;

typedef struct rank_messages {
  pbf_rank_message *list;
  uint32_t count;
} rank_messages;

/* Places in the order of all, and the bins of cells that they are. */
typedef struct rank_run {
  uint32_t first, last;
  uint32_t bin_first, bin_last;
} rank_run;

/* What a rank has in a step: its own particles, and what it holds, which is they and all in reach
 * of them: one run of places, or two in their order where some are beyond a periodic axis' face. */
enum { HELD_RUNS = 2 };
typedef struct rank_share {
  uint32_t own_first, own_last;
  rank_run held[HELD_RUNS];
  uint32_t cell_first, cell_last; /* from the first that is held to the last */
} rank_share;

/* Of one of some ranks: ranks.h. All 0 without. */
typedef struct ranks_state {
  pbf_ranks link;
  uint32_t count, rank;
  pbf_status failed; /* the running call */
  bool lost;         /* with the others, for good; told: and a call has said so */
  bool told;
  char reason[256];

  uint64_t particles; /* a digest of all that callers gave */
  uint64_t settings;  /* and one of what the library keeps itself */
  uint32_t total;     /* particles of all ranks */
  uint32_t before;    /* own ones, before the running step */
  bool lacks;         /* this rank has no memory for its neighbours */
  bool shares_are_fixed;
  double *portions;   /* of the particles, by rank */
  double busy, since; /* seconds */
  uint64_t bytes_sent;

  /* Of the sort: places are those of this solver's arrays. */
  uint32_t pad;                 /* places without a particle before the first one */
  uint32_t own_first, own_last; /* the places of its own, */
  range inner;                  /* and of these the groups that no other rank holds */
  rank_share *shares;
  uint32_t *histogram, *counts;
  uint32_t *ids; /* of what it holds, before the sort */

  void *gathered; /* from all ranks, one thing after another */
  rank_messages sends, receives;
  rank_memory sent, cell_ends;
} ranks_state;

struct pbf_backend_solver {
  pbf_memory memory;
  const pbf_backend_host *host;
  const struct kernels *kernels;
  cpu_isa isa;
  int is_fused;              /* 1: lambda and move have fused multiply-add, … */
  struct kernels with_fused; /* … and `kernels` are these */
  uint32_t threads;          /* at most */
  int threads_by_choice;     /* 1: as many of them as are worth it */
  const struct team_api *team_api;
  struct team *team;
  team_tasks tasks;

  pbf_params params;
  pbf_derived derived; /* from the parameters, as these: */
  pbf_constants constants;
  pbf_schedule schedule;
  pbf_basins basins; /* that the schedule has asked about last */

  uint32_t capacity, count;
  uint32_t local_capacity; /* particles that arrays have room for: capacity without ranks */
  ranks_state ranks;
  uint32_t planned;    /* particles that the schedule is for, */
  double most_left;    /* and the most that steps have left for each layer: plan_steps */
  uint32_t iterations; /* of the last step; changed and read only inside loops of the team */
  int over;            /* … and its solve has ended after them */
  struct buffers buffers;
#define PBF_ARRAY(name, wanted, holders) holders
#define PBF_CPU(type, team_thread, extent) type team_thread;
#include "physics/arrays.def"

  struct pressure_grid_solve pressure_grid_solve;
  pbf_real *lambda;               /* of this iteration, or of all of a step: accelerated */
  pbf_real *added;                /* then what an iteration adds, in sorted_cells; else null */
  pbf_real *packed[2];            /* of what: see packed_positions and those after it */
  uint32_t grid_pressure_pending; /* so many particles, the first, have a lambda without what its
                                     grid added in the last step; positions are those after it */
  pbf_real grid_inv_time_step;    /* of that step */
  pbf_real *pressure;             /* once it has been looked at */
  pbf_real pressure_scale;        /* of the last step */

  pbf_overlap found;      /* for the next step; struct_size 0: none */
  pbf_entering entering;  /* what of it enters */
  int overlaps;           /* some may be left */
  pbf_phase_table phases; /* that differ; count 0: none do */
  uint32_t accelerations; /* whether particles have some */

  pbf_sleep sleep;
  pbf_moving_obstacles moving_obstacles;
  uint32_t asleep;              /* at the end of the last step, or 0 since a particle woke */
  uint32_t wakes_ranks;         /* 1: a collider has left this rank's sleepers, and all wake */
  atomic_uint near_sleep_count; /* asleep, or still enough to sleep: counted in each step, */
  atomic_uint sleepers;         /* as are these */
  atomic_uint all_asleep;       /* 1: the run ends, since all sleep, */
  uint32_t all_asleep_at;       /* with this step */

  /* The sort by cell and id. */
  uint32_t *cells;        /* of the particles in their present order */
  uint32_t *sorted_cells; /* of the sorted ones, until their neighbours are known */
  uint32_t *order;        /* sorted -> present index */
  uint32_t *cell_end;
  uint32_t *chunk_low, *chunk_high; /* lowest and highest cell among CHUNK particles */
  struct grid grid;
  pbf_vec images[IMAGES];  /* of a particle, from where it is */
  pbf_fluid_bounds around; /* the particles that have been sorted, on ranks those of all */

  /* What threads tell each other from loop to loop, by task. */
  box *boxes;
  uint32_t *sample;      /* cells of some particles */
  uint32_t *first_cell;  /* of each range of cells that is sorted in one task, and the end */
  uint32_t *first_place; /* of the particles of each range, and the end */
  list_size *list_sizes;
  uint32_t *first_group; /* of each task of a pass over pairs, and the end */

  /* Lists of neighbours lie in slabs of one size. */
  group *groups;
  uint8_t *list_data;
  uint64_t slab_units;
  uint32_t slabs;
  slab_counter *slab_counters; /* one a thread */
  list_size wanted;            /* by the last search, of all tasks */
  atomic_uint stopped;         /* 1: the run ends for want of it, */
  uint32_t stopped_at;         /* in this step */

  int timing;
  double seconds[PBF_STAGE_COUNT];
  uint64_t runs[PBF_STAGE_COUNT];
  uint64_t skipped; /* iterations among them that a tolerance left empty */

  double now; /* end of the last step: where walls stand for statistics */
  uint32_t collider_count;
  double collider_time;
  pbf_collider_table table;
};
typedef struct pbf_backend_solver solver;

/* That the next run has. */
static inline uint32_t threads_now(const solver *s) {
  return s->threads_by_choice ? team_worth(s->count, s->threads) : s->threads;
}

/* Particles of which the lowest and the highest cell are noted together. */
enum { CHUNK = 256 };

/* Pieces a thread of a loop: over particles, over ranges of cells, of the search, over pairs. More
 * even out better what threads do, and cost more. */
enum { PARTICLE_TASKS = 8, RANGE_PIECES = 2, SEARCH_TASKS = 16, PAIR_TASKS = 64 };

/* Particles of which the cell is looked at to tell the ranges of cells apart. */
enum { SAMPLES_A_RANGE = 4 };

static inline uint64_t chunks_of(uint32_t count) { return ((uint64_t)count + CHUNK - 1) / CHUNK; }

/* Most cells of the grid of so many particles. */
static inline uint64_t cell_limit(uint32_t count) { return 2 * (uint64_t)count + 1024; }

/* Elements of an array of one real for each particle, with room for whole vectors at both ends. */
static inline uint64_t padded(uint32_t capacity) {
  return ((uint64_t)capacity + 15) / 16 * 16 + FIELD_FRONT + FIELD_BACK;
}

/* What loops over pairs look up of neighbours, where they read quads (neighbors.h): positions,
 * which lambda reads, and where phases differ mobilities, … */
static inline pbf_real *packed_positions(const solver *s) { return s->packed[0]; }

/* … and, one after another, the same with lambda, which move reads, with the sizes of curls, or the
 * vectors of the stages after the solve. */
static inline pbf_real *packed_lambda(const solver *s) { return s->packed[1]; }
static inline pbf_real *packed_curl_sizes(const solver *s) { return s->packed[1]; }
static inline pbf_real *packed_missing(const solver *s) { return s->packed[1]; }
static inline pbf_real *packed_vectors(const solver *s) { return s->packed[1]; }

/* A real of each particle, when no iteration is under way: where lambda adds up it is the pressure,
 * and stays. */
static inline pbf_real *scratch_reals(const solver *s) { return s->added ? s->added : s->lambda; }
static inline pbf_real *crowding_of(const solver *s) { return scratch_reals(s); }
static inline pbf_real *curl_sizes(const solver *s) { return scratch_reals(s); }
static inline pbf_real *missing_neighbors_of(const solver *s) { return scratch_reals(s); }
static inline pbf_real *diagnosed_densities(const solver *s) { return scratch_reals(s); }

/* What the pressure grid makes its sums of, before lambda is known. */
static inline pbf_real *grid_densities(const solver *s) { return s->lambda; }

/* A number of each particle that the sort no longer needs: AWAKENED, which no cell is, once
 * something near it wakes its neighbours, in the search and at the end of a step; neighbours in
 * diagnose. */
static inline uint32_t *awakened(const solver *s) { return s->cells; }
static inline uint32_t *neighbor_counts(const solver *s) { return s->cells; }

/* What pressed particles in the last step, by their index before the sort. */
static inline const pbf_real *last_pressures(const solver *s) {
  return s->ranks.count ? s->held_last_pressure : s->last_pressure;
}

#endif
