/* Part of backend.cpp: the arrays of a solver, those that it has for life and those of some scenes
 * only. */
#ifndef PBF_CPU_ARRAYS_H
#define PBF_CPU_ARRAYS_H

#include "common/memory.h"
#include "cpu/ranks.h"

namespace {

/* Memory for whatever array it is for. */
struct memory_taken {
  void *data;
  template <class Value>
  operator Value *() const {
    return static_cast<Value *>(data);
  }
};

}  // namespace

static memory_taken take_memory(pbf_memory *m, const char *name, uint64_t count, uint64_t element) {
  return {pbf_memory_take(m, name, count, element)};
}

static field take_field(solver *s, const char *name) {
  field f;
  pbf_real *base = take_memory(&s->memory, name, PBF_DIM * padded(s->local_capacity), sizeof *base);
  for (uint64_t k = 0; k < PBF_DIM; ++k)
    f.c[k] = base ? base + FIELD_FRONT + k * padded(s->local_capacity) : NULL;
  return f;
}

/* Read by whole vectors from before its first element on, as a field is. */
static pbf_real *take_reals(solver *s, const char *name) {
  pbf_real *base = take_memory(&s->memory, name, padded(s->local_capacity), sizeof *base);
  return base ? base + FIELD_FRONT : NULL;
}

static uint32_t *take_indices(solver *s, const char *name, uint64_t count) {
  return take_memory(&s->memory, name, count, sizeof(uint32_t));
}

/* 0 when one is lacking. What is packed before the first particle's is the sentinel's. The search
 * is the last to ask where cells end: then lambda is packed there. */
static int take_packed_and_cells(solver *s) {
  const uint64_t quads = 4 * padded(s->local_capacity);
  const uint64_t ends = s->ranks.count ? 1 : cell_limit(s->capacity) + 2; /* ranks: halo.h */
  if (!s->kernels->pack) {
    s->cell_end = take_indices(s, "cell end", ends);
    return s->cell_end != NULL;
  }
  for (int k = 0; k < 2; ++k) {
    const uint64_t front = 4 * FIELD_FRONT, least = k ? front + ends : 0;
    pbf_real *base = take_memory(&s->memory, k ? "quads of lambda, or cell end" : "quads",
                                 quads > least ? quads : least, sizeof *base);
    if (!base) return 0;
    s->packed[k] = base + front;
  }
  s->cell_end = reinterpret_cast<uint32_t *>(s->packed[1]);
  return 1;
}

/* What the threads need to share their work out; 0 when one is lacking. */
static int take_tasks(solver *s) {
  pbf_memory *m = &s->memory;
  uint64_t threads = s->threads, ranges = RANGE_PIECES * threads;
  s->sample = take_indices(s, "sampled cell", ranges * SAMPLES_A_RANGE);
  s->first_cell = take_indices(s, "first cell of a range", ranges + 1);
  s->first_place = take_indices(s, "first place of a range", ranges + 1);
  s->first_group = take_indices(s, "first group of a task", PAIR_TASKS * threads + 1);
  s->boxes = take_memory(m, "box of a task", PARTICLE_TASKS * threads, sizeof *s->boxes);
  s->list_sizes =
      take_memory(m, "list size of a task", SEARCH_TASKS * threads, sizeof *s->list_sizes);
  s->slab_counters = take_memory(m, "slabs taken", threads, sizeof *s->slab_counters);
  s->team = take_memory(m, "team", s->team_api->bytes(s->threads), 1);
  return s->team && s->sample && s->first_cell && s->first_place && s->first_group && s->boxes &&
         s->list_sizes && s->slab_counters;
}

