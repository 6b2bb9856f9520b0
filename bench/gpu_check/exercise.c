/* exercise: every call and stage once, small. */
#include "commands.h"

#include <stdio.h>
#include <stdlib.h>

#include "solver.h"

/* Both ways. */
static void look_at_pressures(pbf_solver *solver, uint32_t count, void *room) {
  pbf_view view = {.struct_size = sizeof view};
  must(pbf_get_pressures(solver, 0, count, room), "pbf_get_pressures");
  must(pbf_map(solver, PBF_FIELD_PRESSURE, &view), "pbf_map");
  must(pbf_unmap(solver, PBF_FIELD_PRESSURE), "pbf_unmap");
}

static void exercise(const scene *s, uint32_t precision) {
  pbf_solver *solver = solver_for(s, checked_backend, precision);
  uint32_t count = scene_count(s), gone[3] = {1, 7, 50};
  must(pbf_step(solver, 3), "pbf_step");
  stats_of(solver);
  must(pbf_remove_particles(solver, 3, gone), "pbf_remove_particles");
  uint32_t row = s->dimension * precision;
  char *room = malloc((size_t)count * row);
  must(pbf_get_positions(solver, 0, count - 3, room), "pbf_get_positions");
  must(pbf_set_positions(solver, 0, count - 3, room), "pbf_set_positions");
  must(pbf_get_velocities(solver, 5, 100, room), "pbf_get_velocities");
  must(pbf_set_velocities(solver, 5, 100, room), "pbf_set_velocities");
  must(pbf_get_densities(solver, 0, count - 3, room), "pbf_get_densities");
  int has_pressures = s->params.solver == PBF_SOLVER_CHEBYSHEV;
  if (has_pressures) look_at_pressures(solver, count - 3, room);
  must(pbf_get_positions(solver, 0, 3, room), "pbf_get_positions");
  must(pbf_add_particles(solver, 3, room, NULL, NULL), "pbf_add_particles");
  must(pbf_set_timing(solver, 1), "pbf_set_timing");
  must(pbf_step(solver, 2), "pbf_step");
  must(pbf_set_timing(solver, 0), "pbf_set_timing");
  if (has_pressures) look_at_pressures(solver, count, room);
  printf("{\"check\": \"exercise\", \"dimension\": %u, \"precision\": %u, \"hash\": \"%016llx\"}\n",
         s->dimension, 8 * precision, (unsigned long long)hash_of(solver));
  fflush(stdout);
  free(room);
  pbf_destroy(solver);
}

/* So tall that its pressure grid has coarser levels, under a lid that bears it. */
static scene deep_scene(uint32_t dimension) {
  scene s = small_scene(dimension);
  pbf_collider *lid = &s.colliders[0];
  s.params.solver = PBF_SOLVER_CHEBYSHEV;
  s.params.cohesion = 0;
  s.params.wall_density = 1;
  s.params.pressure_grid = 2;
  s.params.loads = 1;
  s.params.smoothing_radius = 2 * s.spacing;
  s.counts[0] = s.counts[2] = 4;
  s.counts[1] = 100;
  s.params.domain_max[1] = 5.5;
  s.params.domain_max[0] = s.params.domain_max[2] = 4 * s.spacing;
  must(pbf_collider_init(lid, sizeof *lid, PBF_COLLIDER_BOX), "pbf_collider_init");
  for (int a = 0; a < 3; ++a) lid->position[a] = lid->half_extents[a] = 2 * s.spacing;
  lid->position[1] = s.spacing * (s.counts[1] + 2);
  s.collider_count = 1;
  return s;
}

/* What comes and goes among particles that had been removed before, so that ids have gaps. */
static void exercise_flow(uint32_t dimension, uint32_t precision) {
  scene s = shallow_dam_break(3000, 2);
  s.dimension = dimension;
  s.flow = "flow";
  pbf_solver *solver = solver_for(&s, checked_backend, precision);
  must(pbf_step(solver, 40), "pbf_step");
  printf("{\"check\": \"flow\", \"dimension\": %u, \"precision\": %u, \"hash\": \"%016llx\"}\n",
         dimension, 8 * precision, (unsigned long long)hash_of(solver));
  pbf_destroy(solver);
}

void exercise_all(void) {
  for (uint32_t dim = 2; dim <= 3; ++dim)
    for (uint32_t precision = PBF_FLOAT32; precision <= PBF_FLOAT64; precision += 4) {
      exercise_flow(dim, precision);
      scene deep = deep_scene(dim);
      exercise(&deep, precision);
      deep.collider_count = 0; /* nodes are then not torn */
      exercise(&deep, precision);
      for (int k = 0; k < 8; ++k) {
        scene s = k < 4 ? small_scene(dim) : accelerated_scene(dim, k % 2);
        s.counts[0] = 9, s.counts[1] = 13;
        double prestabilization = s.params.prestabilization;
        s.params.prestabilization = 0;
        if (k < 4) set_kernel(&s, k);
        if (k >= 6) add_mirrors(&s), s.params.pressure_grid = 2;
        if (k > 0 && k < 4) {
          s.params.vorticity = s.params.viscosity = 0.05;
          add_colliders(&s);
        }
        if (k == 1) s.params.vorticity = s.params.viscosity = 0, s.params.wall_density = 1;
        if (k == 2) add_optional(&s, NULL);
        if (k == 3) s.params.smoothing_radius = 0.2, s.params.spacing = 0.15; /* lists overflow */
        exercise(&s, precision);
        if (k % 4 == 0) s.spacing = 1e-3; /* cells overflow */
        if (k % 4 == 0) exercise(&s, precision);
        if (k != 2 && k < 5) continue;
        s.params.prestabilization = prestabilization;
        s.spacing *= 0.95; /* a start that is projected */
        exercise(&s, precision);
      }
    }
}
