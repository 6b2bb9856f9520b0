/* Part of sort.h. What walls and colliders do to particles. Where colliders are many a particle
 * does not ask all of them in each pass, one after the other: the lanes of a warp share them out,
 * and look which are near the box around their particles. The others leave each particle as it is,
 * to the bit. */
#ifndef PBF_CUDA_OBSTACLES_H
#define PBF_CUDA_OBSTACLES_H

#include <float.h>

#include "pbf/pbf.h"
#include "physics/boundary.h"

/* Walls and colliders of one step; `surfaces` is on the device. */
struct step_obstacles {
  pbf_domain domain;
  int count;
  const pbf_surface *surfaces;
};

/* A bit for each collider. */
typedef unsigned long long surface_set;
static_assert(PBF_MAX_COLLIDERS <= 64, "a set has 64 bits");

/* Kernels that are short of registers are built for each: colliders take half as many again, and
 * looking for them takes more. */
enum surfaces_met { NO_SURFACES, FEW_SURFACES, MANY_SURFACES };

/* Fewer are asked faster than looked for. */
static inline surfaces_met surfaces_of(uint32_t count) {
  return count == 0 ? NO_SURFACES : count < 8 ? FEW_SURFACES : MANY_SURFACES;
}

/* Numbers whose order as integers is that of the floats. */
static __device__ __forceinline__ uint32_t ordered(float a) {
  uint32_t bits = __float_as_uint(a);
  return bits >> 31 ? ~bits : bits | 0x80000000u;
}

static __device__ __forceinline__ float from_ordered(uint32_t bits) {
  return __uint_as_float(bits >> 31 ? bits & 0x7fffffffu : ~bits);
}

static __device__ __forceinline__ float min_of(uint32_t lanes, float a) {
  return from_ordered(__reduce_min_sync(lanes, ordered(a)));
}

static __device__ __forceinline__ float max_of(uint32_t lanes, float a) {
  return from_ordered(__reduce_max_sync(lanes, ordered(a)));
}

static __device__ __forceinline__ float below(float a) { return a; }
static __device__ __forceinline__ float below(double a) { return __double2float_rd(a); }
static __device__ __forceinline__ float above(float a) { return a; }
static __device__ __forceinline__ float above(double a) { return __double2float_ru(a); }

/* Around the places of these lanes. */
struct lane_box {
  float lower[PBF_DIM], upper[PBF_DIM];
};

static __device__ __forceinline__ lane_box box_around(uint32_t lanes, pbf_vec x) {
  lane_box box;
  for (int k = 0; k < PBF_DIM; ++k) {
    box.lower[k] = min_of(lanes, below(x.c[k]));
    box.upper[k] = max_of(lanes, above(x.c[k]));
  }
  return box;
}

/* Whether something within `bound` of the centre can be within `reach` of the box; with room for
 * what is rounded here, and where a particle asks for itself. */
static __device__ __forceinline__ bool is_near_box(const lane_box &box, pbf_vec center, float bound,
                                                   float reach) {
  const float rounding = 1e-5f;
  float gap2 = 0, away = 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    float c = (float)center.c[k];
    float gap = fmaxf(fmaxf(box.lower[k] - c, c - box.upper[k]), 0);
    gap2 += gap * gap;
    away += fabsf(c);
  }
  float far = bound + reach;
  far += rounding * (far + away);
  return !(gap2 > far * far);
}

/* The colliders that may be within `reach` of the lanes' particles, where these colliders are, or
 * where they `started`. All lanes that are here together look for it. */
static __device__ __forceinline__ surface_set surfaces_near(const step_obstacles &o, pbf_vec x,
                                                            pbf_real reach, bool started) {
  uint32_t lanes = __activemask(), low = 0, high = 0, own = 1u << threadIdx.x % 32;
  lane_box box = box_around(lanes, x);
  float most = max_of(lanes, above(reach));
  for (uint32_t k = (uint32_t)__popc(lanes & (own - 1)); k < (uint32_t)o.count;
       k += (uint32_t)__popc(lanes)) {
    const pbf_surface &s = o.surfaces[k];
    bool near = is_near_box(box, started ? s.start_center : s.center, above(s.bound), most);
    low |= near && k < 32 ? 1u << k % 32 : 0;
    high |= near && k >= 32 ? 1u << k % 32 : 0;
  }
  low = __reduce_or_sync(lanes, low);
  return o.count > 32 ? (surface_set)__reduce_or_sync(lanes, high) << 32 | low : low;
}

/* Calls visit(surface) for those of the set, in their order. */
template <class Visit>
static __device__ __forceinline__ void each_surface(const step_obstacles &o, surface_set set,
                                                    Visit visit) {
  for (; set; set &= set - 1) visit(o.surfaces[__ffsll((long long)set) - 1]);
}

/* What they contribute at x. */
template <surfaces_met SURFACES>
static __device__ __forceinline__ pbf_boundary boundary_at(const pbf_constants *c,
                                                           const step_obstacles &o, pbf_vec x) {
  if (SURFACES != MANY_SURFACES) return pbf_boundary_at(c, o, x);
  pbf_boundary boundary = pbf_boundary_of_domain(c, &o.domain, x);
  each_surface(o, surfaces_near(o, x, pbf_boundary_reach(c), false),
               [&](const pbf_surface &s) { pbf_accumulate_surface(c, &s, x, &boundary); });
  return boundary;
}

template <surfaces_met SURFACES>
static __device__ __forceinline__ void add_boundary(const pbf_constants *c, const step_obstacles &o,
                                                    pbf_vec x, pbf_real *density,
                                                    pbf_vec *gradient) {
  pbf_boundary boundary = boundary_at<SURFACES>(c, o, x);
  pbf_add_boundary(&boundary, density, gradient);
}

/* A particle on its way from `from` to x, see pbf_resolve_collisions. A particle that one collider
 * pushes off it may meet any of them. */
template <surfaces_met SURFACES>
static __device__ __forceinline__ pbf_vec resolve_collisions(const step_obstacles &o,
                                                             int with_obstacle_motion, pbf_vec from,
                                                             pbf_vec x) {
  if (SURFACES == NO_SURFACES) return pbf_keep_in_domain(&o.domain, x);
  if (SURFACES == FEW_SURFACES) return pbf_resolve_collisions(o, with_obstacle_motion, from, x);
  pbf_vec way = pbf_sub(x, from);
  surface_set all = ~0ull >> (64 - o.count),
              near = surfaces_near(o, from, pbf_real_sqrt(pbf_dot(way, way)), with_obstacle_motion);
  for (;; near = all) {
    pbf_vec y = x;
    bool pushed = false;
    each_surface(o, near, [&](const pbf_surface &s) {
      y = pbf_resolve_collision(&o.domain, &s, with_obstacle_motion, from, y);
    });
    for (int k = 0; k < PBF_DIM; ++k) pushed |= y.c[k] != x.c[k];
    if (!pushed || near == all) return pbf_keep_in_domain(&o.domain, y);
  }
}

#endif
