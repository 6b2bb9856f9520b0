/* pbf/phases.h: several fluids in one solver, as oil on water.
 *
 * A phase is a fluid with a rest density of its own. Each particle is of one phase, and stands for
 * the same volume whichever it is: what differs is its mass. So the density constraint counts
 * particles (the number density of Solenthaler & Pajarola, Density contrast SPH interfaces, 2008),
 * and what it pushes moves a particle the less the heavier it is: pairs conserve momentum, a light
 * fluid rises in a heavy one, and at rest the pressure is that of the layers' weight.
 *
 * Densities that are told stay rho/rho0 with rho0 the particle's own. Pressures are over the
 * reference density, that of a phase with rest_density 1, and so are the impulses of loads: for
 * water as 1 and oil as 0.9 both are those of water times 1000 kg/m³. Sums of pbf_stats and of
 * query.h count particles alike, whatever their mass.
 *
 * The rules of pbf.h hold here, too. A solver without phases, or with phases that all have
 * rest_density 1 and viscosity 1, has the bits of one without, and no time for them; the memory is
 * a byte a particle of capacity, and where they differ two bytes and two numbers on the backend.
 * Phases are part of saved states, and of pbf_hash where there are any.
 *
 * Where they differ there is a shear_stress_correction by default however shallow the fluid, and,
 * where the lightest has more than a third of the heaviest's rest_density, a pressure_grid as deep
 * as one fluid has it; however shallow where their rest_density differs and h is less than 2.55
 * spacings: without, a fluid that is a little lighter stays where it is. Refused, with a sentence,
 * are other grids, surface_tension, and viscosity with PBF_SOLVER_JACOBI. docs/fluids.md says how
 * well it holds.
 */
#ifndef PBF_PHASES_H
#define PBF_PHASES_H

#include <pbf/pbf.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Phases -------------------------------------------------------------------------------- */

/* A fluid of its own. */
typedef struct pbf_phase {
  uint32_t struct_size;
  uint32_t user;       /* the caller's, a colour say: kept, and not looked at */
  double rest_density; /* over the reference density, 0.001 … 1000; the heaviest phase at most 1000
                          times the lightest */
  double viscosity;    /* 0 … 1: so much of params.viscosity, which is kinematic, it has */
} pbf_phase;

/* Phases of a solver. */
#define PBF_MAX_PHASES 8u

/* Fills *phase: rest_density 1, viscosity 1, user 0. */
PBF_API pbf_status pbf_phase_init(pbf_phase *phase, uint32_t struct_size);

/* Replaces all phases. `phases` is an array of `count` structs, each of the size of the first.
 * Particles keep their number; all are of phase 0 where there were no phases before. With count 0
 * they are alike again. Wakes all. PBF_ERROR_INVALID_ARGUMENT: particles or an emitter have a phase
 * that would be no more; PBF_ERROR_UNSUPPORTED: the backend has no masses, or a parameter is set
 * that does not know of them. */
PBF_API pbf_status pbf_set_phases(pbf_solver *solver, uint32_t count, const pbf_phase *phases);

/* How many pbf_set_phases has set; 0: particles are alike. */
PBF_API pbf_status pbf_get_phase_count(pbf_solver *solver, uint32_t *count);

/* phase->struct_size must be set. */
PBF_API pbf_status pbf_get_phase(pbf_solver *solver, uint32_t index, pbf_phase *phase);

/* Of particles first … first + count - 1 in the order of adding, numbers below
 * pbf_get_phase_count's. New particles are of phase 0, those of an emitter of its own. Wakes all.
 * Without phases 0 is read. */
PBF_API pbf_status pbf_set_particle_phases(pbf_solver *solver, uint32_t first, uint32_t count,
                                           const uint32_t *phases);
PBF_API pbf_status pbf_get_particle_phases(pbf_solver *solver, uint32_t first, uint32_t count,
                                           uint32_t *phases);

#ifdef __cplusplus
}
#endif

#endif
