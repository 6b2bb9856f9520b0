/* How deep water the iterations carry. Pressure goes from layer to layer, about one an iteration:
 * at rest n iterations leave under a depth H of water with the acceleration g a density error of
 * g H dt² / (4 n d²), d being the spacing (measured up to 20 layers; it grows faster from there).
 */
#ifndef PBF_PHYSICS_DEPTH_H
#define PBF_PHYSICS_DEPTH_H

#include "physics/attraction_depth.h"
#include "physics/basins.h"
#include "physics/choices.h"
#include "physics/derive.h"
#include "physics/elementary.h"
#include "physics/fullness.h"
#include "physics/phases.h"
#include "physics/steps_leave.h"

/* What is left of an error of this kind to the iterations, where a grid carries the rest: the
 * larger one of LEFT and SHARE (error - FROM). What they press on keeps its order: fluid whose
 * whole weight is carried comes loose, by 3 % of its volume, and trembles.
 *
 * LEFT: with 0.5 % 100 layers come loose in one run of a few; with 0.7 % water of 20 layers is
 * lower than n iterations should leave it, with 1 % by half again as much.
 *
 * SHARE: what the grid carries wakes its neighbours, too, and grows with the weight: so the
 * iterations get a share of what is beyond 60 layers (4 iterations, 1/120 s), which is more than
 * LEFT from 220 on. With 0.7 % at any depth 300 layers from disorder swell by 0.7 %, in steps of
 * 1/44 s by 4 %; with 7 % of what is beyond 3 %, 60 and 100 layers in steps of 1/60 s stand 0.1 %
 * lower. */
#define PBF_DEPTH_LEFT 0.006
#define PBF_DEPTH_SHARE 0.05
#define PBF_DEPTH_FROM 0.05

/* Pairs resist shear with what pressure they carry themselves. With shear_stress_correction, which
 * is as noisy as that is great, the iterations get no more than this part of an error, or else the
 * weight of so many layers: with less, shallow water comes loose and trembles. Water of
 * SHEARED_FROM layers and more then has a grid in short steps, too: an eddy in 24 layers in 3D
 * keeps 0.77 instead of 0.13 of its angular momentum in 2 s of 1/240 s each, and 60 layers at rest
 * move at 0.01 √(g d) instead of 0.14. But not in steps that undo a share of an error alone: a grid
 * undoes all of it. */
#define PBF_DEPTH_SHEARED_LEFT 0.1
#define PBF_DEPTH_SHEARED_LEFT_LAYERS 2
#define PBF_DEPTH_SHEARED_FROM 6

/* Left to the solver, only water of so many layers is corrected. Shallower water gains as much, for
 * waves slosh on that are gone after two periods without it, but beside colliders, of which cells
 * of four spacings tell little, it trembles: 12 layers at 0.035 √(g d) around a ball, without a
 * grid at 0.012; and a step takes 1.3 times as long on a CPU, 2 to 6 times on a GPU. */
#define PBF_DEPTH_SHEARED_LAYERS 18

/* Above this error at its settled depth, some 17 layers at 1/120 s and 4 iterations, water gets a
 * grid of the width below where the caller leaves the choice to the solver. */
#define PBF_DEPTH_DEEP 0.015
#define PBF_DEPTH_WIDTH 2

/* Fluid that an attraction weighs has one from so many layers on. Of shells of 4 to 12 layers cells
 * of four spacings tell little: in 3D they stood no better with a grid, or swelled. */
#define PBF_DEPTH_ATTRACTED_LAYERS 16

/* The most particles that a solver with this capacity plans for (lib/solver/plan.c). */
static inline uint32_t pbf_max_planned(uint32_t capacity) { return capacity + capacity / 3 + 3; }

/* Of a head g H dt², in length². */
static inline double pbf_depth_error(const pbf_params *params, double head) {
  double d = pbf_derive_spacing(params), iterations = params->iterations;
  return head / (4 * fmax(iterations, 1) * d * d);
}

/* Whether such a depth along the axis is enough for the correction where the caller leaves that to
 * the solver, and for the grid that it wants. */
