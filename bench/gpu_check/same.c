/* same: two runs, and one from a saved state, have the same bits. */
#include "commands.h"

#include <stdio.h>
#include <stdlib.h>

#include "solver.h"

/* Twice the same; and from a saved state, and in single steps, with particles that came and went.
 */
static int same_bits(const char *name, const scene *s, uint32_t precision, uint32_t steps) {
  uint64_t hashes[3], size;
  uint32_t gone[3] = {1, 7, 500};
  void *state = NULL;
  for (int run = 0; run < 3; ++run) {
    pbf_solver *solver = solver_for(s, checked_backend, precision);
    if (run < 2) {
      must(pbf_step(solver, steps), "pbf_step");
      must(pbf_remove_particles(solver, 3, gone), "pbf_remove_particles");
      if (run == 0) state = saved(solver, &size);
    } else {
      must(pbf_load(solver, state, size), "pbf_load");
    }
    if (run == 0)
      must(pbf_step(solver, steps), "pbf_step");
    else
      for (uint32_t k = 0; k < steps; ++k) must(pbf_step(solver, 1), "pbf_step");
    hashes[run] = hash_of(solver);
    pbf_destroy(solver);
  }
  free(state);
  int good = hashes[0] == hashes[1] && hashes[0] == hashes[2];
  printf(
      "{\"check\": \"same bits\", \"scene\": \"%s\", \"dimension\": %u, \"precision\": %u, "
      "\"particles\": %u, \"steps\": %u, \"first\": \"%016llx\", \"second\": \"%016llx\", "
      "\"after_load\": \"%016llx\", \"good\": %s}\n",
      name, s->dimension, 8 * precision, scene_count(s), 2 * steps, (unsigned long long)hashes[0],
      (unsigned long long)hashes[1], (unsigned long long)hashes[2], good ? "true" : "false");
  fflush(stdout);
  return good;
}

int same_all(void) {
  int failures = 0;
  for (uint32_t precision = PBF_FLOAT32; precision <= PBF_FLOAT64; precision += 4)
    for (uint32_t dim = 2; dim <= 3; ++dim) {
      scene s = small_scene(dim);
      s.params.time_step = 1.0 / 128; /* sums of it are exact, in whatever calls the steps come */
      s.params.vorticity = s.params.viscosity = 0.05;
      add_colliders(&s);
      failures += !same_bits("small", &s, precision, 60);
      s.params.solver = PBF_SOLVER_CHEBYSHEV;
      s.params.wall_no_slip = 1;
      s.params.damping_compensation = s.params.angular_momentum_correction = s.params.wall_density =
          1;
      s.params.shear_stress_correction = 0.7;
      failures += !same_bits("small-damping_compensation", &s, precision, 60);
      add_mirrors(&s);
      failures += !same_bits("small-mirrors", &s, precision, 60);
      s = small_scene(dim);
      s.params.time_step = 1.0 / 128;
      failures += !same_bits("small-plain", &s, precision, 60);
    }
  scene s = report_30k();
  failures += !same_bits("report-30k", &s, PBF_FLOAT32, 100);
  s = shallow_dam_break(30000, 1 / 0.6);
  failures += !same_bits("shallow-dam-break", &s, PBF_FLOAT32, 100);
  s = shallow_dam_break(1000000, 1 / 0.6);
  failures += !same_bits("shallow-dam-break", &s, PBF_FLOAT32, 50);
  return failures;
}
