/* Views, tensors, snapshots, and the state as a whole. */
#include <dlpack/dlpack.h>
#include <math.h>
#include <sched.h>
#include <string.h>

#include "table.h"

typedef struct views {
  uint32_t field, enabled;
  pbf_view view[TWINS];
  struct DLManagedTensor *tensor[TWINS];
  uint64_t hash[TWINS], size[TWINS];
  unsigned char *state[TWINS];
} views;

static pbf_status map(pbf_solver *solver, int twin, void *context) {
  views *v = context;
  v->view[twin].struct_size = sizeof v->view[twin];
  return pbf_map(solver, v->field, &v->view[twin]);
}

static pbf_status unmap(pbf_solver *solver, int twin, void *context) {
  (void)twin;
  return pbf_unmap(solver, ((views *)context)->field);
}

static void check_view(actor *a, const pbf_view *view) {
  const model *m = &a->subject->model;
  insist(a, view->count == m->count && view->reserved == 0);
  if (view->device_type != PBF_DEVICE_CPU) return;
  for (uint32_t i = 0; i < view->count; ++i) {
    uint32_t k = 0;
    while (k < m->count && m->ids[k] != view->ids[i]) ++k;
    insist(a, k < m->count);
  }
  for (uint32_t i = 0; i < view->count && view->field != PBF_FIELD_ID; ++i) {
    const char *at = (const char *)view->data + i * view->particle_stride;
    insist(a, view->element_type == PBF_TYPE_FLOAT32 ? isfinite(*(const float *)(const void *)at)
                                                     : isfinite(*(const double *)(const void *)at));
  }
}

void call_map(actor *a) {
  views v = {.field = dice_below(&a->dice, 7)};
  if (call_both(a, map, &v, CALL_READS) != PBF_OK) return;
  ++a->subject->mapped[v.field];
  for (int twin = 0; twin < TWINS; ++twin) check_view(a, &v.view[twin]);
  if (dice_one_in(&a->dice, 3)) return; /* until pbf_unmap is drawn */
  insist(a, call_both(a, unmap, &v, CALL_READS) == PBF_OK);
  --a->subject->mapped[v.field];
}

void call_unmap(actor *a) {
  uint32_t *mapped = a->subject->mapped;
  for (uint32_t field = 0; field < MOST_FIELDS; ++field) {
    views v = {.field = field};
    while (mapped[field]) {
      insist(a, call_both(a, unmap, &v, CALL_READS) == PBF_OK);
      --mapped[field];
    }
    call_both(a, unmap, &v, CALL_READS | CALL_WRONG);
  }
}

static pbf_status export_tensor(pbf_solver *solver, int twin, void *context) {
  views *v = context;
  return pbf_export_dlpack(solver, v->field, &v->tensor[twin]);
}

static void delete_tensors(struct DLManagedTensor *tensor[TWINS]) {
  for (int twin = 0; twin < TWINS; ++twin) {
    if (tensor[twin]) tensor[twin]->deleter(tensor[twin]);
    tensor[twin] = NULL;
  }
}

/* One pair of them is kept, maybe until the solvers are gone. */
void call_export_dlpack(actor *a) {
  subject *s = a->subject;
  views v = {.field = dice_below(&a->dice, 7)};
  delete_tensors(s->tensor);
  if (call_both(a, export_tensor, &v, CALL_READS) != PBF_OK) {
    delete_tensors(v.tensor);
    return;
  }
  insist(a, v.tensor[0]->dl_tensor.shape[0] == (int64_t)s->model.count);
  if (dice_one_in(&a->dice, 4))
    memcpy(s->tensor, v.tensor, sizeof v.tensor);
  else
    delete_tensors(v.tensor);
}

/* ---- Snapshots ---- */

static pbf_status set_snapshots(pbf_solver *solver, int twin, void *context) {
  (void)twin;
  return pbf_set_snapshots(solver, ((views *)context)->enabled);
}

/* Whether one is held is for the readers to say, too. */
void call_set_snapshots(actor *a) {
  static const uint32_t counts[] = {0, 1, 2, 3, 4, 16, 17};
  views v = {.enabled = counts[dice_below(&a->dice, 7)]};
  if (call_both(a, set_snapshots, &v, CALL_READS | (a->with->readers ? CALL_LOOSE : 0)) == PBF_OK)
    a->subject->snapshots = v.enabled > 0;
}

void call_acquire_snapshot(actor *a) {
  const subject *s = a->subject;
  for (int twin = 0; twin < TWINS; ++twin) {
    pbf_snapshot held = {.struct_size = sizeof held};
    pbf_status status = pbf_acquire_snapshot(s->twin[twin], &held);
    check_status(a, status, pbf_last_error());
    if (status != PBF_OK) {
      insist(a, held.owner == NULL);
      continue;
    }
    insist(a, held.owner && held.dimension == s->dimension && held.element_type == s->precision);
    insist(a, isfinite(held.time));
    insist(a, pbf_acquire_snapshot(s->twin[twin], &held) != PBF_OK); /* it would be lost */
    insist(a, pbf_release_snapshot(&held) == PBF_OK && held.owner == NULL);
  }
}

