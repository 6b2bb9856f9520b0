/* The derived parameters in the precision that the particles have. */
#ifndef PBF_PHYSICS_CONSTANTS_H
#define PBF_PHYSICS_CONSTANTS_H

#include <string.h>

#include "physics/choices.h"
#include "physics/depenetration.h"
#include "physics/depth.h"
#include "physics/derive.h"
#include "physics/real.h"
#include "physics/phases.h"
#include "physics/viscosity_stages.h"

enum { PBF_WALL_NODES = 33 };

typedef struct pbf_constants {
  pbf_real h, h2, inv_h, inv_h2;
  pbf_real tiny2;           /* r² below which a pair has no direction */
  pbf_real symmetry_offset; /* which breaks a symmetry, see pbf_break_symmetry */
  pbf_real value_scale, gradient_scale, gradient_over_h;
  pbf_real cfm;
  pbf_real target;       /* density that the solve aims at: 1, or what overfull.h says */
  pbf_real rounding;     /* density error that may be rounding, see pbf_density_rounding */
  pbf_real omega;        /* of an iteration's moves; 1 where lambda adds up */
  pbf_real tension;      /* weight of densities below rest where lambda does not add up */
  pbf_real min_diagonal; /* 1/length² */
  pbf_real scorr_k, scorr_inv_w;
  pbf_real confinement;              /* dt times the strength of eq. 16, see pbf_max_confinement */
  pbf_real viscosity;                /* eq. 17, or … */
  pbf_real viscosity_step;           /* … on sums of passes/viscous_stress.h, */
  pbf_real viscosity_falloff;        /* how steep its weights are, */
  pbf_real viscosity_max_spread;     /* the most that a block's eigenvalues are iterated for, … */
  pbf_real viscosity_diagonal;       /* … and that of the system */
  pbf_viscosity_plan viscosity_plan; /* and its stages */
  pbf_real viscosity_wall_nearest;   /* no particle counts as nearer to a plane, in h */
  pbf_real viscosity_wall[PBF_VISCOUS_WALL_NODES];
  pbf_real flow_time; /* damping_compensation.h: dt times the part that is undone, */
  pbf_real
      max_mean_flow2;   /* … and beyond which way of the flow in a step, squared, less of it is */
  pbf_real torque_part; /* angular_momentum.h: half of what is given back of a torque, over dt */
  pbf_real shear_stress_max_lambda; /* of which it is taken back */
  pbf_real shear_stress_part;       /* shear_stress.h: what is taken back, over dt; … */
  pbf_real wall_fabric_across, wall_fabric_along; /* … what a wall hides of a first layer's M */
  pbf_real per_neighbor, neighbors_of_solids; /* surface_tension.h: of what a particle has; … */
  pbf_real surface_pull;                      /* … and dt 4 K / h² per_neighbor */
  int scorr_n;
  int accelerated;              /* lambda adds up over the iterations, */
  pbf_real max_tension;         /* … up to this above a density of, and to 0 elsewhere, … */
  pbf_real tension_min_density; /* … see pbf_set_tension */
  pbf_real step_size;           /* of the Chebyshev iteration, */
  double contraction;           /* what its weights follow from, pbf_next_weight, */
  pbf_real weight;              /* and the one of this iteration */
  pbf_real max_change;          /* of lambda in an iteration, see pbf_accelerate */
  double scorr_step, scorr_max; /* an iteration's artificial pressure, and all of it, see
                                    pbf_max_scorr */
  pbf_real smoothing;           /* smooth_pressure.h: what the last pressure counts, … */
  pbf_real time_step2, inv_time_step2; /* … and dt², 1 / dt² */
  pbf_real pressure; /* over -lambda, once it has added up, see pbf_pressure; 0 where it does not */
  pbf_real residual_density;  /* part of a density error that a step leaves, … */
  pbf_real max_undone;        /* … and what it undoes of it at most, … */
  pbf_real max_residual_part; /* … but for the rest of this part, see pbf_residual_density */
  pbf_real overlap_decay;     /* of what is allowed for of an overlap, a step: passes/overlap.h */
  pbf_vec period;             /* of each axis; 0 between walls */
  pbf_real wall_offset;
  pbf_real boundary_weight; /* of what surfaces contribute, and of ghosts */
  pbf_real boundary_rest_density,
      inv_boundary_rest_density; /* density of a wall at a lattice's first layer, or 0 */
  pbf_real wall_gradient_scale;  /* from the slope of two nodes to the gradient that a wall pushes
                                    with, … */
  pbf_real wall_gradient_rise; /* … and how much more for each node beyond the first layer, up to
                              the second, between which there are so many */
  pbf_real wall_first, wall_layer;
  pbf_real
      wall_value[PBF_WALL_NODES]; /* density of a wall at the distance k h / (nodes - 1), and */
  pbf_real wall_slope[PBF_WALL_NODES]; /* its derivative times the distance of two nodes */
  pbf_phase_constants phases;
} pbf_constants;

