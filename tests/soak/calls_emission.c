/* Emitters, drains and reservoirs as they are set and read. They are gone again before a step: what
 * comes in steps is not in the model of a subject. */
#include <math.h>
#include <string.h>

#include <pbf/emit.h>

#include "table.h"

typedef struct flow {
  pbf_emitter emitters[2];
  pbf_volume drains[2];
  pbf_reservoir reservoirs[2];
  uint32_t count, index;
  actor *maker;
} flow;

static flow *draw_flow(actor *a) {
  static _Thread_local flow f;
  static const double wild[] = {NAN, INFINITY, -1, 0, 1e30, -1e300, 1e-300, 5};
  dice *d = &a->dice;
  memset(&f, 0, sizeof f);
  f.maker = a;
  f.count = dice_below(d, 3);
  f.index = dice_below(d, 3);
  for (int i = 0; i < 2; ++i) {
    pbf_emitter *e = &f.emitters[i];
    insist(a, pbf_emitter_init(e, sizeof *e, dice_below(d, 2)) == PBF_OK);
    insist(a, pbf_volume_init(&f.drains[i], sizeof f.drains[i], dice_below(d, 3)) == PBF_OK);
    for (int k = 0; k < 3; ++k) {
      e->position[k] = dice_in(d, 0.3, 0.7);
      e->velocity[k] = dice_in(d, -2, 2);
      f.drains[i].position[k] = dice_in(d, 0, 1);
    }
    insist(a, pbf_reservoir_init(&f.reservoirs[i], sizeof f.reservoirs[i]) == PBF_OK);
    for (int k = 0; k < 3; ++k) {
      f.reservoirs[i].position[k] = 0.5;
      f.reservoirs[i].half_extents[k] = dice_in(d, 0.01, 0.5);
    }
    f.reservoirs[i].depth = dice_in(d, 0.01, 1);
    if (dice_one_in(d, 8)) f.reservoirs[i].pressure = wild[dice_below(d, 8)];
    e->half_width = e->half_height = e->radius = dice_in(d, 0.01, 0.2);
    e->jitter = dice_in(d, 0, 1.05);
    if (dice_one_in(d, 4)) e->rate = dice_in(d, 0, 0.1);
    if (dice_one_in(d, 8)) e->position[dice_below(d, 3)] = wild[dice_below(d, 8)];
    if (dice_one_in(d, 8)) e->radius = e->half_width = wild[dice_below(d, 8)];
    if (dice_one_in(d, 8)) f.drains[i].radius = wild[dice_below(d, 8)];
    if (dice_one_in(d, 16)) e->struct_size = dice_below(d, sizeof *e);
  }
  memset(a->numbers, 0, sizeof a->numbers);
  return &f;
}

static pbf_status set_emitters(pbf_solver *solver, int twin, void *context) {
  const flow *f = context;
  (void)twin;
  pbf_status status = pbf_set_emitters(solver, f->count, f->emitters);
  if (status == PBF_OK) status = pbf_set_emitters(solver, 0, NULL);
  return status;
}

static pbf_status set_drains(pbf_solver *solver, int twin, void *context) {
  const flow *f = context;
  (void)twin;
  pbf_status status = pbf_set_drains(solver, f->count, f->drains);
  if (status == PBF_OK) status = pbf_set_drains(solver, 0, NULL);
  return status;
}

static pbf_status set_reservoirs(pbf_solver *solver, int twin, void *context) {
  const flow *f = context;
  (void)twin;
  pbf_status status = pbf_set_reservoirs(solver, f->count, f->reservoirs);
  if (status == PBF_OK) status = pbf_set_reservoirs(solver, 0, NULL);
  return status;
}

static pbf_status get_emitter(pbf_solver *solver, int twin, void *context) {
  const flow *f = context;
  pbf_emitter *to = (pbf_emitter *)(void *)f->maker->numbers[twin];
  to->struct_size = sizeof *to;
  return pbf_get_emitter(solver, f->index, to);
}

static pbf_status get_drain(pbf_solver *solver, int twin, void *context) {
  const flow *f = context;
  pbf_volume *to = (pbf_volume *)(void *)f->maker->numbers[twin];
  to->struct_size = sizeof *to;
  return pbf_get_drain(solver, f->index, to);
}

static pbf_status get_reservoir(pbf_solver *solver, int twin, void *context) {
  const flow *f = context;
  pbf_reservoir *to = (pbf_reservoir *)(void *)f->maker->numbers[twin];
  to->struct_size = sizeof *to;
  return pbf_get_reservoir(solver, f->index, to);
}

static pbf_status get_reservoir_count(pbf_solver *solver, int twin, void *context) {
  const flow *f = context;
  return pbf_get_reservoir_count(solver, (uint32_t *)(void *)f->maker->numbers[twin]);
}

static pbf_status get_in_out(pbf_solver *solver, int twin, void *context) {
  const flow *f = context;
  pbf_in_out *to = (pbf_in_out *)(void *)f->maker->numbers[twin];
  to->struct_size = sizeof *to;
  return pbf_get_in_out(solver, to);
}

static void read_both(actor *a, action act, int how) {
  call_both(a, act, draw_flow(a), how);
  insist(a, memcmp(a->numbers[0], a->numbers[1], sizeof(pbf_in_out)) == 0);
}

void call_emitter_init(actor *a) {
  pbf_emitter emitter;
  const uint32_t shape = dice_below(&a->dice, 4);
  const pbf_status status = pbf_emitter_init(&emitter, sizeof emitter, shape);
  insist(a, (status == PBF_OK) == (shape < 2));
}

void call_reservoir_init(actor *a) {
  pbf_reservoir reservoir;
  insist(a, pbf_reservoir_init(&reservoir, sizeof reservoir) == PBF_OK);
}

void call_set_emitters(actor *a) { call_both(a, set_emitters, draw_flow(a), CALL_READS); }
void call_set_drains(actor *a) { call_both(a, set_drains, draw_flow(a), CALL_READS); }
void call_get_emitter(actor *a) { read_both(a, get_emitter, CALL_READS | CALL_WRONG); }
void call_get_drain(actor *a) { read_both(a, get_drain, CALL_READS | CALL_WRONG); }
void call_get_in_out(actor *a) { read_both(a, get_in_out, CALL_READS); }
void call_set_reservoirs(actor *a) { call_both(a, set_reservoirs, draw_flow(a), CALL_READS); }
void call_get_reservoir(actor *a) { read_both(a, get_reservoir, CALL_READS | CALL_WRONG); }
void call_get_reservoir_count(actor *a) { read_both(a, get_reservoir_count, CALL_READS); }
