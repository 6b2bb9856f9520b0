/* Particles on the device. */
#ifndef PBF_CUDA_PARTICLES_H
#define PBF_CUDA_PARTICLES_H

#include <stdint.h>

#include "physics/real.h"

/* Position and lambda side by side: what the pair loop reads of a neighbour is one aligned load. */
struct alignas(4 * sizeof(float)) point {
  pbf_real c[PBF_DIM];
  pbf_real lambda;
#if PBF_DIM == 2
  pbf_real unused;
#endif
};
static_assert(sizeof(point) == 4 * sizeof(pbf_real), "a point is loaded as a vector");

static __device__ __forceinline__ point load(const point *points, uint32_t i) {
  union {
    point value;
    float4 part[sizeof(point) / sizeof(float4)];
  } read;
  const float4 *from = reinterpret_cast<const float4 *>(points + i);
#pragma unroll
  for (unsigned k = 0; k < sizeof(point) / sizeof(float4); ++k) read.part[k] = from[k];
  return read.value;
}

/* Anything else. */
template <class Value>
static __device__ __forceinline__ Value load(const Value *values, uint32_t i) {
  return values[i];
}

/* Of arrays that are not there. */
struct no_value {};

static __device__ __forceinline__ no_value load(const no_value *, uint32_t) { return {}; }

static __device__ __forceinline__ void store(point *points, uint32_t i, const point &value) {
  union {
    point value;
    float4 part[sizeof(point) / sizeof(float4)];
  } written;
  written.value = value;
  float4 *to = reinterpret_cast<float4 *>(points + i);
#pragma unroll
  for (unsigned k = 0; k < sizeof(point) / sizeof(float4); ++k) to[k] = written.part[k];
}

static __device__ __forceinline__ pbf_vec position_of(const point &p) {
  pbf_vec x;
  for (int k = 0; k < PBF_DIM; ++k) x.c[k] = p.c[k];
  return x;
}

static __device__ __forceinline__ point point_at(pbf_vec x) {
  point p;
  for (int k = 0; k < PBF_DIM; ++k) p.c[k] = x.c[k];
  p.lambda = 0;
#if PBF_DIM == 2
  p.unused = 0;
#endif
  return p;
}

/* Points after the last: one far from everything (lists.h), and what the search reads beyond the
 * end of a row. */
enum { PBF_SPARE_POINTS = 4 };

/* Particles sorted by cell, and by id within a cell. */
struct sorted_particles {
  point *points;       /* PBF_SPARE_POINTS more than the capacity */
  pbf_vec *velocities; /* that go with the predicted positions */
  uint32_t *ids, *cells;
  uint32_t *cell_start; /* first particle of each cell; one more at the end */
  uint32_t count;       /* the end of those that stages work on, … */
  uint32_t first;       /* … from here on: all, or on ranks its own among those that it holds */
  pbf_real *activity;   /* where fluid sleeps, else null */
  pbf_real *last_pressure; /* where lambda adds up, else null */
  pbf_real *overlap;       /* where fluid has been placed in other fluid, else null */
  uint8_t *phase;          /* where phases differ, else null, … */
  pbf_real *mobility;      /* … as this */
  pbf_vec *acceleration;   /* where particles have some, else null */
};

/* The particle of a thread, of those that stages work on. */
static __device__ __forceinline__ uint32_t own_index(const sorted_particles &p) {
  await_launches_before();
  return p.first + blockIdx.x * blockDim.x + threadIdx.x;
}

#endif
