/* Batches: worlds in the state that the subject has saved last. They live for a call. */
#include <dlpack/dlpack.h>
#include <math.h>
#include <pbf/batch.h>
#include <string.h>

#include "table.h"

enum { MOST_WORLDS = 4 };

typedef struct many {
  pbf_batch *batch;
  uint32_t worlds;
  uint8_t mask[MOST_WORLDS];
} many;

/* Of a call that has nothing wrong in it: whatever memory or threads it lacks, it has a sentence.
 */
static int did(actor *a, pbf_status status) {
  check_status(a, status, pbf_last_error());
  return status == PBF_OK;
}

static pbf_solver *world_of(actor *a, const many *m, uint32_t k) {
  pbf_solver *world = NULL;
  insist(a, pbf_batch_get_world(m->batch, k, &world) == PBF_OK && world);
  return world;
}

static void end(many *m) { pbf_batch_destroy(m->batch); }

/* 0: there is none, for want of a saved state, or of memory. */
static int begin(actor *a, many *m) {
  const subject *s = a->subject;
  pbf_desc desc;
  *m = (many){.worlds = 1 + dice_below(&a->dice, MOST_WORLDS)};
  if (!s->saved_size) {
    call_save(a);
    return 0;
  }
  insist(a, pbf_desc_init(&desc, sizeof desc) == PBF_OK);
  desc.dimension = s->saved_dimension;
  desc.precision = s->saved_precision;
  desc.capacity = MOST_PARTICLES;
  desc.backend = s->backend[0];
  desc.strict = 1;
  desc.threads = dice_below(&a->dice, 4);
  if (!did(a, pbf_batch_create(&desc, NULL, m->worlds, &m->batch))) return 0;
  for (uint32_t k = 0; k < MOST_WORLDS; ++k) m->mask[k] = (uint8_t)dice_below(&a->dice, 2);
  if (did(a, pbf_batch_set_start(m->batch, NULL, s->saved, s->saved_size)) &&
      did(a, pbf_batch_reset(m->batch, NULL)))
    return 1;
  end(m);
  return 0;
}

static uint64_t hash_of(actor *a, const many *m, uint32_t k) {
  uint64_t hash = 0;
  return did(a, pbf_hash(world_of(a, m, k), &hash)) ? hash : 0;
}

/* Worlds of the mask are alike, and so are the others. 0: there was no memory for a look. */
static void check_alike(actor *a, const many *m) {
  uint64_t seen[2] = {0, 0};
  for (uint32_t k = 0; k < m->worlds; ++k) {
    const uint64_t hash = hash_of(a, m, k);
    uint64_t *alike = &seen[m->mask[k]];
    if (hash == 0) continue;
    if (*alike == 0) *alike = hash;
    insist(a, hash == *alike);
  }
  if (seen[0]) insist(a, seen[0] == a->subject->saved_hash);
}

void call_batch_create(actor *a) {
  pbf_batch *batch = NULL;
  many m;
  pbf_status status = pbf_batch_create(NULL, NULL, 1, &batch);
  check_status(a, status, pbf_last_error());
  insist(a, status != PBF_OK && !batch);
  if (!begin(a, &m)) return;
  memset(m.mask, 0, sizeof m.mask);
  check_alike(a, &m);
  end(&m);
}

void call_batch_destroy(actor *a) {
  many m;
  pbf_batch_destroy(NULL);
  if (!begin(a, &m)) return;
  pbf_destroy(world_of(a, &m, 0)); /* which is the batch's */
  world_of(a, &m, 0);
  end(&m);
}

void call_batch_get_info(actor *a) {
  pbf_batch_info info = {.struct_size = sizeof info};
  many m;
  if (!begin(a, &m)) return;
  insist(a, pbf_batch_get_info(m.batch, &info) == PBF_OK && info.worlds == m.worlds);
  end(&m);
}

void call_batch_get_world(actor *a) {
  pbf_solver *world = NULL;
  many m;
  if (!begin(a, &m)) return;
  insist(a, pbf_batch_get_world(m.batch, m.worlds, &world) == PBF_ERROR_NOT_FOUND && !world);
  end(&m);
}

/* Steps of some worlds; what fails in one fails in all of these. */
static void step_some(actor *a, int looks) {
  pbf_status statuses[MOST_WORLDS];
  const char *sentence = NULL;
  many m;
  if (!begin(a, &m)) return;
  const pbf_status status = pbf_batch_step(m.batch, m.mask, dice_below(&a->dice, 4));
  check_status(a, status, pbf_last_error());
  if (looks) insist(a, pbf_batch_get_statuses(m.batch, statuses) == PBF_OK);
  for (uint32_t k = 0; k < m.worlds && looks; ++k) {
    insist(a, pbf_batch_get_sentence(m.batch, k, &sentence) == PBF_OK);
    insist(a, (statuses[k] == PBF_OK) == (sentence[0] == 0));
    insist(a, m.mask[k] || statuses[k] == PBF_OK);
    insist(a, status != PBF_OK || statuses[k] == PBF_OK);
  }
  if (status != PBF_ERROR_OUT_OF_MEMORY) check_alike(a, &m);
  end(&m);
}

void call_batch_step(actor *a) { step_some(a, 0); }
void call_batch_get_statuses(actor *a) { step_some(a, 1); }
void call_batch_get_sentence(actor *a) { step_some(a, 1); }

