/* What walls and colliders do to particles. Where colliders are many a particle does not ask all of
 * them in each pass, one after the other: the lanes of a warp share them out, and look which are
 * near the box around their particles. The others leave each particle as it is, to the bit. */
#ifndef PBF_CUDA_NEAR_SOLIDS_H
#define PBF_CUDA_NEAR_SOLIDS_H

#include <float.h>

#include "pbf/pbf.h"
#include "physics/boundary.h"

/* Walls and colliders of one step; `solids` is on the device. */
struct step_obstacles {
  pbf_walls walls;
  int count;
  const pbf_solid *solids;
};

/* A bit for each collider. */
typedef unsigned long long solid_set;
static_assert(PBF_MAX_COLLIDERS <= 64, "a set has 64 bits");

/* Kernels that are short of registers are built for each: colliders take half as many again, and
 * looking for them takes more. */
enum solids_met { NO_SOLIDS, FEW_SOLIDS, MANY_SOLIDS };

/* Fewer are asked faster than looked for. */
static inline solids_met solids_of(uint32_t count) {
  return count == 0 ? NO_SOLIDS : count < 8 ? FEW_SOLIDS : MANY_SOLIDS;
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
static __device__ __forceinline__ solid_set solids_near(const step_obstacles &o, pbf_vec x,
                                                        pbf_real reach, bool started) {
  uint32_t lanes = __activemask(), low = 0, high = 0, own = 1u << threadIdx.x % 32;
  lane_box box = box_around(lanes, x);
  float most = max_of(lanes, above(reach));
  for (uint32_t k = (uint32_t)__popc(lanes & (own - 1)); k < (uint32_t)o.count;
       k += (uint32_t)__popc(lanes)) {
    const pbf_solid &s = o.solids[k];
    bool near = is_near_box(box, started ? s.start_center : s.center, above(s.bound), most);
    low |= near && k < 32 ? 1u << k % 32 : 0;
    high |= near && k >= 32 ? 1u << k % 32 : 0;
  }
  low = __reduce_or_sync(lanes, low);
  return o.count > 32 ? (solid_set)__reduce_or_sync(lanes, high) << 32 | low : low;
}

/* Calls visit(solid) for those of the set, in their order. */
template <class Visit>
static __device__ __forceinline__ void each_solid(const step_obstacles &o, solid_set set,
                                                  Visit visit) {
  for (; set; set &= set - 1) visit(o.solids[__ffsll((long long)set) - 1]);
}

/* What walls and colliders lend. */
template <solids_met SOLIDS>
static __device__ __forceinline__ pbf_lent lent_at(const pbf_constants *c, const step_obstacles &o,
                                                   pbf_vec x) {
  if (SOLIDS != MANY_SOLIDS) return pbf_lent_at(c, o, x);
  pbf_lent lent = pbf_lent_by_walls(c, &o.walls, x);
  each_solid(o, solids_near(o, x, pbf_lending_reach(c), false),
             [&](const pbf_solid &s) { pbf_join_solid(c, &s, x, &lent); });
  return lent;
}

template <solids_met SOLIDS>
static __device__ __forceinline__ void add_walls(const pbf_constants *c, const step_obstacles &o,
                                                 pbf_vec x, pbf_real *density, pbf_vec *gradient) {
  pbf_lent lent = lent_at<SOLIDS>(c, o, x);
  pbf_add_lent(&lent, density, gradient);
}

/* A particle on its way from `from` to x, see pbf_resolve. Whom one collider pushes off it may meet
 * any of them. */
template <solids_met SOLIDS>
static __device__ __forceinline__ pbf_vec resolve(const step_obstacles &o, int carried,
                                                  pbf_vec from, pbf_vec x) {
  if (SOLIDS == NO_SOLIDS) return pbf_clamp(&o.walls, x);
  if (SOLIDS == FEW_SOLIDS) return pbf_resolve(o, carried, from, x);
  pbf_vec way = pbf_sub(x, from);
  solid_set all = ~0ull >> (64 - o.count),
            near = solids_near(o, from, pbf_real_sqrt(pbf_dot(way, way)), carried);
  for (;; near = all) {
    pbf_vec y = x;
    bool pushed = false;
    each_solid(o, near,
               [&](const pbf_solid &s) { y = pbf_resolve_one(&o.walls, &s, carried, from, y); });
    for (int k = 0; k < PBF_DIM; ++k) pushed |= y.c[k] != x.c[k];
    if (!pushed || near == all) return pbf_clamp(&o.walls, y);
  }
}

#endif
