/* Queries: the same bits of both, and nothing beyond what is asked for. */
#include <math.h>
#include <string.h>

#include <pbf/query.h>

#include "table.h"

enum { MOST_ASKED = 40, GUARD = 0xa5 };

typedef struct question {
  uint32_t count, capacity, found[TWINS];
  double x[MOST_ASKED * 3], to[MOST_ASKED * 3], length;
  pbf_volume volumes[2];
  pbf_sample_grid grid;
  int fields;
  actor *asker;
} question;

static double wild_or(dice *d, double number) {
  static const double wild[] = {NAN, INFINITY, -INFINITY, 1e30, -1e300, 1e-300, 0, -1};
  return dice_one_in(d, 200) ? wild[dice_below(d, 8)] : number;
}

static void draw_volume(actor *a, pbf_volume *volume) {
  dice *d = &a->dice;
  const double angle = dice_in(d, -3, 3);
  if (pbf_volume_init(volume, sizeof *volume, dice_below(d, 3)) != PBF_OK)
    found(a->number, "pbf_volume_init refuses its defaults");
  for (int k = 0; k < 3; ++k) {
    volume->position[k] = wild_or(d, dice_in(d, 0, 1));
    volume->half_extents[k] = wild_or(d, dice_in(d, 0.01, 0.4));
    volume->axis[k] = wild_or(d, dice_in(d, -1, 1));
  }
  volume->radius = wild_or(d, dice_in(d, 0.01, 0.4));
  volume->half_length = wild_or(d, dice_in(d, 0, 0.4));
  volume->orientation[2] = sin(angle);
  volume->orientation[3] = cos(angle);
  if (dice_one_in(d, 30)) volume->orientation[dice_below(d, 4)] = dice_in(d, -1, 1);
  if (dice_one_in(d, 40)) volume->shape = dice_below(d, 5);
  if (dice_one_in(d, 40)) volume->struct_size = dice_below(d, sizeof *volume);
}

static question *draw_question(actor *a) {
  static _Thread_local question q;
  dice *d = &a->dice;
  memset(&q, 0, sizeof q);
  q.asker = a;
  q.count = dice_below(d, MOST_ASKED + 1);
  q.capacity = dice_below(d, MOST_PARTICLES);
  q.fields = (int)dice_below(d, 16);
  for (uint32_t i = 0; i < MOST_ASKED * 3; ++i) {
    q.x[i] = wild_or(d, dice_in(d, -0.2, 1.2));
    q.to[i] = wild_or(d, dice_in(d, -1, 1));
  }
  q.length = dice_one_in(d, 2) ? INFINITY : wild_or(d, dice_in(d, 0.01, 2));
  draw_volume(a, &q.volumes[0]);
  draw_volume(a, &q.volumes[1]);
  q.grid.struct_size = sizeof q.grid;
  for (int k = 0; k < 3; ++k) {
    q.grid.counts[k] = dice_below(d, 4);
    q.grid.origin[k] = wild_or(d, dice_in(d, 0, 1));
    q.grid.step[k] = wild_or(d, dice_in(d, -0.1, 0.1));
  }
  memset(a->numbers, GUARD, sizeof a->numbers);
  return &q;
}

/* Both answers are the same, and a call that fails has written nothing. */
static pbf_status ask(actor *a, action act, question *q) {
  pbf_status status = call_both(a, act, q, CALL_READS);
  insist(a, memcmp(a->numbers[0], a->numbers[1], sizeof a->numbers[0]) == 0);
  for (size_t i = 0; i < sizeof a->numbers[0] && status != PBF_OK; ++i)
    insist(a, a->numbers[0][i] == GUARD);
  return status;
}

static double *numbers_of(const question *q, int twin) {
  return (double *)(void *)q->asker->numbers[twin];
}

static pbf_samples samples_of(const question *q, int twin) {
  double *to = numbers_of(q, twin);
  pbf_samples samples = {.struct_size = sizeof samples, .count = q->count, .points = q->x};
  if (q->fields & 1) samples.densities = to;
  if (q->fields & 2) samples.velocities = to + MOST_ASKED;
  if (q->fields & 4) samples.pressures = to + 4 * MOST_ASKED;
  if (q->fields & 8) samples.wet = (uint8_t *)(to + 5 * MOST_ASKED);
  return samples;
}

static pbf_status sample(pbf_solver *solver, int twin, void *context) {
  const pbf_samples samples = samples_of(context, twin);
  return pbf_sample(solver, &samples);
}

static pbf_status sample_on_grid(pbf_solver *solver, int twin, void *context) {
  const question *q = context;
  pbf_samples samples = samples_of(q, twin);
  const uint32_t depth = q->asker->subject->dimension == 3 ? q->grid.counts[2] : 1;
  samples.points = NULL;
  samples.count = q->grid.counts[0] * q->grid.counts[1] * depth;
  return pbf_sample_on_grid(solver, &q->grid, &samples);
}

static pbf_status cast_rays(pbf_solver *solver, int twin, void *context) {
  const question *q = context;
  double *to = numbers_of(q, twin);
  return pbf_cast_rays(solver, q->count, q->x, q->to, q->length, to,
                       q->fields & 1 ? to + MOST_ASKED : NULL);
}

static pbf_status get_levels(pbf_solver *solver, int twin, void *context) {
  const question *q = context;
  return pbf_get_levels(solver, q->count, q->x, numbers_of(q, twin));
}

static pbf_status measure_volumes(pbf_solver *solver, int twin, void *context) {
  const question *q = context;
  pbf_volume_flow flows[2] = {{.struct_size = sizeof *flows}, {.struct_size = sizeof *flows}};
  pbf_status status = pbf_measure_volumes(solver, 2, q->volumes, flows);
  if (status == PBF_OK) memcpy(numbers_of(q, twin), flows, sizeof flows);
  return status;
}

static pbf_status find_in_volume(pbf_solver *solver, int twin, void *context) {
  question *q = context;
  return pbf_find_in_volume(solver, q->volumes, q->capacity,
                            (uint32_t *)(void *)numbers_of(q, twin), &q->found[twin]);
}

static pbf_status end_queries(pbf_solver *solver, int twin, void *context) {
  (void)twin;
  (void)context;
  return pbf_end_queries(solver);
}

void call_volume_init(actor *a) {
  pbf_volume volume;
  const uint32_t shape = dice_below(&a->dice, 5), size = dice_below(&a->dice, 2 * sizeof volume);
  const pbf_status status =
      pbf_volume_init(&volume, size > sizeof volume ? (uint32_t)sizeof volume : size, shape);
  insist(a, status != PBF_OK || (shape < 3 && volume.shape == shape));
}

void call_sample(actor *a) { ask(a, sample, draw_question(a)); }
void call_sample_on_grid(actor *a) { ask(a, sample_on_grid, draw_question(a)); }
void call_cast_rays(actor *a) { ask(a, cast_rays, draw_question(a)); }
void call_get_levels(actor *a) { ask(a, get_levels, draw_question(a)); }
void call_measure_volumes(actor *a) { ask(a, measure_volumes, draw_question(a)); }
void call_end_queries(actor *a) { ask(a, end_queries, draw_question(a)); }

void call_find_in_volume(actor *a) {
  question *q = draw_question(a);
  if (ask(a, find_in_volume, q) != PBF_OK) return;
  const uint32_t *ids = (const uint32_t *)(const void *)a->numbers[0];
  insist(a, q->found[0] == q->found[1] && q->found[0] <= a->subject->model.count);
  for (uint32_t i = 1; i < q->found[0] && i < q->capacity; ++i) insist(a, ids[i - 1] < ids[i]);
}
