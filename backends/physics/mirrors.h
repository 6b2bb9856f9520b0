/* Domain walls as mirrors, where kernels are wide.
 *
 * What a wall lends by its distance alone (boundary.h) holds the first two layers of a fluid.
 * Kernels that reach farther sum over so much of what lies behind it that its push, which is not
 * the slope of what it lends, does work: tanks at h = 3 spacings never rest, at 4 they boil. There
 * each particle has its neighbours' images, and its own, as neighbours instead: what a wall does is
 * then the slope of a constraint, as all else is, and a lattice between walls is one without end.
 * Between walls nearer to each other than h, images would have images in reach; there the law
 * stays. */
#ifndef PBF_PHYSICS_MIRRORS_H
#define PBF_PHYSICS_MIRRORS_H

#include "physics/surfaces/domain.h"

/* Bits of walls: the lower one of axis k, and the upper one. */
#define PBF_LOWER_WALL(k) (1 << 2 * (k))
#define PBF_UPPER_WALL(k) (2 << 2 * (k))

/* In which walls some particles have images: a corner of three makes seven. Before an image in more
 * than one wall are those in each of them, which are nearer. */
enum { PBF_MAX_GHOSTS = PBF_DIM == 3 ? 26 : 8 };
typedef struct pbf_mirrors {
  int count;
  unsigned char walls[PBF_MAX_GHOSTS]; /* bits of those that an image is in */
} pbf_mirrors;

/* Of particles between `lower` and `upper`, between walls with this reach: those in whose images
 * they can be within h of anybody's. */
PBF_FN pbf_mirrors pbf_mirrors_near(const pbf_walls *walls, pbf_vec lower, pbf_vec upper) {
  const pbf_real reach2 = walls->reach * walls->reach;
  pbf_real away2[3][3] = {{0}}; /* of an axis: in no wall, in the lower one, in the upper one */
  pbf_mirrors mirrors;
  mirrors.count = 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    pbf_real below = pbf_real_max(lower.c[k] - walls->lower.c[k], 0);
    pbf_real above = pbf_real_max(walls->upper.c[k] - upper.c[k], 0);
    away2[k][1] = below * below;
    away2[k][2] = above * above;
  }
  for (int z = 0; z < (PBF_DIM == 3 ? 3 : 1); ++z)
    for (int y = 0; y < 3 && away2[2][z] < reach2; ++y)
      for (int x = 0; x < 3 && away2[2][z] + away2[1][y] < reach2; ++x) {
        const int in = x << 0 | y << 2 | z << 4; /* bits of walls: 1 the lower one, 2 the upper */
        if (in && away2[2][z] + away2[1][y] + away2[0][x] < reach2)
          mirrors.walls[mirrors.count++] = (unsigned char)in;
      }
  return mirrors;
}

#endif
