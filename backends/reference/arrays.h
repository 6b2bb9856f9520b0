/* Part of backend.cpp: the arrays of a solver, those that it has for life and those of some scenes
 * only. */
#ifndef PBF_REFERENCE_ARRAYS_H
#define PBF_REFERENCE_ARRAYS_H

#include "common/memory.h"
#include "reference/grid.h"
#include "reference/solver.h"

template <class Value>
static bool take(solver *s, Value **array, const char *name, uint64_t count) {
  return (*array = static_cast<Value *>(pbf_memory_take(&s->memory, name, count, sizeof(Value))));
}

static bool take_arrays(solver *s) {
  uint64_t n = s->capacity;
  return take(s, &s->x, "position", n) && take(s, &s->v, "velocity", n) &&
         take(s, &s->predicted, "predicted", n) && take(s, &s->moved, "moved", n) &&
         take(s, &s->change, "change", n) && take(s, &s->lambda, "lambda", n) &&
         take(s, &s->ids, "id", n) && take(s, &s->grid.cell_of, "cell", n) &&
         take(s, &s->grid.list, "cell list", n) &&
         take(s, &s->grid.start, "cell start", (uint64_t)grid_cell_limit(s->capacity) + 1);
}

namespace {

/* An entry of physics/arrays.def. */
struct optional_array {
  solver *s;
  const char *name;
  bool wanted;

  /* Takes or releases it, as `wanted` says; false when there is no memory. */
  template <class Element>
  bool keep(Element **array) const {
    return pbf_memory_keep(&s->memory, wanted, name, s->capacity, 0, array);
  }
  bool keep(pbf_pressure_grid_storage *storage) const {
    return pbf_pressure_grid_keep(&s->memory, storage, wanted, name, s->capacity);
  }
  bool keep(pbf_load_tally **tally) const {
    const bool taken = wanted && !*tally;
    if (!pbf_memory_keep_bytes(&s->memory, wanted, name, pbf_load_tally_bytes(s->table.room),
                               tally))
      return false;
    if (taken) pbf_place_load_tally(*tally, s->table.room);
    return true;
  }
  bool keep(pbf_topology_memory *memory) const {
    return pbf_memory_keep(&s->memory, wanted, name, pbf_topology_memory_bytes(s->capacity), 0,
                           &memory->bytes);
  }
  bool keep(pbf_cell_moves *moves) const {
    return pbf_memory_keep(&s->memory, wanted, name, pbf_cell_move_words(s->capacity), 0,
                           &moves->sums);
  }
  bool keep() const { return true; } /* other backends' */
};

}  // namespace

/* What is not wanted any more goes only once there is all that is: where there is not, the scene
 * stays as it was, with what is in its arrays. */
static bool keep_arrays(solver *s, const pbf_schedule &has, const pbf_params &params) {
  for (int take = 1; take >= 0; --take) {
#define PBF_ARRAY(name, wanted, holders) \
  if (((wanted) != 0) == take && !optional_array{s, name, take != 0}.keep(holders)) return false;
#define PBF_REFERENCE(type, member) &s->member
#include "physics/arrays.def"
  }
  return true;
}

#endif
