/* The one loop over pairs of this backend: a thread a particle, which writes to that particle. What
 * a pass does with its neighbours is in physics/passes/. */
#ifndef PBF_CUDA_DRIVER_H
#define PBF_CUDA_DRIVER_H

#include "cuda/lists.h"
#include "physics/passes/pass.h"
#include "physics/passes/shear_stress.h"
#include "physics/passes/start.h"

/* Vectors of what passes look up, as they lie in an array. */
static __device__ __forceinline__ pbf_vec vector_in(const point &p) { return position_of(p); }
static __device__ __forceinline__ pbf_vec vector_in(const start_point &p) {
  return position_of(p.at);
}
static __device__ __forceinline__ pbf_vec vector_in(pbf_vec v) { return v; }
static __device__ __forceinline__ pbf_vec vector_in(const pbf_deviator &d) {
  pbf_vec v;
  for (int k = 0; k < PBF_DIM; ++k) v.c[k] = d.c[k];
  return v;
}

/* Of which the number beside the place is looked up, too. */
struct point_with_number : point {};
static __device__ __forceinline__ point_with_number load(const point_with_number *points,
                                                         uint32_t i) {
  return {load(static_cast<const point *>(points), i)};
}

/* Numbers: those of an array of numbers, or else the lambda beside the place. */
static __device__ __forceinline__ pbf_real number_in(const point &, pbf_real number) {
  return number;
}
static __device__ __forceinline__ pbf_real number_in(const point &, const pbf_deviator &d) {
  return d.c[PBF_DEVIATOR_DIM - 2];
}
static __device__ __forceinline__ pbf_real number_in(const point &, const point_with_number &p) {
  return p.lambda;
}
template <class Value>
static __device__ __forceinline__ pbf_real number_in(const point &other, const Value &) {
  return other.lambda;
}

/* And second numbers. */
static __device__ __forceinline__ pbf_real second_in(const pbf_deviator &d) {
  return d.c[PBF_DEVIATOR_DIM - 1];
}

/* Where particles are for a pass: at their points, … ; in a kernel that serves all scenes at the
 * images of these. */
template <bool SERVES_ALL>
struct at_points_of {
  enum { ELSEWHERE = 0, IMAGES = SERVES_ALL };
  template <class Value>
  __device__ __forceinline__ pbf_vec place(const point &p, const Value &) const {
    return position_of(p);
  }
  __device__ __forceinline__ meets_all meets(const neighborhood &, uint32_t) const { return {}; }
};
typedef at_points_of<true> at_points;

/* Lists hold the pairs within h of each other where they were made. A pass over other places asks
 * for these, or a pair would be seen by the one of its particles that walks the cells alone. */
struct meets_listed {
  const point *points; /* by which lists were made */
  pbf_vec x;           /* of the particle, there */
  pbf_real h2;
  pbf_vec period;

  __device__ __forceinline__ bool operator()(uint32_t j) const {
    const pbf_vec x_ij = pbf_nearest_image(period, pbf_sub(x, position_of(load(points, j))));
    return pbf_dot(x_ij, x_ij) < h2;
  }
};

static __device__ __forceinline__ meets_listed meets_listed_of(const neighborhood &n,
                                                               const point *points, uint32_t i) {
  return {points, position_of(load(points, i)), n.constants.h2, n.grid.period};
}

/* … at points that have moved since lists were made by `listed`, … */
template <bool SERVES_ALL>
struct at_moved_points : at_points_of<SERVES_ALL> {
  const point *listed;

  __device__ __forceinline__ meets_listed meets(const neighborhood &n, uint32_t i) const {
    return meets_listed_of(n, listed, i);
  }
};

/* … or where the step began that takes them there at these velocities. */
struct at_start {
  enum { ELSEWHERE = 1, IMAGES = 1 };
  pbf_real time_step;

  __device__ __forceinline__ meets_listed meets(const neighborhood &n, uint32_t i) const {
    return meets_listed_of(n, n.particles.points, i);
  }

  __device__ __forceinline__ pbf_vec place(const point &p, pbf_vec velocity) const {
    return pbf_start(time_step, position_of(p), velocity);
  }
};

