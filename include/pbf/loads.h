/* pbf/loads.h: forces of the fluid on colliders and walls. Only where pbf_params.loads is 1; a
 * solver with 0 has no memory and no time for them. docs/forces.md says how well they hold.
 *
 * The rules of pbf.h hold here, too.
 */
#ifndef PBF_LOADS_H
#define PBF_LOADS_H

#include <pbf/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Loads ----------------------------------------------------------------------------------- */

/* What the fluid does to a solid. Impulses are over rest density, so those in kg m/s are these
 * times 1000 kg/m³ for water; over time_step they are the mean force in a step. A particle's mass
 * is particle_volume, or spacing^dimension where that is 0. All impulses of one step, on walls and
 * colliders, sum up to the momentum that the fluid has lost to them: its momentum before the step,
 * with what gravity and attraction gave it, less that after it, without the parameters vorticity,
 * XSPH's viscosity and drag, which act on it in between. Pressure pushes by the same path as
 * velocities, with lambda, collisions and a pressure grid, and by that is shared out; fluid that
 * sticks to solids pulls them along.
 */
typedef struct pbf_collider_load {
  uint32_t struct_size;
  uint32_t contacts;             /* particles nearer than a spacing */
  double impulse[3];             /* of the last step; of a divided one, of its last part */
  double angular_impulse[3];     /* about the collider's position; of a wall, the origin; 2D: z */
  double impulse_sum[3];         /* since these sums were last read, … */
  double angular_impulse_sum[3]; /* … or params.loads was set, or the collider came */
  double time_sum;               /* for which they are sums */
  double penetration;            /* of the deepest particle centre behind the surface; 0: none is */
  double wetted_area;            /* in 2D a length; good to a few parts of a hundred on a face */
} pbf_collider_load;

/* Loads of all colliders, as many as pbf_get_collider_count tells, in their order. `loads` is an
 * array of `count` structs, each of the size in loads[0].struct_size. Begins the sums of those that
 * it gives anew. A collider keeps its sums where pbf_set_colliders replaces it by one of the same
 * number. Not part of a saved state. The same bits with any number of threads.
 * Fluid asleep presses with the pressure with which it fell asleep, and does not adhere.
 * PBF_ERROR_STATE: params.loads is 0. PBF_ERROR_UNSUPPORTED: the backend has none. */
PBF_API pbf_status pbf_get_collider_loads(pbf_solver *solver, uint32_t count,
                                          pbf_collider_load *loads);

/* The same of the domain's walls, by PBF_WALL_…: `count` is 2 * dimension. */
PBF_API pbf_status pbf_get_wall_loads(pbf_solver *solver, uint32_t count, pbf_collider_load *loads);

#ifdef __cplusplus
}
#endif

#endif
