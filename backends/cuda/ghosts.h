/* Part of kernels_solve.h. What ghosts in the domain's walls add to a particle's sums
 * (physics/ghosts.h). */
#ifndef PBF_CUDA_GHOSTS_H
#define PBF_CUDA_GHOSTS_H

#include "cuda/driver.h"
#include "cuda/iteration.h"
#include "physics/passes/density.h"
#include "physics/ghosts.h"

/* The walls in which a particle has ghosts near, its own or others'. */
struct wall_ghosts {
  uint32_t codes; /* a bit for each ghost: a digit to base 3 an axis, … */
  pbf_real doubled[2][PBF_DIM];
};

/* … 0 in no wall, 1 in the lower one and 2 in the upper one. */
static __device__ __forceinline__ uint32_t code_of(int walls) {
  uint32_t code = 0;
  for (int k = PBF_DIM - 1; k >= 0; --k)
    code = 3 * code + (walls & PBF_UPPER_WALL(k) ? 2 : walls & PBF_LOWER_WALL(k) ? 1 : 0);
  return code;
}

static __device__ __forceinline__ bool has_ghosts(const pbf_domain &domain, pbf_vec x) {
  return PBF_GHOSTS && domain.ghost_reach > 0 &&
         pbf_domain_distance(&domain, x) < domain.ghost_reach;
}

static __device__ __forceinline__ wall_ghosts ghosts_at(const pbf_domain &domain, pbf_vec x) {
  wall_ghosts ghosts = {};
  if (!has_ghosts(domain, x)) return ghosts;
  const pbf_ghost_walls walls = pbf_ghost_walls_near(&domain, x, x);
  for (int k = 0; k < walls.count; ++k) ghosts.codes |= 1u << code_of(walls.walls[k]);
  for (int k = 0; k < PBF_DIM; ++k) {
    ghosts.doubled[0][k] = 2 * (x.c[k] - domain.lower.c[k]);
    ghosts.doubled[1][k] = 2 * (x.c[k] - domain.upper.c[k]);
  }
  return ghosts;
}

/* Whether any lane of the warp, which all call it, has some. */
static __device__ __forceinline__ bool warp_has(const wall_ghosts &ghosts) {
  return PBF_GHOSTS && __any_sync(~0u, ghosts.codes != 0);
}

/* Calls visit(ghost's x_i - x_j, r²) for the ghosts nearer than h of a neighbour at x_ij, or with 0
 * of the particle itself. A neighbour nearer than h alone can have any. */
template <class Visit>
static __device__ __forceinline__ void for_ghosts(const wall_ghosts &ghosts, pbf_real h2,
                                                  pbf_vec x_ij, Visit visit) {
  if (!ghosts.codes || !(pbf_dot(x_ij, x_ij) < h2)) return;
  /* Each axis in both walls: what a ghost takes of them is in registers, and selected. */
  constexpr int LOWER = PBF_LOWER_WALL(0) | PBF_LOWER_WALL(1) | PBF_LOWER_WALL(2);
  pbf_real doubled[2][PBF_DIM];
  lane_vector<pbf_real> in[2];
  for (int k = 0; k < PBF_DIM; ++k)
    for (int upper = 0; upper < 2; ++upper) doubled[upper][k] = ghosts.doubled[upper][k];
  ghost_in(LOWER, doubled, lanes_of(x_ij), &in[0]);
  ghost_in(LOWER << 1, doubled, lanes_of(x_ij), &in[1]);
#pragma unroll 1
  for (uint32_t left = ghosts.codes; left; left &= left - 1) {
    uint32_t code = (uint32_t)__ffs((int)left) - 1;
    pbf_vec ghost;
    for (int k = 0; k < PBF_DIM; ++k, code /= 3) {
      uint32_t digit = code % 3;
      ghost.c[k] = digit == 0 ? x_ij.c[k] : digit == 1 ? in[0].c[k] : in[1].c[k];
    }
    pbf_real r2 = pbf_dot(ghost, ghost);
    if (r2 < h2) visit(ghost, r2);
  }
}

/* Adds the ghosts of one neighbour at x_ij, with this lambda where the pass looks it up. */
template <class Pass>
static __device__ __forceinline__ void add_ghosts(const Pass &pass, const wall_ghosts &ghosts,
                                                  const typename Pass::template own<pbf_real> &own,
                                                  pbf_vec x_ij, pbf_real lambda,
                                                  typename Pass::template sums<pbf_real> *sums) {
  for_ghosts(ghosts, pass.c->h2, x_ij, [&](pbf_vec ghost, pbf_real r2) {
    pass.pair(sums, own, {lanes_of(ghost), r2, lambda, {}}, pass.c->boundary_weight);
  });
}

/* Warps that share the lists of 32 particles: there are few particles at walls, and much to do for
 * those in corners. */
enum { PBF_GHOST_SHARES = 4 };

static inline uint32_t ghost_blocks_for(uint32_t count) { return (count + 31) / 32; }

/* Most particles have no ghosts, and the other kernels are short of registers and of time: this one
 * runs just before, and they take its sums. Those of a solve that is over, and of sleepers out of
 * reach of the awake, are not read. */
template <class Pass, class Places, class Value>
static __global__ void __launch_bounds__(32 * PBF_GHOST_SHARES)
    ghost_kernel(neighborhood n, convergence_check watch, const pbf_real *activity,
                 pbf_domain domain, Places places, const Value *values,
                 typename Pass::template sums<pbf_real> *all) {
  typedef typename Pass::template sums<pbf_real> pass_sums;
  __shared__ pass_sums parts[PBF_GHOST_SHARES - 1][32];
  await_launches_before();
  const uint32_t lane = threadIdx.x % 32, share = threadIdx.x / 32,
                 i = n.particles.first + blockIdx.x * 32 + lane;
  const uint32_t own = min(i, n.particles.count - 1);
  const Pass pass = {&n.constants, {}};
  if (PBF_TOLERANCE && watch.watch && is_converged(watch)) return;
  const point here = load(n.particles.points, own);
  const pbf_vec x = places.place(here, load(values, own));
  const bool inactive = PBF_SLEEP && activity && pbf_is_inactive(activity[own]);
  const wall_ghosts ghosts = inactive ? wall_ghosts{} : ghosts_at(domain, x);
  typename Pass::template own<pbf_real> of_own;
  if constexpr (Pass::NUMBER > 0) of_own = {here.lambda};
  pass_sums sums = {};
  if (warp_has(ghosts)) {
    if (share == 0) add_ghosts(pass, ghosts, of_own, {{0}}, here.lambda, &sums);
    for_points_with<PBF_GHOST_SHARES>(
        n.particles, n.grid, n.lists, i, x, values, [&](const point &other, const Value &value) {
          add_ghosts(pass, ghosts, of_own, pbf_sub(x, places.place(other, value)), other.lambda,
                     &sums);
        });
    if (share > 0) parts[share - 1][lane] = sums;
    __syncthreads(); /* all warps of a block have the same particles, and come here or none */
    for (uint32_t k = 1; share == 0 && k < PBF_GHOST_SHARES; ++k)
      add_sums(&sums, parts[k - 1][lane]);
  }
  if (share == 0 && i < n.particles.count) all[i] = sums;
}

#endif
