/* The solver of the `cuda` backend: what it holds, and how long each array lives. */
#ifndef PBF_CUDA_SOLVER_H
#define PBF_CUDA_SOLVER_H

#include <string.h>

#include "cuda/context.h"
#include "cuda/features.h"
#include "cuda/pressure_grid_solve.h"
#include "cuda/memory.h"
#include "cuda/kernels_velocities.h"
#include "cuda/overlap.h"
#include "cuda/many_colliders.h"
#include "cuda/ranks.h"
#include "cuda/scan.h"
#include "cuda/shapes.h"
#include "cuda/sleep.h"
#include "cuda/small/kernel.h"
#include "cuda/status.h"
#include "cuda/timing.h"
#include "physics/loads.h"
#include "physics/schedule.h"

/* Steps of which colliders are placed and uploaded at once. */
enum { STEPS_AHEAD = SMALL_STEPS };

/* Records of worlds on their way to the device. */
struct world_upload {
  void *host, *device;
  uint64_t bytes;
  cudaEvent_t read;
};

/* What worlds that step together have in common; it ends with the last of them. */
struct world_team {
  uint32_t users;
  uint32_t turn;           /* of the uploads */
  world_upload uploads[2]; /* the host writes one while the device reads the other */
  cudaEvent_t done;        /* after their last launch */
};

/* Steps that a world is to do together with others. */
struct steps_put_off {
  pbf_step_times times;
  uint32_t steps;
};

struct solver {
  pbf_allocator allocator;
  const pbf_backend_host *host;
  int device;
  pbf_cuda_context context;
  cudaStream_t stream;
  bool owns_stream;
  uint32_t multiprocessors;
  size_t block_shared; /* bytes of shared memory that a block can have */
  bool launches_early; /* where the device can (launch_early) */
  char device_name[96];
  pbf_cuda_memory memory;
  stage_clock clock;

  pbf_params params;
  pbf_derived derived; /* from the parameters, as these: */
  pbf_constants constants;
  pbf_schedule schedule;
  pbf_basins basins; /* that the schedule has asked about last */
  pbf_few_basins basins_memory;
  double time; /* of the last step's end: where walls and colliders stand for statistics */

  uint32_t capacity, count;
  uint32_t scene_capacity; /* on ranks that of all, else the same */
  uint32_t first;          /* particle of the state in its arrays; above 0 on ranks alone */
  rank_state ranks;
  uint32_t planned; /* particles that the schedule is for, */
  double most_left; /* and the most that steps have left for each layer: plan_steps */
  uint32_t worlds;  /* that run at once, this one of them; 0, 1: it is alone */
  point *points;    /* state */
  pbf_vec *velocities;
  uint32_t *ids;
  point *other; /* between steps, room for transfers */
  pbf_vec *other_velocities;
  uint32_t *other_ids, *cells;
  uint32_t *cell_start;
  void *scan_scratch;
  size_t scan_bytes;

  neighbor_lists lists;
  void *list_storage; /* the lists, before them the sort's scratch; or what a small scene has */
  uint64_t list_bytes;

#define PBF_ARRAY(name, wanted, holders) holders
#define PBF_CUDA(type, member, elements) type member;
#include "physics/arrays.def"

  uint32_t pressure_grid_cluster;  /* most blocks of a cluster; 0: it has none */
  pbf_pressure_grid pressure_grid; /* of the last step, … */
  double pressure_grid_scale;      /* … as is this, of lambda, … */
  bool pressure_grid_gains;        /* whether a collider goes faster or slower in the step */
  bool pressure_grid_is_torn;      /* by colliders that are thin, or periodic axes, … */
  int pressure_grid_solids;        /* … and the colliders in it, if so */
  pbf_domain pressure_grid_domain; /* between these walls */
  found_topology topology;         /* what the device's is of */
  uint64_t *all_asleep;   /* in the host's memory: the epoch in which the device found that; with
                             sleep only */
  uint64_t epoch;         /* between two events that may wake a particle */
  pbf_overlap found;      /* for the next step; struct_size 0: none */
  pbf_entering entering;  /* what of it enters */
  int overlaps;           /* some may be left */
  pbf_phase_table phases; /* that differ; count 0: none do */
  uint32_t accelerations; /* whether particles have some */
  pbf_sleep sleep;
  pbf_moving_obstacles moving_obstacles;
  pbf_real *pressures;               /* once they have been looked at */
  pbf_real pressure_scale;           /* of the last step */
  bool ordered;                      /* the particles are in the order of their ids */
  struct small_upload *small_upload; /* where small scenes are wanted, as all of these */
  struct small_control *small_control;
  bool small_allowed; /* shared memory */
  uint16_t *owners;
  world_team *team;    /* with which it has stepped; null: with none */
  cudaEvent_t reached; /* in its stream, what its team follows */
  bool puts_off;       /* steps may wait for those of other worlds */
  bool works_together; /* its team's last launch may be under way, … */
  bool works_alone;    /* … or something in its own stream */
  steps_put_off put_off;
  pbf_status late_failure;     /* of what had been put off, until a call can tell */
  cudaEvent_t handed;          /* between the caller's stream and its own, once there is one */
  uint32_t *refused;           /* row of what the caller has written last, on the device, … */
  uint32_t *told;              /* … and in the host's memory until a call can tell */
  uint32_t owned, owned_steps; /* particles that `owners` orders, and for how many steps */

