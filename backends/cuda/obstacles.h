/* Part of sort.h. What walls and colliders do to particles. Where colliders are some a particle
 * does not ask all of them in each pass, one after the other: the lanes of a warp share them out,
 * and look which are near the box around their particles. The others leave each particle as it is,
 * to the bit. */
#ifndef PBF_CUDA_OBSTACLES_H
#define PBF_CUDA_OBSTACLES_H

#include <float.h>

#include "cuda/listed_obstacles.h"
#include "cuda/warp.h"

/* Walls and colliders, of surfaces of such a type. */
template <class Surface>
struct obstacles_of {
  const pbf_domain &domain;
  int count;
  const Surface *surfaces;
};

/* A bit for each collider. */
typedef unsigned long long surface_set;

/* The first of some. */
static __host__ __device__ __forceinline__ int lowest_of(surface_set set) {
#ifdef __CUDA_ARCH__
  return __ffsll((long long)set) - 1;
#else
  return __builtin_ctzll(set);
#endif
}
static_assert(PBF_FEW_COLLIDERS <= 64, "a set has 64 bits");

/* Kernels that meet colliders are built for each: colliders take many registers, looking for them
 * takes more, and distances between the nodes of a field a stack. More than a set has bits for are
 * listed by a grid. */
enum surfaces_met { NO_SURFACES, FEW_SURFACES, MANY_SURFACES, FIELD_SURFACES, LISTED_SURFACES };

/* Whether fields may be among them. */
template <surfaces_met SURFACES>
constexpr bool meets_fields = SURFACES == FIELD_SURFACES || SURFACES == LISTED_SURFACES;

/* What a kernel that is built for such surfaces sees of them. */
template <surfaces_met SURFACES>
static __device__ __forceinline__ auto obstacles_met(const step_obstacles &o) {
  if constexpr (meets_fields<SURFACES>)
    return obstacles_of<pbf_surface>{o.domain, o.count, o.surfaces};
  else
    return obstacles_of<pbf_closed_surface>{o.domain, SURFACES == NO_SURFACES ? 0 : o.count,
                                            static_cast<const pbf_closed_surface *>(o.surfaces)};
}

/* … and of those that may be within `reach` of x. */
template <surfaces_met SURFACES>
static __device__ __forceinline__ auto obstacles_near(const step_obstacles &o, pbf_vec x,
                                                      double reach) {
  if constexpr (SURFACES == LISTED_SURFACES)
    return listed_near(o, x, reach);
  else
    return obstacles_met<SURFACES>(o);
}

/* By which constants they are asked. */
template <bool LISTED>
static __device__ __forceinline__ const pbf_constants *constants_for(const step_obstacles &o,
                                                                     const pbf_constants *c) {
  return LISTED ? &scene_behind(o)->constants : c;
}

/* The same for kernels that have an instance for lists, and one for all others. */
template <bool LISTED>
static __device__ __forceinline__ decltype(auto) asked_near(const step_obstacles &o, pbf_vec x,
                                                            double reach) {
  if constexpr (LISTED)
    return listed_near(o, x, reach);
  else
    return (o);
}

/* Fewer are asked faster than looked for. */
static inline surfaces_met surfaces_of(uint32_t count) {
  if (count > PBF_FEW_COLLIDERS) return LISTED_SURFACES;
  return count == 0 ? NO_SURFACES : count < 8 ? FEW_SURFACES : MANY_SURFACES;
}

/* Integers in the order of the floats. */
static __device__ __forceinline__ uint32_t ordered(float a) {
  uint32_t bits = __float_as_uint(a);
  return bits >> 31 ? ~bits : bits | 0x80000000u;
}

static __device__ __forceinline__ float from_ordered(uint32_t bits) {
  return __uint_as_float(bits >> 31 ? bits & 0x7fffffffu : ~bits);
}

static __device__ __forceinline__ float min_of(uint32_t lanes, float a) {
  return from_ordered(min_of_lanes(lanes, ordered(a)));
}

static __device__ __forceinline__ float max_of(uint32_t lanes, float a) {
  return from_ordered(max_of_lanes(lanes, ordered(a)));
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

/* The least distance of a place from the box. */
static __device__ __forceinline__ float gap_to_box(const lane_box &box, pbf_vec place) {
  float gap2 = 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    float c = (float)place.c[k];
    float gap = fmaxf(fmaxf(box.lower[k] - c, c - box.upper[k]), 0);
    gap2 += gap * gap;
  }
  return sqrtf(gap2);
}

/* What is rounded in a distance of about `far` from there, here, and where a particle asks for
 * itself. */
static __device__ __forceinline__ float rounding_of(pbf_vec place, float far) {
  float away = 0;
  for (int k = 0; k < PBF_DIM; ++k) away += fabsf((float)place.c[k]);
  return 1e-5f * (far + away);
}

/* Whether something of it can be within `reach` of the box. */
static __device__ __forceinline__ bool is_near_box(const lane_box &box, const pbf_surface &s,
                                                   float reach) {
  const float far = above(s.bound) + reach;
  return !(gap_to_box(box, s.center) > far + rounding_of(s.center, far));
}

