/* Parameters, colliders, and what a solver tells of itself. */
#include <math.h>
#include <string.h>

#include "../fuzz/draw.h"
#include "table.h"

enum { DRAWN = 96, MOST_COLLIDERS = 5 };

/* The fuzz targets draw from bytes. */
static input input_of(actor *a, uint8_t *bytes) {
  dice_bytes(&a->dice, bytes, DRAWN);
  return (input){bytes, DRAWN, 0};
}

static pbf_status set_params(pbf_solver *solver, int twin, void *context) {
  (void)twin;
  return pbf_set_params(solver, context);
}

void call_set_params(actor *a) {
  uint8_t bytes[DRAWN];
  input in = input_of(a, bytes);
  pbf_params params = {.struct_size = sizeof params};
  while (pbf_get_params(a->subject->twin[0], &params) == PBF_ERROR_BUSY) {
  }
  int wild = 0;
  if (dice_one_in(&a->dice, 5)) {
    const double kept = params.prestabilization;
    insist(a, pbf_params_init(&params, sizeof params) == PBF_OK);
    params.prestabilization = kept;
  } else {
    wild = draw_params(&in, &params);
  }
  if (params.iterations > 16) params.iterations = 16;
  if (call_both(a, set_params, &params, 0) == PBF_OK) a->subject->wild |= wild;
}

enum { MOST_LOADS = 64 };

typedef struct out {
  uint32_t index;
  double limit[TWINS];
  uint32_t number[TWINS];
  pbf_params params[TWINS];
  pbf_collider collider[TWINS];
  pbf_collider_load loads[TWINS][MOST_LOADS];
  pbf_info info[TWINS];
  pbf_plan plan[TWINS];
  pbf_stats stats[TWINS];
  pbf_timings timings[TWINS];
} out;

/* Too large for many stacks. */
static out *zeros(void) {
  static _Thread_local out o;
  memset(&o, 0, sizeof o);
  return &o;
}

static pbf_status get_params(pbf_solver *solver, int twin, void *context) {
  pbf_params *params = &((out *)context)->params[twin];
  params->struct_size = sizeof *params;
  return pbf_get_params(solver, params);
}

void call_get_params(actor *a) { call_both(a, get_params, zeros(), CALL_READS); }

/* ---- Colliders ---- */

typedef struct colliders {
  uint32_t count;
  double duration;
  pbf_collider all[64];
} colliders;

static pbf_status set_colliders(pbf_solver *solver, int twin, void *context) {
  const colliders *c = context;
  (void)twin;
  return pbf_set_colliders(solver, c->count, c->all);
}

static pbf_status move_colliders(pbf_solver *solver, int twin, void *context) {
  const colliders *c = context;
  (void)twin;
  return pbf_move_colliders(solver, c->count, c->all, c->duration);
}

void call_set_colliders(actor *a) {
  static _Thread_local colliders c;
  int wild = 0;
  c.count = dice_one_in(&a->dice, 20) ? 64 : dice_below(&a->dice, MOST_COLLIDERS);
  for (uint32_t i = 0; i < c.count; ++i) {
    uint8_t bytes[DRAWN];
    input in = input_of(a, bytes);
    wild |= draw_collider(&in, &c.all[i]);
  }
  if (call_both(a, set_colliders, &c, 0) == PBF_OK) a->subject->wild |= wild;
}

/* Where they are now, and a little off. */
void call_move_colliders(actor *a) {
  static _Thread_local colliders c;
  while (pbf_get_collider_count(a->subject->twin[0], &c.count) == PBF_ERROR_BUSY) {
  }
  for (uint32_t i = 0; i < c.count; ++i) {
    c.all[i] = (pbf_collider){.struct_size = sizeof c.all[i]};
    while (pbf_get_collider(a->subject->twin[0], i, &c.all[i]) == PBF_ERROR_BUSY) {
    }
    for (int axis = 0; axis < 3; ++axis) c.all[i].position[axis] += dice_in(&a->dice, -0.2, 0.2);
    if (dice_one_in(&a->dice, 16)) c.all[i].radius = dice_one_in(&a->dice, 2) ? NAN : -1;
  }
  c.duration = dice_one_in(&a->dice, 8) ? 0 : dice_in(&a->dice, 0.001, 0.1);
  if (dice_one_in(&a->dice, 8)) ++c.count;
  if (c.count > 64) c.count = 64;
  call_both(a, move_colliders, &c, 0);
}

static pbf_status get_collider_count(pbf_solver *solver, int twin, void *context) {
  return pbf_get_collider_count(solver, &((out *)context)->number[twin]);
}

static pbf_status get_collider(pbf_solver *solver, int twin, void *context) {
  out *o = context;
  o->collider[twin].struct_size = sizeof o->collider[twin];
  return pbf_get_collider(solver, o->index, &o->collider[twin]);
}

void call_get_collider_count(actor *a) {
  out *o = zeros();
  insist(a,
         call_both(a, get_collider_count, o, CALL_READS) != PBF_OK || o->number[0] == o->number[1]);
}

void call_get_collider(actor *a) {
  out *o = zeros();
  o->index = dice_below(&a->dice, 5);
  if (call_both(a, get_collider, o, CALL_READS) != PBF_OK) return;
  insist(a, memcmp(&o->collider[0], &o->collider[1], sizeof o->collider[0]) == 0);
}

