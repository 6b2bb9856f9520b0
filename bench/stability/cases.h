/* The stiff and extreme cases. Each is a function that runs trials and records facts; what passes
 * is judged from the files by pbf-check. The table is in cases.cpp. */
#ifndef PBF_BENCH_STABILITY_CASES_H
#define PBF_BENCH_STABILITY_CASES_H

#include <string>
#include <vector>

#include "stability/record.h"

namespace bench::stability {

struct Case {
  int number;
  const char *name;
  const char *passes;  // when it does, in a few words
  unsigned limit;      // seconds after which the whole case has failed
  void (*run)(Record &record);
};

const std::vector<Case> &all_cases();

// Folder of a case's files: "07-step-times-10".
std::string folder_of(const Case &entry);

// overlap.cpp
void two_coincident(Record &record);
void thousand_coincident(Record &record);
void one_cell(Record &record);
void neighbor_overflow(Record &record);
void dense_start(Record &record);
// few.cpp
void no_particles(Record &record);
void one_falling(Record &record);
void two_particles(Record &record);
// time_step.cpp
void step_times_10(Record &record);
void step_times_100(Record &record);
void tiny_step(Record &record);
void alternating_step(Record &record);
// column.cpp
void deep_columns(Record &record);
void many_iterations(Record &record);
// gravity.cpp
void heavy(Record &record);
void flipping_gravity(Record &record);
void sudden_changes(Record &record);
// place.cpp
void far_origin(Record &record);
void tank_lengths(Record &record);
// thin_wall.cpp
void fast_at_thin_wall(Record &record);
void long_at_thin_wall(Record &record);
// piston.cpp
void piston(Record &record);
void overfull_piston(Record &record);
// several_fluids.cpp
void mass_ratio(Record &record);
void density_ratio(Record &record);
void heavy_above(Record &record);
// misuse.cpp
void bad_numbers(Record &record);
void bad_domains(Record &record);
void above_capacity(Record &record);
// confined.cpp
void thin_domain(Record &record);
void leaving(Record &record);
// drops.cpp
void colliding_drops(Record &record);
// rest.cpp
void long_runs(Record &record);
void sleep_and_wake(Record &record);
// repeat.cpp
void save_and_load(Record &record);
void thread_counts(Record &record);
// turning.cpp
void turning_tank(Record &record);
// symmetry.cpp
void permuted(Record &record);
void turned_and_mirrored(Record &record);

}  // namespace bench::stability

#endif
