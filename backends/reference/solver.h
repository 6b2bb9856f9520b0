/* The solver of the `reference` backend: Algorithm 1 read aloud. Particles stay in the order of
 * adding, so that row and particle are the same number everywhere. */
#ifndef PBF_REFERENCE_SOLVER_H
#define PBF_REFERENCE_SOLVER_H

#include "common/collider_table.h"
#include "common/pressure_grid.h"
#include "physics/constants.h"
#include "physics/loads.h"
#include "physics/passes/shear_stress.h"
#include "physics/schedule.h"
#include "physics/sleep.h"
#include "reference/grid.h"

struct pbf_backend_solver {
  pbf_memory memory;
  const pbf_backend_host *host;
  pbf_params params;
  pbf_derived derived; /* from the parameters, as these: */
  pbf_constants constants;
  pbf_schedule schedule;
  pbf_basins basins; /* that the schedule has asked about last */
  uint32_t capacity, count;
  uint32_t planned;    /* particles that the schedule is for, */
  double most_left;    /* and the most that steps have left for each layer: plan_steps */
  uint32_t iterations; /* of the last step */
  pbf_vec *x, *v;      /* state */
  pbf_vec *predicted;  /* where x* starts */
  pbf_vec *moved;      /* x* */
  pbf_vec *change;     /* position change of an iteration; what shear_stress.h pushes; rates of
                          rotation; the second velocity of viscosity */
  pbf_real *lambda;    /* of this iteration, or of all of a step: accelerated */

#define PBF_ARRAY(name, wanted, holders) holders
#define PBF_REFERENCE(type, member) type member;
#include "physics/arrays.def"

  pbf_real *pressure;      /* once it has been looked at */
  pbf_real pressure_scale; /* of the last step */
  pbf_overlap found;       /* for the next step; struct_size 0: none */
  pbf_entering entering;   /* what of it enters */
  int overlaps;            /* some may be left */
  pbf_phase_table phases;  /* that differ; count 0: none do */
  uint32_t accelerations;  /* whether particles have some */
  pbf_sleep sleep;
  pbf_moving_obstacles moving_obstacles;
  uint32_t *ids;
  struct grid grid;
  uint32_t collider_count;
  double collider_time;
  double now; /* end of the last step: where walls stand for statistics */
  pbf_collider_table table;
};
typedef struct pbf_backend_solver solver;

#endif
