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

/* Whether a stage that the build has is in the schedule. */
template <int FEATURE = 0>
PBF_FN bool runs(const pbf_schedule &has, pbf_stage stage) {
  return (FEATURE == 0 || (PBF_BUILT & FEATURE)) && has.runs[stage];
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
  if (runs<PBF_FEATURE_CHEBYSHEV>(has, PBF_STAGE_SLACK)) e.slack();
  if (runs<PBF_FEATURE_PRESSURE_GRID>(has, PBF_STAGE_GRID)) e.pressure_grid();
  for (uint32_t k = 0; k < has.runs[PBF_STAGE_LAMBDA] && !e.is_over(k); ++k) {
    e.begin_iteration(k);
    e.lambda(k);
    if (runs<PBF_FEATURE_UNDAMPING>(has, PBF_STAGE_TORQUE)) e.torque(k);
    e.move(k);
  }
  e.velocity();
  if (runs<PBF_FEATURE_UNDAMPING>(has, PBF_STAGE_UNDAMP)) {
    e.flow();
    e.undamp();
  }
  if (runs<PBF_FEATURE_UNDAMPING>(has, PBF_STAGE_TURN)) {
    e.turn_rate();
    e.turn();
  }
  if (runs<PBF_FEATURE_VORTICITY>(has, PBF_STAGE_CURL)) {
    e.curl();
    e.confine();
  }
  if (runs<PBF_FEATURE_VISCOSITY>(has, PBF_STAGE_VISCOSITY)) e.viscosity();
  const bool all_asleep = runs<PBF_FEATURE_SLEEP>(has, PBF_STAGE_SLEEP) && e.settle();
  e.end();
  return all_asleep ? STEP_COMPLETE_ALL_ASLEEP : STEP_COMPLETE;
}

}  // namespace

#endif
