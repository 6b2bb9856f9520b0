/* What the host keeps of a solver. */
#ifndef PBF_LIB_SOLVER_SOLVER_H
#define PBF_LIB_SOLVER_SOLVER_H

#include <stdatomic.h>

#include "check.h"
#include "common/fp_environment.h"
#include "plugin/plugin.h"

enum { PBF_FIELD_COUNT = PBF_FIELD_PRESSURE + 1 };

/* What has been placed in fluid that steps have moved: overlap.h. */
typedef struct pbf_overlap_state {
  pbf_overlap found; /* placed since the last step; struct_size 0: nothing */
  double end;        /* when nothing is left of what was placed before it; 0: nothing was */
  double time_step;  /* of the last step, or of one before it that was much alike; 0: none yet */
  double error;      /* that it left for each layer of fluid at rest: physics/steps_leave.h; */
  double most;       /* that any step has left, */
  double left;       /* and it under all of the fluid */
  double reference;  /* as much as it would have left of the error that there was at `since`, … */
  double since;      /* … and which comes to be `left` … */
  double rate;       /* … exponentially */
  uint32_t moved;    /* 1: steps have moved the particles that there are */
  uint32_t reserved; /* 0 */
} pbf_overlap_state;

/* How places have been set since the last step: prestabilize.h. */
/* How particles have been placed: all places, or what density they have, are other ones; whether
 * two are at one point has not been looked for; some were, and have been set apart. */
enum { PBF_PLACES_SET_ANEW = 1, PBF_PLACES_UNSEEN = 2, PBF_PLACES_PARTED = 4, PBF_PLACES_ALL = 7 };

typedef struct pbf_placement {
  uint64_t places;          /* of these */
  uint64_t shifted;         /* 1: colliders have jumped, */
  uint64_t colliders;       /* these, a bit each of the first 64 (colliders.h), … */
  double collider_shift[3]; /* … all alike */
  double shift[3];          /* of all particles alike */
  double wall_shift[6];     /* of each wall */
} pbf_placement;

enum { PBF_MAX_BLOCKS = 96 };

typedef struct pbf_block {
  void *memory;
  uint64_t size, alignment;
} pbf_block;

/* The caller's functions, and where they run: callbacks.h. */
typedef struct pbf_callbacks {
  pbf_allocator allocator;
  pbf_log_fn log; /* or null */
  void *log_user;
  uintptr_t thread;           /* of the running call, or the last one */
  const void *volatile frame; /* on its stack, of a callback that runs; null: none does */
  uint64_t calls;             /* of them, so far */
  uint32_t block_count;       /* blocks that the solver has, as many as there is room for */
  pbf_block blocks[PBF_MAX_BLOCKS];
} pbf_callbacks;

/* Why a solver can do nothing any more but be destroyed. */
typedef enum pbf_left {
  PBF_LEFT_NOT,
  PBF_LEFT_BY_CALLBACK, /* an exception, a longjmp or a thread's end has left a call halfway */
  PBF_LEFT_BY_FORK      /* another thread was inside when this process was forked off */
} pbf_left;

/* Of steps that pbf_begin_step has begun. */
typedef enum pbf_begun {
  PBF_BEGUN_NOT,
  PBF_BEGUN_STEPS,
  PBF_BEGUN_ENDING, /* a thread waits for them */
  PBF_BEGUN_ALONE   /* a callback of theirs has destroyed the solver: none will wait */
} pbf_begun;

/* What views of a field show on ranks: particles/rank_views.h. */
typedef struct pbf_rank_copy {
  void *data;
  uint64_t bytes;
} pbf_rank_copy;

struct pbf_solver {
  /* Guarded by the lock in handles.c. */
  pbf_solver *next_live;
  uint32_t references;             /* the handle, a running call, every exported tensor */
  uint32_t in_call;                /* 1: a call is running */
  uint32_t exported;               /* tensors that are not deleted yet */
  struct pbf_snapshots *snapshots; /* for other threads; null: none are made */
  pbf_left left;
  pbf_begun begun;
  uint32_t in_batch;          /* 1: it ends with its batch, not by pbf_destroy */
  _Atomic uint32_t cancelled; /* 1: the running call is to end after its present step */
  _Atomic uint32_t destroyed; /* 1: a call that still runs logs no more */