/* What kernel_slope is scaled by. */
PBF_FN pbf_real pbf_slope_scale(int features, const pbf_constants *c) {
  return features & PBF_FEATURE_POLY6 ? -c->gradient_scale : -c->gradient_over_h;
}

/* Every so many steps one corrects the shear stress of all of them. Arrangements change little in
 * three steps: eddies keep as much as with a correction in every step, for a third of the cost. An
 * odd number: lambda alternates from step to step, and with corrections in even ones alone water
 * boils that no pressure grid carries. */
enum { PBF_SHEAR_STRESS_STEPS = 3 };

/* Whether the step that is the nth of its length is one of these: by what calls, divided in
 * whatever way, and saved states keep. A correction stands for as many steps that are alike, so
 * that steps that alternate have none. */
static inline int pbf_shear_stress_is_due(uint64_t nth) {
  return nth % PBF_SHEAR_STRESS_STEPS == 0;
}

/* Share by share, what starts dense would still be thrown: ten layers 6 % too dense flew at eleven
 * times the speed of a fall by half a layer. Such a step undoes no more than fluid does that
 * spreads by a tenth of its length while a particle falls by h / 2: 0.002 dt / time, of which the
 * share is told by the residual density; all of an error where there is none. But always more than
 * it adds: n iterations leave g H dt² / (4 n d²) under a depth H (depth.h), which is at most the
 * domain's, and twice that where the fluid moves. Under 144 layers it would be squeezed ever more.
 */
static inline double pbf_max_undone_of(const pbf_params *params, double residual_density) {
  double head = 0, dt = params->time_step;
  for (int k = 0; k < PBF_DIM; ++k)
    head += fabs(params->gravity[k]) * (params->domain_max[k] - params->domain_min[k]);
  double left = pbf_depth_error(params, head * dt * dt);
  return residual_density > 0 ? fmax(0.002 * (1 - residual_density) / residual_density, 2 * left)
                              : 1e30;
}

/* And a part of the rest: pressure that is the same however great an error holds no weight, for
 * what holds it is that there is more of it below. With one iteration a step of 2 ms, where water
 * at rest is a percent dense, it fell to half its height. What weight asks for goes with dt², and
 * so does the part: shorter steps would throw by more of it. */
static inline double pbf_max_residual_part(double residual_density) {
  return 1 - 0.1 * (1 - residual_density) * (1 - residual_density);
}

/* What a step takes off an overlap: passes/overlap.h. */
static inline double pbf_overlap_decay_of(const pbf_params *params) {
  return fmin(pbf_overlap_rate(params, PBF_DIM) * params->time_step, 1);
}

/* A density at rest is 1 but for the rounding of its sum and of the places, and what the solve does
 * about that becomes velocity, too: in a step of 1e-7 s half a metre a second. So where a step is
 * short for gravity, `residual_density` > 0, or no gravity says what is short, errors of no more
 * than that are none: in float32 1e-5 for a domain of ten h. Larger ones are undone as elsewhere.
 */
static inline double pbf_density_rounding(const pbf_params *params, double residual_density,
                                          double diagonal) {
  const double bit = sizeof(pbf_real) == sizeof(float) ? 0x1p-23 : 0x1p-52;
  double extent = 0, part = pbf_gravity_of(params) > 0 ? residual_density : 1;
  for (int k = 0; k < PBF_DIM; ++k)
    extent = fmax(extent, fmax(fabs(params->domain_min[k]), fabs(params->domain_max[k])));
  return part * fmin(1e-4, 2 * bit * (4 + extent * sqrt(diagonal)));
}

