/* Calls without a solver, and those that make and end one. */
#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <pbf/ranks.h>

#include "table.h"

void call_version(actor *a) {
  insist(a, pbf_version() ==
                PBF_VERSION_MAJOR * 1000000u + PBF_VERSION_MINOR * 1000u + PBF_VERSION_PATCH);
}

void call_status_string(actor *a) {
  const char *name = pbf_status_string((pbf_status)dice_next(&a->dice));
  insist(a, name && name[0]);
  insist(a, strcmp(pbf_status_string(PBF_ERROR_DATA), "PBF_ERROR_DATA") == 0);
}

void call_last_error(actor *a) { insist(a, pbf_last_error() != NULL); }

/* ---- Structs that are filled ---- */

enum { ROOM = 4096 };

typedef pbf_status (*fill)(actor *a, void *to, uint32_t size);

static pbf_status fill_desc(actor *a, void *to, uint32_t size) {
  (void)a;
  return pbf_desc_init(to, size);
}

static pbf_status fill_params(actor *a, void *to, uint32_t size) {
  (void)a;
  return pbf_params_init(to, size);
}

static pbf_status fill_collider(actor *a, void *to, uint32_t size) {
  return pbf_collider_init(to, size, dice_below(&a->dice, 6));
}

/* Of any size; what lies beyond it stays. */
static void fill_any(actor *a, fill function, uint32_t usual) {
  static _Thread_local _Alignas(16) unsigned char bytes[ROOM];
  const uint32_t size = dice_one_in(&a->dice, 2) ? usual : dice_below(&a->dice, ROOM - 64);
  memset(bytes, 0xa5, sizeof bytes);
  pbf_status status = function(a, dice_one_in(&a->dice, 16) ? NULL : bytes, size);
  check_status(a, status, pbf_last_error());
  for (uint32_t i = status == PBF_OK ? size : 0; i < ROOM; ++i)
    if (bytes[i] != 0xa5) found(a->number, "%s: writes byte %u of %u", a->function, i, size);
}

void call_desc_init(actor *a) { fill_any(a, fill_desc, sizeof(pbf_desc)); }
void call_params_init(actor *a) { fill_any(a, fill_params, sizeof(pbf_params)); }
void call_collider_init(actor *a) { fill_any(a, fill_collider, sizeof(pbf_collider)); }

/* ---- Backends ---- */

void call_get_backend_count(actor *a) {
  uint32_t count = 0;
  insist(a, pbf_get_backend_count(&count) == PBF_OK && count >= a->with->backend_count);
  insist(a, pbf_get_backend_count(NULL) == PBF_ERROR_INVALID_ARGUMENT);
}

void call_get_backend_info(actor *a) {
  pbf_backend_info info = {.struct_size = sizeof info};
  pbf_desc desc;
  uint32_t count = 0;
  insist(a, pbf_desc_init(&desc, sizeof desc) == PBF_OK);
  insist(a, pbf_get_backend_count(&count) == PBF_OK);
  desc.dimension = dice_below(&a->dice, 5);
  const uint32_t index = dice_below(&a->dice, count + 2);
  pbf_status status = pbf_get_backend_info(dice_one_in(&a->dice, 2) ? NULL : &desc, index, &info);
  check_status(a, status, pbf_last_error());
  if (status != PBF_OK) return;
  insist(a, memchr(info.name, 0, sizeof info.name) && memchr(info.reason, 0, sizeof info.reason));
  insist(a, info.available ? info.score > 0 && info.name[0] : info.reason[0] != 0);
}

/* What is no plugin; few, for each stays in the list of what was tried. */
void call_load_backend(actor *a) {
  static const char *const paths[] = {NULL,
                                      "",
                                      "relative.so",
                                      "/dev/null",
                                      "/dev/full",
                                      "/",
                                      "/nowhere/pbf_backend_x.so",
                                      "/proc/self/mem",
                                      "/proc/self/exe",
                                      "/proc/self/maps"};
  pbf_status status = pbf_load_backend(paths[dice_below(&a->dice, sizeof paths / sizeof *paths)]);
  check_status(a, status, pbf_last_error());
  insist(a, status != PBF_OK);
  count_fault(FAULT_ARGUMENT);
}

