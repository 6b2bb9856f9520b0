#include "cells.h"

#include <math.h>
#include <string.h>

#include "memory.h"

/* A cell's number along an axis has 21 bits of its key, x in the lowest: cells in a row follow each
 * other. What is farther out lies in the last one around which there are all others. */
enum { CELL_BITS = 21, CELL_MAX = (1 << CELL_BITS) - 1 - PBF_CELL_REACH };
enum { DIGIT_BITS = 8, DIGITS = 1 << DIGIT_BITS };

static uint64_t key_of(const pbf_cells *cells, const double *point) {
  uint64_t key = 0;
  for (uint32_t k = 0; k < cells->dimension; ++k) {
    const double cell = floor((point[k] - cells->origin[k]) * PBF_CELL_REACH / cells->radius);
    key |= (uint64_t)fmin(PBF_CELL_REACH + cell, CELL_MAX) << (k * CELL_BITS);
  }
  return key;
}

static void find_origin(pbf_cells *cells, const double *points) {
  for (uint32_t k = 0; k < cells->dimension; ++k) {
    cells->origin[k] = INFINITY;
    for (uint32_t i = 0; i < cells->count; ++i)
      cells->origin[k] = fmin(cells->origin[k], points[(uint64_t)i * cells->dimension + k]);
  }
}

typedef struct keyed {
  uint64_t key;
  uint32_t point, reserved;
} keyed;

/* A pass of a radix sort: stable, so that points keep their order within a cell. Returns where the
 * result is: in `to`, or, where all have the same digit, still in `from`. */
static keyed *sort_by_digit(keyed *from, keyed *to, uint32_t count, uint32_t shift) {
  uint32_t starts[DIGITS] = {0}, sum = 0;
  for (uint32_t i = 0; i < count; ++i) ++starts[from[i].key >> shift & (DIGITS - 1)];
  if (starts[from[0].key >> shift & (DIGITS - 1)] == count) return from;
  for (uint32_t digit = 0; digit < DIGITS; ++digit) {
    const uint32_t here = starts[digit];
    starts[digit] = sum;
    sum += here;
  }
  for (uint32_t i = 0; i < count; ++i) to[starts[from[i].key >> shift & (DIGITS - 1)]++] = from[i];
  return to;
}

static pbf_status sort(pbf_cells *cells, const double *points) {
  const uint64_t bytes = 2 * (uint64_t)cells->count * sizeof(keyed);
  void *memory;
  pbf_status status = pbf_memory_allocate(cells->allocator, bytes, "sorting by cells", &memory);
  if (status != PBF_OK) return status;
  keyed *const both = memory, *sorted = both;
  for (uint32_t i = 0; i < cells->count; ++i)
    sorted[i] = (keyed){key_of(cells, points + (uint64_t)i * cells->dimension), i, 0};
  for (uint32_t shift = 0; shift < cells->dimension * CELL_BITS; shift += DIGIT_BITS)
    sorted =
        sort_by_digit(sorted, sorted == both ? both + cells->count : both, cells->count, shift);
  for (uint32_t i = 0; i < cells->count; ++i) {
    cells->keys[i] = sorted[i].key;
    cells->order[i] = sorted[i].point;
    memcpy(cells->points + (uint64_t)i * cells->dimension,
           points + (uint64_t)sorted[i].point * cells->dimension,
           cells->dimension * sizeof *points);
  }
  pbf_memory_free(cells->allocator, memory, bytes);
  return PBF_OK;
}

pbf_status pbf_cells_build(const pbf_allocator *allocator, const double *points, uint32_t count,
                           uint32_t dimension, double radius, pbf_cells *cells) {
  *cells =
      (pbf_cells){.allocator = allocator, .dimension = dimension, .count = count, .radius = radius};
  const uint64_t of_points = (uint64_t)count * dimension * sizeof *cells->points;
  const uint64_t of_keys = (uint64_t)count * sizeof *cells->keys;
  cells->bytes = of_points + of_keys + (uint64_t)count * sizeof *cells->order;
  pbf_status status =
      pbf_memory_allocate(allocator, cells->bytes, "particles sorted by cells", &cells->memory);
  if (status != PBF_OK || count == 0) return status;
  cells->points = cells->memory;
  cells->keys = (uint64_t *)(void *)((char *)cells->memory + of_points);
  cells->order = (uint32_t *)(void *)((char *)cells->memory + of_points + of_keys);
  find_origin(cells, points);
  status = sort(cells, points);
  if (status != PBF_OK) pbf_cells_free(cells);
  return status;
}

void pbf_cells_free(pbf_cells *cells) {
  pbf_memory_free(cells->allocator, cells->memory, cells->bytes);
  cells->memory = NULL;
}

/* The first element with a key of at least `key`. */
static uint32_t find_key(const pbf_cells *cells, uint64_t key) {
  uint32_t below = 0, above = cells->count;
  while (below < above) {
    const uint32_t middle = below + (above - below) / 2;
    if (cells->keys[middle] < key)
      below = middle + 1;
    else
      above = middle;
  }
  return below;
}

uint32_t pbf_cells_around(const pbf_cells *cells, uint32_t element,
                          pbf_cell_run runs[PBF_CELL_RUNS]) {
  const uint64_t y = (uint64_t)1 << CELL_BITS, z = y << CELL_BITS;
  const uint32_t layers = cells->dimension == 3 ? PBF_CELL_LINES : 1;
  const uint64_t corner = cells->keys[element] - PBF_CELL_REACH * (1 + y + (layers > 1 ? z : 0));
  uint32_t count = 0;
  for (uint32_t layer = 0; layer < layers; ++layer) {
    for (uint32_t line = 0; line < PBF_CELL_LINES; ++line) {
      const uint64_t first = corner + layer * z + line * y;
      runs[count].begin = find_key(cells, first);
      runs[count].end = find_key(cells, first + PBF_CELL_LINES);
      count += runs[count].begin < runs[count].end;
    }
  }
  return count;
}