static inline int pbf_depth_is_sheared(const pbf_params *params, int axis, double depth) {
  const int layers =
      params->shear_stress_correction >= 0 ? PBF_DEPTH_SHEARED_FROM : PBF_DEPTH_SHEARED_LAYERS;
  return pbf_shear_stress_correction(params) > 0 && fabs(params->gravity[axis]) > 0 &&
         pbf_residual_part(params) == 0 && depth > (layers - 0.5) * pbf_derive_spacing(params);
}

/* Whether the grid is wanted at such a depth along the axis. */
static inline int pbf_depth_is_deep(const pbf_params *params, int axis, double depth) {
  double head = fabs(params->gravity[axis]) * depth * params->time_step * params->time_step;
  return pbf_depth_is_sheared(params, axis, depth) ||
         pbf_depth_error(params, head) > PBF_DEPTH_DEEP;
}

/* Of so many particles, settled in the domain or in a container within it, along the axis of the
 * gravity's largest component of those that have walls; periodic ones have no floor. */
typedef struct pbf_settled {
  double fluid;  /* the particles' volume */
  double depth;  /* theirs */
  double height; /* the domain's */
  int axis;
} pbf_settled;

static inline pbf_settled pbf_settled_of(const pbf_params *params, uint32_t colliders,
                                         const pbf_collider *list, uint32_t count) {
  pbf_settled s = {(double)count, 0, 0, 0};
  double part = count, largest = 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    double length = params->domain_max[k] - params->domain_min[k], g = fabs(params->gravity[k]);
    part *= pbf_derive_spacing(params) / length;
    s.fluid *= pbf_derive_spacing(params);
    if (!(g > largest) || pbf_is_periodic(params, k)) continue;
    largest = g;
    s.height = length;
    s.axis = k;
  }
  s.depth = fmax(s.height * fmin(part, 1),
                 pbf_containers_depth(params, colliders, list, s.axis, s.fluid));
  return s;
}

/* Whether `is_deep` holds for them there, between other colliders, or where planes leave room. What
 * holds at a depth holds at a larger one. */
static inline int pbf_depth_could_be(int (*is_deep)(const pbf_params *params, int axis,
                                                    double depth),
                                     const pbf_params *params, pbf_basins *basins,
                                     uint32_t colliders, const pbf_collider *list, uint32_t count) {
  const pbf_settled s = pbf_settled_of(params, colliders, list, count);
  if (is_deep(params, s.axis, s.depth)) return 1;
  if (!is_deep(params, s.axis, s.height * (1 + 1e-9))) return 0; /* no basin is deeper */
  if (is_deep(params, s.axis, pbf_basins_deepest(basins, params, colliders, list, s.axis))) {
    pbf_basins_find(basins, params);
    if (is_deep(params, s.axis, pbf_basins_depth(basins, s.fluid))) return 1;
  }
  if (!is_deep(params, s.axis, basins->room_height)) return 0;
  pbf_basins_find_room(basins, params);
  return is_deep(params, s.axis, pbf_region_depth(&basins->room, s.fluid));
}

static inline int pbf_may_have_pressure_grid(const pbf_params *params) {
  return params->pressure_grid != 0;
}

static inline int pbf_depth_has_weight(const pbf_params *params) {
  double most = fabs(params->attraction);
  for (int k = 0; k < PBF_DIM; ++k) most = fmax(most, fabs(params->gravity[k]));
  return most > 0;
}

/* Whether there is something for a grid to carry at such a depth along the axis. */
static inline int pbf_depth_is_beyond_left(const pbf_params *params, int axis, double depth) {
  double head = fabs(params->gravity[axis]) * depth * params->time_step * params->time_step;
  return pbf_depth_error(params, head) > PBF_DEPTH_LEFT;
}

/* Whether an attraction weighs so many particles, deep ones, of which the iterations would leave
 * more than that. */
static inline int pbf_attraction_leaves(const pbf_params *params, uint32_t colliders,
                                        const pbf_collider *list, uint32_t count, double error) {
  const double fluid = count * pbf_whole_power(pbf_derive_spacing(params), PBF_DIM);
  const pbf_attracted is = pbf_attracted_of(params, colliders, list, fluid);
  const double least = (PBF_DEPTH_ATTRACTED_LAYERS - 0.5) * pbf_derive_spacing(params);
  const double head = is.head * params->time_step * params->time_step;
  return is.depth > least && pbf_depth_error(params, head) > error;
}