/* Whether it can meet a particle in the box on a way of `way` that it carries along in the step. */
static __device__ __forceinline__ bool may_meet_moving(const lane_box &box, const pbf_surface &s,
                                                       float way) {
  const float gap = gap_to_box(box, s.start_center);
  const float far = above(s.bound) + way + 2 * above(s.skin) + above(s.step);
  return !(gap - above(s.turn) * gap > far + rounding_of(s.start_center, far + gap));
}

/* The colliders near the lanes' particles, all of which look for them together: those that
 * near(box, most, surface) says of the box around them, `most` being the largest of their numbers.
 */
template <class Near>
static __device__ __forceinline__ surface_set surfaces_that(const step_obstacles &o, pbf_vec x,
                                                            pbf_real number, Near near) {
  uint32_t lanes = __activemask(), low = 0, high = 0, own = 1u << threadIdx.x % 32;
  lane_box box = box_around(lanes, x);
  float radius = max_of(lanes, above(number));
  for (uint32_t k = (uint32_t)__popc(lanes & (own - 1)); k < (uint32_t)o.count;
       k += (uint32_t)__popc(lanes)) {
    bool is_near = near(box, radius, o.surfaces[k]);
    low |= is_near && k < 32 ? 1u << k % 32 : 0;
    high |= is_near && k >= 32 ? 1u << k % 32 : 0;
  }
  low = or_of_lanes(lanes, low);
  return o.count > 32 ? (surface_set)or_of_lanes(lanes, high) << 32 | low : low;
}

/* Calls visit(surface) for those of the set, in their order. */
struct surface_subset {
  const pbf_closed_surface *surfaces;
  surface_set set;

  template <class Visit>
  PBF_IN void each(Visit visit) const {
    for (surface_set rest = set; rest; rest &= rest - 1) visit(surfaces[lowest_of(rest)]);
  }
};

/* What they contribute at x. */
template <surfaces_met SURFACES>
static __device__ __forceinline__ pbf_boundary boundary_at(const pbf_constants *c,
                                                           const step_obstacles &o, pbf_vec x) {
  const auto met = obstacles_met<SURFACES>(o);
  if constexpr (SURFACES == LISTED_SURFACES) {
    return listed_boundary(c, o, x);
  } else if constexpr (SURFACES != MANY_SURFACES) {
    return pbf_boundary_at(c, met, x);
  } else {
    pbf_boundary boundary = pbf_boundary_of_domain(c, &o.domain, x);
    const surface_subset near = {
        met.surfaces, surfaces_that(o, x, pbf_boundary_reach(c),
                                    [](const lane_box &box, float reach, const pbf_surface &s) {
                                      return is_near_box(box, s, reach);
                                    })};
    const auto all = [&](auto visit) {
      near.each([&](const pbf_closed_surface &s) { visit(s, 0); });
    };
    if (near.set) pbf_accumulate_surfaces(c, &o.domain, x, all, &boundary);
    return boundary;
  }
}

template <surfaces_met SURFACES>
static __device__ __forceinline__ void add_boundary(const pbf_constants *c, const step_obstacles &o,
                                                    pbf_vec x, pbf_real *density,
                                                    pbf_vec *gradient) {
  pbf_boundary boundary = boundary_at<SURFACES>(c, o, x);
  pbf_add_boundary(&boundary, density, gradient);
}

/* A particle on its way from `from` to x, see pbf_resolve_collisions. What does not find it inside,
 * and does not move, leaves it no farther from `from` than the way is long, and so none but those
 * as near can push it. The others push by as much as that: then those that are pushed may meet any.
 */
template <surfaces_met SURFACES>
static __device__ __forceinline__ pbf_vec resolve_collisions(const step_obstacles &o,
                                                             int with_obstacle_motion, pbf_vec from,
                                                             pbf_vec x) {
  const auto met = obstacles_met<SURFACES>(o);
  if constexpr (SURFACES == NO_SURFACES) {
    return pbf_keep_in_domain(&o.domain, x);
  } else if constexpr (SURFACES == LISTED_SURFACES) {
    return resolve_among_listed(&scene_behind(o)->domain, o.surfaces, &scene_behind(o)->grid,
                                with_obstacle_motion, from, x);
  } else if constexpr (SURFACES != MANY_SURFACES) {
    return pbf_resolve_collisions(met, with_obstacle_motion, from, x);
  } else {
    const pbf_vec kept = pbf_keep_in_domain(&o.domain, x);
    const pbf_vec way = pbf_sub(x, from), kept_way = pbf_sub(kept, from);
    const pbf_real length =
        pbf_real_sqrt(pbf_real_max(pbf_dot(way, way), pbf_dot(kept_way, kept_way)));
    surface_subset near = {
        met.surfaces, surfaces_that(o, from, length,
                                    [&](const lane_box &box, float longest, const pbf_surface &s) {
                                      return with_obstacle_motion
                                                 ? may_meet_moving(box, s, longest)
                                                 : is_near_box(box, s, longest + 2 * above(s.skin));
                                    })};
    const pbf_vec after = pbf_resolve_among(&o.domain, near, with_obstacle_motion, from, x);
    if (!with_obstacle_motion && !(o.surfaces[0].iteration_push > 0)) return after;
    bool pushed = false;
    for (int k = 0; k < PBF_DIM; ++k) pushed |= after.c[k] != kept.c[k];
    return pushed ? pbf_resolve_collisions(met, with_obstacle_motion, from, x) : after;
  }
}

#endif