  uint32_t collider_count;
  double collider_time;
  pbf_collider *colliders; /* these, or in the table of many: */
  pbf_collider few_colliders[PBF_FEW_COLLIDERS];
  many_colliders many;
  device_shapes shapes; /* theirs */
};

/* Whether colliders are more than kernels take by value. */
static inline bool are_listed(const solver *s) {
  return (PBF_BUILT & PBF_FEATURE_COLLIDERS) && s->collider_count > PBF_FEW_COLLIDERS;
}

static inline bool has_ranks(const solver *s) {
  return (PBF_BUILT & PBF_FEATURE_RANKS) && s->ranks.count > 0;
}

/* Particles of the scene. */
static inline uint32_t particles_of_all(const solver *s) {
  return has_ranks(s) ? s->ranks.total : s->count;
}

static inline cudaLaunchAttribute early_launch() {
  cudaLaunchAttribute early;
  early.id = cudaLaunchAttributeProgrammaticStreamSerialization;
  early.val.programmaticStreamSerializationAllowed = 1;
  return early;
}

/* A launch that is on its way while the one before ends: its kernel begins with thread_index(),
 * own_index() or await_launches_before(), and has read no memory before. */
template <class... Parameters, class... Arguments>
static void launch_early(const solver *s, void (*kernel)(Parameters...), uint32_t blocks,
                         uint32_t threads, size_t shared, const Arguments &...arguments) {
  cudaLaunchAttribute early = early_launch();
  cudaLaunchConfig_t config = {};
  config.gridDim = dim3(blocks);
  config.blockDim = dim3(threads);
  config.dynamicSmemBytes = shared;
  config.stream = s->stream;
  config.attrs = &early;
  config.numAttrs = s->launches_early;
  cudaLaunchKernelEx(&config, kernel, Parameters(arguments)...);
}

static inline sort_scratch scratch_of(const solver *s) {
  uint32_t *room = static_cast<uint32_t *>(s->list_storage);
  return {room, room + s->count, room + 2 * (size_t)s->count};
}

static inline unsorted_particles state_of(const solver *s) {
  return {s->points + s->first,
          s->velocities + s->first,
          s->ids + s->first,
          s->count,
          s->activity ? s->activity + s->first : nullptr,
          s->tally ? &s->tally->all : nullptr,
          s->tally ? &s->tally->some : nullptr,
          s->last_pressure ? s->last_pressure + s->first : nullptr,
          s->overlap ? s->overlap + s->first : nullptr,
          s->constants.overlap_decay,
          s->phase ? s->phase + s->first : nullptr,
          s->acceleration ? s->acceleration + s->first : nullptr};
}

static inline neighborhood neighborhood_of(const solver *s, const cell_grid &grid) {
  return {{s->other, s->other_velocities, s->other_ids, s->cells, s->cell_start,
           has_ranks(s) ? s->ranks.last : s->count, s->ranks.first, s->other_activity,
           s->other_last_pressure, s->other_overlap, s->other_phase, s->mobility,
           s->other_acceleration},
          grid,
          {s->lists.entries, s->lists.sizes, s->lists.bases, s->far_bases, s->lists.chunks,
           s->lists.sentinel_index},
          s->constants};
}

/* Without arrays where the scene has no pressure grid. */
static inline pressure_grid_arrays pressure_grid_of(const solver *s) {
  if (!PBF_HAS_PRESSURE_GRID || !s->pressure_grid_memory) return pressure_grid_arrays{};
  const bool torn = s->pressure_grid_is_torn;
  const uint64_t limit = pbf_pressure_grid_max_nodes(s->scene_capacity);
  pressure_grid_arrays a = pressure_grid_arrays_in(s->pressure_grid_memory, s->scene_capacity,
                                                   torn ? (uint32_t)limit : s->pressure_grid.nodes);
  a.cell_moves = s->cell_moves;
  if (!torn) return a;
  a.topology =
      pbf_pressure_grid_topology_in(s->topology_memory, limit, pbf_pressure_grid_limit(s->planned));
  a.topology.surfaces = s->pressure_grid_solids > PBF_FEW_COLLIDERS
                            ? s->many.divided
                            : pressure_grid_surfaces(s->topology_memory, s->scene_capacity);
  a.topology.is_active = 1;
  a.topology.surface_count = s->pressure_grid_solids;
  a.topology.domain = s->pressure_grid_domain;
  return a;
}

template <class Value>
static inline void swap_arrays(Value *a, Value *b) {
  Value kept = *a;
  *a = *b;
  *b = kept;
}

static inline pbf_status copy_out(solver *s, void *to, const void *from, uint64_t bytes) {
  if (pbf_status status =
          pbf_cuda_check(cudaMemcpyAsync(to, from, bytes, cudaMemcpyDeviceToHost, s->stream),
                         "cudaMemcpyAsync to the host"))
    return status;
  return pbf_cuda_check(cudaStreamSynchronize(s->stream), "cudaStreamSynchronize");
}

#endif
