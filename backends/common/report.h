/* What backends on the host report in the same way: statistics, and the stages of the plan. */
#ifndef PBF_COMMON_REPORT_H
#define PBF_COMMON_REPORT_H

#include <math.h>

#include "physics/real.h"
#include "physics/schedule.h"

/* Adds one of stats->count particles; `first` is 1 for the first of them. Until pbf_stats_finish,
 * speed_max is a square. NaN is no maximum. */
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
  stats->speed_max = pbf_max(v2, stats->speed_max);
  stats->density_mean += density;
  stats->density_error_mean += pbf_max(density - 1, 0);
  stats->density_error_max = pbf_max(density - 1, stats->density_error_max);
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
  stats->speed_max = sqrt(stats->speed_max);
  stats->density_mean *= per_particle;
  stats->density_error_mean *= per_particle;
  stats->neighbors_mean *= per_particle;
}

namespace {

constexpr bool pbf_same_text(const char *a, const char *b) {
  while (*a && *a == *b) ++a, ++b;
  return *a == *b;
}

/* How many entries stages have in a plan, and in times: those next to each other that have the
 * same name have one together. */
constexpr int pbf_stage_entries() {
  constexpr const char *names[] = {
#define PBF_STAGE(ID, name, feature, times, launches) name,
#include "physics/stages.def"
  };
  int entries = 1;
  for (int k = 1; k < PBF_STAGE_COUNT; ++k) entries += !pbf_same_text(names[k], names[k - 1]);
  return entries;
}

static_assert(pbf_stage_entries() <= PBF_MAX_STAGES,
              "a plan has no room for that many stages: give the new one its neighbour's name");

/* The entry of a stage, behind those of the stages before it. */
template <class Entry>
static inline Entry *pbf_stage_entry(Entry *entries, uint32_t *count, int stage) {
  const char *name = pbf_stage_name((pbf_stage)stage);
  if (*count && pbf_same_text(entries[*count - 1].name, name)) return &entries[*count - 1];
  Entry *entry = &entries[(*count)++];
  snprintf(entry->name, sizeof entry->name, "%s", name);
  return entry;
}

}  // namespace

/* Adds a stage that runs so often a step to the plan, and gives its entry. */
static inline pbf_plan_stage *pbf_plan_add_stage(pbf_plan *plan, int stage, uint32_t runs) {
  pbf_plan_stage *entry = pbf_stage_entry(plan->stages, &plan->stage_count, stage);
  if (runs > entry->runs_per_step) entry->runs_per_step = runs;
  return entry;
}

static inline void pbf_plan_stages(const pbf_schedule *schedule, pbf_plan *plan) {
  for (int k = 0; k < PBF_STAGE_COUNT; ++k)
    if (schedule->runs[k]) pbf_plan_add_stage(plan, k, schedule->runs[k]);
}

/* Adds the time of a stage, which has run so often. */
static inline void pbf_timings_add(pbf_timings *timings, int stage, double milliseconds,
                                   uint64_t runs) {
  pbf_stage_time *entry = pbf_stage_entry(timings->stages, &timings->stage_count, stage);
  entry->milliseconds += milliseconds;
  if (runs > entry->runs) entry->runs = runs;
}

#endif