/* ---- A solver's life ---- */

static void spoil_desc(actor *a, pbf_desc *desc) {
  const uint32_t any = dice_one_in(&a->dice, 2) ? (uint32_t)dice_next(&a->dice) : 0;
  switch (dice_below(&a->dice, 12)) {
    case 0:
      desc->struct_size = any;
      break;
    case 1:
      desc->api_version = any;
      break;
    case 2:
      desc->dimension = any;
      break;
    case 3:
      desc->precision = any;
      break;
    case 4:
      desc->capacity = any | 0x40000000u;
      break;
    case 5:
      desc->strict = any | 2;
      break;
    case 6:
      desc->backend = "no such backend";
      break;
    case 7:
      desc->device = -1 - (int32_t)(any & 7);
      break;
    case 8:
      desc->stream = &desc->stream;
      break;
    case 9:
      desc->isa = "no such set";
      break;
    case 10:
      desc->finish_task = (pbf_finish_task_fn)(uintptr_t)1;
      break;
    default:
      desc->api_version = PBF_API_VERSION + 1;
      break;
  }
}

static void create_wrongly(actor *a) {
  pbf_desc desc;
  pbf_params params;
  pbf_solver *solver = NULL;
  insist(a, pbf_desc_init(&desc, sizeof desc) == PBF_OK);
  insist(a, pbf_params_init(&params, sizeof params) == PBF_OK);
  desc.backend = a->with->backends[dice_below(&a->dice, a->with->backend_count)];
  desc.capacity = 16;
  desc.strict = 1;
  count_fault(FAULT_ARGUMENT);
  const int spoiled = !dice_one_in(&a->dice, 4);
  if (spoiled)
    spoil_desc(a, &desc);
  else
    params.smoothing_radius = dice_one_in(&a->dice, 2) ? NAN : -1;
  pbf_status status = pbf_create(dice_one_in(&a->dice, 16) ? NULL : &desc, &params, &solver);
  check_status(a, status, pbf_last_error());
  insist(a, status != PBF_OK && solver == NULL);
}

static void drop(actor *a) { subject_drop(a, a->subject); }

void call_create(actor *a) {
  if (dice_one_in(&a->dice, 2)) {
    create_wrongly(a);
    return;
  }
  drop(a);
  subject_make(a, a->subject);
}

/* Ranks that can't be: without functions, and with whatever numbers. */
void call_create_on_ranks(actor *a) {
  pbf_desc desc;
  pbf_ranks ranks = {.struct_size = sizeof ranks};
  pbf_solver *solver = NULL;
  insist(a, pbf_desc_init(&desc, sizeof desc) == PBF_OK);
  desc.backend = a->with->backends[dice_below(&a->dice, a->with->backend_count)];
  desc.capacity = 16;
  count_fault(FAULT_ARGUMENT);
  ranks.rank = dice_below(&a->dice, 4);
  ranks.count = dice_below(&a->dice, 4);
  if (dice_one_in(&a->dice, 4)) ranks.struct_size = (uint32_t)dice_next(&a->dice);
  pbf_status status =
      pbf_create_on_ranks(&desc, NULL, dice_one_in(&a->dice, 8) ? NULL : &ranks, &solver);
  check_status(a, status, pbf_last_error());
  insist(a, status != PBF_OK && solver == NULL);
}

/* What is gone is refused. Its address may be another solver's by now. */
void call_destroy(actor *a) {
  pbf_solver *gone = a->subject->twin[0];
  uint32_t count;
  pbf_destroy(NULL);
  drop(a);
  check_status(a, pbf_get_count(gone, &count), pbf_last_error());
  insist(a, pbf_get_count(NULL, &count) == PBF_ERROR_INVALID_ARGUMENT);
  subject_make(a, a->subject);
}
