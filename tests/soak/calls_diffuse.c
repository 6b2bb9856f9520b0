/* Spray, foam and bubbles, which stay on over steps, saves and loads: both twins have to have the
 * same ones. */
#include <math.h>
#include <string.h>

#include <pbf/diffuse.h>

#include "table.h"

enum { MOST_DIFFUSE = 64 };

typedef struct sprays {
  pbf_diffuse_desc desc, seen[TWINS];
  pbf_diffuse_info info[TWINS];
  int is_on;
  uint32_t count, first;
  double x[3 * MOST_DIFFUSE], way[3];
  double read[TWINS][9 * MOST_DIFFUSE];
} sprays;

static sprays *draw_sprays(actor *a) {
  static _Thread_local sprays s;
  static const double wild[] = {NAN, INFINITY, -1, 0, 1e30, -1e300, 1e-300, 5};
  dice *d = &a->dice;
  memset(&s, 0, sizeof s);
  s.is_on = !dice_one_in(d, 4);
  s.desc = (pbf_diffuse_desc){.struct_size = sizeof s.desc,
                              .capacity = 1 + dice_below(d, MOST_DIFFUSE),
                              .seed = dice_below(d, 3),
                              .interval = 1 + dice_below(d, 3),
                              .foam_neighbors = dice_below(d, 8),
                              .bubble_neighbors = 8 + dice_below(d, 20),
                              .trapped_air_max = dice_in(d, 0.1, 1),
                              .wave_crest_max = dice_in(d, 0.1, 1),
                              .energy_max = dice_in(d, 0.01, 1),
                              .trapped_air_rate = dice_in(d, 0, 50),
                              .wave_crest_rate = dice_one_in(d, 2) ? dice_in(d, 0, 50) : 0,
                              .lifetime_max = dice_in(d, 0, 0.2),
                              .buoyancy = dice_in(d, 0, 3),
                              .bubble_drag = dice_in(d, 0, 50),
                              .spray_drag = dice_in(d, 0, 1),
                              .scatter = dice_in(d, 0, 1)};
  if (dice_one_in(d, 8)) s.desc.energy_min = wild[dice_below(d, 8)];
  if (dice_one_in(d, 8)) s.desc.bubble_drag = wild[dice_below(d, 8)];
  if (dice_one_in(d, 16)) s.desc.struct_size = dice_below(d, sizeof s.desc);
  s.count = dice_below(d, MOST_DIFFUSE + 1);
  s.first = dice_below(d, 8);
  for (int i = 0; i < 3 * MOST_DIFFUSE; ++i) s.x[i] = dice_in(d, 0.01, 1);
  for (int k = 0; k < 3; ++k) s.way[k] = dice_in(d, -0.1, 0.1);
  if (dice_one_in(d, 8)) s.way[dice_below(d, 3)] = wild[dice_below(d, 8)];
  return &s;
}

static pbf_status init(pbf_solver *solver, int twin, void *context) {
  sprays *s = context;
  return pbf_diffuse_init(solver, &s->seen[twin], sizeof s->seen[twin]);
}

static pbf_status set(pbf_solver *solver, int twin, void *context) {
  const sprays *s = context;
  (void)twin;
  return pbf_set_diffuse(solver, s->is_on ? &s->desc : NULL);
}

static pbf_status get(pbf_solver *solver, int twin, void *context) {
  sprays *s = context;
  s->seen[twin].struct_size = sizeof s->seen[twin];
  return pbf_get_diffuse(solver, &s->seen[twin]);
}

static pbf_status get_info(pbf_solver *solver, int twin, void *context) {
  sprays *s = context;
  s->info[twin].struct_size = sizeof s->info[twin];
  return pbf_get_diffuse_info(solver, &s->info[twin]);
}

static pbf_status read_some(pbf_solver *solver, int twin, void *context) {
  sprays *s = context;
  double *to = s->read[twin];
  const pbf_diffuse_read wanted = {.struct_size = sizeof wanted,
                                   .first = s->first,
                                   .count = s->count / 4,
                                   .element_type = PBF_TYPE_FLOAT64,
                                   .components = 3,
                                   .stride = 9 * sizeof *to,
                                   .positions = to,
                                   .velocities = to + 3,
                                   .lives = to + 6,
                                   .kinds = (uint32_t *)(void *)(to + 7),
                                   .ids = (uint64_t *)(void *)(to + 8)};
  return pbf_read_diffuse(solver, &wanted);
}

/* As numbers of float32 and float64 what is above 0 is above 0 in both. */
static pbf_status add(pbf_solver *solver, int twin, void *context) {
  const sprays *s = context;
  (void)twin;
  return pbf_add_diffuse(solver, s->count / 2, s->x, NULL, s->x);
}

static pbf_status shift(pbf_solver *solver, int twin, void *context) {
  const sprays *s = context;
  (void)twin;
  return pbf_shift_diffuse(solver, s->way);
}

/* What one twin has seen, the other has. */
static void see_both(actor *a, action act) {
  sprays *s = draw_sprays(a);
  if (call_both(a, act, s, CALL_READS) != PBF_OK) return;
  insist(a, memcmp(&s->seen[0], &s->seen[1], sizeof s->seen[0]) == 0);
  insist(a, memcmp(&s->info[0], &s->info[1], sizeof s->info[0]) == 0);
  insist(a, memcmp(s->read[0], s->read[1], sizeof s->read[0]) == 0);
}

void call_diffuse_init(actor *a) { see_both(a, init); }
void call_set_diffuse(actor *a) { call_both(a, set, draw_sprays(a), 0); }
void call_get_diffuse(actor *a) { see_both(a, get); }
void call_get_diffuse_info(actor *a) { see_both(a, get_info); }
void call_read_diffuse(actor *a) { see_both(a, read_some); }
void call_add_diffuse(actor *a) { call_both(a, add, draw_sprays(a), 0); }
void call_shift_diffuse(actor *a) { call_both(a, shift, draw_sprays(a), 0); }
