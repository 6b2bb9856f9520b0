/* Which stages a scene has, in their order (Algorithm 1): a stage that is not in the schedule is
 * not run, and what only it needs is not allocated. */
#ifndef PBF_PHYSICS_SCHEDULE_H
#define PBF_PHYSICS_SCHEDULE_H

#include <stdio.h>
#include <string.h>

#include "physics/constants.h"
#include "physics/depth.h"
#include "physics/features.h"

typedef enum pbf_stage {
  PBF_STAGE_PREDICT,   /* lines 1-4, with walls and colliders when they act there */
  PBF_STAGE_NEIGHBORS, /* lines 5-7 */
  PBF_STAGE_SLACK,     /* density at the start of a very short step */
  PBF_STAGE_GRID,      /* deep water's pressure, on a coarse grid */
  PBF_STAGE_LAMBDA,    /* lines 9-11, an iteration */
  PBF_STAGE_TORQUE,    /* of the pushes of an iteration: turn.h */
  PBF_STAGE_MOVE,      /* lines 12-18, an iteration; lines 13 and 14 with collisions there */
  PBF_STAGE_VELOCITY,  /* lines 20, 21, 23, with collisions after the solve */
  PBF_STAGE_FLOW,      /* mean velocities, for … */
  PBF_STAGE_UNDAMP,    /* … undamp.h */
  PBF_STAGE_TURN_RATE, /* turn.h: how fast the pairs around a particle are to turn, and … */
  PBF_STAGE_TURN,      /* … their velocities, by that */
  PBF_STAGE_CURL,      /* line 22, eq. 15 */
  PBF_STAGE_CONFINE,   /* line 22, eq. 16 */
  PBF_STAGE_VISCOSITY, /* line 22, eq. 17 */
  PBF_STAGE_SLEEP,     /* who falls asleep and who wakes */
  PBF_STAGE_COUNT
} pbf_stage;

typedef struct pbf_schedule {
  uint32_t runs[PBF_STAGE_COUNT]; /* a step, at most */
  int features;
  int colliders;
  double least_room; /* of the smallest container, see physics/containers.h */
  int accelerated;   /* lambda adds up over the iterations */
  int wall_density;  /* walls and colliders lend density */
  int watched;       /* the solve ends when its density error is small enough */
  int collide_after_prediction, collide_in_iteration, collide_after_solve;
} pbf_schedule;

static inline pbf_schedule pbf_schedule_of(const pbf_params *params, uint32_t colliders,
                                           const pbf_collider *list, uint32_t capacity) {
  pbf_schedule s;
  memset(&s, 0, sizeof s);
  s.features = pbf_features_of(params);
  s.colliders = (int)colliders;
  s.least_room = pbf_containers_volume(params, colliders, list);
  s.accelerated = params->solver == PBF_SOLVER_CHEBYSHEV;
  s.wall_density = params->wall_density > 0;
  s.watched = params->tolerance > 0;
  s.collide_after_prediction = (params->collide & PBF_COLLIDE_AFTER_PREDICTION) != 0;
  s.collide_in_iteration = (params->collide & PBF_COLLIDE_IN_ITERATION) != 0;
  s.collide_after_solve = (params->collide & PBF_COLLIDE_AFTER_SOLVE) != 0;
  s.runs[PBF_STAGE_PREDICT] = s.runs[PBF_STAGE_NEIGHBORS] = s.runs[PBF_STAGE_VELOCITY] = 1;
  s.runs[PBF_STAGE_SLACK] = pbf_slack_of(params) > 0;
  s.runs[PBF_STAGE_GRID] = (PBF_BUILT & PBF_FEATURE_PRESSURE_GRID) &&
                           pbf_depth_grid(params, colliders, list, capacity) > 0;
  s.runs[PBF_STAGE_LAMBDA] = s.runs[PBF_STAGE_MOVE] = params->iterations;
  s.runs[PBF_STAGE_FLOW] = s.runs[PBF_STAGE_UNDAMP] = params->undamping > 0 && s.accelerated;
  s.runs[PBF_STAGE_TURN_RATE] = s.runs[PBF_STAGE_TURN] =
      params->torque_correction > 0 && s.accelerated;
  s.runs[PBF_STAGE_TORQUE] = s.runs[PBF_STAGE_TURN] ? params->iterations : 0;
  s.runs[PBF_STAGE_CURL] = s.runs[PBF_STAGE_CONFINE] = params->vorticity > 0;
  s.runs[PBF_STAGE_VISCOSITY] = params->viscosity > 0;
  s.runs[PBF_STAGE_SLEEP] = params->sleep_speed > 0;
  return s;
}

static inline const char *pbf_stage_name(pbf_stage stage) {
  static const char *const names[PBF_STAGE_COUNT] = {
      "predict", "neighbors", "slack",     "pressure grid", "lambda",    "torque",
      "move",    "velocity",  "flow",      "undamp",        "turn rate", "turn",
      "curl",    "confine",   "viscosity", "sleep"};
  return names[stage];
}

/* "3d-f32-wendland", "2d-f64-poly6-scorr" */
static inline void pbf_variant_name(char *name, size_t size, int features, uint32_t dimension,
                                    uint32_t precision) {
  snprintf(name, size, "%ud-f%u-%s%s", dimension, 8 * precision,
           features & PBF_FEATURE_POLY6 ? "poly6" : "wendland",
           features & PBF_FEATURE_SCORR ? "-scorr" : "");
}

#endif
