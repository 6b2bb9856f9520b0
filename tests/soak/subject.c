/* Pairs of solvers: their making and their end. */
#include <dlpack/dlpack.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "actor.h"
#include "helpers.h"
#include "tasks.h"

/* ---- Heaps ---- */

enum { MOST_HEAPS = 4096 };

static heap *heaps[MOST_HEAPS];
static atomic_uint heap_count;

heap *heap_for(actor *a) {
  const unsigned place = atomic_fetch_add(&heap_count, 1);
  heap *h = place < MOST_HEAPS ? calloc(1, sizeof *h) : NULL;
  if (!h) return NULL;
  h->actor = a->number;
  h->most = 64u << 20;
  heaps[place] = h;
  return h;
}

void check_heaps(void) {
  for (unsigned k = 0; k < heap_count && k < MOST_HEAPS; ++k) {
    heap *h = heaps[k];
    if (h && h->blocks)
      found(h->actor, "pbf_destroy: %lld blocks of %lld bytes are not given back",
            (long long)h->blocks, (long long)h->bytes);
    free(h);
    heaps[k] = NULL;
  }
}

/* ---- Making ---- */

static int is_one_thread(const char *backend) {
  return strcmp(backend, "serial") == 0 || strcmp(backend, "threads") == 0 ||
         strcmp(backend, "openmp") == 0;
}

/* Bits of these are the same; those of any other backend are its own. */
static const char *twin_of(actor *a, const char *backend) {
  if (!is_one_thread(backend)) return backend;
  for (int tries = 0; tries < 16; ++tries) {
    const char *other = a->with->backends[dice_below(&a->dice, a->with->backend_count)];
    if (is_one_thread(other)) return other;
  }
  return backend;
}

static pbf_desc draw_desc(actor *a, subject *s) {
  static const char *const isas[] = {"scalar", "sse2", "avx2", "avx512"};
  pbf_desc desc;
  if (pbf_desc_init(&desc, sizeof desc) != PBF_OK) found(a->number, "pbf_desc_init fails");
  desc.dimension = s->dimension = 2 + dice_below(&a->dice, 2);
  desc.precision = s->precision = dice_one_in(&a->dice, 2) ? PBF_FLOAT32 : PBF_FLOAT64;
  desc.capacity = s->capacity = 1 + dice_below(&a->dice, MOST_PARTICLES);
  desc.strict = 1;
  if (dice_one_in(&a->dice, 4)) desc.isa = isas[dice_below(&a->dice, 4)];
  return desc;
}

static pbf_status make_twin(actor *a, subject *s, int twin, pbf_desc desc) {
  s->heap[twin] = heap_for(a);
  if (!s->heap[twin]) return PBF_ERROR_OUT_OF_MEMORY;
  const pbf_allocator allocator = heap_allocator(s->heap[twin]);
  desc.allocator = &allocator;
  desc.backend = s->backend[twin];
  desc.threads = 1 + dice_below(&a->dice, 4);
  if (a->with->tasks && strcmp(desc.backend, "threads") == 0 && dice_one_in(&a->dice, 2)) {
    desc.enqueue_task = tasks_enqueue;
    desc.finish_task = tasks_finish;
  }
  if (a->with->memory && dice_one_in(&a->dice, 4))
    s->heap[twin]->failing_in = 1 + (int)dice_below(&a->dice, 30);
  pbf_status status = pbf_create(&desc, NULL, &s->twin[twin]);
  check_status(a, status, pbf_last_error());
  const int injected = s->heap[twin]->failed;
  s->heap[twin]->failing_in = 0;
  if (status == PBF_OK) return status;
  if (s->heap[twin]->blocks)
    found(a->number, "pbf_create: %s, and %lld blocks are kept", pbf_status_string(status),
          (long long)s->heap[twin]->blocks);
  if (injected) count_fault(FAULT_MEMORY);
  const int limited = a->with->limit_addresses || a->with->limit_threads;
  /* A driver that has no thread or memory for a context says that the device is busy. */
  if (status != PBF_ERROR_UNAVAILABLE && !(status == PBF_ERROR_DEVICE && limited) &&
      !(status == PBF_ERROR_OUT_OF_MEMORY && (injected || limited)))
    found(a->number, "pbf_create: %s: %s", pbf_status_string(status), pbf_last_error());
  return status;
}

/* Another thread may take it for the one that was at its address, and be inside. */
static void set_params(actor *a, pbf_solver *solver, const pbf_params *params) {
  pbf_status status;
  while ((status = pbf_set_params(solver, params)) == PBF_ERROR_BUSY && a->with->intruders) {
  }
  if (status == PBF_OK) return;
  if (status == PBF_ERROR_OUT_OF_MEMORY && (a->with->limit_addresses || a->with->limit_threads))
    _exit(0); /* a limit parts the twins */
  found(a->number, "pbf_set_params: %s: %s", pbf_status_string(status), pbf_last_error());
}

/* Places at random take hundreds of iterations to part. */
static void forgo_prestabilization(actor *a, const subject *s) {
  pbf_params params;
  if (pbf_params_init(&params, sizeof params) != PBF_OK) return;
  params.prestabilization = 0;
  for (int twin = 0; twin < TWINS; ++twin) set_params(a, s->twin[twin], &params);
}

int subject_make(actor *a, subject *s) {
  s->model = (model){0};
  memset(s->mapped, 0, sizeof s->mapped);
  s->wild = s->snapshots = s->begun[0] = s->begun[1] = 0;
  s->twin[0] = s->twin[1] = NULL;
  s->backend[0] = a->with->backends[dice_below(&a->dice, a->with->backend_count)];
  s->backend[1] = twin_of(a, s->backend[0]);
  const pbf_desc desc = draw_desc(a, s);
  for (int twin = 0; twin < TWINS; ++twin) {
    if (make_twin(a, s, twin, desc) == PBF_OK) continue;
    subject_drop(a, s);
    return 0;
  }
  if (!dice_one_in(&a->dice, 8)) forgo_prestabilization(a, s);
  helpers_show(a);
  return 1;
}

void subject_drop(actor *a, subject *s) {
  (void)a;
  for (int twin = 0; twin < TWINS; ++twin) {
    pbf_destroy(s->twin[twin]);
    s->twin[twin] = NULL;
    if (s->tensor[twin]) s->tensor[twin]->deleter(s->tensor[twin]);
    s->tensor[twin] = NULL;
  }
}
