/* A schedule that a solver takes on, with the constants that depend on the fluid's depth. */
#ifndef PBF_COMMON_ADOPT_SCHEDULE_H
#define PBF_COMMON_ADOPT_SCHEDULE_H

#include "physics/schedule.h"

/* Its parameters and what is derived from them are those that the schedule is for. */
template <class Solver>
static void adopt_schedule(Solver *s, const pbf_schedule &schedule) {
  s->schedule = schedule;
  pbf_set_shear_stress(&s->constants, &s->params, &s->derived, schedule.shear_correction);
}

#endif