  /* Belongs to the running call. */
  struct pbf_worker *worker;     /* which runs what is begun: worker.h; null: none has begun */
  pbf_fp_environment callers_fp; /* the environment of the thread that it came from */
  int callers_cancellation;      /* its state, see os.h */
  pbf_allocator allocator;       /* these three lead to the caller's own: */
  pbf_log_fn log;
  void *log_user;
  pbf_callbacks callbacks;
  pbf_ranks ranks; /* count 0: alone */
  uint32_t untold; /* steps since ranks have told each other whether their call is cancelled, … */
  uint32_t told;   /* … and 1: it is */
  uint64_t rank_settings; /* a number of all that rank_settings.h has been given */
  const pbf_plugin *plugin;
  pbf_backend_api api; /* the table of this solver's variant */
  pbf_backend_solver *backend;
  pbf_check_kind kind;
  uint32_t capacity;
  int32_t device;
  double work_at_once; /* particles by iterations by steps that a backend does in some 20 ms */
  uint32_t on_device;  /* 1: its steps go on after the backend's call of them */
  uint32_t fell_back;
  char fallback_reason[256];

  pbf_params params; /* as the caller set them */

  uint32_t collider_count;
  pbf_collider *colliders; /* as set, at collider_time; null when there are none */
  double collider_time;
  uint32_t brought_count; /* of the running call: with references, and not the solver's own yet */
  const pbf_collider *brought;

  uint32_t count;
  uint32_t planned;       /* particles that the last step's plan was for, see plan.h */
  uint32_t planned_there; /* the same as the backend knows it, … */
  double most_there;      /* … and overlap.most */
  uint64_t next_id;
  uint32_t *ids; /* ascending, `capacity` long; null while they are 0 … count - 1 */

  /* time = time_base + steps_since * time_step: rounding errors do not add up. */
  uint64_t step;
  uint64_t steps_since;
  double time_base;

  uint32_t substeps;      /* of the last step */
  double time_step_there; /* as the backend has it: params.time_step, or a part */
  uint32_t part, parts;   /* of a step that is made part by part; 0, 0: none */
  uint32_t said; /* PBF_LIMIT_…, a bit each: steps are too long for it, and it was said */
  uint32_t step_length_checked; /* 1: nothing has changed since by which steps could be too long */

  pbf_placement placement; /* since the last step */

  pbf_overlap_state overlap;

  struct pbf_emission *emission; /* lib/emission/emission.h; null: nothing comes or goes */

  struct pbf_diffuse *diffuse; /* lib/diffuse/diffuse.h; null: no spray, foam and bubbles */

  struct pbf_query_index *query; /* lib/query/index.h; null: nothing was asked yet */

  void *previous;          /* positions by row before the last step; null: they are not kept */
  uint32_t previous_count; /* rows that had one; those after them have been where they are */

  void *accelerations;         /* lib/particles/accelerations.h; null: there are none */
  uint32_t acceleration_count; /* rows that have been given one; those after them have none */

  struct pbf_phases *phases; /* lib/particles/phases.h; null: there are none */

  uint64_t generation;
  _Atomic uint32_t
      mapped[PBF_FIELD_COUNT]; /* views of each field, which any thread may give back */
  pbf_rank_copy rank_copies[PBF_FIELD_COUNT];
};

/* Bytes of one component of a position. */
static inline uint32_t pbf_element_size(const pbf_solver *solver) { return solver->kind.precision; }

/* Bytes of a position, and of a velocity. */
static inline uint64_t pbf_point_bytes(const pbf_solver *solver) {
  return (uint64_t)solver->kind.dimension * pbf_element_size(solver);
}

#endif
