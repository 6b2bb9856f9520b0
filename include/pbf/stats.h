/* pbf/stats.h: sums over the particles, and how long a step may be. Computed when they are asked
 * for.
 *
 * The rules of pbf.h hold here, too.
 */
#ifndef PBF_STATS_H
#define PBF_STATS_H

#include <pbf/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Sums over all particles ----------------------------------------------------------------- */

/* Sums over all particles in their present state, particles of unit mass, in float64. */
typedef struct pbf_stats {
  uint32_t struct_size;
  uint32_t count;
  uint32_t iterations;    /* of the last step; params.iterations unless it ended before */
  uint32_t neighbors_max; /* within h, the particle itself not counted */
  double neighbors_mean;
  double center_of_mass[3];
  double position_min[3];
  double position_max[3];
  double momentum[3];    /* a particle's mean: sum of v / count */
  double kinetic_energy; /* a particle's mean: sum of |v|²/2 / count */
  double speed_max;
  double density_error_mean; /* mean of max(rho/rho0 - 1, 0): a free surface is no error */
  double density_error_max;  /* largest rho/rho0 - 1, at least 0 */
  double density_mean;       /* mean of rho/rho0 */
  uint32_t asleep;           /* particles, see pbf_params.sleep_speed */
  uint32_t squeezed;   /* particles inside a collider, and at another one or a wall: what closes on
                          fluid leaves them no room, and they stay where they are until there is */
  double step_limit;   /* as pbf_get_step_limit gives it */
  uint32_t limited_by; /* PBF_LIMIT_…: what that is for */
  uint32_t substeps;   /* parts that the last step had, see pbf_params.max_substeps; 0 before the
                          first and after a load */
} pbf_stats;

/* Looks for neighbours, which takes a third of a step or so. stats->struct_size must be set. */
PBF_API pbf_status pbf_get_stats(pbf_solver *solver, pbf_stats *stats);

/* ---- How long a step may be ------------------------------------------------------------------ */

/* What a step can be too long for. */
enum {
  PBF_LIMIT_NONE = 0,
  PBF_LIMIT_GRAVITY = 1,    /* g dt² <= 0.5 spacing */
  PBF_LIMIT_ATTRACTION = 2, /* the same with the largest acceleration at the surface of the fluid
                               once it has gathered, or of a repulsion in the domain */
  PBF_LIMIT_PARTICLES = 3,  /* v dt <= spacing: the fastest particle, */
  PBF_LIMIT_WALLS = 4,      /* wall, */
  PBF_LIMIT_COLLIDERS = 5,  /* collider, its turn included */
  PBF_LIMIT_TENSION = 6     /* surface_tension dt² <= 0.02 spacing³, in 2D 0.05: of more, only so
                               much acts */
};

/* The longest time_step that the present parameters, accelerations, colliders and velocities stand,
 * undivided; infinite where nothing moves or falls. Beyond it water at rest lies down or boils, and
 * what moves squeezes it: up to 1 spacing a step by less than a tenth, at 3 by three quarters
 * (measured at 4 iterations). The bound on speed is that of Courant, Friedrichs and Lewy
 * (Mathematische Annalen 100, 1928). Drag is solved exactly and limits nothing. pbf_desc.log is
 * told of longer steps: once for each cause, and again only after it has ended; when steps are
 * made, of particles when pbf_get_stats or max_substeps looks at them. Looks at all particles. */
PBF_API pbf_status pbf_get_step_limit(pbf_solver *solver, double *limit);

#ifdef __cplusplus
}
#endif

#endif
