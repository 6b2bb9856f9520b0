#include "stability/cases.h"

#include <cstdio>

namespace bench::stability {

const std::vector<Case> &all_cases() {
  static const std::vector<Case> cases = {
      {1, "two-coincident", "they separate, momentum 0 to rounding", 60, two_coincident},
      {2, "thousand-coincident", "speed under the cap, centre of mass fixed", 120,
       thousand_coincident},
      {3, "no-particles", "a step is a no-op", 60, no_particles},
      {4, "one-falling", "the scheme's own parabola", 60, one_falling},
      {5, "two-particles", "centre of mass exact", 60, two_particles},
      {6, "one-cell", "100,000 particles in one cell end within memory", 1800, one_cell},
      {7, "step-times-10", "finite, no energy gained", 300, step_times_10},
      {8, "step-times-100", "finite, no energy gained", 300, step_times_100},
      {9, "tiny-step", "no drift over 10,000 steps of 1e-7", 600, tiny_step},
      {10, "alternating-step", "surface as with the constant step", 600, alternating_step},
      {11, "deep-columns", "error by the stated law, no boiling", 1800, deep_columns},
      {12, "many-iterations", "residual falls monotonically", 300, many_iterations},
      {13, "heavy", "gravity x 1,000: bounded compression, recovers", 300, heavy},
      {14, "flipping-gravity", "volume kept", 600, flipping_gravity},
      {15, "far-origin", "as at the origin, or refused with the reason", 300, far_origin},
      {16, "fast-at-thin-wall", "no particle escapes at 50 h a step", 120, fast_at_thin_wall},
      {17, "long-at-thin-wall", "no particle escapes in 100,000 steps", 1800, long_at_thin_wall},
      {18, "piston", "finite, pressure rises, recovers", 300, piston},
      {19, "overfull-piston", "overload reported, recovers", 300, overfull_piston},
      {20, "mass-ratio", "momentum kept", 300, mass_ratio},
      {21, "density-ratio", "interface flat", 600, density_ratio},
      {22, "bad-numbers", "NaN, infinity, denormals refused with the index", 60, bad_numbers},
      {23, "bad-domains", "status code", 60, bad_domains},
      {24, "thin-domain", "finite", 120, thin_domain},
      {25, "leaving", "counted, the stated policy obeyed", 120, leaving},
      {26, "above-capacity", "status code, state untouched", 60, above_capacity},
      {27, "neighbor-overflow", "no neighbour cut silently", 300, neighbor_overflow},
      {28, "sudden-changes", "no jump in energy", 300, sudden_changes},
      {29, "colliding-drops", "linear and angular momentum kept", 300, colliding_drops},
      {30, "long-runs", "100,000 steps: no drift, noise falls, memory flat", 3600, long_runs},
      {31, "sleep-and-wake", "as the awake run, wakes on touch", 60, sleep_and_wake},
      {32, "save-and-load", "continues with the same bits", 120, save_and_load},
      {33, "thread-counts", "the same bits", 120, thread_counts},
      {34, "turning-tank", "paraboloid; at 100 rad/s inside, no energy gained", 1800, turning_tank},
      {35, "tank-lengths", "none of 0.84 to 4 m explodes", 900, tank_lengths},
      {36, "dense-start", "random at 1.5 rest density settles", 600, dense_start},
      {37, "permuted", "the same fields", 120, permuted},
      {38, "turned-and-mirrored", "the same scalars", 120, turned_and_mirrored},
      {39, "heavy-above", "what is heavier ends below", 600, heavy_above},
  };
  return cases;
}

std::string folder_of(const Case &entry) {
  char number[8];
  std::snprintf(number, sizeof number, "%02d-", entry.number);
  return number + std::string(entry.name);
}

}  // namespace bench::stability