/* Artificial pressure that a step can integrate, times the stiffness. Measured where it is beyond
 * all bounds: a fluid at rest boils from 15 on at h = 2 spacings (the paper's own iteration from
 * 40 on), from 0.3 on at 3, where its share at rest spacing is 0.7 instead of 0.02; a dam break
 * gains energy from 3 on. */
static inline double pbf_max_scorr(const pbf_params *params) {
  double q = pbf_derive_spacing(params) / params->smoothing_radius;
  double rest = pbf_shape_value(params->kernel, q);
  double share = params->scorr_k > 0 ? rest / pbf_shape_value(params->kernel, params->scorr_dq) : 0;
  return fmin(1, 0.02 / fmax(pbf_pow(share, params->scorr_n), 1e-6));
}

/* The most of dt e, a length (eq. 16): each step multiplies eddies by 1 + dt e / their width, and
 * what the density solve takes from them does not grow with e. Measured on tanks and dam breaks at
 * steps of 1.3 to 20 ms: at 0.01 h they gain next to nothing (in the shortest steps up to twice
 * their energy), at 0.02 h up to ten times, from 0.1 h on a hundred times and more. The paper's own
 * iteration has the paper's confinement. */
static inline double pbf_max_confinement(const pbf_params *params) {
  int accelerated = params->solver == PBF_SOLVER_CHEBYSHEV;
  return accelerated ? 0.01 * params->smoothing_radius : INFINITY;
}

/* What an iteration may add to lambda, times the stiffness: where neighbours are few a disordered
 * fluid is stiffer than its lattice by far. With h of fewer than two spacings it boils under its
 * weight in long steps; in 2D, from 2 on, what hits a wall at half a spacing a step flies off with
 * twice its energy. Measured from 1.3 to 3 spacings. */
static inline double pbf_max_change_of(const pbf_params *params) {
  double spacings = params->smoothing_radius / pbf_derive_spacing(params);
  return fmin(fmax(1 + (spacings - 1.4) / 0.3, 0.5), PBF_DIM == 2 ? 1.5 : 3);
}

/* Interval [a, L] of eigenvalues that the Chebyshev iteration treats alike: L is the lattice's
 * largest with room for disorder; a such that the iterations of a step leave `rest` of what lies
 * inside, but not so small that the memory of the iteration outlasts changes of the contact set:
 * below an angle of about 0.2, 16 iterations of a falling block gain energy. */
static inline void pbf_set_acceleration(pbf_constants *c, const pbf_params *params,
                                        double stiffness, double pressure) {
  const double rest = 0.3, min_angle = 0.25, margin = 1.05;
  double largest = margin * PBF_SAFE_RELAXATION / (double)c->omega;
  double angle = fmax(pbf_acosh(1 / rest) / params->iterations, min_angle);
  double smallest = largest * (pbf_cosh(angle) - 1) / (pbf_cosh(angle) + 1);
  c->accelerated = params->solver == PBF_SOLVER_CHEBYSHEV;
  c->step_size = (pbf_real)(2 / (largest + smallest));
  c->contraction = (largest - smallest) / (largest + smallest);
  c->weight = 1;
  c->max_change = (pbf_real)(stiffness > 0 ? pbf_max_change_of(params) / stiffness : 1e30);
  c->scorr_step = params->scorr_k * (double)c->omega;
  c->scorr_max = stiffness > 0 ? pbf_max_scorr(params) / stiffness : 0;
  c->pressure = (pbf_real)(c->accelerated && params->time_step > 0
                               ? pressure / (params->time_step * params->time_step)
                               : 0);
  c->residual_density = (pbf_real)pbf_residual_part(params);
  c->overlap_decay = (pbf_real)pbf_overlap_decay_of(params);
  c->max_undone = (pbf_real)pbf_max_undone_of(params, pbf_residual_part(params));
  c->max_residual_part = (pbf_real)pbf_max_residual_part(pbf_residual_part(params));
  if (c->accelerated) c->omega = 1;
}

