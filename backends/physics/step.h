/* One step (Algorithm 1), for all backends: which stages, in which order, on what conditions. What
 * a stage is to a backend its executor says: a loop, a loop of a team, a launch. */
#ifndef PBF_PHYSICS_STEP_H
#define PBF_PHYSICS_STEP_H

#include "physics/passes/drag.h"
#include "physics/schedule.h"

enum step_outcome {
  STEP_OF_NONE_AWAKE,
  STEP_SHORT_OF_MEMORY,
  STEP_COMPLETE,
  STEP_COMPLETE_ALL_ASLEEP
};

/* What stages read of neighbours, one bit each: what the ghosts of a particle (ghosts.h) repeat. */
enum exchanged_fields {
  FIELD_POSITION = 1 << 0,
  FIELD_LAMBDA = 1 << 1,       /* what an iteration moves by */
  FIELD_LAMBDA_TOTAL = 1 << 2, /* of the step */
  FIELD_VELOCITY = 1 << 3,
  FIELD_MEAN_VELOCITY = 1 << 4,
  FIELD_CORRECTION_RATE = 1 << 5,
  FIELD_CURL_SIZE = 1 << 6,
  FIELD_DEVIATOR = 1 << 7,
  FIELD_SHEAR_PUSH = 1 << 8,
  FIELD_MISSING = 1 << 9,        /* neighbours */
  FIELD_CROWDING = 1 << 10,      /* what it leaves out of viscosity */
  FIELD_VISCOUS_CHANGE = 1 << 11 /* of the velocity, so far */
};

namespace {

/* Whether a stage that the build has is in the schedule. */
template <pbf_stage STAGE>
PBF_FN bool runs(const pbf_schedule &has) {
  constexpr int features[] = {
  /* what a build must have to run each stage */
#define PBF_STAGE(ID, name, feature, times, launches) PBF_FEATURE_##feature,
#include "physics/stages.def"
  };
  constexpr int feature = features[STAGE];
  return (PBF_BUILT & feature) == feature && has.runs[STAGE];
}

/* Whether the schedule has no stages but these: for a step that has an order of its own, and must
 * not leave out a stage that it does not know. */
template <int N>
PBF_FN bool has_only(const pbf_schedule &has, const pbf_stage (&stages)[N]) {
  for (int k = 0; k < PBF_STAGE_COUNT; ++k) {
    bool listed = has.runs[k] == 0;
    for (pbf_stage stage : stages) listed |= stage == k;
    if (!listed) return false;
  }
  return true;
}

template <class Executor>
static inline void pull_at_surfaces(Executor &e) {
  e.missing_neighbors();
  e.exchange(FIELD_MISSING);
  e.surface_tension();
}

/* e.exchange(fields) stands between what changes a field of particles and what reads it of their
 * neighbours. Where an executor holds copies of it, packed for its loops, or in ghosts of its own
 * or of other processes, they are refreshed there; where all is read from where it is, it does
 * nothing. find_neighbors() finds the ghosts, too, with what they repeat.
 *
 * e.over_particles<Pass>(stage) is a stage that changes velocities, each by itself (pass.h). */
template <class Executor>
static inline step_outcome run_step(Executor &e, const pbf_schedule &has) {
  if (!e.wake()) return STEP_OF_NONE_AWAKE; /* particles near what moves */
  e.predict();
  if (!e.find_neighbors()) return STEP_SHORT_OF_MEMORY;
  if (runs<PBF_STAGE_OVERLAP>(has)) e.overlap();
  if (runs<PBF_STAGE_RESIDUAL_DENSITY>(has)) e.residual_density();
  if (runs<PBF_STAGE_VISCOSITY>(has) && has.accelerated) {
    e.crowding();
    for (uint32_t k = 0; k < has.runs[PBF_STAGE_VISCOSITY]; ++k) {
      e.exchange(k ? FIELD_VISCOUS_CHANGE : FIELD_CROWDING);
      e.viscosity(k);
    }
    e.move_by_viscosity();
    e.exchange(FIELD_POSITION);
  }
  e.begin_solve();
  if (runs<PBF_STAGE_GRID>(has)) {
    e.pressure_grid();
    e.exchange(FIELD_POSITION);
  }
  for (uint32_t k = 0; k < has.runs[PBF_STAGE_LAMBDA] && !e.is_converged(k); ++k) {
    e.begin_iteration(k);
    e.lambda(k);
    e.exchange(FIELD_LAMBDA);
    if (runs<PBF_STAGE_TORQUE>(has)) e.torque_deficit(k);
    e.move(k);
    e.exchange(FIELD_POSITION);
  }
  e.velocity();
  e.exchange(FIELD_POSITION);
  if (runs<PBF_STAGE_SHEAR_STRESS>(has) && e.shear_stress_is_due()) {
    e.deviator();
    e.exchange(FIELD_DEVIATOR);
    e.shear_push();
    e.exchange(FIELD_SHEAR_PUSH);
    e.correct_shear_stress();
    e.exchange(FIELD_POSITION);
  }
  if (runs<PBF_STAGE_DAMPING_COMPENSATION>(has)) {
    e.exchange(FIELD_VELOCITY);
    e.mean_velocity();
    e.exchange(FIELD_MEAN_VELOCITY | FIELD_LAMBDA_TOTAL);
    e.compensate_damping();
  }
  if (runs<PBF_STAGE_ANGULAR_MOMENTUM>(has)) {
    e.correction_rate();
    e.exchange(FIELD_CORRECTION_RATE);
    e.correct_angular_momentum();
  }
  if (runs<PBF_STAGE_FRICTION>(has)) {
    e.friction();
    e.exchange(FIELD_POSITION);
  }
  const bool tension = runs<PBF_STAGE_SURFACE_TENSION>(has);
  if (tension && has.adhesion) pull_at_surfaces(e); /* and solids, which loads are to know */
  if (runs<PBF_STAGE_LOADS>(has)) e.loads();
  if (runs<PBF_STAGE_CURL>(has)) {
    e.exchange(FIELD_VELOCITY);
    e.curl();
    e.exchange(FIELD_CURL_SIZE);
    e.confine();
  }
  if (runs<PBF_STAGE_VISCOSITY>(has) && !has.accelerated) {
    e.exchange(FIELD_VELOCITY);
    e.viscosity(0);
  }
  if (tension && !has.adhesion) pull_at_surfaces(e);
  if (runs<PBF_STAGE_DRAG>(has)) e.template over_particles<drag_pass>(PBF_STAGE_DRAG);
  bool all_asleep = false;
  if (runs<PBF_STAGE_SLEEP>(has)) {
    e.exchange(FIELD_VELOCITY);
    all_asleep = e.update_sleep();
  }
  e.end();
  return all_asleep ? STEP_COMPLETE_ALL_ASLEEP : STEP_COMPLETE;
}

}  // namespace

#endif
