#include "coincident.h"

#include <math.h>
#include <string.h>

#include "memory.h"
#include "params.h"
#include "physics/coincident.h"
#include "physics/spacing.h"
#include "solver/solver_time.h"
#include "values.h"

typedef struct points {
  const pbf_solver *solver;
  const void *positions;
  uint32_t count;
  double grain;
} points;

static double component(const points *p, uint32_t i, uint32_t k) {
  const pbf_check_kind *kind = &p->solver->kind;
  return pbf_value_at(p->positions, (uint64_t)i * kind->dimension + k, kind->precision);
}

/* What is the same for all that coincide. Places of lattices are not between two cells. */
static double cell(const points *p, uint32_t i, uint32_t k) {
  const double value = component(p, i, k), off_lattices = 0.3819660112501051;
  return p->grain > 0 ? floor(value / p->grain + off_lattices) : value;
}

static uint64_t hash_of(const points *p, uint32_t i) {
  const uint64_t odd = UINT64_C(0x9e3779b97f4a7c15); /* 2^64 over the golden ratio */
  uint64_t hash = 0, bits;
  for (uint32_t k = 0; k < p->solver->kind.dimension; ++k) {
    const double value = cell(p, i, k) + 0.0; /* -0 is 0 */
    memcpy(&bits, &value, sizeof bits);
    hash = (hash ^ bits) * odd;
    hash ^= hash >> 29;
  }
  return hash * odd;
}

/* ---- Points that may be another's ------------------------------------------------------------ */

/* A bit for each of 2^bits hashes, with `bits` so that few points share one by chance: whether
 * there is a point of it, and whether there are more. Takes a sixth of the memory that points
 * themselves would in a table, and of the time. */
typedef struct hash_bits {
  uint64_t *seen, *repeated;
  uint32_t bits;
  uint64_t bytes; /* of both */
} hash_bits;

enum { BITS_A_POINT = 16 };

static pbf_status allocate_bits(const points *p, hash_bits *h) {
  void *memory;
  for (h->bits = 6; UINT64_C(1) << h->bits < BITS_A_POINT * (uint64_t)p->count;) ++h->bits;
  h->bytes = (UINT64_C(2) << h->bits) / 8;
  pbf_status status =
      pbf_memory_allocate(&p->solver->allocator, h->bytes, "a table of the new positions", &memory);
  if (status != PBF_OK) return status;
  memset(memory, 0, h->bytes);
  h->seen = memory;
  h->repeated = h->seen + ((UINT64_C(1) << h->bits) / 64);
  return PBF_OK;
}

static void note_hashes(const points *p, const hash_bits *h) {
  for (uint32_t i = 0; i < p->count; ++i) {
    const uint64_t hash = hash_of(p, i) >> (64 - h->bits), bit = UINT64_C(1) << hash % 64;
    h->repeated[hash / 64] |= h->seen[hash / 64] & bit;
    h->seen[hash / 64] |= bit;
  }
}

static int is_repeated(const points *p, const hash_bits *h, uint32_t i) {
  const uint64_t hash = hash_of(p, i) >> (64 - h->bits);
  return (int)(h->repeated[hash / 64] >> hash % 64 & 1);
}

/* Those that share a hash; where `suspects` is null they are counted. */
static uint32_t list_suspects(const points *p, const hash_bits *h, uint32_t *suspects) {
  uint32_t count = 0;
  for (uint32_t i = 0; i < p->count; ++i) {
    if (!is_repeated(p, h, i)) continue;
    if (suspects) suspects[count] = i;
    ++count;
  }
  return count;
}

/* ---- Points that are ------------------------------------------------------------------------- */

/* A point and the particles at it: a slot of a hash table with open addressing. */
typedef struct point_slot {
  uint32_t first; /* the first particle at the point, + 1; 0: the slot is free */
  uint32_t count, seen;
} point_slot;

typedef struct point_table {
  points all;
  uint32_t *suspects, count;
  point_slot *slots;
  uint64_t mask;
  void *memory;
  uint64_t bytes;
} point_table;

static int same_point(const points *p, uint32_t i, uint32_t j) {
  for (uint32_t k = 0; k < p->solver->kind.dimension; ++k)
    if (cell(p, i, k) < cell(p, j, k) || cell(p, i, k) > cell(p, j, k)) return 0;
  return 1;
}

