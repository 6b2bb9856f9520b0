/* Several fluids: their table, and which particles are of which. */
#include <math.h>
#include <string.h>

#include <pbf/phases.h>

#include "table.h"

typedef struct fluids {
  pbf_phase of[3], seen[TWINS];
  uint32_t count, index, first, rows, phases[MOST_PARTICLES], read[TWINS][MOST_PARTICLES];
} fluids;

static fluids *draw_fluids(actor *a) {
  static _Thread_local fluids f;
  static const double wild[] = {NAN, 0, -1, 1e30, 1e-300};
  dice *d = &a->dice;
  memset(&f, 0, sizeof f);
  f.count = dice_below(d, 4);
  f.index = dice_below(d, 3);
  for (int i = 0; i < 3; ++i) {
    insist(a, pbf_phase_init(&f.of[i], sizeof f.of[i]) == PBF_OK);
    f.of[i].rest_density = dice_in(d, 0.2, 2);
    f.of[i].viscosity = dice_in(d, 0, 1);
    if (dice_one_in(d, 16)) f.of[i].rest_density = wild[dice_below(d, 5)];
  }
  f.first = dice_below(d, a->subject->model.count + 1);
  f.rows = dice_below(d, a->subject->model.count - f.first + 1);
  for (uint32_t i = 0; i < MOST_PARTICLES; ++i) f.phases[i] = dice_below(d, 3);
  return &f;
}

static pbf_status set_phases(pbf_solver *solver, int twin, void *context) {
  const fluids *f = context;
  (void)twin;
  return pbf_set_phases(solver, f->count, f->of);
}

static pbf_status get_phase_count(pbf_solver *solver, int twin, void *context) {
  return pbf_get_phase_count(solver, &((fluids *)context)->read[twin][0]);
}

static pbf_status get_phase(pbf_solver *solver, int twin, void *context) {
  fluids *f = context;
  f->seen[twin].struct_size = sizeof f->seen[twin];
  return pbf_get_phase(solver, f->index, &f->seen[twin]);
}

static pbf_status set_particle_phases(pbf_solver *solver, int twin, void *context) {
  const fluids *f = context;
  (void)twin;
  return pbf_set_particle_phases(solver, f->first, f->rows, f->phases);
}

static pbf_status get_particle_phases(pbf_solver *solver, int twin, void *context) {
  fluids *f = context;
  return pbf_get_particle_phases(solver, f->first, f->rows, f->read[twin]);
}

void call_phase_init(actor *a) { draw_fluids(a); }

void call_set_phases(actor *a) { call_both(a, set_phases, draw_fluids(a), 0); }

void call_set_particle_phases(actor *a) { call_both(a, set_particle_phases, draw_fluids(a), 0); }

static void read_both(actor *a, action act) {
  fluids *f = draw_fluids(a);
  if (call_both(a, act, f, CALL_READS) != PBF_OK) return;
  insist(a, memcmp(f->read[0], f->read[1], sizeof f->read[0]) == 0);
  insist(a, memcmp(&f->seen[0], &f->seen[1], sizeof f->seen[0]) == 0);
}

void call_get_phase_count(actor *a) { read_both(a, get_phase_count); }
void call_get_phase(actor *a) { read_both(a, get_phase); }
void call_get_particle_phases(actor *a) { read_both(a, get_particle_phases); }
