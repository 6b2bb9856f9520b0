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
#define PBF_STAGE(ID, name, feature, times, launches) PBF_STAGE_##ID,
#include "physics/stages.def"
  PBF_STAGE_COUNT
} pbf_stage;

typedef struct pbf_schedule {
  uint32_t runs[PBF_STAGE_COUNT]; /* a step, at most */
  int features;
  int colliders;
  int solids;             /* of them that water can be on two sides of */
  int has_topology;       /* these, or periodic axes, may tear the pressure grid's nodes */
  double min_volume;      /* of the smallest container, see physics/containers.h */
  int accelerated;        /* lambda adds up over the iterations */
  int wall_density;       /* walls and colliders contribute density */
  int corrects_shear;     /* shear_stress.h, now, … */
  int may_correct_shear;  /* … or with more particles */
  int adhesion;           /* of fluid with a tension to walls or colliders: adhesion.h */
  int no_slip;            /* fluid sticks to walls or colliders: no_slip.h */
  int checks_convergence; /* the solve ends when its density error is small enough */
  int phases;             /* that differ: phases.h, … */
  int close_phases;       /* … and a pressure grid carries: pbf_phases_are_close */
  int accelerations;      /* particles have some beside gravity */
  int may_have_grid;      /* a pressure grid, now or with more particles */
  int collide_after_prediction, collide_in_iteration, collide_after_solve;
} pbf_schedule;

static inline uint32_t pbf_has_friction(const pbf_params *params, uint32_t colliders,
                                        const pbf_collider *list) {
  uint32_t has = params->wall_friction > 0 || params->wall_static_friction > 0;
  for (uint32_t k = 0; k < colliders; ++k)
    has |= list[k].friction > 0 || list[k].static_friction > 0;
  return has && params->time_step > 0;
}

static inline uint32_t pbf_has_adhesion(const pbf_params *params, uint32_t colliders,
                                        const pbf_collider *list) {
  uint32_t has = params->wall_adhesion > 0;
  for (uint32_t k = 0; k < colliders; ++k) has |= list[k].adhesion > 0;
  return has && params->surface_tension > 0;
}

/* For `count` particles. What runs depends on them, and not on `capacity`, which is how many there
 * is room for: what more of them would need is in memory from the start, so that adding can't fail.
 * `most` is what steps so far have left of an error for each layer, see pbf_depth_wants_grid.
 * `derived` is of the same parameters; `basins` are looked for where they are others than before.
 * `table`: of phases that differ, or null. `accelerations`: whether particles have some. */
static inline pbf_schedule pbf_schedule_of(const pbf_params *params, const pbf_derived *derived,
                                           pbf_basins *basins, uint32_t colliders,
                                           const pbf_collider *list, uint32_t count,
                                           uint32_t capacity, double most, int overlaps = 0,
                                           const pbf_phase_table *table = NULL,
                                           int accelerations = 0) {
  pbf_schedule s;
  memset(&s, 0, sizeof s);
  s.features = pbf_features_of(params);
  s.colliders = (int)colliders;
  for (uint32_t k = 0; k < colliders; ++k) s.solids += pbf_is_solid(&list[k]);
  s.has_topology = s.solids > 0 || params->periodic;
  s.min_volume = pbf_containers_volume(params, colliders, list);
  s.accelerated = params->solver == PBF_SOLVER_CHEBYSHEV;
  s.wall_density = params->wall_density > 0;
  const int phases = s.phases = table && table->count > 0;
  s.accelerations = accelerations;
  s.close_phases = phases && pbf_phases_are_close(table);
  s.no_slip = params->viscosity > 0 && params->wall_no_slip > 0;
  for (uint32_t k = 0; k < colliders; ++k)
    s.no_slip |= params->viscosity > 0 && list[k].no_slip > 0;
  s.adhesion = pbf_has_adhesion(params, colliders, list) != 0;
  s.checks_convergence = params->tolerance > 0;
  s.collide_after_prediction = (params->collide & PBF_COLLIDE_AFTER_PREDICTION) != 0;
  s.collide_in_iteration = (params->collide & PBF_COLLIDE_IN_ITERATION) != 0;
  s.collide_after_solve = (params->collide & PBF_COLLIDE_AFTER_SOLVE) != 0;
  s.corrects_shear = (PBF_BUILT & PBF_FEATURE_DAMPING_COMPENSATION) && s.accelerated &&
                     pbf_depth_corrects_shear(params, basins, colliders, list, count, phases);
  const int accelerated = s.accelerated, corrects_shear = s.corrects_shear;
#define PBF_STAGE(ID, name, feature, times, launches) \
  if ((PBF_BUILT & PBF_FEATURE_##feature) == PBF_FEATURE_##feature) s.runs[PBF_STAGE_##ID] = times;
#include "physics/stages.def"
  s.may_have_grid =
      (PBF_BUILT & PBF_FEATURE_PRESSURE_GRID) &&
      pbf_depth_grid(params, basins, colliders, list, pbf_max_planned(capacity), most, table) > 0;
  s.may_correct_shear =
      (PBF_BUILT & PBF_FEATURE_DAMPING_COMPENSATION) && s.accelerated &&
      pbf_depth_corrects_shear(params, basins, colliders, list, pbf_max_planned(capacity), phases);
  return s;
}

static inline const char *pbf_stage_name(pbf_stage stage) {
  static const char *const names[PBF_STAGE_COUNT] = {
#define PBF_STAGE(ID, name, feature, times, launches) name,
#include "physics/stages.def"
  };
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