static point_slot *find_point(const point_table *t, uint32_t i) {
  for (uint64_t index = hash_of(&t->all, i) >> 16;; ++index) {
    point_slot *slot = &t->slots[index & t->mask];
    if (!slot->first || same_point(&t->all, i, slot->first - 1)) return slot;
  }
}

/* Returns whether any particles coincide. */
static int count_points(const point_table *t) {
  int coincide = 0;
  for (uint32_t s = 0; s < t->count; ++s) {
    point_slot *slot = find_point(t, t->suspects[s]);
    if (!slot->first) slot->first = t->suspects[s] + 1;
    coincide |= ++slot->count > 1;
  }
  return coincide;
}

static void move_apart(const point_table *t, uint32_t i, const double offset[3], char *copy) {
  const pbf_solver *solver = t->all.solver;
  const uint32_t dimension = solver->kind.dimension, size = pbf_element_size(solver);
  const pbf_box box = pbf_params_box(&solver->params, dimension, pbf_solver_time(solver));
  for (uint32_t k = 0; k < dimension; ++k) {
    double value = fmin(component(&t->all, i, k) + offset[k], box.upper[k]);
    value = fmax(value, box.lower[k]);
    float single = (float)value;
    memcpy(copy + i * pbf_point_bytes(solver) + k * size,
           size == sizeof single ? (void *)&single : (void *)&value, size);
  }
}

static void set_apart(const point_table *t, double spacing, char *copy) {
  for (uint32_t s = 0; s < t->count; ++s) {
    double offset[3];
    point_slot *slot = find_point(t, t->suspects[s]);
    if (slot->count == 1) continue;
    pbf_coincident_offset(t->all.solver->kind.dimension, spacing, slot->seen++, slot->count,
                          offset);
    move_apart(t, t->suspects[s], offset, copy);
  }
}

static pbf_status copy_apart(const point_table *t, pbf_distinct *distinct) {
  const pbf_solver *solver = t->all.solver;
  distinct->bytes = t->all.count * pbf_point_bytes(solver);
  pbf_status status = pbf_memory_allocate(&solver->allocator, distinct->bytes,
                                          "a copy of the new positions", &distinct->copy);
  if (status != PBF_OK) return status;
  memcpy(distinct->copy, t->all.positions, distinct->bytes);
  set_apart(t, pbf_derive_spacing(&solver->params), distinct->copy);
  distinct->positions = distinct->copy;
  return PBF_OK;
}

static pbf_status allocate_table(point_table *t) {
  uint64_t slots = 2;
  while (slots < 2 * (uint64_t)t->count) slots *= 2;
  t->bytes = slots * sizeof *t->slots + t->count * sizeof *t->suspects;
  pbf_status status = pbf_memory_allocate(&t->all.solver->allocator, t->bytes,
                                          "a table of the new positions", &t->memory);
  if (status != PBF_OK) return status;
  t->slots = t->memory;
  t->suspects = (uint32_t *)(void *)(t->slots + slots);
  t->mask = slots - 1;
  memset(t->slots, 0, slots * sizeof *t->slots);
  return PBF_OK;
}

static pbf_status look_closer(const points *p, const hash_bits *h, pbf_distinct *distinct) {
  point_table t = {.all = *p, .count = list_suspects(p, h, NULL)};
  if (t.count == 0) return PBF_OK;
  pbf_status status = allocate_table(&t);
  if (status != PBF_OK) return status;
  (void)list_suspects(p, h, t.suspects);
  if (count_points(&t)) status = copy_apart(&t, distinct);
  pbf_memory_free(&p->solver->allocator, t.memory, t.bytes);
  return status;
}

pbf_status pbf_distinct_positions(const pbf_solver *solver, const void *positions, uint32_t count,
                                  double grain, pbf_distinct *distinct) {
  const points p = {solver, positions, count, grain};
  hash_bits h;
  *distinct = (pbf_distinct){.positions = positions};
  pbf_status status = allocate_bits(&p, &h);
  if (status != PBF_OK) return status;
  note_hashes(&p, &h);
  status = look_closer(&p, &h, distinct);
  pbf_memory_free(&solver->allocator, h.seen, h.bytes);
  return status;
}

void pbf_distinct_free(const pbf_solver *solver, pbf_distinct *distinct) {
  pbf_memory_free(&solver->allocator, distinct->copy, distinct->bytes);
}