/* Such parameters as leave this error for each layer, in place of those that leave another one. */
static inline pbf_params pbf_with_error_per_layer(const pbf_params *params, double error) {
  pbf_params other = *params;
  other.time_step *= sqrt(error / pbf_error_per_layer(params, PBF_DIM));
  return other;
}

/* Whether a grid is wanted in these steps, or was in those that left the most for each layer and
 * still has something to carry. Where it went sooner, the iterations would from one step to the
 * next have up to two and a half times as much to carry, and water at rest would jump. */
static inline int pbf_depth_wants_grid(const pbf_params *params, pbf_basins *basins,
                                       uint32_t colliders, const pbf_collider *list, uint32_t count,
                                       double most) {
  const double error = pbf_error_per_layer(params, PBF_DIM);
  if (!(error > 0) || pbf_is_more_than_ever(error, most))
    return pbf_depth_could_be(pbf_depth_is_deep, params, basins, colliders, list, count) ||
           pbf_attraction_leaves(params, colliders, list, count, PBF_DEPTH_DEEP);
  const pbf_params longest = pbf_with_error_per_layer(params, most);
  return pbf_depth_could_be(pbf_depth_is_sheared, params, basins, colliders, list, count) ||
         (pbf_depth_could_be(pbf_depth_is_beyond_left, params, basins, colliders, list, count) &&
          pbf_depth_could_be(pbf_depth_is_deep, &longest, basins, colliders, list, count)) ||
         (pbf_attraction_leaves(params, colliders, list, count, PBF_DEPTH_LEFT) &&
          pbf_attraction_leaves(&longest, colliders, list, count, PBF_DEPTH_DEEP));
}

/* The cells' width of the grid that so many particles have, in units of h; 0: none. More particles
 * have one where fewer have. `most` is what steps have left for each layer, at most. Of `phases`,
 * null where there are none, those that are close (phases.h) have one however deep they are,
 * without which light ones do not rise. Wide kernels part them by themselves, and are quieter
 * without one where they are shallow. Those of which it would carry nothing have none. */
static inline double pbf_depth_grid(const pbf_params *params, pbf_basins *basins,
                                    uint32_t colliders, const pbf_collider *list, uint32_t count,
                                    double most, const pbf_phase_table *phases = NULL) {
  if (!pbf_may_have_pressure_grid(params)) return 0;
  if (phases && !(pbf_carried_density(phases) > 0)) return 0;
  if (params->pressure_grid > 0) return params->pressure_grid;
  const int always = phases && pbf_phases_are_close(phases) && !pbf_is_wide_kernel(params);
  int deep = params->solver == PBF_SOLVER_CHEBYSHEV &&
             (always ? pbf_depth_has_weight(params)
                     : pbf_depth_wants_grid(params, basins, colliders, list, count, most));
  return deep ? PBF_DEPTH_WIDTH : 0;
}

/* Whether so many particles have their shear stress corrected. Without gravity only what walls
 * press on all sides, which take angular momentum themselves: of a body that an attraction holds
 * together the correction would take 0.3 to 1 % in 4 s. Where fluids differ by little, what
 * pressure resists of shear would hold the lighter one under the other for good, however deep they
 * are. */
static inline int pbf_depth_corrects_shear(const pbf_params *params, pbf_basins *basins,
                                           uint32_t colliders, const pbf_collider *list,
                                           uint32_t count, int phases = 0) {
  if (params->shear_stress_correction >= 0) return params->shear_stress_correction > 0;
  if (pbf_shear_stress_correction(params) == 0) return 0;
  if (params->surface_tension > 0) return 1;
  if (pbf_gravity_of(params) == 0) return pbf_is_full(params, colliders, list, count);
  if (phases) return 1;
  return pbf_may_have_pressure_grid(params) &&
         pbf_depth_could_be(pbf_depth_is_sheared, params, basins, colliders, list, count);
}

#endif
