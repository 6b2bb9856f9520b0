/* Where the ghost of a neighbour in a wall that mirrors the fluid is (physics/mirrors.h). */
#ifndef PBF_PHYSICS_PASSES_GHOST_H
#define PBF_PHYSICS_PASSES_GHOST_H

#include "physics/mirrors.h"
#include "physics/passes/pass.h"

namespace {

/* From the ghost of j in these walls (bits of mirrors.h) to i, and r² of that, for a pair at x_ij
 * and an i whose place counts twice[0] from the lower walls and twice[1] from the upper ones,
 * doubled. Whoever is behind a wall, a ghost never pushes out, and is no nearer than j. */
template <class L>
PBF_FN L ghost_in(int walls, const L (&twice)[2][PBF_DIM], const lane_vector<L> &x_ij,
                  lane_vector<L> *ghost) {
  L r2 = ops<L>::set(0);
  for (int k = 0; k < PBF_DIM; ++k) {
    const int lower = walls & PBF_LOWER_WALL(k), upper = walls & PBF_UPPER_WALL(k);
    ghost->c[k] = x_ij.c[k];
    if (lower | upper) {
      L apart = twice[upper != 0][k] - x_ij.c[k];
      apart = ops<L>::max(ops<L>::max(apart, -apart), ops<L>::max(x_ij.c[k], -x_ij.c[k]));
      ghost->c[k] = lower ? apart : -apart;
    }
    r2 = ops<L>::fma(ghost->c[k], ghost->c[k], r2);
  }
  return r2;
}

}  // namespace

#endif