/* A neighbour at `other` of a particle at x, of which nothing else is looked up so far. */
static __device__ __forceinline__ neighbor_of<pbf_real> neighbor_between(pbf_vec x, pbf_vec other) {
  const pbf_vec x_ij = pbf_sub(x, other);
  neighbor_of<pbf_real> j;
  j.x_ij = lanes_of(x_ij);
  j.r2 = pbf_dot(x_ij, x_ij);
  return j;
}

/* A pass's sums hold reals alone. */
template <class Sums>
static __device__ __forceinline__ void add_sums(Sums *all, const Sums &part) {
  pbf_real *to = reinterpret_cast<pbf_real *>(all);
  const pbf_real *from = reinterpret_cast<const pbf_real *>(&part);
#pragma unroll
  for (unsigned k = 0; k < sizeof(Sums) / sizeof(pbf_real); ++k) to[k] += from[k];
}

/* Adds the neighbours of particle i, which stands at x. `values`: of whatever the pass looks up
 * beside places and lambdas, or the places need. All threads of a warp call it. */
template <class Pass, class Value, class Places = at_points>
static __device__ __forceinline__ void add_neighbors(
    const Pass &pass, const neighborhood &n, uint32_t i, pbf_vec x,
    const typename Pass::template own<pbf_real> &own, const Value *values,
    typename Pass::template sums<pbf_real> *sums, const Places &places = {}) {
  const uint32_t real = min(i, n.particles.count - 1);
  for_points_with<1, Places::IMAGES != 0>(
      n.particles, n.grid, n.lists, i, x, values,
      [&](const point &other, const Value &v) {
        pbf_vec place = places.place(other, v);
        if (Places::ELSEWHERE && n.grid.periodic)
          place = pbf_sub(x, pbf_nearest_image(n.grid.period, pbf_sub(x, place)));
        neighbor_of<pbf_real> j = neighbor_between(x, place);
        if constexpr (Pass::NUMBER > 0) j.number = number_in(other, v);
        if constexpr (Pass::VECTOR) j.vector = lanes_of(vector_in(v));
        if constexpr (Pass::NUMBER > 1) j.second = second_in(v);
        pass.pair(sums, own, j);
      },
      places.meets(n, real));
}

template <class Pass, class Value, class Places = at_points>
static __device__ __forceinline__ typename Pass::template sums<pbf_real> sums_around(
    const Pass &pass, const neighborhood &n, uint32_t i, pbf_vec x,
    const typename Pass::template own<pbf_real> &own, const Value *values,
    const Places &places = {}) {
  auto sums = pass.template begin<pbf_real>();
  add_neighbors(pass, n, i, x, own, values, &sums, places);
  pass.end(&sums);
  return sums;
}

/* Calls visit(neighbour) for those of particle i nearer than h, whose numbers are lambdas; without
 * lists. */
template <class Visit>
static __device__ __forceinline__ void for_present_neighbors(const neighborhood &n, uint32_t i,
                                                             Visit visit) {
  const sorted_particles &p = n.particles;
  pbf_vec x = position_of(load(p.points, i));
  grid_view view = grid_look(n.grid, x);
  for (bool beyond = false;; beyond = true) {
    for (int row = 0; row < PBF_ROWS; ++row) {
      uint32_t first, last;
      if (!grid_reach(n.grid, view, row, &first, &last)) continue;
      uint32_t end = p.cell_start[last + 1];
      for (uint32_t j = p.cell_start[first]; j < end; ++j) {
        point other = load(p.points, j);
        pbf_vec x_ij = pbf_sub(x, position_of(other));
        if (n.grid.periodic) x_ij = pbf_nearest_image(n.grid.period, x_ij);
        pbf_real r2 = pbf_dot(x_ij, x_ij);
        if (j != i && r2 < n.constants.h2)
          visit(neighbor_of<pbf_real>{lanes_of(x_ij), r2, other.lambda, {}});
      }
    }
    if (beyond || !grid_reaches_beyond(n.grid, view)) break;
    view = grid_view_beyond(n.grid, view);
  }
}

/* Its sums over these. */
template <class Pass>
static __device__ __forceinline__ typename Pass::template sums<pbf_real> sums_present(
    const Pass &pass, const neighborhood &n, uint32_t i) {
  auto sums = pass.template begin<pbf_real>();
  for_present_neighbors(n, i, [&](const neighbor_of<pbf_real> &j) { pass.pair(&sums, {}, j); });
  pass.end(&sums);
  return sums;
}

#endif
