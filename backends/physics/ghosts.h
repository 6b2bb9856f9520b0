/* Ghosts: particles that stand for others, and are neighbours like these.
 *
 * Today they are the mirror images of particles in the domain's walls, where kernels are wide. What
 * a wall contributes by its distance alone (boundary.h) holds the first two layers of a fluid.
 * Kernels that reach farther sum over so much of what lies behind it that its push, which is not
 * the slope of what it contributes, does work: tanks at h = 3 spacings never rest, at 4 they boil.
 * There each particle has its neighbours' ghosts, and its own, as neighbours instead: what a wall
 * does is then the slope of a constraint, as all else is, and a lattice between walls is one
 * without end. Between walls nearer to each other than h, ghosts would have ghosts in reach; there
 * the contribution stays. */
#ifndef PBF_PHYSICS_GHOSTS_H
#define PBF_PHYSICS_GHOSTS_H

#include "physics/passes/pass.h"
#include "physics/surfaces/domain.h"

/* Bits of walls: the lower one of axis k, and the upper one. */
#define PBF_LOWER_WALL(k) (1 << 2 * (k))
#define PBF_UPPER_WALL(k) (2 << 2 * (k))

/* In which walls some particles have ghosts: a corner of three makes seven. Before a ghost in more
 * than one wall are those in each of them, which are nearer. */
enum { PBF_MAX_GHOSTS = PBF_DIM == 3 ? 26 : 8 };
typedef struct pbf_ghost_walls {
  int count;
  unsigned char walls[PBF_MAX_GHOSTS]; /* bits of those that a ghost is in */
} pbf_ghost_walls;

/* Of particles between `lower` and `upper`: the walls in which any particle can have a ghost that
 * is within h of them. */
PBF_FN pbf_ghost_walls pbf_ghost_walls_near(const pbf_domain *domain, pbf_vec lower,
                                            pbf_vec upper) {
  const pbf_real reach2 = domain->ghost_reach * domain->ghost_reach;
  pbf_real away2[3][3] = {{0}}; /* of an axis: in no wall, in the lower one, in the upper one */
  pbf_ghost_walls ghosts;
  ghosts.count = 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    pbf_real below = pbf_real_max(lower.c[k] - domain->lower.c[k], 0);
    pbf_real above = pbf_real_max(domain->upper.c[k] - upper.c[k], 0);
    away2[k][1] = below * below;
    away2[k][2] = above * above;
  }
  for (int z = 0; z < (PBF_DIM == 3 ? 3 : 1); ++z)
    for (int y = 0; y < 3 && away2[2][z] < reach2; ++y)
      for (int x = 0; x < 3 && away2[2][z] + away2[1][y] < reach2; ++x) {
        const int in = x << 0 | y << 2 | z << 4; /* bits of walls: 1 the lower one, 2 the upper */
        if (in && away2[2][z] + away2[1][y] + away2[0][x] < reach2)
          ghosts.walls[ghosts.count++] = (unsigned char)in;
      }
  return ghosts;
}

namespace {

/* From the ghost of j in these walls (bits of pbf_ghost_walls) to i, and r² of that, for a pair at
 * x_ij and an i whose doubled distances are doubled[0] from the lower walls and doubled[1] from the
 * upper ones. Also behind a wall, a ghost never pushes out, and is no nearer than j. */
template <class L>
PBF_FN L ghost_in(int walls, const L (&doubled)[2][PBF_DIM], const lane_vector<L> &x_ij,
                  lane_vector<L> *ghost) {
  L r2 = ops<L>::set(0);
  for (int k = 0; k < PBF_DIM; ++k) {
    const int lower = walls & PBF_LOWER_WALL(k), upper = walls & PBF_UPPER_WALL(k);
    ghost->c[k] = x_ij.c[k];
    if (lower | upper) {
      L apart = doubled[upper != 0][k] - x_ij.c[k];
      apart = ops<L>::max(ops<L>::max(apart, -apart), ops<L>::max(x_ij.c[k], -x_ij.c[k]));
      ghost->c[k] = lower ? apart : -apart;
    }
    r2 = ops<L>::multiply_add(ghost->c[k], ghost->c[k], r2);
  }
  return r2;
}

}  // namespace

#endif
