/* One step (Algorithm 1), for all backends: which stages, in which order, on what conditions. What
 * a stage is to a backend its executor says: a loop, a loop of a team, a launch. */
#ifndef PBF_PHYSICS_STEP_H
#define PBF_PHYSICS_STEP_H

#include "physics/schedule.h"

enum step_outcome {
  STEP_OF_NONE_AWAKE,
  STEP_SHORT_OF_MEMORY,
  STEP_COMPLETE,
  STEP_COMPLETE_ALL_ASLEEP
};

namespace {

/* What a build must have to run each stage, by stages.def. */
constexpr int stage_features[] = {
#define PBF_STAGE(ID, name, feature, times, launches) PBF_FEATURE_##feature,
#include "physics/stages.def"
};

/* Whether a stage that the build has is in the schedule. */
template <pbf_stage STAGE>
PBF_FN bool runs(const pbf_schedule &has) {
  constexpr int feature = stage_features[STAGE];
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
static inline step_outcome run_step(Executor &e, const pbf_schedule &has) {
  if (!e.wake()) return STEP_OF_NONE_AWAKE; /* who is near what moves */
  e.predict();
  if (!e.find_neighbors()) return STEP_SHORT_OF_MEMORY;
  e.begin_solve();
  if (runs<PBF_STAGE_RESIDUAL_DENSITY>(has)) e.residual_density();
  if (runs<PBF_STAGE_GRID>(has)) e.pressure_grid();
  for (uint32_t k = 0; k < has.runs[PBF_STAGE_LAMBDA] && !e.is_converged(k); ++k) {
    e.begin_iteration(k);
    e.lambda(k);
    if (runs<PBF_STAGE_TORQUE>(has)) e.torque_deficit(k);
    e.move(k);
  }
  e.velocity();
  if (runs<PBF_STAGE_DAMPING_COMPENSATION>(has)) {
    e.mean_velocity();
    e.compensate_damping();
  }
  if (runs<PBF_STAGE_ANGULAR_MOMENTUM>(has)) {
    e.correction_rate();
    e.correct_angular_momentum();
  }
  if (runs<PBF_STAGE_CURL>(has)) {
    e.curl();
    e.confine();
  }
  if (runs<PBF_STAGE_VISCOSITY>(has)) e.viscosity();
  if (runs<PBF_STAGE_DRAG>(has)) e.drag();
  const bool all_asleep = runs<PBF_STAGE_SLEEP>(has) && e.update_sleep();
  e.end();
  return all_asleep ? STEP_COMPLETE_ALL_ASLEEP : STEP_COMPLETE;
}

}  // namespace

#endif