static pbf_collider_load *loads_of(out *o, int twin) {
  for (uint32_t k = 0; k < o->index && k < MOST_LOADS; ++k)
    o->loads[twin][k].struct_size = sizeof o->loads[twin][k];
  return o->loads[twin];
}

static pbf_status get_collider_loads(pbf_solver *solver, int twin, void *context) {
  out *o = context;
  return pbf_get_collider_loads(solver, o->index, loads_of(o, twin));
}

static pbf_status get_wall_loads(pbf_solver *solver, int twin, void *context) {
  out *o = context;
  return pbf_get_wall_loads(solver, o->index, loads_of(o, twin));
}

void call_get_collider_loads(actor *a) {
  out *o = zeros();
  o->index = dice_below(&a->dice, 5);
  call_both(a, get_collider_loads, o, CALL_READS);
}

void call_get_wall_loads(actor *a) {
  out *o = zeros();
  o->index = 4 + dice_below(&a->dice, 3);
  call_both(a, get_wall_loads, o, CALL_READS);
}

/* ---- Reports ---- */

static pbf_status set_timing(pbf_solver *solver, int twin, void *context) {
  (void)twin;
  return pbf_set_timing(solver, ((out *)context)->index);
}

void call_set_timing(actor *a) {
  out *o = zeros();
  o->index = dice_below(&a->dice, 2);
  call_both(a, set_timing, o, CALL_READS);
}

static pbf_status get_timings(pbf_solver *solver, int twin, void *context) {
  pbf_timings *timings = &((out *)context)->timings[twin];
  timings->struct_size = sizeof *timings;
  return pbf_get_timings(solver, timings);
}

void call_get_timings(actor *a) {
  out *o = zeros();
  if (call_both(a, get_timings, o, CALL_READS) != PBF_OK) return;
  insist(a, o->timings[0].stage_count <= PBF_MAX_STAGES);
  for (uint32_t i = 0; i < o->timings[0].stage_count; ++i)
    insist(a, o->timings[0].stages[i].name[0] && o->timings[0].stages[i].milliseconds >= 0);
}

static pbf_status get_plan(pbf_solver *solver, int twin, void *context) {
  pbf_plan *plan = &((out *)context)->plan[twin];
  plan->struct_size = sizeof *plan;
  return pbf_get_plan(solver, plan);
}

/* What the allocator has given is at least what the plan says. */
void call_get_plan(actor *a) {
  out *o = zeros();
  if (call_both(a, get_plan, o, CALL_READS) != PBF_OK) return;
  insist(a, o->plan[0].stage_count <= PBF_MAX_STAGES && o->plan[0].array_count <= PBF_MAX_ARRAYS);
  insist(a, isfinite(o->plan[0].bytes_per_particle));
}

static pbf_status get_info(pbf_solver *solver, int twin, void *context) {
  pbf_info *info = &((out *)context)->info[twin];
  info->struct_size = sizeof *info;
  return pbf_get_info(solver, info);
}

void call_get_info(actor *a) {
  out *o = zeros();
  if (call_both(a, get_info, o, CALL_READS) != PBF_OK) return;
  for (int twin = 0; twin < TWINS; ++twin) {
    const pbf_info *info = &o->info[twin];
    insist(a, info->dimension == a->subject->dimension && !info->fell_back);
    insist(a, info->precision == a->subject->precision && info->capacity == a->subject->capacity);
    insist(a, strcmp(info->backend, a->subject->backend[twin]) == 0);
  }
}

static pbf_status get_stats(pbf_solver *solver, int twin, void *context) {
  pbf_stats *stats = &((out *)context)->stats[twin];
  stats->struct_size = sizeof *stats;
  return pbf_get_stats(solver, stats);
}

void call_get_stats(actor *a) {
  out *o = zeros();
  if (call_both(a, get_stats, o, CALL_READS) != PBF_OK) return;
  const pbf_stats *s = &o->stats[0];
  insist(a,
         s->count == a->subject->model.count && s->neighbors_max <= (s->count ? s->count - 1 : 0));
  insist(a, s->asleep <= s->count && s->squeezed <= s->count);
  insist(a, isfinite(s->kinetic_energy) && isfinite(s->speed_max) && isfinite(s->density_mean));
  if (!isfinite(s->density_error_max) || s->density_error_mean > s->density_error_max * (1 + 1e-9))
    found(a->number, "%s: a density error of %g at most, and of %.17g on average", a->function,
          s->density_error_max, s->density_error_mean);
  insist(a, !(s->step_limit <= 0));
}

static pbf_status get_step_limit(pbf_solver *solver, int twin, void *context) {
  return pbf_get_step_limit(solver, &((out *)context)->limit[twin]);
}

void call_get_step_limit(actor *a) {
  out *o = zeros();
  if (call_both(a, get_step_limit, o, CALL_READS) != PBF_OK) return;
  if (!(o->limit[0] > 0)) found(a->number, "%s: a limit of %g", a->function, o->limit[0]);
  insist(a, memcmp(&o->limit[0], &o->limit[1], sizeof o->limit[0]) == 0);
}
