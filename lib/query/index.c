#include "index.h"

#include <math.h>
#include <string.h>

#include "compiler.h"
#include "memory.h"
#include "particles/numbers.h"
#include "particles/particles.h"
#include "physics/spacing.h"
#include "solver/ids.h"

/* A cell's number along an axis has at most 20 bits. What is farther out lies in the last one
 * around which there are all others. */
enum { CELL_BITS = 20, DIGIT_BITS = 11, DIGITS = 1 << DIGIT_BITS, SHORT_RUN = 32 };

static const double pi = 3.14159265358979323846;

/* ---- Memory --------------------------------------------------------------------------------- */

/* Entries of the directory for so many particles: about two each. */
static uint32_t most_entry_bits(uint32_t count) {
  uint32_t bits = 1;
  while (bits < 31 && UINT32_C(1) << bits < count) ++bits;
  return bits + (bits < 31);
}

static uint64_t directory_size(uint32_t capacity) {
  return (UINT64_C(1) << most_entry_bits(capacity)) + 1;
}

static uint64_t bytes_for(uint64_t capacity, const pbf_solver *solver, int copies) {
  const pbf_query_index *index = NULL;
  return capacity * ((1 + (copies != 0)) * pbf_point_bytes(solver) + sizeof *index->keys +
                     2 * sizeof *index->sorted + sizeof *index->elements) +
         directory_size((uint32_t)capacity) * sizeof *index->first;
}

/* Where the arrays lie behind the struct, those of the largest elements first. */
static void lay_out(pbf_query_index *index, char *at, int copies) {
  const uint64_t capacity = index->capacity, point = (uint64_t)index->dimension * index->precision;
  index->sorted = (void *)at;
  index->spare = index->sorted + capacity;
  index->velocities = at;
  index->pressures = at + capacity * point;
  at += 2 * capacity * sizeof *index->sorted;
  index->keys = (void *)at;
  at += capacity * sizeof *index->keys;
  index->points = at;
  at += capacity * point;
  index->copy = copies ? at : NULL;
  if (copies) at += capacity * point;
  index->elements = (void *)at;
  index->first = index->elements + capacity;
}

/* For as many particles as there are, and some more. */
pbf_status pbf_query_index_reserve(pbf_solver *solver) {
  void *memory;
  const uint32_t count = solver->count, more = count / 4 + 64;
  const uint32_t capacity = more < solver->capacity - count ? count + more : solver->capacity;
  const uint64_t head = (sizeof(pbf_query_index) + 63) / 64 * 64;
  int copies;
  if (solver->query && solver->query->capacity >= count) return PBF_OK;
  pbf_status status = pbf_numbers_need_copies(solver, &copies);
  if (status != PBF_OK) return status;
  const uint64_t bytes = head + bytes_for(capacity, solver, copies);
  status = pbf_memory_allocate(&solver->allocator, bytes, "particles sorted for queries", &memory);
  if (status != PBF_OK) return status;
  pbf_query_index_free(solver);
  solver->query = memory;
  *solver->query = (pbf_query_index){.capacity = capacity,
                                     .bytes = bytes,
                                     .dimension = solver->kind.dimension,
                                     .precision = solver->kind.precision};
  lay_out(solver->query, (char *)memory + head, copies);
  return PBF_OK;
}

/* ---- Cells ---------------------------------------------------------------------------------- */

static void find_bounds(pbf_query_index *index, const pbf_numbers *x, uint32_t precision) {
  for (uint32_t k = 0; k < index->dimension; ++k) {
    double lower = INFINITY, upper = -INFINITY;
    for (uint32_t i = 0; i < index->count; ++i) {
      const double at = pbf_numbers_get(x, i, k, precision);
      lower = at < lower ? at : lower;
      upper = at > upper ? at : upper;
    }
    index->lower[k] = lower;
    index->upper[k] = upper;
  }
}