void call_release_snapshot(actor *a) {
  pbf_snapshot none = {.struct_size = sizeof none};
  check_status(a, pbf_release_snapshot(&none), pbf_last_error());
  insist(a, pbf_release_snapshot(NULL) == PBF_ERROR_INVALID_ARGUMENT);
}

/* ---- State ---- */

static pbf_status save(pbf_solver *solver, int twin, void *context) {
  views *v = context;
  return pbf_save(solver, v->state[twin], &v->size[twin]);
}

static pbf_status load(pbf_solver *solver, int twin, void *context) {
  const views *v = context;
  (void)twin;
  return pbf_load(solver, v->state[0], v->size[0]);
}

static pbf_status hash(pbf_solver *solver, int twin, void *context) {
  return pbf_hash(solver, &((views *)context)->hash[twin]);
}

void call_hash(actor *a) {
  views v = {0};
  if (call_both(a, hash, &v, CALL_READS) == PBF_OK) insist(a, v.hash[0] == v.hash[1]);
}

/* The other twin's state is the same, byte by byte. */
void call_save(actor *a) {
  subject *s = a->subject;
  static _Thread_local _Alignas(8) unsigned char other[STATE_BYTES];
  views v = {.state = {s->saved, other}, .size = {sizeof s->saved, sizeof other}};
  views needed = {0};
  s->saved_size = 0;
  if (call_both(a, save, &needed, CALL_READS) != PBF_OK) return;
  insist(a, needed.size[0] == needed.size[1]);
  if (needed.size[0] > sizeof s->saved) return;
  if (call_both(a, save, &v, CALL_READS) != PBF_OK) return;
  insist(a, v.size[0] == needed.size[0] && v.size[1] == needed.size[0]);
  if (call_both(a, hash, &v, CALL_READS) != PBF_OK) return;
  s->saved_size = v.size[0];
  s->saved_hash = v.hash[0];
  s->saved_model = s->model;
  s->saved_dimension = s->dimension;
  s->saved_precision = s->precision;
}

/* FNV-1a, as at the end of a saved state. */
static void seal(unsigned char *state, uint64_t size) {
  uint64_t sum = UINT64_C(0xcbf29ce484222325);
  for (uint64_t i = 0; i + 8 < size; ++i) sum = (sum ^ state[i]) * UINT64_C(0x100000001b3);
  memcpy(state + size - 8, &sum, sizeof sum);
}

/* Bits turned over, bytes exchanged, an end that is missing; with a right checksum or not. */
static void damage(actor *a, unsigned char *state, uint64_t *size) {
  const int sealed = dice_one_in(&a->dice, 2);
  count_fault(FAULT_DAMAGE);
  for (uint32_t k = 1 + dice_below(&a->dice, 4); k > 0; --k)
    state[dice_below(&a->dice, (uint32_t)*size)] ^= (unsigned char)(1u << dice_below(&a->dice, 8));
  if (dice_one_in(&a->dice, 4)) *size = dice_below(&a->dice, (uint32_t)*size + 1);
  if (sealed && *size > 8) seal(state, *size);
}

/* On solvers that end then: what a sealed one holds is another state. */
static void load_damaged(actor *a, views *v) {
  static _Thread_local _Alignas(8) unsigned char damaged[STATE_BYTES];
  memcpy(damaged, v->state[0], v->size[0]);
  v->state[0] = damaged;
  damage(a, damaged, &v->size[0]);
  if (call_both(a, load, v, 0) != PBF_OK) return;
  if (call_both(a, hash, v, CALL_READS) == PBF_OK) insist(a, v->hash[0] == v->hash[1]);
  call_unmap(a);
  subject_drop(a, a->subject);
  subject_make(a, a->subject);
}

void call_load(actor *a) {
  subject *s = a->subject;
  const subject *from = &a->subjects[dice_below(&a->dice, SUBJECTS)];
  views v = {.state = {(unsigned char *)from->saved}, .size = {from->saved_size}};
  if (!from->saved_size) {
    call_save(a);
    return;
  }
  if (dice_one_in(&a->dice, 3)) {
    load_damaged(a, &v);
    return;
  }
  if (call_both(a, load, &v, 0) != PBF_OK) return;
  insist(a, from->saved_dimension == s->dimension && from->saved_precision == s->precision);
  insist(a, from->saved_model.count <= s->capacity);
  s->model = from->saved_model;
  s->wild |= from->wild;
  if (call_both(a, hash, &v, CALL_READS) == PBF_OK)
    insist(a, v.hash[0] == from->saved_hash && v.hash[1] == from->saved_hash);
  check_subject(a);
}