/* A twentieth, where the square of the step's length is a number and not 0. */
static inline void pbf_set_smoothing(pbf_constants *c, const pbf_params *params) {
  const double part = 0.05, dt2 = params->time_step * params->time_step;
  const double least = sizeof(pbf_real) == sizeof(float) ? 1e-37 : 1e-300;
  const int acts = c->accelerated && dt2 > least && dt2 < 1 / least;
  c->smoothing = (pbf_real)(acts ? part : 0);
  c->time_step2 = (pbf_real)(acts ? dt2 : 0);
  c->inv_time_step2 = (pbf_real)(acts ? 1 / dt2 : 0);
}

/* Fluid that is torn apart inside, where water would not be, pulls itself together: lambda may be
 * above 0 where a density lacks less than a tenth of what the outermost layer of a lattice lacks,
 * so that surfaces, films and drops never pull. (From a fifth on, what doubles its weight gains
 * energy.) No more pull than holds up a column of 8 h, so that short steps do not throw what they
 * find torn, and none without gravity, which is what says that; nor more than a lattice takes
 * without falling together, since pull undoes what pressed lattices are stiff by. */
static inline void pbf_set_tension(pbf_constants *c, const pbf_params *params,
                                   const pbf_derived *d) {
  const double layers = 8, part = 0.1;
  double dt = params->time_step, weight = layers * d->h * pbf_gravity_of(params) * dt * dt;
  double pull =
      d->stiffness > 0 && d->pressure > 0 ? fmin(weight / d->pressure, 1 / d->stiffness) : 0;
  c->max_tension = (pbf_real)(params->cohesion * pull);
  c->tension_min_density = (pbf_real)(1 - part * d->surface_lacks);
}

/* Steps in which the weight falls by more than half a spacing are too long for the arrangement to
 * last until the next, and correct nothing. What presses pairs more than a domain full of fluid
 * weighs is no fluid under its weight: what is squeezed so would boil. */
static inline void pbf_set_shear_stress(pbf_constants *c, const pbf_params *params,
                                        const pbf_derived *d) {
  const double part = pbf_shear_stress_correction(params), dt = params->time_step;
  double head = 0, weight = pbf_gravity_of(params);
  for (int k = 0; k < PBF_DIM; ++k)
    head += fabs(params->gravity[k]) * (params->domain_max[k] - params->domain_min[k]);
  const int acts = dt > 0 && weight * dt * dt <= 0.5 * pbf_derive_spacing(params);
  c->shear_stress_part = (pbf_real)(acts ? PBF_SHEAR_STRESS_STEPS * part / dt : 0);
  c->shear_stress_max_lambda =
      (pbf_real)(head > 0 && d->pressure > 0 ? head * dt * dt / d->pressure : INFINITY);
}

/* K of surface_tension.h is this times tension / spacing. Measured on drops of 8 to 24 spacings
 * radius, by their pressure and period: what energy a surface has in the end depends on how its
 * particles arrange themselves. */
#define PBF_PULL_OF_TENSION (PBF_DIM == 3 ? 21 : 13)

static inline void pbf_set_surface_tension(pbf_constants *c, const pbf_params *params,
                                           const pbf_derived *d) {
  const double acts =
      pbf_acting_tension(d->spacing, params->surface_tension, params->time_step, PBF_DIM);
  c->per_neighbor = (pbf_real)d->per_neighbor;
  c->neighbors_of_solids = (pbf_real)d->neighbors_of_solids;
  c->surface_pull = (pbf_real)(PBF_PULL_OF_TENSION * acts / d->spacing * params->time_step * 4 *
                               d->per_neighbor / (d->h * d->h));
}

/* The constants of iteration k = 0, 1, …: `c` of the one before gets the weight (Golub & Varga
 * 1961), and its artificial pressure, until all that a step can take has acted. */
static inline void pbf_set_iteration(pbf_constants *c, uint32_t k) {
  if (!c->accelerated) return;
  double r2 = c->contraction * c->contraction;
  c->weight = (pbf_real)(k == 0 ? 1 : k == 1 ? 2 / (2 - r2) : 4 / (4 - r2 * (double)c->weight));
  double left = fmax(0, c->scorr_max - c->scorr_step * k);
  c->scorr_k = (pbf_real)fmin(c->scorr_step, left);
}