/* 0 when one is lacking. */
static int take_arrays(solver *s) {
  uint64_t n = padded(s->local_capacity), chunks = chunks_of(s->local_capacity);
  buffers *b = &s->buffers;
  b->x = take_field(s, "position");
  b->v = take_field(s, "velocity");
  b->scratch[0] = take_field(s, "predicted");
  b->scratch[1] = take_field(s, "predicted velocity");
  b->sorted_predicted = take_field(s, "sorted predicted");
  b->sorted_velocity = take_field(s, "sorted velocity");
  s->lambda = take_reals(s, "lambda");
  b->ids = take_indices(s, "id", n);
  b->sorted_ids = take_indices(s, "sorted id", n);
  s->cells = take_indices(s, "cell", n);
  s->sorted_cells = reinterpret_cast<uint32_t *>(take_reals(s, "sorted cell, or lambda added"));
  s->order = take_indices(s, "order", n);
  s->chunk_low = take_indices(s, "lowest cell of a chunk", chunks);
  s->chunk_high = take_indices(s, "highest cell of a chunk", chunks);
  s->groups = take_memory(&s->memory, "group", n / s->kernels->width, sizeof *s->groups);
  return s->memory.count == 15 && take_packed_and_cells(s) && take_tasks(s);
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
static void clear_arrays(void *context, team_thread *self) {
  clearing c = {static_cast<solver *>(context), self->threads};
  parallel_for(self, self->threads, clear_part, NULL, &c);
}

/* How much of an optional array there is: elements, and how many of them lie before the first. */
struct extent {
  uint64_t count, front;
};

/* Read by whole vectors from before the first element to behind the last, as a field is. */
static extent reals(const solver *s) { return {padded(s->local_capacity), FIELD_FRONT}; }

/* Of what ranks hold before it is sorted; without ranks none. */
static extent held_reals(const solver *s) { return s->ranks.count ? reals(s) : extent{0, 0}; }

static extent vectors(const solver *s) {
  return {PBF_DIM * padded(s->local_capacity), FIELD_FRONT};
}

static extent held_vectors(const solver *s) { return s->ranks.count ? vectors(s) : extent{0, 0}; }

/* None where loops over pairs read no quads. */
static extent quads(const solver *s) {
  if (!s->kernels->pack) return {0, 0};
  return {4 * padded(s->local_capacity), 4 * FIELD_FRONT};
}

static extent chunks(const solver *s) {
  return {padded(s->local_capacity) / ACTIVITY_CHUNK + 1, 0};
}

static extent tasks(const solver *s) { return {(uint64_t)PAIR_TASKS * s->threads, 0}; }

static extent load_bytes(const solver *s) { return {pbf_load_tally_bytes(s->table.room), 0}; }

static extent topology_bytes(const solver *s) {
  return {pbf_topology_memory_bytes(s->capacity), 0};
}

static extent cell_move_words(const solver *s) { return {pbf_cell_move_words(s->capacity), 0}; }

/* Of all numbers of a cell, where ranks add them up; without ranks none. */
static extent words_of_cells(const solver *s) {
  enum { NUMBERS = 2 + PBF_DIM };
  return {s->ranks.count ? NUMBERS * PIECES * pbf_pressure_grid_max_nodes(s->capacity) : 0, 0};
}

static extent grid_words(const solver *s) { return {pbf_pressure_grid_words(s->capacity), 0}; }

namespace {

/* An entry of physics/arrays.def. */
struct optional_array {
  solver *s;
  const char *name;
  bool wanted;

  /* Takes or releases it, as `wanted` says; false when there is no memory. */
  template <class Element>
  bool keep(Element **array, extent e) const {
    return pbf_memory_keep(&s->memory, wanted && e.count, name, e.count, e.front, array);
  }
  bool keep(field *f, extent e) const {
    bool kept = keep(&f->c[0], e);
    for (int k = 1; k < PBF_DIM; ++k) f->c[k] = f->c[0] ? f->c[k - 1] + e.count / PBF_DIM : NULL;
    return kept;
  }
  bool keep(pbf_pressure_grid_storage *storage, extent) const {
    return pbf_pressure_grid_keep(&s->memory, storage, wanted, name, s->capacity);
  }
  bool keep(pbf_load_tally **tally, extent e) const {
    const bool taken = wanted && !*tally;
    if (!pbf_memory_keep_bytes(&s->memory, wanted, name, e.count, tally)) return false;
    if (taken) pbf_place_load_tally(*tally, s->table.room);
    return true;
  }
  bool keep(pbf_topology_memory *memory, extent e) const { return keep(&memory->bytes, e); }
  bool keep(pbf_cell_moves *moves, extent e) const { return keep(&moves->sums, e); }
  bool keep() const { return true; } /* other backends' */
};

}  // namespace

/* What is not wanted any more goes only once there is all that is: where there is not, the scene
 * stays as it was, with what is in its arrays. */
static bool keep_arrays(solver *s, const pbf_schedule &has, const pbf_params &params) {
  for (int take = 1; take >= 0; --take) {
#define PBF_ARRAY(name, wanted, holders) \
  if (((wanted) != 0) == take && !optional_array{s, name, take != 0}.keep(holders)) return false;
#define PBF_CPU(type, team_thread, extent) &s->team_thread, extent(s)
#define PBF_CPU_BUFFER(type, team_thread, extent) &s->buffers.team_thread, extent(s)
#include "physics/arrays.def"
  }
  if (!s->buffers.activity) s->asleep = 0;
  s->added = has.accelerated ? reinterpret_cast<pbf_real *>(s->sorted_cells) : NULL;
  return true;
}

#endif
