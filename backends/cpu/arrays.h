/* The arrays of a solver: those that it has for life, and those that only some parameters need. */
#ifndef PBF_CPU_ARRAYS_H
#define PBF_CPU_ARRAYS_H

#include "cpu/worker.h"

/* Memory for whatever array it is for. */
struct memory_taken {
  void *data;
  template <class Value>
  operator Value *() const {
    return static_cast<Value *>(data);
  }
};

static memory_taken take_memory(pbf_memory *m, const char *name, uint64_t count, uint64_t element) {
  return {pbf_memory_take(m, name, count, element)};
}

static field take_field(solver *s, const char *name) {
  field f;
  pbf_real *base = take_memory(&s->memory, name, PBF_DIM * padded(s->capacity), sizeof *base);
  for (uint64_t k = 0; k < PBF_DIM; ++k)
    f.c[k] = base ? base + FIELD_FRONT + k * padded(s->capacity) : NULL;
  return f;
}

/* Read by whole vectors from before its first element on, as a field is. */
static pbf_real *take_reals(solver *s, const char *name) {
  pbf_real *base = take_memory(&s->memory, name, padded(s->capacity), sizeof *base);
  return base ? base + FIELD_FRONT : NULL;
}

static uint32_t *take_indices(solver *s, const char *name, uint64_t count) {
  return take_memory(&s->memory, name, count, sizeof(uint32_t));
}

/* 0 when one is lacking. The quad before the first particle's is nobody's. */
static int take_quads(solver *s) {
  for (int k = 0; k < 2 && s->kernels->pack; ++k) {
    pbf_real *base = take_memory(&s->memory, k ? "quads of lambda" : "quads",
                                 4 * padded(s->capacity), sizeof *base);
    if (!base) return 0;
    s->quads[k] = base + 4 * FIELD_FRONT;
  }
  return 1;
}

/* What the threads need to share their work out; 0 when one is lacking. */
static int take_pieces(solver *s) {
  pbf_memory *m = &s->memory;
  uint64_t threads = s->threads, ranges = RANGE_PIECES * threads;
  s->sample = take_indices(s, "sampled cell", ranges * SAMPLES_A_RANGE);
  s->first_cell = take_indices(s, "first cell of a range", ranges + 1);
  s->first_place = take_indices(s, "first place of a range", ranges + 1);
  s->first_group = take_indices(s, "first group of a piece", PAIR_PIECES * threads + 1);
  s->boxes = take_memory(m, "box of a piece", PARTICLE_PIECES * threads, sizeof *s->boxes);
  s->list_sizes =
      take_memory(m, "list size of a piece", SEARCH_PIECES * threads, sizeof *s->list_sizes);
  s->slab_counters = take_memory(m, "slabs taken", threads, sizeof *s->slab_counters);
  s->team = take_memory(m, "team", team_bytes(s->threads), 1);
  return s->team && s->sample && s->first_cell && s->first_place && s->first_group && s->boxes &&
         s->list_sizes && s->slab_counters;
}

/* 0 when one is lacking. */
static int take_arrays(solver *s) {
  uint64_t n = padded(s->capacity), chunks = chunks_of(s->capacity);
  buffers *b = &s->buffers;
  b->x = take_field(s, "position");
  b->v = take_field(s, "velocity");
  b->spare[0] = take_field(s, "predicted");
  b->spare[1] = take_field(s, "predicted velocity");
  b->spare[2] = take_field(s, "sorted predicted");
  b->spare[3] = take_field(s, "sorted velocity");
  s->lambda = take_reals(s, "lambda");
  b->ids = take_indices(s, "id", n);
  b->spare_ids = take_indices(s, "sorted id", n);
  s->cells = take_indices(s, "cell", n);
  s->sorted_cells = take_indices(s, "sorted cell", n);
  s->order = take_indices(s, "order", n);
  s->cell_end = take_indices(s, "cell end", cell_limit(s->capacity) + 1);
  s->chunk_low = take_indices(s, "lowest cell of a chunk", chunks);
  s->chunk_high = take_indices(s, "highest cell of a chunk", chunks);
  s->groups = take_memory(&s->memory, "group", n / s->kernels->width, sizeof *s->groups);
  return s->memory.count == 16 && take_quads(s) && take_pieces(s);
}

typedef struct clearing {
  solver *s;
  uint32_t parts;
} clearing;

