/* What backends on the host report in the same way: statistics, and the stages of the plan. */
#ifndef PBF_COMMON_REPORT_H
#define PBF_COMMON_REPORT_H

#include <math.h>

#include "physics/real.h"
#include "physics/schedule.h"

/* Adds one of stats->count particles; `first` is 1 for the first of them. */
static inline void pbf_stats_add(pbf_stats *stats, int first, pbf_vec position, pbf_vec velocity,
                                 double density, uint32_t neighbors) {
  double v2 = 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    double x = (double)position.c[k], v = (double)velocity.c[k];
    stats->center_of_mass[k] += x;
    stats->momentum[k] += v;
    if (first || x < stats->position_min[k]) stats->position_min[k] = x;
    if (first || x > stats->position_max[k]) stats->position_max[k] = x;
    v2 += v * v;
  }
  stats->kinetic_energy += 0.5 * v2;
  stats->speed_max = fmax(stats->speed_max, sqrt(v2));
  stats->density_mean += density;
  stats->density_error_mean += fmax(density - 1, 0);
  stats->density_error_max = fmax(stats->density_error_max, density - 1);
  stats->neighbors_mean += neighbors;
  if (neighbors > stats->neighbors_max) stats->neighbors_max = neighbors;
}

/* Turns the sums over all particles, at least one, into means. */
static inline void pbf_stats_finish(pbf_stats *stats) {
  double per_particle = 1.0 / stats->count;
  for (int k = 0; k < PBF_DIM; ++k) {
    stats->center_of_mass[k] *= per_particle;
    stats->momentum[k] *= per_particle;
  }
  stats->kinetic_energy *= per_particle;
  stats->density_mean *= per_particle;
  stats->density_error_mean *= per_particle;
  stats->neighbors_mean *= per_particle;
}

static inline void pbf_plan_stages(const pbf_schedule *schedule, pbf_plan *plan) {
  for (int k = 0; k < PBF_STAGE_COUNT; ++k) {
    if (!schedule->runs[k]) continue;
    pbf_plan_stage *stage = &plan->stages[plan->stage_count++];
    snprintf(stage->name, sizeof stage->name, "%s", pbf_stage_name((pbf_stage)k));
    stage->runs_per_step = schedule->runs[k];
  }
}

#endif
