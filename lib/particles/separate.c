#include "separate.h"

#include <math.h>
#include <string.h>

#include "fnv.h"
#include "memory.h"
#include "params.h"
#include "physics/coincident.h"
#include "physics/spacing.h"
#include "solver/solver_time.h"
#include "values.h"

/* A point that particles are at: a slot of a hash table with open addressing. */
typedef struct place {
  uint32_t first; /* particle there, + 1; 0: the slot is free */
  uint32_t count, seen;
} place;

typedef struct places {
  const pbf_solver *solver;
  const void *positions;
  uint64_t point_bytes;
  place *slots;
  uint64_t mask;
} places;

static double component(const places *p, uint32_t i, uint32_t k) {
  const pbf_check_kind *kind = &p->solver->kind;
  return pbf_value_at(p->positions, (uint64_t)i * kind->dimension + k, kind->precision);
}

static int same_point(const places *p, uint32_t i, uint32_t j) {
  for (uint32_t k = 0; k < p->solver->kind.dimension; ++k)
    if (component(p, i, k) < component(p, j, k) || component(p, i, k) > component(p, j, k))
      return 0;
  return 1;
}

static place *place_of(const places *p, uint32_t i) {
  double point[3] = {0, 0, 0};
  for (uint32_t k = 0; k < p->solver->kind.dimension; ++k)
    point[k] = component(p, i, k) + 0.0; /* -0 is 0 */
  uint64_t slot = pbf_fnv(PBF_FNV_START, point, sizeof point);
  for (slot ^= slot >> 32;; ++slot) {
    place *there = &p->slots[slot & p->mask];
    if (!there->first || same_point(p, i, there->first - 1)) return there;
  }
}

/* Returns whether some are at one point. */
static int find_places(places *p, uint32_t count) {
  int shared = 0;
  for (uint32_t i = 0; i < count; ++i) {
    place *there = place_of(p, i);
    if (!there->first) there->first = i + 1;
    shared |= ++there->count > 1;
  }
  return shared;
}

static void move_apart(places *p, uint32_t count, double spacing, char *copy) {
  uint32_t dimension = p->solver->kind.dimension, size = pbf_element_size(p->solver);
  pbf_box box = pbf_params_box(&p->solver->params, dimension, pbf_solver_time(p->solver));
  for (uint32_t i = 0; i < count; ++i) {
    double offset[3];
    place *there = place_of(p, i);
    pbf_coincident_offset(dimension, spacing, there->seen++, there->count, offset);
    for (uint32_t k = 0; k < dimension && there->count > 1; ++k) {
      double value = fmin(component(p, i, k) + offset[k], box.upper[k]);
      value = fmax(value, box.lower[k]);
      float single = (float)value;
      memcpy(copy + i * p->point_bytes + k * size,
             size == sizeof single ? (void *)&single : (void *)&value, size);
    }
  }
}

pbf_status pbf_separate(const pbf_solver *solver, const void *positions, uint32_t count,
                        pbf_separated *separated) {
  uint64_t point_bytes = pbf_point_bytes(solver), slots = 2;
  while (slots < 2 * (uint64_t)count) slots *= 2;
  void *memory;
  *separated = (pbf_separated){.positions = positions};
  pbf_status status = pbf_memory_allocate(&solver->allocator, slots * sizeof(place),
                                          "a table of the new positions", &memory);
  if (status != PBF_OK) return status;
  memset(memory, 0, slots * sizeof(place));
  places p = {solver, positions, point_bytes, memory, slots - 1};
  if (find_places(&p, count)) {
    separated->bytes = count * point_bytes;
    status = pbf_memory_allocate(&solver->allocator, separated->bytes,
                                 "a copy of the new positions", &separated->copy);
    if (status == PBF_OK) {
      memcpy(separated->copy, positions, separated->bytes);
      move_apart(&p, count, pbf_derive_spacing(&solver->params), separated->copy);
      separated->positions = separated->copy;
    }
  }
  pbf_memory_free(&solver->allocator, memory, slots * sizeof(place));
  return status;
}

void pbf_separated_free(const pbf_solver *solver, pbf_separated *separated) {
  pbf_memory_free(&solver->allocator, separated->copy, separated->bytes);
}
