/* pbf/anisotropy.h: smoothed positions and ellipsoids, for renderers that draw a surface.
 *
 * The rules of pbf.h hold here, too.
 */
#ifndef PBF_ANISOTROPY_H
#define PBF_ANISOTROPY_H

#include <pbf/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Smoothed positions and anisotropies ----------------------------------------------------- */

/* What Yu & Turk, "Reconstructing surfaces of particle-based fluids using anisotropic kernels", ACM
 * TOG 32(1), 2013 draw in place of balls: eq. n is theirs here. A struct that is 0 but for its
 * size, count and a place to write to takes the numbers of the paper, and positions as they are. */
typedef struct pbf_anisotropy_desc {
  uint32_t struct_size;
  uint32_t first; /* rows, as for pbf_get_positions */
  uint32_t count;
  uint32_t min_neighbors; /* a particle with fewer is a ball, eq. 15's N; 0: 25 in 3D, 9 in 2D */
  double radius;     /* of the weights of eq. 11, a length above the spacing, at most 4 h; 0: 2 h */
  double smoothing;  /* lambda of eq. 6, 0 … 1: so much nearer to the weighted mean of the
                        neighbours; 0: positions as they are; 0.9 in the paper */
  double max_ratio;  /* k_r of eq. 15, >= 1: the longest axis over any other; 0: 4 */
  double lone_scale; /* k_n of eq. 15, in (0, 1]: the radius of a particle with few neighbours, in
                        that of one inside; 0: 0.5 */
  void *positions;   /* shape (count, dimension), lengths; or null */
  void *stretches;   /* shape (count, dimension, dimension), no unit, symmetric: A; or null */
} pbf_anisotropy_desc;

/* Writes smoothed positions x and, for each, a matrix A: the particle is the ellipsoid x + r A u,
 * |u| <= 1, with r half the spacing, or the kernel W(|A⁻¹ (y - x)|) / det A about x. The axes of A
 * are those of the weighted covariance of the neighbours' places, eq. 9, and as long as its
 * eigenvalues, in units of that of a cubic or square lattice of the spacing: A is the identity
 * inside a fluid at rest, flat in a sheet, long in a thread. Neither walls nor colliders count as
 * neighbours. Computed on the host in float64, from positions that are read back, in a fixed order:
 * the same positions give the same bits on all backends. One thread, some 5 microseconds a particle
 * in 3D with h of 2 spacings, and 92 bytes a particle while it runs, which is all that it costs.
 * Threads and views as for pbf_get_positions. */
PBF_API pbf_status pbf_get_anisotropies(pbf_solver *solver, const pbf_anisotropy_desc *anisotropy);

#ifdef __cplusplus
}
#endif

#endif