static void choose_cells(pbf_query_index *index) {
  const double most = (1 << CELL_BITS) - 1;
  uint32_t total = 0;
  index->cell = index->radius / PBF_QUERY_REACH;
  for (uint32_t k = 0; k < index->dimension; ++k) {
    const double width = (index->upper[k] - index->lower[k]) / index->cell;
    index->cells[k] = (uint32_t)fmin(floor(width) + 1 + 2 * PBF_QUERY_REACH, most);
    index->bits[k] = 1;
    while (UINT32_C(1) << index->bits[k] < index->cells[k]) ++index->bits[k];
    total += index->bits[k];
  }
  const uint32_t entry_bits = most_entry_bits(index->count);
  index->shift = total > entry_bits ? total - entry_bits : 0;
  index->entries = UINT32_C(1) << (total - index->shift);
}

/* The number of a coordinate's cell, as a number that may be beyond all. */
static double cell_of(const pbf_query_index *index, uint32_t axis, double x) {
  return PBF_QUERY_REACH + floor((x - index->lower[axis]) / index->cell);
}

/* What is beyond the cells that can be counted lies in the last one. */
static uint32_t inner_cell(const pbf_query_index *index, uint32_t axis, double cell) {
  return (uint32_t)fmin(cell, index->cells[axis] - 1 - PBF_QUERY_REACH);
}

static uint64_t key_of(const pbf_query_index *index, uint32_t x, uint32_t y, uint32_t z) {
  const uint32_t bits = index->bits[0];
  return x | (uint64_t)y << bits |
         (index->dimension == 3 ? (uint64_t)z << (bits + index->bits[1]) : 0);
}

static void find_keys(pbf_query_index *index, const pbf_numbers *x, const pbf_solver *solver) {
  for (uint32_t i = 0; i < index->count; ++i) {
    uint32_t cell[3] = {0, 0, 0};
    for (uint32_t k = 0; k < index->dimension; ++k)
      cell[k] =
          inner_cell(index, k, cell_of(index, k, pbf_numbers_get(x, i, k, solver->kind.precision)));
    index->sorted[i] = (pbf_query_key){key_of(index, cell[0], cell[1], cell[2]), i,
                                       x->ids ? x->ids[i] : pbf_ids_of_row(solver, i)};
  }
}

/* ---- Sorting -------------------------------------------------------------------------------- */

/* A pass of a radix sort, stable. */
static void sort_by_digit(const pbf_query_key *from, pbf_query_key *to, uint32_t count,
                          uint32_t shift) {
  uint32_t starts[DIGITS] = {0}, sum = 0;
  for (uint32_t i = 0; i < count; ++i) ++starts[from[i].key >> shift & (DIGITS - 1)];
  for (uint32_t digit = 0; digit < DIGITS; ++digit) {
    const uint32_t here = starts[digit];
    starts[digit] = sum;
    sum += here;
  }
  for (uint32_t i = 0; i < count; ++i) to[starts[from[i].key >> shift & (DIGITS - 1)]++] = from[i];
}

static void sift(pbf_query_key *heap, uint32_t root, uint32_t count) {
  const pbf_query_key moved = heap[root];
  for (uint32_t child = 2 * root + 1; child < count; child = 2 * root + 1) {
    child += child + 1 < count && heap[child + 1].id > heap[child].id;
    if (heap[child].id <= moved.id) break;
    heap[root] = heap[child];
    root = child;
  }
  heap[root] = moved;
}

/* Those of one cell by id: mostly few, and mostly in order. */
static void sort_by_id(pbf_query_key *run, uint32_t count) {
  if (count > SHORT_RUN) {
    for (uint32_t root = count / 2; root-- > 0;) sift(run, root, count);
    for (uint32_t end = count; end-- > 1;) {
      const pbf_query_key last = run[0];
      run[0] = run[end];
      run[end] = last;
      sift(run, 0, end);
    }
    return;
  }
  for (uint32_t i = 1; i < count; ++i) {
    const pbf_query_key moved = run[i];
    uint32_t to = i;
    for (; to > 0 && run[to - 1].id > moved.id; --to) run[to] = run[to - 1];
    run[to] = moved;
  }
}