/* A start stays where what is to replace it is no state. */
static void refuse_starts(actor *a, const many *m) {
  const uint64_t sizes[] = {0, 8, a->subject->saved_size - 1, UINT64_MAX};
  const pbf_status status =
      pbf_batch_set_start(m->batch, NULL, a->subject->saved, sizes[dice_below(&a->dice, 4)]);
  check_status(a, status, pbf_last_error());
  insist(a, status != PBF_OK);
}

void call_batch_set_start(actor *a) {
  many m;
  if (!begin(a, &m)) return;
  refuse_starts(a, &m);
  if (did(a, pbf_batch_step(m.batch, m.mask, 1)) &&
      did(a, pbf_batch_set_start(m.batch, m.mask, NULL, 0)) &&
      did(a, pbf_batch_reset(m.batch, NULL)))
    check_alike(a, &m);
  end(&m);
}

void call_batch_reset(actor *a) {
  many m;
  if (!begin(a, &m)) return;
  pbf_batch_step(m.batch, NULL, 2);
  if (did(a, pbf_batch_reset(m.batch, NULL))) {
    memset(m.mask, 0, sizeof m.mask);
    check_alike(a, &m);
  }
  end(&m);
}

void call_batch_set_gravity(actor *a) {
  double gravity[MOST_WORLDS][3];
  many m;
  if (!begin(a, &m)) return;
  for (uint32_t k = 0; k < MOST_WORLDS; ++k)
    for (int c = 0; c < 3; ++c)
      gravity[k][c] = dice_one_in(&a->dice, 30) ? NAN : dice_below(&a->dice, 20) - 10.0;
  if (did(a, pbf_batch_set_gravity(m.batch, m.mask, gravity[0]))) {
    pbf_params params = {.struct_size = sizeof params};
    for (uint32_t k = 0; k < m.worlds; ++k)
      if (m.mask[k] && did(a, pbf_get_params(world_of(a, &m, k), &params)))
        insist(a, params.gravity[1] == gravity[k][1]);
  }
  end(&m);
}

static int set_ball(actor *a, const many *m, const uint8_t *mask) {
  pbf_collider ball;
  insist(a, pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SPHERE) == PBF_OK);
  ball.radius = 0.1;
  return did(a, pbf_batch_set_colliders(m->batch, mask, 1, &ball));
}

void call_batch_set_colliders(actor *a) {
  uint32_t count = 0;
  many m;
  if (!begin(a, &m)) return;
  if (set_ball(a, &m, m.mask))
    for (uint32_t k = 0; k < m.worlds; ++k)
      if (m.mask[k] && did(a, pbf_get_collider_count(world_of(a, &m, k), &count)))
        insist(a, count == 1);
  end(&m);
}

void call_batch_move_colliders(actor *a) {
  double places[MOST_WORLDS][1][3] = {{{0}}};
  many m;
  if (!begin(a, &m)) return;
  for (uint32_t k = 0; k < MOST_WORLDS; ++k) places[k][0][1] = dice_below(&a->dice, 3);
  if (set_ball(a, &m, NULL) &&
      did(a, pbf_batch_move_colliders(m.batch, m.mask, 1, places[0][0], NULL,
                                      0.01 * dice_below(&a->dice, 4))))
    did(a, pbf_batch_step(m.batch, NULL, 1));
  end(&m);
}

void call_batch_add_particles(actor *a) {
  static const double places[2 * MOST_WORLDS][3];
  uint32_t counts[MOST_WORLDS], now[MOST_WORLDS];
  many m;
  if (!begin(a, &m)) return;
  for (uint32_t k = 0; k < MOST_WORLDS; ++k) counts[k] = dice_below(&a->dice, 3);
  if (did(a, pbf_batch_add_particles(m.batch, counts, places, NULL)) &&
      did(a, pbf_batch_get_counts(m.batch, now)))
    for (uint32_t k = 0; k < m.worlds; ++k)
      insist(a, now[k] == a->subject->saved_model.count + counts[k]);
  end(&m);
}

void call_batch_get_counts(actor *a) {
  uint32_t counts[MOST_WORLDS] = {0};
  many m;
  if (!begin(a, &m)) return;
  if (did(a, pbf_batch_get_counts(m.batch, counts)))
    for (uint32_t k = 0; k < m.worlds; ++k) insist(a, counts[k] == a->subject->saved_model.count);
  end(&m);
}

void call_batch_read(actor *a) {
  static _Thread_local double numbers[MOST_WORLDS][4][3];
  many m;
  const pbf_read_desc read = {.struct_size = sizeof read,
                              .field = dice_below(&a->dice, 7),
                              .first = dice_below(&a->dice, 3),
                              .count = dice_below(&a->dice, 5),
                              .element_type = dice_one_in(&a->dice, 2) ? 0 : PBF_TYPE_FLOAT64,
                              .data = numbers};
  if (!begin(a, &m)) return;
  did(a, pbf_batch_read(m.batch, m.mask, &read, dice_one_in(&a->dice, 2) ? 0 : sizeof numbers[0]));
  end(&m);
}

void call_batch_export_dlpack(actor *a) {
  struct DLManagedTensor *tensor = NULL;
  many m;
  if (!begin(a, &m)) return;
  const uint32_t field = dice_below(&a->dice, 7), rows = dice_below(&a->dice, 9);
  const int is_there = did(a, pbf_batch_export_dlpack(m.batch, field, rows, &tensor));
  insist(a, is_there == (tensor != NULL));
  end(&m);
  if (tensor) insist(a, tensor->dl_tensor.shape[0] == m.worlds);
  if (tensor) tensor->deleter(tensor);
}
