/* How many stages viscosity takes in a step, and their weights. Host only, float64.
 *
 * v' = nu laplace(v) is integrated over a step by the implicit Euler method, as in Weiler,
 * Koschier, Brand and Bender, A physically consistent implicit viscosity solver for SPH fluids
 * (2018): so flows that are steady are right at any step, and none is unstable. The system (1 + K)
 * v = v*, K of passes/viscous_stress.h, is solved by the Chebyshev semi-iteration (Golub and Varga
 * 1961), with the same bound D of all particles' blocks as a preconditioner. It needs no sums over
 * all particles, and so has the same bits on any number of threads.
 *
 * K is a sum over pairs, hence 1 <= 1 + K <= 2 D - 1, and the eigenvalues of D⁻¹ (1 + K) lie
 * between 1 / (1 + k) and 2 - 1 / (1 + k), k = D - 1. The interval that is iterated for
 * is such that the first root of the polynomial is at 1 / (1 + k) of the rest lattice: of waves
 * that are long no error is left. */
#ifndef PBF_PHYSICS_VISCOSITY_STAGES_H
#define PBF_PHYSICS_VISCOSITY_STAGES_H

#include <math.h>

#include "physics/derive.h"

/* Of what a step is to change a velocity by, so much is left at most. */
#define PBF_VISCOSITY_TOLERANCE 0.02

/* Block beyond which more viscosity does not act: 106 stages. */
#define PBF_VISCOSITY_MAX_STIFFNESS 750.0

/* Times the rest lattice's block: the most that is iterated for, which is as uneven as fluids are.
 * In crowds pairs have less viscosity, so that it holds there, too (passes/viscous_stress.h). */
#define PBF_VISCOSITY_UNEVEN 1.25

/* Of a viscosity of 1: the block of the rest lattice. */
static inline double pbf_viscosity_stiffness(const pbf_params *params,
                                             const pbf_viscosity_lattice *l, uint32_t dimension) {
  return params->time_step * l->to_laplacian * l->spread / dimension;
}

/* The viscosity that acts. */
static inline double pbf_viscosity_acting(const pbf_params *params,
                                          const pbf_viscosity_lattice *lattice,
                                          uint32_t dimension) {
  const double stiffness = pbf_viscosity_stiffness(params, lattice, dimension);
  return stiffness > 0 ? fmin(params->viscosity, PBF_VISCOSITY_MAX_STIFFNESS / stiffness)
                       : params->viscosity;
}

/* The interval of eigenvalues that so many stages are for, by its center, and the ratio of that to
 * its half width. */
typedef struct pbf_viscosity_plan {
  uint32_t stages;
  double center, ratio;
} pbf_viscosity_plan;

/* Chebyshev's polynomial. */
static inline double pbf_chebyshev(uint32_t degree, double x) {
  double before = 1, value = x;
  for (uint32_t k = 1; k < degree; ++k) {
    const double next = 2 * x * value - before;
    before = value;
    value = next;
  }
  return value;
}

/* By so many stages; 0: they are too few for `lowest` and `highest`. */
static inline int pbf_viscosity_plan_with(uint32_t stages, double lowest, double highest,
                                          pbf_viscosity_plan *plan) {
  *plan = (pbf_viscosity_plan){stages, lowest, 1};
  if (stages == 1) return highest / lowest - 1 <= PBF_VISCOSITY_TOLERANCE;
  const double root = pbf_cos(0.5 * 3.14159265358979323846 / stages);
  const double from = (2 * lowest - highest * (1 - root)) / (1 + root);
  if (!(from > 0)) return 0;
  plan->center = 0.5 * (highest + from);
  plan->ratio = (highest + from) / (highest - from);
  return pbf_chebyshev(stages, plan->ratio) * PBF_VISCOSITY_TOLERANCE >= 1;
}

static inline pbf_viscosity_plan pbf_viscosity_plan_of(const pbf_params *params,
                                                       const pbf_viscosity_lattice *lattice,
                                                       uint32_t dimension) {
  const double k = pbf_viscosity_acting(params, lattice, dimension) *
                   pbf_viscosity_stiffness(params, lattice, dimension);
  const double lowest = 1 / (1 + PBF_VISCOSITY_UNEVEN * k);
  const double highest = 2 - 1 / (1 + PBF_VISCOSITY_UNEVEN * k);
  pbf_viscosity_plan plan;
  uint32_t stages = (uint32_t)(0.7 * sqrt(highest / lowest));
  if (stages < 1) stages = 1;
  while (!pbf_viscosity_plan_with(stages, lowest, highest, &plan)) ++stages;
  return plan;
}

static inline uint32_t pbf_viscosity_stages(const pbf_params *params,
                                            const pbf_viscosity_lattice *lattice,
                                            uint32_t dimension) {
  return pbf_viscosity_plan_of(params, lattice, dimension).stages;
}

#endif