/* Of viscosity as a stress. */
static inline void pbf_set_viscosity(pbf_constants *c, const pbf_params *params,
                                     const pbf_derived *d) {
  const pbf_viscosity_lattice *l = &d->viscosity;
  c->viscosity_step = c->viscosity_falloff = 0;
  c->viscosity_max_spread = c->viscosity_diagonal = 0;
  c->viscosity_wall_nearest = 0;
  for (int k = 0; k < PBF_VISCOUS_WALL_NODES; ++k) c->viscosity_wall[k] = 0;
  c->viscosity_plan = (pbf_viscosity_plan){0, 1, 1};
  if (!(params->viscosity > 0) || params->solver != PBF_SOLVER_CHEBYSHEV) return;
  const double step =
      pbf_viscosity_acting(params, l, PBF_DIM) * params->time_step * l->to_laplacian;
  c->viscosity_plan = pbf_viscosity_plan_of(params, l, PBF_DIM);
  c->viscosity_step = (pbf_real)step;
  c->viscosity_falloff = (pbf_real)l->falloff;
  const double spread = PBF_VISCOSITY_UNEVEN * l->spread / PBF_DIM;
  c->viscosity_max_spread = (pbf_real)spread;
  c->viscosity_diagonal = (pbf_real)(1 + step * spread);
  c->viscosity_wall_nearest = (pbf_real)(0.25 * d->spacing / d->h);
  for (int k = 0; k < PBF_VISCOUS_WALL_NODES; ++k)
    c->viscosity_wall[k] = (pbf_real)(step * l->wall[k]);
}

/* The weights of a stage: of what its blocks make of the residual, and of the change by the last
 * stage. */
typedef struct pbf_viscosity_weights {
  int first; /* the velocity that it finds is what the step starts from */
  pbf_real residual, before;
} pbf_viscosity_weights;

/* Of stage k = 0, 1, … (Saad, Iterative methods for sparse linear systems, 2003, algorithm 12.1).
 */
static inline pbf_viscosity_weights pbf_viscosity_weights_of(const pbf_constants *c, uint32_t k) {
  const pbf_viscosity_plan *p = &c->viscosity_plan;
  double before = 1 / p->ratio, now = before;
  if (k == 0) return (pbf_viscosity_weights){1, (pbf_real)(1 / p->center), 0};
  for (uint32_t stage = 1; stage <= k; ++stage) {
    before = now;
    now = 1 / (2 * p->ratio - before);
  }
  return (pbf_viscosity_weights){0, (pbf_real)(2 * now * p->ratio / p->center),
                                 (pbf_real)(now * before)};
}

/* What a wall pushes with. */
static inline void pbf_set_wall_gradient(pbf_constants *c, const pbf_derived *d) {
  enum { LAST = PBF_WALL_NODES - 1 };
  double layer = LAST * d->spacing / d->h;
  c->wall_gradient_scale = (pbf_real)(LAST / d->h * d->wall_gradient_scale);
  c->wall_gradient_rise =
      (pbf_real)(LAST / d->h * (d->wall_gradient_scale_far - d->wall_gradient_scale) / layer);
  c->wall_first = (pbf_real)(LAST * d->wall_first);
  c->wall_layer = (pbf_real)layer;
}

/* Density that a wall contributes at the nodes t h. The half-space beyond it would have f(t), and
 * with f's own slope the first layer of a fluid at rest is not held half a spacing off: a tank ten
 * layers wide lost 8 % of its height. So it is f0 (f/f0)^s, f0 the value at that layer and s from
 * pbf_derive_wall: with it, what walls contribute is to about a hundredth what ghosts in them
 * would on average, in motion too. Where that is thrice f0 it goes on in a straight line: the power
 * would throw particles about at contact. */