static pbf_query_key *sort_by_key(const pbf_query_index *index, pbf_query_key *from,
                                  pbf_query_key *to, uint32_t count) {
  uint32_t bits = 0;
  for (uint32_t k = 0; k < index->dimension; ++k) bits += index->bits[k];
  for (uint32_t shift = 0; shift < bits; shift += DIGIT_BITS) {
    sort_by_digit(from, to, count, shift);
    pbf_query_key *const sorted = to;
    to = from;
    from = sorted;
  }
  return from;
}

static const pbf_query_key *sort(pbf_query_index *index) {
  pbf_query_key *sorted = sort_by_key(index, index->sorted, index->spare, index->count);
  for (uint32_t begin = 0, end; begin < index->count; begin = end) {
    for (end = begin + 1; end < index->count && sorted[end].key == sorted[begin].key; ++end) {
    }
    sort_by_id(sorted + begin, end - begin);
  }
  return sorted;
}

static void store(pbf_query_index *index, const pbf_query_key *sorted) {
  uint32_t entry = 0;
  for (uint32_t i = 0; i < index->count; ++i) {
    index->keys[i] = sorted[i].key;
    index->elements[i] = sorted[i].element;
    while (entry <= sorted[i].key >> index->shift) index->first[entry++] = i;
  }
  while (entry <= index->entries) index->first[entry++] = index->count;
}

static PBF_ALWAYS_INLINE void gather_as(const pbf_query_index *index, const pbf_numbers *numbers,
                                        uint32_t components, void *sorted, uint64_t size) {
  for (uint32_t i = 0; i < index->count; ++i) {
    const char *from = numbers->data + index->elements[i] * numbers->particle_stride;
    char *to = (char *)sorted + i * components * size;
    for (uint32_t k = 0; k < components; ++k)
      memcpy(to + k * size, from + k * numbers->component_stride, size);
  }
}

/* Numbers of a field as they are, in the order of the index. */
static void gather(const pbf_query_index *index, const pbf_numbers *numbers, uint32_t components,
                   void *sorted) {
  if (index->precision == PBF_FLOAT32)
    gather_as(index, numbers, components, sorted, PBF_FLOAT32);
  else
    gather_as(index, numbers, components, sorted, PBF_FLOAT64);
}

/* ---- Building ------------------------------------------------------------------------------- */

static void find_period(const pbf_solver *solver, uint32_t axis, double *face, double *period) {
  const pbf_params *params = &solver->params;
  const int periodic = params->periodic >> axis & 1 && axis < solver->kind.dimension;
  *face = periodic ? params->domain_min[axis] : 0;
  *period = periodic ? params->domain_max[axis] - params->domain_min[axis] : 0;
}

static int has_periods_of_now(const pbf_query_index *index, const pbf_solver *solver) {
  double face, period;
  for (uint32_t k = 0; k < 3; ++k) {
    find_period(solver, k, &face, &period);
    if (index->face[k] != face || index->period[k] != period) return 0;
  }
  return 1;
}

static int is_of_now(const pbf_solver *solver) {
  const pbf_query_index *index = solver->query;
  return index && index->is_built && index->generation == solver->generation &&
         index->radius == 1.5 * solver->params.smoothing_radius &&
         index->spacing == pbf_derive_spacing(&solver->params) && has_periods_of_now(index, solver);
}

static void describe(pbf_query_index *index, const pbf_solver *solver) {
  index->count = solver->count;
  index->radius = 1.5 * solver->params.smoothing_radius;
  index->spacing = pbf_derive_spacing(&solver->params);
  for (uint32_t k = 0; k < 3; ++k) find_period(solver, k, &index->face[k], &index->period[k]);
  const double d = index->spacing / index->radius;
  index->scale = index->dimension == 3 ? d * d * d * 21 / (2 * pi) : d * d * 7 / pi;
}

static pbf_status build(pbf_solver *solver) {
  pbf_numbers x;
  pbf_status status = pbf_query_index_reserve(solver);
  if (status != PBF_OK) return status;
  pbf_query_index *index = solver->query;
  index->is_built = index->has_velocities = index->has_pressures = 0;
  describe(index, solver);
  status = pbf_numbers_find_in(solver, PBF_FIELD_POSITION, 0, solver->count, index->copy, &x);
  if (status == PBF_OK && index->count > 0) {
    find_bounds(index, &x, solver->kind.precision);
    choose_cells(index);
    find_keys(index, &x, solver);
    store(index, sort(index));
    gather(index, &x, index->dimension, index->points);
  }
  pbf_numbers_free(solver, &x);
  index->generation = solver->generation;
  index->is_built = status == PBF_OK;
  return status;
}

