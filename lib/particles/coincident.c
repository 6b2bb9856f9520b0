#include "coincident.h"

#include <math.h>
#include <string.h>

#include "fnv.h"
#include "memory.h"
#include "params.h"
#include "physics/coincident.h"
#include "physics/spacing.h"
#include "solver/solver_time.h"
#include "values.h"

/* A point and the particles at it: a slot of a hash table with open addressing. */
typedef struct point_slot {
  uint32_t first; /* the first particle at the point, + 1; 0: the slot is free */
  uint32_t count, seen;
} point_slot;

typedef struct point_table {
  const pbf_solver *solver;
  const void *positions;
  uint64_t point_bytes;
  point_slot *slots;
  uint64_t mask;
} point_table;

static double component(const point_table *p, uint32_t i, uint32_t k) {
  const pbf_check_kind *kind = &p->solver->kind;
  return pbf_value_at(p->positions, (uint64_t)i * kind->dimension + k, kind->precision);
}

static int same_point(const point_table *p, uint32_t i, uint32_t j) {
  for (uint32_t k = 0; k < p->solver->kind.dimension; ++k)
    if (component(p, i, k) < component(p, j, k) || component(p, i, k) > component(p, j, k))
      return 0;
  return 1;
}

static point_slot *find_point(const point_table *p, uint32_t i) {
  double point[3] = {0, 0, 0};
  for (uint32_t k = 0; k < p->solver->kind.dimension; ++k)
    point[k] = component(p, i, k) + 0.0; /* -0 is 0 */
  uint64_t index = pbf_fnv(PBF_FNV_START, point, sizeof point);
  for (index ^= index >> 32;; ++index) {
    point_slot *slot = &p->slots[index & p->mask];
    if (!slot->first || same_point(p, i, slot->first - 1)) return slot;
  }
}

/* Returns whether any particles coincide. */
static int count_points(point_table *p, uint32_t count) {
  int coincide = 0;
  for (uint32_t i = 0; i < count; ++i) {
    point_slot *slot = find_point(p, i);
    if (!slot->first) slot->first = i + 1;
    coincide |= ++slot->count > 1;
  }
  return coincide;
}

static void set_apart(point_table *p, uint32_t count, double spacing, char *copy) {
  uint32_t dimension = p->solver->kind.dimension, size = pbf_element_size(p->solver);
  pbf_box box = pbf_params_box(&p->solver->params, dimension, pbf_solver_time(p->solver));
  for (uint32_t i = 0; i < count; ++i) {
    double offset[3];
    point_slot *slot = find_point(p, i);
    pbf_coincident_offset(dimension, spacing, slot->seen++, slot->count, offset);
    for (uint32_t k = 0; k < dimension && slot->count > 1; ++k) {
      double value = fmin(component(p, i, k) + offset[k], box.upper[k]);
      value = fmax(value, box.lower[k]);
      float single = (float)value;
      memcpy(copy + i * p->point_bytes + k * size,
             size == sizeof single ? (void *)&single : (void *)&value, size);
    }
  }
}

static pbf_status copy_apart(point_table *p, uint32_t count, pbf_distinct *distinct) {
  distinct->bytes = count * p->point_bytes;
  pbf_status status = pbf_memory_allocate(&p->solver->allocator, distinct->bytes,
                                          "a copy of the new positions", &distinct->copy);
  if (status != PBF_OK) return status;
  memcpy(distinct->copy, p->positions, distinct->bytes);
  set_apart(p, count, pbf_derive_spacing(&p->solver->params), distinct->copy);
  distinct->positions = distinct->copy;
  return PBF_OK;
}

pbf_status pbf_distinct_positions(const pbf_solver *solver, const void *positions, uint32_t count,
                                  pbf_distinct *distinct) {
  uint64_t slots = 2;
  while (slots < 2 * (uint64_t)count) slots *= 2;
  uint64_t bytes = slots * sizeof(point_slot);
  void *memory;
  *distinct = (pbf_distinct){.positions = positions};
  pbf_status status =
      pbf_memory_allocate(&solver->allocator, bytes, "a table of the new positions", &memory);
  if (status != PBF_OK) return status;
  memset(memory, 0, bytes);
  point_table p = {solver, positions, pbf_point_bytes(solver), memory, slots - 1};
  if (count_points(&p, count)) status = copy_apart(&p, count, distinct);
  pbf_memory_free(&solver->allocator, memory, bytes);
  return status;
}

void pbf_distinct_free(const pbf_solver *solver, pbf_distinct *distinct) {
  pbf_memory_free(&solver->allocator, distinct->copy, distinct->bytes);
}