static void clear_part(void *context, uint32_t part) {
  const clearing *c = static_cast<const clearing *>(context);
  for (uint32_t k = 0; k < c->s->memory.count; ++k) {
    const pbf_array *a = &c->s->memory.arrays[k];
    if (a->data == c->s->team) continue;
    uint64_t begin = a->bytes / c->parts * part;
    uint64_t end = part + 1 == c->parts ? a->bytes : a->bytes / c->parts * (part + 1);
    memset((char *)a->data + begin, 0, end - begin);
  }
}

/* Each thread writes its part first, so that the pages lie near it. */
static void clear_arrays(void *context, member *me) {
  clearing c = {static_cast<solver *>(context), me->threads};
  team_for(me, me->threads, clear_part, NULL, &c);
}

/* Takes or releases an array that only some parameters need. 0 when there is no memory. */
static int keep_reals(solver *s, int wanted, pbf_real **array, const char *name) {
  if (wanted && !*array)
    *array = take_memory(&s->memory, name, padded(s->capacity), sizeof **array);
  if (wanted) return *array != NULL;
  pbf_memory_free(&s->memory, *array);
  *array = NULL;
  return 1;
}

/* Reals that begin as 0, `count` of them, and *array behind the first `front`. */
static int keep_zeroed(solver *s, int wanted, pbf_real **array, uint64_t count, uint64_t front,
                       const char *name) {
  pbf_real *base = *array ? *array - front : NULL;
  if (wanted && base) return 1;
  pbf_memory_free(&s->memory, base);
  *array = NULL;
  if (!wanted) return 1;
  base = take_memory(&s->memory, name, count, sizeof *base);
  if (!base) return 0;
  memset(base, 0, count * sizeof *base);
  *array = base + front;
  return 1;
}

/* Read as take_reals's are, also behind the last particle: no number must be none. */
static int keep_added(solver *s, int wanted) {
  return keep_zeroed(s, wanted, &s->added, padded(s->capacity), FIELD_FRONT, "lambda added");
}

static int keep_excess(solver *s, int wanted) {
  if (wanted && !s->excess)
    s->excess = take_memory(&s->memory, "density error of a piece",
                            (uint64_t)PAIR_PIECES * s->threads, sizeof *s->excess);
  if (wanted) return s->excess != NULL;
  pbf_memory_free(&s->memory, s->excess);
  s->excess = NULL;
  return 1;
}

/* Bytes that begin as 0. */
static int keep_flags(solver *s, int wanted, uint8_t **array, const char *name, uint64_t count) {
  if (wanted && !*array && (*array = take_memory(&s->memory, name, count, 1)))
    memset(*array, 0, count);
  if (wanted) return *array != NULL;
  pbf_memory_free(&s->memory, *array);
  *array = NULL;
  return 1;
}

static int keep_rest(solver *s, const pbf_schedule *has) {
  int wanted = has->runs[PBF_STAGE_SLEEP] != 0;
  rest *now = &s->buffers.rest, *spare = &s->buffers.spare_rest;
  return keep_reals(s, wanted, &now->unrest, "unrest") &&
         keep_reals(s, wanted, &now->lambda, "lambda asleep") &&
         keep_reals(s, wanted, &spare->unrest, "sorted unrest") &&
         keep_reals(s, wanted, &spare->lambda, "sorted lambda asleep") &&
         keep_flags(s, wanted, &s->calm, "calm", padded(s->capacity) / CALM_CHUNK + 1);
}

static int keep_field(solver *s, int wanted, field *f, const char *name) {
  uint64_t each = padded(s->capacity);
  int kept = keep_zeroed(s, wanted, &f->c[0], PBF_DIM * each, FIELD_FRONT, name);
  for (int k = 1; k < PBF_DIM; ++k) f->c[k] = f->c[0] ? f->c[0] + k * each : NULL;
  return kept;
}

static int keep_turning(solver *s, int wanted) {
  return keep_field(s, wanted, &s->start, "start of the step") &&
         keep_field(s, wanted, &s->torque, "torque") &&
         keep_zeroed(s, wanted && s->kernels->pack, &s->quads[2], 4 * padded(s->capacity),
                     4 * FIELD_FRONT, "quads of the step's start");
}

static int keep_arrays(solver *s, const pbf_schedule *has) {
  return keep_added(s, has->accelerated) &&
         keep_reals(s, has->runs[PBF_STAGE_SLACK] != 0, &s->slack, "slack") && keep_rest(s, has) &&
         keep_excess(s, has->watched) && keep_turning(s, has->runs[PBF_STAGE_TURN] != 0) &&
         pbf_deep_keep(&s->memory, &s->deep, has->runs[PBF_STAGE_GRID] != 0, s->capacity);
}

#endif