static pbf_status add_field(pbf_solver *solver, uint32_t field, uint32_t components, void *sorted) {
  pbf_numbers numbers;
  pbf_status status =
      pbf_numbers_find_in(solver, field, 0, solver->count, solver->query->copy, &numbers);
  if (status == PBF_OK) gather(solver->query, &numbers, components, sorted);
  pbf_numbers_free(solver, &numbers);
  return status;
}

pbf_status pbf_query_index_get(pbf_solver *solver, uint32_t fields, const pbf_query_index **found) {
  pbf_status status = fields & PBF_QUERY_PRESSURES ? pbf_check_pressures(solver) : PBF_OK;
  if (status == PBF_OK && !is_of_now(solver)) status = build(solver);
  if (status != PBF_OK) return status;
  pbf_query_index *index = solver->query;
  if (fields & PBF_QUERY_VELOCITIES && !index->has_velocities) {
    status = add_field(solver, PBF_FIELD_VELOCITY, index->dimension, index->velocities);
    index->has_velocities = status == PBF_OK;
  }
  if (status == PBF_OK && fields & PBF_QUERY_PRESSURES && !index->has_pressures) {
    status = add_field(solver, PBF_FIELD_PRESSURE, 1, index->pressures);
    index->has_pressures = status == PBF_OK;
  }
  *found = index;
  return status;
}

/* ---- Looking up ----------------------------------------------------------------------------- */

/* The first particle with a key of at least `key`. */
static uint32_t find_key(const pbf_query_index *index, uint64_t key) {
  const uint64_t entry = key >> index->shift;
  if (entry >= index->entries) return index->count;
  uint32_t below = index->first[entry], above = index->first[entry + 1];
  while (below < above) {
    const uint32_t middle = below + (above - below) / 2;
    if (index->keys[middle] < key)
      below = middle + 1;
    else
      above = middle;
  }
  return below;
}

static void find_runs(pbf_query_place *place) {
  const pbf_query_index *index = place->index;
  const uint32_t *cell = place->cell, layers = index->dimension == 3 ? PBF_QUERY_LINES : 1;
  place->count = 0;
  for (uint32_t z = 0; z < layers; ++z) {
    for (uint32_t y = 0; y < PBF_QUERY_LINES; ++y) {
      const uint32_t layer = layers > 1 ? cell[2] + z - PBF_QUERY_REACH : 0;
      const uint64_t first =
          key_of(index, cell[0] - PBF_QUERY_REACH, cell[1] + y - PBF_QUERY_REACH, layer);
      pbf_query_run *run = &place->runs[place->count];
      run->begin = find_key(index, first);
      run->end = find_key(index, first + PBF_QUERY_LINES);
      place->count += run->begin < run->end;
    }
  }
}

void pbf_query_go(pbf_query_place *place, const double *point) {
  const pbf_query_index *index = place->index;
  uint32_t cell[3] = {0, 0, 0};
  for (uint32_t k = 0; k < index->dimension; ++k) {
    const double at = point[k];
    if (index->count == 0 || !(at > index->lower[k] - index->radius) ||
        !(at < index->upper[k] + index->radius)) {
      place->count = place->is_set = 0;
      return;
    }
    /* Before the first particle and behind the last; in their cells nothing else is near. */
    cell[k] = inner_cell(index, k, fmax(cell_of(index, k, at), PBF_QUERY_REACH));
  }
  if (place->is_set && memcmp(cell, place->cell, sizeof cell) == 0) return;
  memcpy(place->cell, cell, sizeof cell);
  place->is_set = 1;
  find_runs(place);
}

