/* time: how long steps of a scene take. */
#include "commands.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "solver.h"

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int ascending(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* One step a call, as a game does it. */
static double time_single_calls(pbf_solver *solver, uint32_t steps) {
  double begin = now();
  for (uint32_t k = 0; k < steps; ++k) must(pbf_step(solver, 1), "pbf_step");
  must(pbf_synchronize(solver), "pbf_synchronize");
  return 1e3 * (now() - begin) / steps;
}

static void print_stages(pbf_solver *solver, uint32_t steps) {
  pbf_timings t = {.struct_size = sizeof t};
  if (pbf_set_timing(solver, 1) != PBF_OK) return; /* this backend takes no times */
  must(pbf_step(solver, steps), "pbf_step");
  must(pbf_get_timings(solver, &t), "pbf_get_timings");
  must(pbf_set_timing(solver, 0), "pbf_set_timing");
  printf("\"stage_us\": {");
  for (uint32_t k = 0; k < t.stage_count; ++k)
    printf("%s\"%s\": %.2f", k ? ", " : "", t.stages[k].name,
           1e3 * t.stages[k].milliseconds / steps);
  printf("}, ");
}

void time_scene(const scene *s, uint32_t precision, uint32_t lead_in, uint32_t steps) {
  enum { RUNS = 5 };
  double ms[RUNS];
  pbf_solver *solver = solver_for(s, checked_backend, precision);
  must(pbf_step(solver, lead_in), "pbf_step");
  must(pbf_synchronize(solver), "pbf_synchronize");
  uint64_t size = 0;
  uint32_t count = scene_count(s);
  void *state = count <= 5000000 ? saved(solver, &size) : NULL; /* the same steps each time */
  for (int run = 0; run < RUNS; ++run) {
    if (state) must(pbf_load(solver, state, size), "pbf_load");
    must(pbf_synchronize(solver), "pbf_synchronize");
    double begin = now();
    must(pbf_step(solver, steps), "pbf_step");
    must(pbf_synchronize(solver), "pbf_synchronize");
    ms[run] = 1e3 * (now() - begin) / steps;
  }
  if (state) must(pbf_load(solver, state, size), "pbf_load");
  must(pbf_synchronize(solver), "pbf_synchronize");
  double single = time_single_calls(solver, steps);
  qsort(ms, RUNS, sizeof *ms, ascending);
  pbf_stats stats = stats_of(solver);
  pbf_plan plan = {.struct_size = sizeof plan};
  pbf_info info = {.struct_size = sizeof info};
  must(pbf_get_plan(solver, &plan), "pbf_get_plan");
  must(pbf_get_info(solver, &info), "pbf_get_info");
  printf(
      "{\"time\": \"%s\", \"backend\": \"%s\", \"device\": \"%s\", \"build\": \"%s\", "
      "\"variant\": \"%s\", \"particles\": %u, \"support\": %.4f, \"iterations\": %u, "
      "\"extra\": \"%s\", \"lead_in\": %u, \"steps\": %u, \"ms_per_step\": %.5f, \"min\": %.5f, "
      "\"max\": %.5f, "
      "\"ms_per_step_in_single_calls\": %.5f, ",
      s->name, info.backend, info.device_name, info.build_id, plan.variant, count,
      s->params.smoothing_radius / s->spacing, s->params.iterations, s->extra ? s->extra : "",
      lead_in, steps, ms[RUNS / 2], ms[0], ms[RUNS - 1], single);
  print_stages(solver, steps < 20 ? steps : 20);
  printf(
      "\"particle_iterations_per_second\": %.4g, \"neighbors_mean\": %.2f, "
      "\"neighbors_max\": %u, \"density_error_mean\": %.5f, \"density_error_max\": %.4f, "
      "\"center_of_mass\": [%.4f, %.4f, %.4f], \"position_max\": [%.3f, %.3f, %.3f], "
      "\"bytes_per_particle\": %.1f}\n",
      1e3 * count * s->params.iterations / ms[RUNS / 2], stats.neighbors_mean, stats.neighbors_max,
      stats.density_error_mean, stats.density_error_max, stats.center_of_mass[0],
      stats.center_of_mass[1], stats.center_of_mass[2], stats.position_max[0],
      stats.position_max[1], stats.position_max[2], plan.bytes_per_particle);
  fflush(stdout);
  free(state);
  pbf_destroy(solver);
}