static inline void pbf_set_walls(pbf_constants *c, const pbf_params *params,
                                 const pbf_derived *derived) {
  enum { LAST = PBF_WALL_NODES - 1 };
  const double largest = 3;
  double at = 1, value = 0, slope = 0; /* of the steepest node */
  memset(c->wall_value, 0, sizeof c->wall_value);
  memset(c->wall_slope, 0, sizeof c->wall_slope);
  c->wall_offset = (pbf_real)derived->wall_offset;
  c->boundary_weight = (pbf_real)params->wall_density;
  c->wall_fabric_across = (pbf_real)(derived->wall_fabric_across * params->wall_density);
  c->wall_fabric_along = (pbf_real)(derived->wall_fabric_along * params->wall_density);
  c->boundary_rest_density = c->inv_boundary_rest_density = 0;
  pbf_set_wall_gradient(c, derived);
  if (!(params->wall_density > 0)) return;
  double scale = derived->wall_first_density * params->wall_density;
  c->boundary_rest_density = (pbf_real)scale;
  c->inv_boundary_rest_density = (pbf_real)(scale > 0 ? 1 / scale : 0);
  for (int k = LAST - 1; k >= 0; --k) {
    double t = (double)k / LAST, steeper, more;
    more = pbf_wall_contribution(derived, params->kernel, PBF_DIM, t, &steeper);
    if (more <= largest) at = t, value = more, slope = steeper;
    c->wall_value[k] = (pbf_real)(scale * (value + (t - at) * slope));
    c->wall_slope[k] = (pbf_real)(scale * slope / LAST);
  }
}

/* `same`: those of other parameters with the same derived ones, or null: the tables of walls are
 * known from them, which takes a thousandth of the time. */
static inline pbf_constants pbf_constants_from(const pbf_params *params, const pbf_derived *derived,
                                               const pbf_constants *same) {
  const pbf_derived &d = *derived;
  pbf_constants c;
  if (same) c = *same;
  c.h = (pbf_real)d.h;
  c.h2 = (pbf_real)(d.h * d.h);
  c.inv_h = (pbf_real)(1 / d.h);
  c.inv_h2 = (pbf_real)(1 / (d.h * d.h));
  c.tiny2 = (pbf_real)(1e-14 * d.h * d.h);
  c.symmetry_offset = (pbf_real)(1e-12 * d.spacing);
  c.value_scale = (pbf_real)d.value_scale;
  c.gradient_scale = (pbf_real)d.gradient_scale;
  c.gradient_over_h = (pbf_real)(d.gradient_scale / d.h);
  c.cfm = (pbf_real)d.cfm;
  c.target = 1;
  c.omega = (pbf_real)d.omega;
  /* Never 0, so that the lambda of a lone particle is finite, and moves nothing. */
  c.min_diagonal = (pbf_real)(fmax(params->min_diagonal, 1e-12) * d.diagonal);
  c.scorr_k = (pbf_real)d.scorr_k;
  c.scorr_inv_w = (pbf_real)d.scorr_inv_w;
  c.confinement =
      (pbf_real)fmin(params->time_step * params->vorticity, pbf_max_confinement(params));
  c.viscosity = (pbf_real)fmin(params->viscosity, 1);
  pbf_set_viscosity(&c, params, &d);
  c.flow_time = (pbf_real)(params->damping_compensation * params->time_step);
  c.max_mean_flow2 = (pbf_real)(0.01 * d.h * d.h);
  c.torque_part = (pbf_real)(params->time_step > 0
                                 ? 0.5 * pbf_angular_momentum_correction(params) / params->time_step
                                 : 0);
  pbf_set_shear_stress(&c, params, &d);
  pbf_set_surface_tension(&c, params, &d);
  c.scorr_n = (int)params->scorr_n;
  pbf_set_acceleration(&c, params, d.stiffness, d.pressure);
  pbf_set_smoothing(&c, params);
  pbf_set_tension(&c, params, &d);
  for (int k = 0; k < PBF_DIM; ++k) c.period.c[k] = pbf_period_of(params, k);
  if (!same) pbf_set_walls(&c, params, &d);
  c.rounding = c.accelerated
                   ? (pbf_real)pbf_density_rounding(params, (double)c.residual_density, d.diagonal)
                   : 0;
  c.tension = c.accelerated ? 1 : (pbf_real)params->cohesion;
  c.phases.heaviest = c.phases.carried = 1;
  return c;
}

static inline pbf_constants pbf_constants_of(const pbf_params *params) {
  const pbf_derived derived = pbf_derive(params, PBF_DIM);
  return pbf_constants_from(params, &derived, NULL);
}

static inline int pbf_only_time_step_differs(const pbf_params *before, const pbf_params *after) {
  pbf_params other = *before;
  other.time_step = after->time_step;
  return memcmp(&other, after, sizeof other) == 0;
}

#endif