static void find_lines(pbf_query_place *place) {
  const pbf_query_index *index = place->index;
  const uint32_t *from = place->cell, *to = place->last;
  place->count = 0;
  for (uint32_t z = from[2]; z <= to[2]; ++z) {
    for (uint32_t y = from[1]; y <= to[1]; ++y) {
      pbf_query_run *run = &place->runs[place->count];
      run->begin = find_key(index, key_of(index, from[0], y, z));
      run->end = find_key(index, key_of(index, to[0], y, z) + 1);
      place->count += run->begin < run->end;
    }
  }
}

void pbf_query_go_within(pbf_query_place *place, const double *point, double reach) {
  const pbf_query_index *index = place->index;
  uint32_t from[3] = {0, 0, 0}, to[3] = {0, 0, 0};
  for (uint32_t k = 0; k < index->dimension; ++k) {
    const double lower = point[k] - reach, upper = point[k] + reach;
    if (index->count == 0 || !(upper >= index->lower[k]) || !(lower <= index->upper[k])) {
      place->count = place->is_set = 0;
      return;
    }
    from[k] = inner_cell(index, k, fmax(cell_of(index, k, lower), PBF_QUERY_REACH));
    to[k] = inner_cell(index, k, cell_of(index, k, upper));
  }
  if (place->is_set && memcmp(from, place->cell, sizeof from) == 0 &&
      memcmp(to, place->last, sizeof to) == 0)
    return;
  memcpy(place->cell, from, sizeof from);
  memcpy(place->last, to, sizeof to);
  place->is_set = 1;
  find_lines(place);
}

uint32_t pbf_query_images(const pbf_query_index *index, const double *point,
                          double images[PBF_QUERY_IMAGES][3]) {
  uint32_t count = 1;
  images[0][2] = 0;
  memcpy(images[0], point, index->dimension * sizeof *point);
  for (uint32_t k = 0; k < index->dimension; ++k) {
    const double period = index->period[k];
    if (!(period > 0)) continue;
    const double from = images[0][k] - index->face[k], in = from - period * floor(from / period);
    const double beyond = in < index->radius ? period : in > period - index->radius ? -period : 0;
    for (uint32_t i = 0; i < count; ++i) images[i][k] = index->face[k] + in;
    for (uint32_t i = 0; beyond != 0 && i < count; ++i) {
      memcpy(images[count + i], images[i], sizeof images[i]);
      images[count + i][k] += beyond;
    }
    count *= beyond != 0 ? 2 : 1;
  }
  return count;
}

/* ---- Ordering points ------------------------------------------------------------------------- */

static pbf_status reserve_order(pbf_solver *solver, uint32_t count) {
  pbf_query_index *index = solver->query;
  void *memory;
  if (index->order_capacity >= count) return PBF_OK;
  pbf_status status =
      pbf_memory_allocate(&solver->allocator, 2 * (uint64_t)count * sizeof *index->order,
                          "an order of points", &memory);
  if (status != PBF_OK) return status;
  pbf_memory_free(&solver->allocator, index->order, pbf_query_order_bytes(index));
  index->order = memory;
  index->order_capacity = count;
  return PBF_OK;
}

/* What is outside of all cells counts to the nearest. */
static uint64_t key_at(const pbf_query_index *index, const double *point) {
  uint32_t cell[3] = {0, 0, 0};
  for (uint32_t k = 0; k < index->dimension; ++k)
    cell[k] = inner_cell(index, k, fmax(cell_of(index, k, point[k]), PBF_QUERY_REACH));
  return key_of(index, cell[0], cell[1], cell[2]);
}

pbf_status pbf_query_order(pbf_solver *solver, uint32_t count, const double *points,
                           const pbf_query_key **order) {
  pbf_status status = reserve_order(solver, count);
  if (status != PBF_OK) return status;
  const pbf_query_index *index = solver->query;
  pbf_query_key *from = index->order, *to = from + count;
  for (uint32_t i = 0; i < count; ++i)
    from[i] = (pbf_query_key){
        index->count > 0 ? key_at(index, points + (uint64_t)i * index->dimension) : 0, i, 0};
  *order = sort_by_key(index, from, to, count);
  return PBF_OK;
}
