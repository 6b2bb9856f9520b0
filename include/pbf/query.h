/* pbf/query.h: ask the fluid. What is in a volume, how fast does it flow at a point, where does a
 * ray meet the surface, how high is the water?
 *
 * All answers follow from one interpolation of the particles' present state, on the host and in
 * float64 whatever the solver's precision:
 *   density   rho/rho0 (x) = d^dimension sum_j W(x - x_j), with Wendland's C2 kernel of the radius
 *             1.5 h, three spacings by default: 1 inside to 1 %, 1/2 half a spacing above the
 *             particles of a flat surface, 0 in air. Walls and colliders add nothing: at one it is
 *             1/2, too. The surface is where it is 1/2; a film of one layer has none.
 *   fields    velocity and pressure: the value at x of the straight line that fits those of the
 *             particles within 1.5 h best by the kernel's weights (moving least squares, Lancaster
 *             & Salkauskas, Mathematics of Computation 37, 1981). Linear fields come out as they
 *             are, at surfaces, too. Along directions in which the particles hardly spread, as in
 *             spray, it is their weighted mean (Shepard, ACM National Conference 1968). 0 in air.
 *   faces     of periodic axes (pbf_params.periodic) are none: a point is at its image in the
 *             domain, near particles on both sides. Volumes of pbf_find_in_volume, and rays, end
 *             there: they meet what lies where they are.
 *   order     sums run over cells and, within a cell, by id: the same positions give the same bits
 *             on all backends.
 *   cost      the first query after particles have changed sorts all of them, some 0.03
 *             microseconds a particle, of a device with a copy of their positions; the first that
 *             asks for velocities or pressures reads these, too, the latter as pbf_get_pressures
 *             does. All others until the next change take 2 to 6 microseconds a point, on one
 *             thread. Some 80 bytes a particle in float32, taken by the first query and kept until
 *             pbf_end_queries or pbf_destroy: later ones allocate only where there are more
 *             particles, or points. A step costs nothing more.
 *
 * In 2D points have two numbers, and the third of vectors in structs is not looked at. The rules of
 * pbf.h hold here, too; a call that fails writes nothing.
 */
#ifndef PBF_QUERY_H
#define PBF_QUERY_H

#include <pbf/pbf.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Volumes ------------------------------------------------------------------------------- */

/* Shapes of a volume: which of its sizes it has. */
enum { PBF_VOLUME_BOX = 0, PBF_VOLUME_SPHERE = 1, PBF_VOLUME_CAPSULE = 2 };

/* A part of space. */
typedef struct pbf_volume {
  uint32_t struct_size;
  uint32_t shape;         /* PBF_VOLUME_… */
  double position[3];     /* centre */
  double orientation[4];  /* unit quaternion x, y, z, w; 2D: a turn about z */
  double half_extents[3]; /* box, > 0 */
  double axis[3];         /* capsule: direction, before `orientation` turns it */
  double radius;          /* sphere, capsule, > 0 */
  double half_length;     /* capsule: from the centre to either end of its segment, >= 0 */
} pbf_volume;

/* Fills *volume: at the origin, not turned, axis +y, sizes 1. */
PBF_API pbf_status pbf_volume_init(pbf_volume *volume, uint32_t struct_size, uint32_t shape);

/* The ids of the particles with their centres in the volume or on its surface, ascending: the first
 * `capacity` of them go to `ids`, which may be null where capacity is 0, and *count gets how many
 * there are, be it more than capacity. Looks at all particles, and needs nothing of what a query
 * keeps. */
PBF_API pbf_status pbf_find_in_volume(pbf_solver *solver, const pbf_volume *volume,
                                      uint32_t capacity, uint32_t *ids, uint32_t *count);

/* What of the fluid is in a volume. */
typedef struct pbf_volume_flow {
  uint32_t struct_size;
  uint32_t reserved;  /* 0 */
  double volume;      /* of the whole volume, a length^dimension */
  double fraction;    /* how much of it is below the surface, 0 … 1 */
  double centre[3];   /* of that part, where buoyancy acts; `position` where there is none */
  double velocity[3]; /* its mean; 0 where there is none */
} pbf_volume_flow;

/* flows[i] for volumes[i]: sums over 8 to 16 points along each axis, a spacing apart where these
 * are enough. Both are arrays of `count` structs, each of the size of the first, which must be set
 * in flows[0], too. A collider keeps the fluid out of itself: its place is dry however deep it is.
 */
PBF_API pbf_status pbf_measure_volumes(pbf_solver *solver, uint32_t count,
                                       const pbf_volume *volumes, pbf_volume_flow *flows);

/* ---- Points -------------------------------------------------------------------------------- */

/* Where to write; null: that is not asked for. */
typedef struct pbf_samples {
  uint32_t struct_size;
  uint32_t count;       /* points; of a grid all of its points */
  const double *points; /* shape (count, dimension); of a grid null */
  double *densities;    /* shape (count), rho/rho0 */
  double *velocities;   /* shape (count, dimension) */
  double *pressures;    /* shape (count), p/rho0 as pbf_get_pressures has it, and refused with it */
  uint8_t *wet;         /* shape (count): 1 where there is water, density >= 1/2, or 0 */
} pbf_samples;

/* What is asked for of each point; the equations are above. */
PBF_API pbf_status pbf_sample(pbf_solver *solver, const pbf_samples *samples);

/* Points origin + (i, j, k) step, i < counts[0] and so on; in 2D counts[2] is not looked at. */
typedef struct pbf_sample_grid {
  uint32_t struct_size;
  uint32_t counts[3];
  double origin[3];
  double step[3];
} pbf_sample_grid;

/* Arrays of shape (counts[0], counts[1], counts[2]), row-major: the last index is the fastest. */
PBF_API pbf_status pbf_sample_on_grid(pbf_solver *solver, const pbf_sample_grid *grid,
                                      const pbf_samples *samples);

/* ---- Surfaces ------------------------------------------------------------------------------ */

/* Where rays first meet the surface, from whichever side: distances, shape (count), lengths from
 * the origin, INFINITY where that is nowhere within `length` (> 0, or INFINITY); normals, shape
 * (count, dimension), unit vectors out of the fluid, 0 where nothing is met; or null. Origins and
 * directions (of any length above 0): shape (count, dimension). A ray goes through cells without
 * particles at once, and elsewhere by half a spacing: what is thinner may be missed. */
PBF_API pbf_status pbf_cast_rays(pbf_solver *solver, uint32_t count, const double *origins,
                                 const double *directions, double length, double *distances,
                                 double *normals);

/* How high the water stands at points, shape (count, dimension), of which what lies along gravity
 * does not matter: levels, shape (count), of the topmost surface there, as the way against gravity
 * from the origin, -g·x/|g| (y, where gravity points down along y); NaN where there is none. Drops
 * of a few particles count, single ones do not. PBF_ERROR_STATE where gravity is 0. */
PBF_API pbf_status pbf_get_levels(pbf_solver *solver, uint32_t count, const double *points,
                                  double *levels);

/* Gives back the memory that queries keep; the next one takes it again. */
PBF_API pbf_status pbf_end_queries(pbf_solver *solver);

#ifdef __cplusplus
}
#endif

#endif
