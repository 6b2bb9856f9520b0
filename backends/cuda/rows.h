/* Part of population.h: between the sorted order and the order of adding; adding and removing. */
#ifndef PBF_CUDA_ROWS_H
#define PBF_CUDA_ROWS_H

#include "common/rows.h"
#include "cuda/launch.h"
#include "cuda/particles.h"

/* `count` rows; their ids on the device, or null where these are first_id … first_id + count - 1.
 */
struct row_range {
  const uint32_t *ids;
  uint32_t first_id, count;
  uint32_t first; /* of the rows of all particles */
};

/* Row of `id` within the range; rows.count or more where it is not in it. */
static __device__ inline uint32_t row_in_range(const row_range &rows, uint32_t id) {
  return rows.ids ? pbf_find_id(rows.ids, rows.count, id) : id - rows.first_id;
}

static __global__ void read_points_kernel(const point *points, const uint32_t *ids, uint32_t count,
                                          row_range rows, pbf_vec *out) {
  uint32_t i = thread_index();
  if (i >= count) return;
  uint32_t row = row_in_range(rows, ids[i]);
  if (row < rows.count) out[row] = position_of(load(points, i));
}

static __global__ void write_points_kernel(point *points, const uint32_t *ids, uint32_t count,
                                           row_range rows, const pbf_vec *in) {
  uint32_t i = thread_index();
  if (i >= count) return;
  uint32_t row = row_in_range(rows, ids[i]);
  if (row >= rows.count) return;
  point to = point_at(in[row]);
  to.lambda = points[i].lambda;
  store(points, i, to);
}

template <class Value>
static __global__ void read_values_kernel(const Value *values, const uint32_t *ids, uint32_t count,
                                          row_range rows, Value *out) {
  uint32_t i = thread_index();
  if (i >= count) return;
  uint32_t row = row_in_range(rows, ids[i]);
  if (row < rows.count) out[row] = values[i];
}

template <class Value>
static __global__ void write_values_kernel(Value *values, const uint32_t *ids, uint32_t count,
                                           row_range rows, const Value *in) {
  uint32_t i = thread_index();
  if (i >= count) return;
  uint32_t row = row_in_range(rows, ids[i]);
  if (row < rows.count) values[i] = in[row];
}

/* Unrest and lambda of each, for saved states. */
static __global__ void read_rest_kernel(const point *points, const pbf_real *activity,
                                        const uint32_t *ids, uint32_t count, row_range rows,
                                        pbf_real *out) {
  uint32_t i = thread_index();
  if (i >= count) return;
  uint32_t row = row_in_range(rows, ids[i]);
  if (row >= rows.count) return;
  out[2 * (size_t)row] = activity[i];
  out[2 * (size_t)row + 1] = points[i].lambda;
}

static __global__ void write_rest_kernel(point *points, pbf_real *activity, const uint32_t *ids,
                                         uint32_t count, row_range rows, const pbf_real *in) {
  uint32_t i = thread_index();
  if (i >= count) return;
  uint32_t row = row_in_range(rows, ids[i]);
  if (row >= rows.count) return;
  activity[i] = in[2 * (size_t)row];
  points[i].lambda = in[2 * (size_t)row + 1];
}

static __global__ void append_points_kernel(point *points, uint32_t count, const pbf_vec *in) {
  uint32_t i = thread_index();
  if (i < count) store(points, i, point_at(in[i]));
}

/* 1 for the particles that stay, and 0 after the last, for the scan. */
static __global__ void mark_kept_kernel(const uint32_t *ids, uint32_t count,
                                        const uint32_t *removed, uint32_t removed_count,
                                        uint32_t *kept) {
  uint32_t i = thread_index();
  if (i < count) kept[i] = pbf_find_id(removed, removed_count, ids[i]) == removed_count;
  if (i == count) kept[i] = 0;
}

struct particle_arrays {
  point *points;
  pbf_vec *velocities;
  uint32_t *ids;
  pbf_real *activity;      /* where fluid sleeps, else null */
  pbf_real *last_pressure; /* where lambda adds up, else null */
  pbf_real *overlap;       /* where fluid has been placed in other fluid, else null */
  uint8_t *phase;          /* where phases differ, else null */
  pbf_vec *acceleration;   /* where particles have some, else null */
};

/* `place` is the exclusive scan of what mark_kept_kernel wrote. */
static __global__ void compact_kernel(particle_arrays from, uint32_t count, const uint32_t *place,
                                      particle_arrays to) {
  uint32_t i = thread_index();
  if (i >= count || place[i] == place[i + 1]) return;
  store(to.points, place[i], load(from.points, i));
  to.velocities[place[i]] = from.velocities[i];
  to.ids[place[i]] = from.ids[i];
  if (from.activity) to.activity[place[i]] = from.activity[i];
  if (from.last_pressure) to.last_pressure[place[i]] = from.last_pressure[i];
  if (from.overlap) to.overlap[place[i]] = from.overlap[i];
  if (from.phase) to.phase[place[i]] = from.phase[i];
  if (from.acceleration) to.acceleration[place[i]] = from.acceleration[i];
}

#endif
